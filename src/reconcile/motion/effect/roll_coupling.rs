//! Sprung bodies that are not free of each other across the vehicle: roll inertia or roll stiffness.

use super::axle_coupling::shapes;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let shapes = shapes(frame, &["roll"]);
    if shapes.is_empty() {
        return vec![];
    }
    vec![Candidate::of("roll_coupling", None, shapes)]
}
