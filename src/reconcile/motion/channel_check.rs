//! Channels that show by themselves that they can't be relied on: dead or saturated.

use super::frame::MotionFrame;
use crate::finding::Finding;
use crate::series::channels::Channels;
use crate::series::quality::{Kind, check_channels};

/// A channel at fault: effect id without place, channel, what was measured of it.
#[derive(Clone, Debug, PartialEq)]
pub struct BrokenChannel {
    /// `dead_channel` or `saturated_channel`.
    pub id: &'static str,
    /// Channel.
    pub channel: String,
    /// Its variation, or how many peaks are cut.
    pub measured: f64,
}

/// Dead and saturated channels among those compared, in a record.
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
