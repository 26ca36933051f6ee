//! Coupling of the sprung bodies over two axles: the pitch inertia of the frame, or its substitute.

use super::places::coupling_forms;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::frame::MotionFrame;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let shapes = coupling_forms(frame, &["pitch"]);
    if shapes.is_empty() {
        return vec![];
    }
    vec![Candidate::new("pitch_coupling", None, shapes)]
}
