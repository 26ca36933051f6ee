//! A damper that the model lacks: c v.

use super::places::links;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::term::Term;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    links(frame)
        .into_iter()
        .filter(|(l, _)| !frame.vehicle.links[*l].terms.contains(&Term::Damping))
        .map(|(link, place)| {
            let shapes = vec![Change::Terms {
                link,
                terms: vec![Term::Damping],
            }];
            Candidate::new("viscous_damper", place.as_deref(), shapes).with_positive_parameter()
        })
        .collect()
}
