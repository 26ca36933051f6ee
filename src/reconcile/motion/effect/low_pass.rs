//! A channel that passed through a low-pass filter with a lower cut-off frequency than the other channels. The filter has order 1, or order 2
//! (Butterworth).

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;

/// Log odds against a low-pass relative to a plain delay, which it resembles. A late logger is far more frequent than a slow filter.
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
