//! Friction between leaves: fc tanh(v / velocity), for several velocities below which it fades.

use super::places::{extent, links};
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::motion::Motion;
use crate::vehicle::term::Term;

/// Fading velocities as shares of the rms rate: from sharp to nearly viscous.
const SHARES: [f64; 6] = [0.006, 0.02, 0.04, 0.08, 0.16, 0.3];

pub(super) fn candidates(frame: &MotionFrame, motion: &Motion) -> Vec<Candidate> {
    let has = |l: usize| {
        frame.vehicle.links[l]
            .terms
            .iter()
            .any(|t| matches!(t, Term::Friction { .. }))
    };
    links(frame)
        .into_iter()
        .filter(|(l, _)| !has(*l))
        .map(|(link, place)| {
            let (_, rate) = extent(motion, link);
            let shape = |share: &f64| Change::Terms {
                link,
                terms: vec![Term::Friction {
                    velocity: share * rate,
                }],
            };
            let shapes = SHARES.iter().map(shape).collect();
            Candidate::new("coulomb_friction", place.as_deref(), shapes).with_positive_parameter()
        })
        .collect()
}
