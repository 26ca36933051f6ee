//! Test of a fit by the means of accelerometers: gravity times gain, with zeros unknown within the limits of data sheets.

use super::at_rest::{STATIC, finite_mean};
use super::corrections::adjustments;
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use crate::vehicle::layout::Measures;

/// Returns the sum of squared deviates of the accelerometers' means from gravity times gain under a fit. Their zeros are unknown within the limits of
/// data sheets. Channels without a static part are left out.
pub fn zeros(frame: &MotionFrame, fit: &MotionFit) -> f64 {
    let adjust = adjustments(frame, &fit.parts);
    let gain = |channel: &str| -> f64 {
        adjust
            .iter()
            .filter(|a| a.channel == channel)
            .map(|a| a.gain)
            .product()
    };
    let v = &fit.assembled.vehicle;
    v.sensors
        .iter()
        .filter(|s| s.measures == Measures::Acceleration && frame.bodies.contains(&s.at.body))
        .filter_map(|s| {
            let (mean, _) = finite_mean(frame.data.samples(&s.channel).ok()?)?;
            let in_g = mean / frame.gravity;
            STATIC
                .contains(&in_g.abs())
                .then(|| ((in_g - gain(&s.channel)) / frame.rules.zero_g).powi(2))
        })
        .sum()
}
