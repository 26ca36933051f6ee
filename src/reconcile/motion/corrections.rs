//! Corrections of channels: those of the job and those of a set of effects.

use super::change::{Change, with_adjustment};
use super::frame::MotionFrame;
use super::part::Part;
use crate::vehicle::adjustment::{Adjustment, Lag, Slip};

/// Corrections of the job joined by those of a set; its mains lines are columns of the fit, not taken out of the record.
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

/// The same with mains lines: what a job states of a set.
pub fn stated(frame: &MotionFrame, parts: &[Part]) -> Vec<Adjustment> {
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

/// Mains lines of a set, Hz.
pub fn lines(parts: &[Part]) -> Vec<f64> {
    let line = |p: &Part| match p.shape {
        Change::Line { hz, .. } => Some(hz),
        _ => None,
    };
    parts.iter().filter_map(line).collect()
}
