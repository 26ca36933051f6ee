//! Result of a search.

use super::channel_check::BrokenChannel;
use super::motion_fit::MotionFit;
use crate::reconcile::search::ScoredSet;

/// Result of a search: all scored sets, best first, and the best one.
pub(super) struct RankedEffectSets {
    /// Fit of the analyst's model with sensor noise only.
    pub null: MotionFit,
    /// Every set, best first.
    pub all: Vec<ScoredSet<MotionFit>>,
    /// Best set; empty if no effect raises the evidence enough.
    pub best: ScoredSet<MotionFit>,
    /// Unreliable channels: dead or saturated.
    pub broken: Vec<BrokenChannel>,
}

/// Returns the other sets, nearest first, without sets that only add to the best one. If the best set is empty, returns all sets with effects.
pub(super) fn other_sets<'a>(
    best: &'a ScoredSet<MotionFit>,
    all: &'a [ScoredSet<MotionFit>],
) -> impl Iterator<Item = &'a ScoredSet<MotionFit>> {
    all.iter().filter(|s| {
        let adds = best.set.iter().all(|m| s.set.contains(m));
        !s.set.is_empty() && (best.set.is_empty() || !adds)
    })
}
