//! An accelerometer that reads a multiple of the truth.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    frame
        .channels()
        .into_iter()
        .filter(|c| frame.is_sensor(c))
        .map(|channel| {
            let shapes = vec![Change::Gain {
                channel: channel.clone(),
            }];
            Candidate::new("accel_gain", Some(&channel), shapes)
        })
        .collect()
}
