//! Sets that differ from the best one by which channel is at fault: scored whether or not the search came by them, so that channels
//! which the record can't tell apart are all on the table.

use super::fitted::MotionFit;
use super::scorer::MotionScorer;
use crate::reconcile::search::{Scored, Scorer, settle};

/// Joins to `all` the best set with each of its channel faults moved to every other channel of the kind; best first again.
pub fn with_aliases(scorer: &mut MotionScorer, all: &mut Vec<Scored<MotionFit>>, decisive: f64) {
    let Some(best) = settle(all, decisive) else {
        return;
    };
    for &member in &best.set {
        let candidates = scorer.candidates;
        let own = &candidates[member];
        if !own.is_channel() {
            continue;
        }
        for (c, other) in candidates.iter().enumerate() {
            if best.set.contains(&c) || other.family() != own.family() {
                continue;
            }
            let mut set: Vec<usize> = best.set.iter().copied().filter(|m| *m != member).collect();
            set.push(c);
            set.sort_unstable();
            if all.iter().any(|s| s.set == set) {
                continue;
            }
            all.extend(scorer.score(&set, Some((&best, None))));
        }
    }
    all.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
}
