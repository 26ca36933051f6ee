//! Corrections of channels from the job and from a set of effects.

use super::change::{Change, with_adjustment};
use super::frame::MotionFrame;
use super::part::Part;
use crate::vehicle::adjustment::{Adjustment, Lag, Slip};

/// Returns the corrections of the job joined with the corrections of a set. Mains lines of the set are columns of the fit, so they are not
/// removed from the record.
pub fn adjustments(frame: &MotionFrame, parts: &[Part]) -> Vec<Adjustment> {
    let mut out = frame.corrections.clone();
    for p in parts {
        let Some(channel) = p.shape.channel() else {
            continue;
        };
        let mut more = Adjustment::none(channel);
        match &p.shape {
            Change::Gain { .. } => more.gain = 1.0 / p.fault,
            Change::Delay { .. } => more.delay_s = p.fault,
            Change::Clock { .. } => more.clock = p.fault,
            Change::Slip { at_s, .. } => more.slips.push(Slip {
                at_s: *at_s,
                by_s: p.fault,
            }),
            Change::Lag { order, .. } => more.lags.push(Lag {
                order: *order,
                time_s: p.fault,
            }),
            Change::Flip { .. } => more.gain = -1.0,
            _ => continue,
        }
        out = with_adjustment(&out, more);
    }
    out
}

/// Returns the corrections of the job and of a set including its mains lines, as a job states them.
pub fn state_corrections(frame: &MotionFrame, parts: &[Part]) -> Vec<Adjustment> {
    let mut out = adjustments(frame, parts);
    for p in parts {
        if let Change::Line { channel, hz } = &p.shape {
            let mut more = Adjustment::none(channel);
            more.lines_hz.push(*hz);
            out = with_adjustment(&out, more);
        }
    }
    out
}

/// Returns the mains lines of a set, Hz.
pub fn lines(parts: &[Part]) -> Vec<f64> {
    let line = |p: &Part| match p.shape {
        Change::Line { hz, .. } => Some(hz),
        _ => None,
    };
    parts.iter().filter_map(line).collect()
}
