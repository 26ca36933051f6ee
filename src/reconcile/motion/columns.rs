//! Columns of the least squares: parameters, faults of channels, and what is declared to be uncertain.

use super::change::Change;
use super::design::{Bins, Design};
use super::frame::MotionFrame;
use super::part::{ColumnOf, Part};
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// The column of one channel in every equation, times a function of angular frequency.
fn channel_column(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    channel: usize,
    factor: impl Fn(f64) -> Complex64,
) -> Vec<Bins> {
    responses
        .iter()
        .map(|r| {
            r[channel]
                .iter()
                .zip(&design.channels[channel].bins)
                .zip(&design.f_hz)
                .map(|((h, a), f)| h * a * factor(2.0 * PI * f))
                .collect()
        })
        .collect()
}

/// Column of a fault of a channel per unit of its parameter (1 / gain, or delay).
pub fn fault_column(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    shape: &Change,
    fault: f64,
) -> Option<Vec<Bins>> {
    let (channel, is_gain) = match shape {
        Change::Gain { channel } => (channel, true),
        Change::Delay { channel } => (channel, false),
        _ => return None,
    };
    let c = design.channels.iter().position(|x| x.name == *channel)?;
    Some(channel_column(design, responses, c, |w| {
        if is_gain {
            Complex64::new(1.0 / fault, 0.0)
        } else {
            Complex64::new(0.0, w)
        }
    }))
}

/// What is declared to be uncertain, as columns with priors (one sd).
pub fn nuisance(
    frame: &MotionFrame,
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    parts: &[Part],
) -> Vec<(ColumnOf, Vec<Bins>, f64)> {
    let mut out = Vec::new();
    for (c, channel) in design.channels.iter().enumerate() {
        let faulty = |is_gain: bool| {
            parts.iter().any(|p| match &p.shape {
                Change::Gain { channel: x } => is_gain && *x == channel.name,
                Change::Delay { channel: x } => !is_gain && *x == channel.name,
                _ => false,
            })
        };
        if frame.gain_tolerance > 0.0 && !faulty(true) {
            let one = |_: f64| Complex64::new(1.0, 0.0);
            out.push((
                ColumnOf::Gain(c),
                channel_column(design, responses, c, one),
                frame.gain_tolerance,
            ));
        }
        if frame.sync_tolerance_s > 0.0 && !faulty(false) {
            let late = |w: f64| Complex64::new(0.0, w);
            out.push((
                ColumnOf::Delay(c),
                channel_column(design, responses, c, late),
                frame.sync_tolerance_s,
            ));
        }
    }
    out
}

/// Equations of a column list, one slice each.
pub fn slices(column: &[Bins]) -> Vec<&[Complex64]> {
    column.iter().map(Vec::as_slice).collect()
}

/// The column of a parameter in every equation.
pub fn parameter_column(design: &Design, parameter: usize) -> Vec<&[Complex64]> {
    design
        .equations
        .iter()
        .map(|e| {
            e.columns
                .iter()
                .find(|c| c.0 == parameter)
                .map_or(&[] as &[Complex64], |c| c.1.as_slice())
        })
        .collect()
}
