//! An accelerometer mounted or wired the wrong way round.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    frame
        .channels()
        .into_iter()
        .filter(|c| frame.is_sensor(c))
        .map(|channel| {
            let shapes = vec![Change::Flip {
                channel: channel.clone(),
            }];
            Candidate::new("sign_flip", Some(&channel), shapes)
        })
        .collect()
}
