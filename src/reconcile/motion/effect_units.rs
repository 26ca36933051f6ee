//! Units of effects.

use super::change::Change;
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use crate::vehicle::term::Quantity;

/// Returns the unit of the first parameter of a change. If no force sets the scale, the unit is relative to the reference mass.
pub fn unit_of_change(frame: &MotionFrame, change: &Change, fit: &MotionFit) -> String {
    let quantity = match change {
        Change::Gain { .. } | Change::Flip { .. } | Change::Swap { .. } => return "-".to_owned(),
        Change::Delay { .. } | Change::Slip { .. } | Change::Lag { .. } => return "s".to_owned(),
        Change::Clock { .. } => return "ppm".to_owned(),
        Change::Line { channel, .. } if frame.is_sensor(channel) => {
            return format!("{}/s2", frame.units.length);
        }
        Change::Line { .. } => Some(Quantity::Force),
        Change::Terms { terms, .. } => terms.first().map(|t| t.quantity()),
        Change::Links(links) => {
            let term = links.first().and_then(|l| l.terms.first());
            term.map(|t| t.quantity())
        }
        Change::Step(_) => Some(Quantity::Mass),
    };
    let Some(quantity) = quantity else {
        return String::new();
    };
    let unit = frame.units.unit_name(quantity);
    let driven = fit
        .design
        .equations
        .iter()
        .any(|e| e.target.iter().any(|t| t.norm_sqr() > 0.0));
    if driven || frame.known.values().any(|v| *v != 0.0) {
        unit
    } else {
        format!("({unit})/({})", frame.units.mass)
    }
}
