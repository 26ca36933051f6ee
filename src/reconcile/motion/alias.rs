//! Sets that differ from the best one by which channel is at fault: scored whether or not the search came by them, so that channels
//! which the record can't tell apart are all on the table.

use super::fitted::MotionFit;
use super::scorer::MotionScorer;
use crate::reconcile::search::{Scored, Scorer, settle};

/// Joins to `all` the best set with each of its channel faults moved to every other channel of the kind; best first again.
///
/// Constants of forms (the velocity below which friction fades) were found before the fault came, or with another channel at fault, and are as
/// wrong there as the channel is. Each of these sets finds its own, so that none leads by them.
pub fn with_aliases(scorer: &mut MotionScorer, all: &mut Vec<Scored<MotionFit>>, decisive: f64) {
    let Some(best) = settle(all, decisive) else {
        return;
    };
    let candidates = scorer.candidates;
    if !best.set.iter().any(|&m| candidates[m].is_channel()) {
        return;
    }
    let best = scorer.with_own_constants(best);
    all.retain(|s| s.set != best.set);
    all.push(best.clone());
    for &member in &best.set {
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
            let known = all.iter().position(|s| s.set == set);
            let scored = known.map(|at| all.swap_remove(at));
            let scored = scored.or_else(|| scorer.score(&set, Some((&best, None))));
            all.extend(scored.map(|s| scorer.with_own_constants(s)));
        }
    }
    all.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
}
