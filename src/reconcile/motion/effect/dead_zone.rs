//! Free play of a spring: no (or almost no) force until the stretch exceeds a gap.

use super::places::{extent, links};
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::motion::Motion;
use crate::vehicle::term::Term;

/// Gaps as shares of the largest stretch.
const SHARES: [f64; 6] = [0.02, 0.05, 0.1, 0.18, 0.3, 0.45];

pub(super) fn candidates(frame: &MotionFrame, motion: &Motion) -> Vec<Candidate> {
    let may = |l: usize| {
        let terms = &frame.vehicle.links[l].terms;
        let has = terms.iter().any(|t| matches!(t, Term::DeadZone { .. }));
        !has && terms.contains(&Term::Stiffness)
    };
    links(frame)
        .into_iter()
        .filter(|(l, _)| may(*l))
        .map(|(link, place)| {
            let (largest, _) = extent(motion, link);
            let shape = |share: &f64| Change::Terms {
                link,
                terms: vec![Term::DeadZone {
                    gap: share * largest,
                }],
            };
            let shapes = SHARES.iter().map(shape).collect();
            Candidate::new("dead_zone", place.as_deref(), shapes).with_positive_parameter()
        })
        .collect()
}
