//! A channel that is late or early relative to the other channels.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    frame
        .channels()
        .into_iter()
        .map(|channel| {
            let shapes = vec![Change::Delay {
                channel: channel.clone(),
            }];
            Candidate::new("time_offset", Some(&channel), shapes)
        })
        .collect()
}
