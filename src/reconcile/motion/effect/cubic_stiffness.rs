//! A spring that stiffens (or softens) with the cube of stretch: k3 d^3, with k2 d^2 if its symmetric point is not at rest.

use super::places::links;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::term::Term;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    links(frame)
        .into_iter()
        .filter(|(l, _)| !frame.vehicle.links[*l].terms.contains(&Term::Cubic))
        .map(|(link, place)| {
            let shapes = vec![Change::Terms {
                link,
                terms: vec![Term::Cubic],
            }];
            Candidate::new("cubic_stiffness", place.as_deref(), shapes)
        })
        .collect()
}
