//! A damper with two rates, rebound and compression: ca |v| in addition to c v.

use super::places::links;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::term::Term;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    links(frame)
        .into_iter()
        .filter(|(l, _)| !frame.vehicle.links[*l].terms.contains(&Term::TwoRate))
        .map(|(link, place)| {
            let shapes = vec![Change::Terms {
                link,
                terms: vec![Term::TwoRate],
            }];
            Candidate::new("asymmetric_damper", place.as_deref(), shapes)
        })
        .collect()
}
