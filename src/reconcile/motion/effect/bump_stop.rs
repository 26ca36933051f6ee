//! End stops: kb (|d| - gap) beyond a gap, on either side or both.

use super::places::{extent, links};
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::motion::Motion;
use crate::vehicle::term::{Side, Term};

/// Gaps as shares of the largest stretch.
const SHARES: [f64; 6] = [0.25, 0.4, 0.55, 0.68, 0.8, 0.9];

pub(super) fn candidates(frame: &MotionFrame, motion: &Motion) -> Vec<Candidate> {
    let has = |l: usize| {
        frame.vehicle.links[l]
            .terms
            .iter()
            .any(|t| matches!(t, Term::BumpStop { .. }))
    };
    links(frame)
        .into_iter()
        .filter(|(l, _)| !has(*l))
        .map(|(link, place)| {
            let (largest, _) = extent(motion, link);
            let mut shapes = Vec::new();
            for side in [Side::Both, Side::Compression, Side::Rebound] {
                shapes.extend(SHARES.iter().map(|share| Change::Terms {
                    link,
                    terms: vec![Term::BumpStop {
                        gap: share * largest,
                        side,
                    }],
                }));
            }
            Candidate::new("bump_stop", place.as_deref(), shapes).with_positive_parameter()
        })
        .collect()
}
