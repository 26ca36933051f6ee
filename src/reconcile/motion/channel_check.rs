//! Channels whose readings show that they are unreliable: dead or saturated.

use super::frame::MotionFrame;
use crate::finding::Finding;
use crate::series::channels::Channels;
use crate::series::quality::{Kind, check_channels};

/// Channel at fault: effect id without place, channel, and measured value.
#[derive(Clone, Debug, PartialEq)]
pub struct BrokenChannel {
    /// `dead_channel` or `saturated_channel`.
    pub id: &'static str,
    /// Channel.
    pub channel: String,
    /// Variation of a dead channel, or number of cut peaks of a saturated one.
    pub measured: f64,
}

/// Returns the dead and saturated channels of a record among the compared channels.
pub fn broken_channels(frame: &MotionFrame, record: &Channels) -> Vec<BrokenChannel> {
    let own = frame.channels();
    let kind = |name: &str| {
        if frame.vehicle.wheels.iter().any(|w| w.channel == name) {
            Kind::Force
        } else if frame.is_sensor(name) {
            Kind::Acceleration
        } else {
            Kind::Other
        }
    };
    let name = |f: &Finding| match f.code {
        "dead-channel" => Some("dead_channel"),
        "saturated-channel" => Some("saturated_channel"),
        _ => None,
    };
    check_channels(record, frame.gravity, kind)
        .iter()
        .filter(|f| own.contains(&f.subject))
        .filter_map(|f| {
            Some(BrokenChannel {
                id: name(f)?,
                channel: f.subject.clone(),
                measured: f.measured.unwrap_or(f64::NAN),
            })
        })
        .collect()
}
