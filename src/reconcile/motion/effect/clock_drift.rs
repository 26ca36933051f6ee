//! A channel whose clock runs faster or slower than the clocks of the other channels. The channel is late by a share of the time since the record
//! began.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let one = |channel: String| {
        let id = channel.clone();
        Candidate::new("clock_drift", Some(&id), vec![Change::Clock { channel }])
    };
    frame.channels().into_iter().map(one).collect()
}
