//! A spring whose rate differs between rebound and compression: k2 d^2.

use super::places::links;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::term::Term;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    links(frame)
        .into_iter()
        .filter(|(l, _)| !frame.vehicle.links[*l].terms.contains(&Term::Quadratic))
        .map(|(link, place)| {
            let shapes = vec![Change::Terms {
                link,
                terms: vec![Term::Quadratic],
            }];
            Candidate::new("quadratic_stiffness", place.as_deref(), shapes).with_handicap(2.0)
        })
        .collect()
}
