//! Evidence of a set under the covariance of the set's prediction.
//!
//! Channel faults also act on the errors of the model and of the loads. A channel with reversed sign, for example, reverses the sign of its share of
//! the covariance. The covariance of the model without effects therefore favours general forms, which do not change it, over channel faults. The
//! compared sets are therefore each evaluated under their own covariance.

use super::frame::StrainFrame;
use super::likelihood::{Fit, Likelihood};
use crate::reconcile::effect::{Candidate, Stage};
use crate::reconcile::search::{ScoredSet, Scorer, settle};
use rayon::prelude::*;

/// Returns the best of `contenders`, and of alternatives to members of `found` at the same gauges, each under its own covariance.
pub(super) fn best_by_own_covariance(
    frame: &StrainFrame,
    candidates: &[Candidate],
    likelihood: &mut Likelihood<'_>,
    contenders: &[ScoredSet<Fit>],
    found: &ScoredSet<Fit>,
) -> Option<ScoredSet<Fit>> {
    if found.set.is_empty() {
        return Some(found.clone());
    }
    let mut first: Vec<ScoredSet<Fit>> = contenders.to_vec();
    for set in at_same_gauges(candidates, likelihood, &found.set) {
        if first.iter().all(|s| s.set != set) {
            first.extend(likelihood.score(&set, None));
        }
    }
    if first.iter().all(|s| s.set != found.set) {
        first.push(found.clone());
    }
    let own = |s: ScoredSet<Fit>| under_own_covariance(frame, candidates, &s.set, &s);
    let scored: Vec<Option<ScoredSet<Fit>>> = first.into_par_iter().map(own).collect();
    let all: Vec<ScoredSet<Fit>> = scored.into_iter().flatten().collect();
    settle(&all, frame.rules.decisive)
}

/// Scores a set under the covariance of its prediction, with the parameters that its members have in `near`.
pub(super) fn under_own_covariance(
    frame: &StrainFrame,
    candidates: &[Candidate],
    set: &[usize],
    near: &ScoredSet<Fit>,
) -> Option<ScoredSet<Fit>> {
    let reference = reference_of(near);
    let reference: Vec<(usize, Vec<f64>)> = (reference.into_iter())
        .filter(|(c, _)| set.contains(c))
        .collect();
    let runs = frame.observations.fit_runs();
    Likelihood::new(frame, candidates, &runs, &reference).score(set, Some((near, None)))
}

/// Returns the log evidence of a set under its own covariance.
pub(super) fn own_evidence(
    frame: &StrainFrame,
    candidates: &[Candidate],
    s: &ScoredSet<Fit>,
) -> f64 {
    let own = under_own_covariance(frame, candidates, &s.set, s);
    own.map_or(s.log_evidence, |own| own.log_evidence)
}

/// Scores a set with more members than `near`, fitted from the start, under the covariance of the members that `near` contains.
pub(super) fn with_members(
    frame: &StrainFrame,
    candidates: &[Candidate],
    set: &[usize],
    near: &ScoredSet<Fit>,
) -> Option<ScoredSet<Fit>> {
    let runs = frame.observations.fit_runs();
    let mut reference = reference_of(near);
    reference.retain(|(c, _)| set.contains(c));
    Likelihood::new(frame, candidates, &runs, &reference).score(set, None)
}

/// Returns the members with their parameters.
pub(super) fn reference_of(s: &ScoredSet<Fit>) -> Vec<(usize, Vec<f64>)> {
    let parameters = s.fit.parameters.iter().cloned();
    s.set.iter().copied().zip(parameters).collect()
}

/// Returns the sets in which a fault of one or two channels replaces all members of `set` that act on those channels only.
fn at_same_gauges(
    candidates: &[Candidate],
    likelihood: &Likelihood<'_>,
    set: &[usize],
) -> Vec<Vec<usize>> {
    let gauges = |c: usize| {
        candidates
            .get(c)
            .map(|c| c.effect.gauges())
            .unwrap_or_default()
    };
    let mut out = Vec::new();
    for (c, candidate) in candidates.iter().enumerate() {
        let own = candidate.effect.gauges();
        if candidate.effect.stage() != Stage::Reading || !(1..=2).contains(&own.len()) {
            continue;
        }
        let (replaced, kept): (Vec<usize>, Vec<usize>) = set.iter().partition(|&&m| {
            let at = gauges(m);
            !at.is_empty() && at.iter().all(|g| own.contains(g))
        });
        let covered = own
            .iter()
            .all(|g| replaced.iter().any(|&m| gauges(m).contains(g)));
        if covered
            && !replaced.contains(&c)
            && kept.iter().all(|&m| likelihood.is_compatible_pair(m, c))
        {
            let mut new = [kept.as_slice(), &[c]].concat();
            new.sort_unstable();
            out.push(new);
        }
    }
    out
}
