//! What a search found, and what it takes to be named.

use super::channel_check::BrokenChannel;
use super::fitted::MotionFit;
use crate::reconcile::search::Scored;

/// Log evidence that an effect must bring to be named: odds of 400, so that a set of up to three effects holds a chance one in fewer than
/// one job of a hundred.
pub(super) const DECISIVE: f64 = 6.0;
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
