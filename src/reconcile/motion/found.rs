//! What a search found.

use super::channel_check::BrokenChannel;
use super::fitted::MotionFit;
use crate::reconcile::search::Scored;

/// What a search found: all sets that were scored, best first, and the best one.
pub(super) struct Found {
    /// The analyst's model under sensor noise alone.
    pub null: MotionFit,
    /// Every set, best first.
    pub all: Vec<Scored<MotionFit>>,
    /// The best set, empty where nothing pays.
    pub best: Scored<MotionFit>,
    /// Channels that show by themselves that they can't be relied on.
    pub broken: Vec<BrokenChannel>,
}

/// Other sets, nearest first; sets that merely add to the best are no rivals. Where nothing is named, what came nearest.
pub(super) fn other_sets<'a>(
    best: &'a Scored<MotionFit>,
    all: &'a [Scored<MotionFit>],
) -> impl Iterator<Item = &'a Scored<MotionFit>> {
    all.iter().filter(|s| {
        let adds = best.set.iter().all(|m| s.set.contains(m));
        !s.set.is_empty() && (best.set.is_empty() || !adds)
    })
}
