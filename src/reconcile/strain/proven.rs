//! A name needs a gap that falls by it on runs that it was not fitted on.

use super::explanation::{ids, is_unmodelled, named_part};
use super::likelihood::Fit;
use super::own_covariance::under_own_covariance;
use super::validation::{Proofs, validated, validated_beside};
use crate::reconcile::effect::Candidate;
use crate::reconcile::search::Scored;
use rayon::prelude::*;

/// A set without those of its names that the runs which judge don't bear out.
pub(super) struct Proven {
    /// The set that is left, at least one name in it.
    pub set: Scored<Fit>,
    /// What is said of the names that were taken out.
    pub doubt: String,
}

/// `best` without names beside others by which the gap does not fall, one after the other, the one that raises it most first; `None` where
/// it falls by every name. All gaps are those of the same readings. A single name is held against no effect at all by whoever judges the set.
pub(super) fn proven(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    best: &Scored<Fit>,
) -> Option<Proven> {
    if is_unmodelled(candidates, &best.set).is_some() {
        return None;
    }
    let frame = proofs.frame;
    let mut set = best.clone();
    let mut told: Vec<String> = Vec::new();
    loop {
        let names = named_part(candidates, &set.set);
        if names.len() < 2 || frame.stop.is_asked() {
            break;
        }
        let with = validated(proofs, candidates, &set).0.after;
        let without = |c: &usize| {
            let rest: Vec<usize> = set.set.iter().copied().filter(|m| m != c).collect();
            let fitted = under_own_covariance(frame, candidates, &rest, &set)?;
            let after = validated_beside(proofs, candidates, &fitted, &set.set)
                .0
                .after;
            (after <= with).then_some((*c, after, fitted))
        };
        let useless: Vec<Option<(usize, f64, Scored<Fit>)>> =
            names.par_iter().map(without).collect();
        let least = useless
            .into_iter()
            .flatten()
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let Some((c, after, fitted)) = least else {
            break;
        };
        told.push(format!(
            "{} ({:.2} % with it, {:.2} % without)",
            ids(candidates, &[c]).concat(),
            100.0 * with,
            100.0 * after
        ));
        set = fitted;
    }
    (!told.is_empty()).then(|| Proven {
        set,
        doubt: format!(
            "the gap on the runs that judge does not fall by some of what explains the rest, and it is not named: {}",
            told.join(", ")
        ),
    })
}
