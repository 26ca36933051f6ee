//! Test that each identified effect reduces the gap on the validation data.

use super::gap::proof_gap;
use super::motion_fit::MotionFit;
use super::scorer::MotionScorer;
use crate::reconcile::effect_removal::{ReducedEffectSet, Useless, without_useless};
use crate::reconcile::search::{ScoredSet, Scorer};

/// Returns `best` without members that do not reduce the gap ([`without_useless`]), and a message on each of these members.
pub(super) fn remove_unproven(
    scorer: &mut MotionScorer,
    all: &[ScoredSet<MotionFit>],
    best: ScoredSet<MotionFit>,
) -> (ScoredSet<MotionFit>, Vec<String>) {
    let members = |s: &ScoredSet<MotionFit>| s.set.clone();
    let (set, out) = without_useless(best, members, |set, members| {
        if scorer.is_stopped() {
            return None;
        }
        let with = proof_gap(scorer.frame, &set.fit)?;
        let mut without = |c: &usize| {
            let rest: Vec<usize> = set.set.iter().copied().filter(|m| m != c).collect();
            let known = all.iter().find(|s| s.set == rest).cloned();
            let fit = known.or_else(|| scorer.score(&rest, Some((set, None))))?;
            let without = proof_gap(scorer.frame, &fit.fit)?;
            Some(ReducedEffectSet {
                gap: without.gap,
                fall: with.fall_from(&without),
                fit,
            })
        };
        Some((with.gap, members.iter().map(&mut without).collect()))
    });
    let remarks = |u: &Useless| {
        format!(
            "{} explains more of the fitted record, but does not reduce the gap of the proof ({:.2} % with it, {:.2} % without)",
            scorer.candidates[u.candidate].id,
            100.0 * u.with,
            100.0 * u.without
        )
    };
    let remarks = out.iter().map(remarks).collect();
    (set, remarks)
}
