//! Test that each identified effect reduces the gap on runs that were not fitted.

use super::explanation::{ids, is_unmodelled, named_part};
use super::likelihood::Fit;
use super::own_covariance::under_own_covariance;
use super::validation::{Proofs, residuals_on};
use crate::reconcile::checks::Fall;
use crate::reconcile::effect::Candidate;
use crate::reconcile::effect_removal::{ReducedEffectSet, Useless, without_useless};
use crate::reconcile::search::ScoredSet;
use rayon::prelude::*;

/// Set of effects without the effects that do not reduce the gap on the validation runs.
pub(super) struct ProvenEffects {
    /// Smaller set, with at least one identified effect.
    pub set: ScoredSet<Fit>,
    /// Message on the removed effects.
    pub reason: String,
}

/// Returns `best` without effects that do not reduce the gap ([`without_useless`]); `None` if no effect is removed, or if `best` has a general form.
pub(super) fn remove_unproven(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    best: &ScoredSet<Fit>,
) -> Option<ProvenEffects> {
    if is_unmodelled(candidates, &best.set).is_some() {
        return None;
    }
    let frame = proofs.frame;
    let names = |s: &ScoredSet<Fit>| named_part(candidates, &s.set);
    let (set, out) = without_useless(best.clone(), names, |set, names| {
        if frame.stop.is_asked() {
            return None;
        }
        let [with, _] = residuals_on(proofs, candidates, set, &set.set);
        let without = |c: &usize| {
            let rest: Vec<usize> = set.set.iter().copied().filter(|m| m != c).collect();
            let fit = under_own_covariance(frame, candidates, &rest, set)?;
            let [without, _] = residuals_on(proofs, candidates, &fit, &set.set);
            Some(ReducedEffectSet {
                gap: without.numbers().after,
                fall: Fall::from_residuals(&without.after, &with.after, &with.floor),
                fit,
            })
        };
        Some((
            with.numbers().after,
            names.par_iter().map(without).collect(),
        ))
    });
    let described = |u: &Useless| {
        format!(
            "{} ({:.2} % with it, {:.2} % without)",
            ids(candidates, &[u.candidate]).concat(),
            100.0 * u.with,
            100.0 * u.without
        )
    };
    let described: Vec<String> = out.iter().map(described).collect();
    (!described.is_empty()).then(|| ProvenEffects {
        set,
        reason: format!(
            "some of the effects that explain the fitted runs do not reduce the gap on the runs of the proof, and are not reported: {}",
            described.join(", ")
        ),
    })
}
