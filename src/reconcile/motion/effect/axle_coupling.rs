//! One axle joined to the next along the vehicle: a walking beam, a balancer, or springs that connect both axles.

use super::places::coupling_forms;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::frame::MotionFrame;

/// Links between the wheels of neighbouring axles, and one that adds their stretches.
const LINKS: [&str; 2] = ["axle", "bar"];

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    if frame.vehicle.name != "rear3" {
        return vec![];
    }
    let shapes = coupling_forms(frame, &LINKS);
    if shapes.is_empty() {
        return vec![];
    }
    vec![Candidate::new("axle_coupling", None, shapes)]
}
