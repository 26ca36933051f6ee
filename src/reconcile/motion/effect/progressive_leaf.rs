//! A leaf spring that stiffens as leaves close: kp d |d|.

use super::places::links;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::term::Term;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    links(frame)
        .into_iter()
        .filter(|(l, _)| !frame.vehicle.links[*l].terms.contains(&Term::Progressive))
        .map(|(link, place)| {
            let shapes = vec![Change::Terms {
                link,
                terms: vec![Term::Progressive],
            }];
            Candidate::new("progressive_leaf", place.as_deref(), shapes).with_handicap(2.0)
        })
        .collect()
}
