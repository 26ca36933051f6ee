//! A name needs a gap that falls by it on what the record is judged by.

use super::fitted::MotionFit;
use super::gap::proof_gap;
use super::scorer::MotionScorer;
use crate::reconcile::search::{Scored, Scorer};

/// `best` without members beside others by which that gap does not fall, one after the other, the one that raises it most first; what is said
/// of each. A single member is held against no effect at all by whoever judges the set.
pub(super) fn proven(
    scorer: &mut MotionScorer,
    all: &[Scored<MotionFit>],
    best: Scored<MotionFit>,
) -> (Scored<MotionFit>, Vec<String>) {
    let mut set = best;
    let mut told = Vec::new();
    while set.set.len() > 1 && !scorer.is_stopped() {
        let Some(with) = proof_gap(scorer.frame, &set.fit).map(|g| g.gap) else {
            break;
        };
        let mut least: Option<(usize, f64, Scored<MotionFit>)> = None;
        for &member in &set.set {
            let rest: Vec<usize> = set.set.iter().copied().filter(|m| *m != member).collect();
            let known = all.iter().find(|s| s.set == rest).cloned();
            let Some(fewer) = known.or_else(|| scorer.score(&rest, Some((&set, None)))) else {
                continue;
            };
            let Some(gap) = proof_gap(scorer.frame, &fewer.fit).map(|g| g.gap) else {
                continue;
            };
            if gap <= with && least.as_ref().is_none_or(|l| gap < l.1) {
                least = Some((member, gap, fewer));
            }
        }
        let Some((member, gap, fewer)) = least else {
            break;
        };
        told.push(format!(
            "{} explains more of the fitted record, but the gap that judges does not fall by it ({:.2} % with it, {:.2} % without)",
            scorer.candidates[member].id,
            100.0 * with,
            100.0 * gap
        ));
        set = fewer;
    }
    (set, told)
}
