//! Coupling of left and right side of one axle: an anti-roll bar, or roll inertia or stiffness of body and axle.

use super::places::coupling_forms;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::frame::MotionFrame;

/// Links across the vehicle: between the stretches of both sides, the wheels, the bodies, or a body and the opposite wheel.
const LINKS: [&str; 4] = ["bar", "axle", "roll", "cross"];

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    if frame.vehicle.name != "front_pair" {
        return vec![];
    }
    let shapes = coupling_forms(frame, &LINKS);
    if shapes.is_empty() {
        return vec![];
    }
    vec![Candidate::new("roll_coupling", None, shapes)]
}
