//! A damper whose force grows with the square of the rate: c2 v |v|.

use super::places::links;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::term::Term;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    links(frame)
        .into_iter()
        .filter(|(l, _)| {
            !frame.vehicle.links[*l]
                .terms
                .contains(&Term::QuadraticDamping)
        })
        .map(|(link, place)| {
            let shapes = vec![Change::Terms {
                link,
                terms: vec![Term::QuadraticDamping],
            }];
            Candidate::new("quadratic_damping", place.as_deref(), shapes)
        })
        .collect()
}
