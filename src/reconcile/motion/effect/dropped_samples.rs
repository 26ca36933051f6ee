//! A logger that lost samples of one channel, or wrote some of them twice. From then on the channel reads early, or late.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

/// Moments tried through the record.
const MOMENTS: usize = 13;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let (start, length) = (frame.data.start_s, frame.data.duration_s());
    let one = |channel: String| {
        let shape = |i: usize| Change::Slip {
            channel: channel.clone(),
            at_s: start + length * i as f64 / (MOMENTS + 1) as f64,
        };
        let shapes = (1..=MOMENTS).map(shape).collect();
        Candidate::new("dropped_samples", Some(&channel), shapes)
    };
    frame.channels().into_iter().map(one).collect()
}
