//! Corrections of channels: those of the job and those of a set of effects.

use super::change::{Change, with_adjustment};
use super::frame::MotionFrame;
use super::part::Part;
use crate::vehicle::motion::Adjustment;

/// Corrections of the job joined by those of a set.
pub fn adjustments(frame: &MotionFrame, parts: &[Part]) -> Vec<Adjustment> {
    let mut out = frame.corrections.clone();
    for p in parts {
        let more = match &p.shape {
            Change::Gain { channel } => Adjustment {
                channel: channel.clone(),
                gain: 1.0 / p.fault,
                delay_s: 0.0,
            },
            Change::Delay { channel } => Adjustment {
                channel: channel.clone(),
                gain: 1.0,
                delay_s: p.fault,
            },
            Change::Flip { channel } => Adjustment {
                channel: channel.clone(),
                gain: -1.0,
                delay_s: 0.0,
            },
            _ => continue,
        };
        out = with_adjustment(&out, more);
    }
    out
}
