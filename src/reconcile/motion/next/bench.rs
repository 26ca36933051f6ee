//! Measurements at rest: gains and timing of accelerometers.

use super::parameter_information::Rows;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::corrections::adjustments;
use crate::reconcile::motion::frame::MotionFrame;
use crate::reconcile::motion::motion_fit::MotionFit;
use crate::reconcile::motion::part::ColumnOf;
use crate::vehicle::adjustment::{Adjustment, Lag};
use crate::vehicle::layout::Measures;

/// Uncertainty of a gain from plus and minus 1 g, one sd: a sensor that leans by 4 degrees reads this much less.
const TURNED: f64 = 0.0025;
/// Uncertainty of a time from a stroke, samples, one sd. A peak between two samples is located to a fifth of their distance.
const STRUCK: f64 = 0.2;

/// Returns the accelerometers of the compared bodies, as numbers in the design.
fn accelerometers(frame: &MotionFrame, fit: &MotionFit) -> Vec<usize> {
    let v = &fit.assembled.vehicle;
    let own = |name: &str| {
        v.sensors.iter().any(|s| {
            let is_compared = frame.bodies.contains(&s.at.body);
            s.channel == name && is_compared && s.measures == Measures::Acceleration
        })
    };
    let channels = fit.design.channels.iter().enumerate();
    channels
        .filter(|(_, c)| own(&c.name))
        .map(|(k, _)| k)
        .collect()
}

/// Returns the estimate of a channel's tolerance; 0 if the fit has none.
fn estimate(fit: &MotionFit, of: ColumnOf) -> f64 {
    let at = fit.column_of.iter().position(|c| *c == of);
    at.and_then(|at| fit.estimates.get(at).copied())
        .unwrap_or(0.0)
}

/// Returns the columns of every fault and tolerance for rows of channels: `entry(row, column)` over the row's standard deviation.
fn columns(
    fit: &MotionFit,
    n_rows: usize,
    entry: impl Fn(usize, &ColumnOf) -> f64,
) -> Vec<Vec<f64>> {
    let one = |of: &ColumnOf| (0..n_rows).map(|row| entry(row, of)).collect();
    fit.column_of.iter().map(one).collect()
}

/// Returns the natural log of the factor from each accelerometer's reading to the truth; a reversed sign counts as a factor of e.
pub(super) fn turn_over(frame: &MotionFrame, fit: &MotionFit) -> Rows {
    let own = accelerometers(frame, fit);
    let adjust = adjustments(frame, &fit.parts);
    let name = |row: usize| fit.design.channels[own[row]].name.as_str();
    let reading = (0..own.len()).map(|row| {
        let gain = Adjustment::of_channel(&adjust, name(row)).map_or(1.0, |a| a.gain);
        let turned = f64::from(u8::from(gain < 0.0));
        let tolerance = estimate(fit, ColumnOf::Gain(own[row]));
        (tolerance - gain.abs().ln() + turned) / TURNED
    });
    let entry = |row: usize, of: &ColumnOf| -> f64 {
        let by = match of {
            ColumnOf::Gain(c) if *c == own[row] => 1.0,
            ColumnOf::Fault(p) => match &fit.parts[*p].shape {
                Change::Gain { channel } if channel == name(row) => 1.0 / fit.parts[*p].fault,
                _ => 0.0,
            },
            _ => 0.0,
        };
        by / TURNED
    };
    Rows {
        reading: reading.collect(),
        own: columns(fit, own.len(), entry),
        fresh: vec![],
        scale: vec![],
    }
}

/// Returns the delay of each accelerometer at two strokes, one at the beginning and one at the end of a record. The record is as long as the present
/// one. The times of the strokes are unknown.
pub(super) fn stroke_delay_rows(frame: &MotionFrame, fit: &MotionFit) -> Rows {
    let own = accelerometers(frame, fit);
    let adjust = Adjustment::without_slips(&adjustments(frame, &fit.parts));
    let start_s = frame.data.start_s;
    let length_s = frame.data.duration_s();
    let sigma = STRUCK / frame.data.rate_hz;
    // All channels at the beginning, then at the end.
    let n = own.len();
    let channel = |row: usize| own[row % n.max(1)];
    let name = |row: usize| fit.design.channels[channel(row)].name.as_str();
    let after = |row: usize| if row < n { 0.0 } else { length_s };
    let reading = (0..2 * n).map(|row| {
        let late = Adjustment::of_channel(&adjust, name(row))
            .map_or(0.0, |a| a.lateness(start_s + after(row), start_s));
        (late + estimate(fit, ColumnOf::Delay(channel(row)))) / sigma
    });
    let entry = |row: usize, of: &ColumnOf| -> f64 {
        let by = match of {
            ColumnOf::Delay(c) if *c == channel(row) => 1.0,
            ColumnOf::Fault(p) => match &fit.parts[*p].shape {
                shape if shape.channel() != Some(name(row)) => 0.0,
                Change::Delay { .. } => 1.0,
                Change::Clock { .. } => after(row),
                Change::Lag { order, .. } => Lag {
                    order: *order,
                    time_s: 1.0,
                }
                .delay_s(),
                _ => 0.0,
            },
            _ => 0.0,
        };
        by / sigma
    };
    let stroke = |k: usize| -> Vec<f64> {
        let own = |row: usize| f64::from(u8::from(row / n.max(1) == k)) / sigma;
        (0..2 * n).map(own).collect()
    };
    Rows {
        reading: reading.collect(),
        own: columns(fit, 2 * n, entry),
        fresh: vec![(stroke(0), None), (stroke(1), None)],
        scale: vec![],
    }
}
