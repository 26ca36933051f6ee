//! A spring that changes during the record: warming rubber, a leaf that breaks.

use super::places::links;
use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::vehicle::term::Term;

/// Sudden changes tried through the record.
const STEPS: usize = 7;

pub(super) fn candidates(frame: &MotionFrame) -> Vec<Candidate> {
    let (start, length) = (frame.data.start_s, frame.data.duration_s());
    let has = |l: usize| {
        let terms = &frame.vehicle.links[l].terms;
        terms
            .iter()
            .any(|t| matches!(t, Term::StiffnessChange { .. }))
    };
    links(frame)
        .into_iter()
        .filter(|(l, _)| !has(*l))
        .map(|(link, place)| {
            let form = |at_s: f64, over_s: f64| Change::Terms {
                link,
                terms: vec![Term::StiffnessChange { at_s, over_s }],
            };
            let mut shapes = vec![form(start, length)];
            for i in 1..=STEPS {
                let share = i as f64 / (STEPS + 1) as f64;
                shapes.push(form(start + share * length, 0.0));
            }
            Candidate::new("stiffness_drift", place.as_deref(), shapes)
        })
        .collect()
}
