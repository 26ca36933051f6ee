//! Wheels that are not free of each other: through the axle's own inertia or stiffness, through springs that see both wheels.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::layout::Link;
use crate::vehicle::preset::coupling;
use crate::vehicle::term::Term;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let shapes = shapes(frame, &["axle", "bar", "cross"]);
    if shapes.is_empty() {
        return vec![];
    }
    vec![Candidate::of("axle_coupling", None, shapes)]
}

/// Coupling links by name, each as inertia, as spring, and as spring with damper.
pub(super) fn shapes(frame: &MotionFrame, names: &[&str]) -> Vec<Change> {
    let mut out = Vec::new();
    for name in names {
        let Some(link) = coupling(&frame.vehicle, name) else {
            continue;
        };
        let with = |terms: Vec<Term>| {
            Change::Links(vec![Link {
                terms,
                ..link.clone()
            }])
        };
        if !matches!(*name, "bar" | "cross") {
            out.push(with(vec![Term::Inertance]));
        }
        out.push(with(vec![Term::Stiffness]));
        out.push(with(vec![Term::Stiffness, Term::Damping]));
    }
    out
}
