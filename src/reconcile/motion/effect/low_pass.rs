//! A channel that went through a slower low-pass than the others: of order 1, or 2 (Butterworth).

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

/// Log odds against it relative to a plain delay, which it resembles: loggers are late far more often than one of their filters is slow.
const HANDICAP: f64 = 3.0;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let one = |channel: String| {
        let shape = |order: u8| Change::Lag {
            channel: channel.clone(),
            order,
        };
        Candidate::new("low_pass", Some(&channel), vec![shape(1), shape(2)])
            .with_positive_parameter()
            .with_handicap(HANDICAP)
    };
    frame.channels().into_iter().map(one).collect()
}
