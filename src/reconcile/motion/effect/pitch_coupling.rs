//! Sprung bodies that are not free of each other along the vehicle; the same link as roll, to the body of another axle.

use super::axle_coupling::shapes;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let shapes = shapes(frame, &["pitch"]);
    if shapes.is_empty() {
        return vec![];
    }
    vec![Candidate::of("pitch_coupling", None, shapes)]
}
