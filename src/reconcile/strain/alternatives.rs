//! Alternative explanations of a set.

use super::explanation::{ids, is_unmodelled, named_part};
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::own_covariance::{under_own_covariance, with_members};
use super::smooth_alternative::is_smooth;
use super::validation::{Proofs, validate_set};
use crate::reconcile::effect::Candidate;
use crate::reconcile::outcome::AlternativeExplanation;
use crate::reconcile::search::ScoredSet;
use rayon::prelude::*;

/// Difference in log evidence from the best set beyond which alternative explanations are not reported.
pub(super) const WORTH_NAMING: f64 = 25.0;

/// Alternative set of effects with its ids.
pub(super) type AlternativeSet = (Vec<String>, ScoredSet<Fit>);

/// Returns the alternative explanations of a set of log evidence `level`, with their gaps.
pub(super) fn report_alternatives(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    rivals: &[AlternativeSet],
    level: f64,
) -> Vec<AlternativeExplanation> {
    let one = |(ids, s): &AlternativeSet| AlternativeExplanation {
        ids: ids.clone(),
        evidence_difference: level - s.log_evidence,
        gap_after: validate_set(proofs, candidates, s).0.after,
        indistinguishable: level - s.log_evidence < proofs.frame.rules.indistinguishable,
    };
    rivals.par_iter().map(one).collect()
}

/// Returns alternative sets with at most as many identified effects as the best set, nearest first. The number is not limited if the best set
/// contains a curve. Each set has its own covariance, like the best set.
pub(super) fn find_alternative_sets(
    frame: &StrainFrame,
    candidates: &[Candidate],
    all: &[ScoredSet<Fit>],
    best: &ScoredSet<Fit>,
) -> Vec<AlternativeSet> {
    const MOST: usize = 5;
    /// Number of sets tried: twice as many, since sets change their order under their own covariance.
    const TRIED: usize = 2 * MOST;
    let own = named_part(candidates, &best.set);
    // If the best set contains a smooth error, which can take many shapes, alternatives may have any number of effects.
    let curved = own.iter().any(|c| is_smooth(candidates, *c));
    let is_near = |s: &ScoredSet<Fit>| best.log_evidence - s.log_evidence < WORTH_NAMING;
    let other = |s: &&ScoredSet<Fit>| {
        let named = named_part(candidates, &s.set);
        !named.is_empty()
            && is_unmodelled(candidates, &s.set).is_none()
            && named != own
            && (curved || named.len() <= own.len().max(1))
            && is_near(s)
    };
    let near: Vec<&ScoredSet<Fit>> = all.iter().filter(other).take(TRIED).collect();
    // Noise effects of the best set are not names, so an alternative may contain them as well.
    let noise_members: Vec<usize> = (best.set.iter().copied())
        .filter(|c| !own.contains(c))
        .collect();
    let alike = |s: &&ScoredSet<Fit>| {
        let alone = under_own_covariance(frame, candidates, &s.set, s);
        let mut set = named_part(candidates, &s.set);
        set.extend(&noise_members);
        set.sort_unstable();
        let with_noise = (set != s.set).then(|| with_members(frame, candidates, &set, s));
        let better =
            |a: &ScoredSet<Fit>, b: &ScoredSet<Fit>| a.log_evidence.total_cmp(&b.log_evidence);
        let both = alone.into_iter().chain(with_noise.flatten());
        both.max_by(better).unwrap_or_else(|| (*s).clone())
    };
    let mut out: Vec<ScoredSet<Fit>> = near.par_iter().map(alike).collect();
    out.retain(is_near);
    out.sort_by(|a, b| b.log_evidence.total_cmp(&a.log_evidence));
    out.truncate(MOST);
    let with_ids = |s: ScoredSet<Fit>| (ids(candidates, &s.set), s);
    out.into_iter().map(with_ids).collect()
}

/// Removes alternatives with the same ids as `best`, and all but the first of alternatives with equal ids. They are other starts or forms of one
/// effect.
pub(super) fn without_own(
    candidates: &[Candidate],
    best: &ScoredSet<Fit>,
    rivals: &mut Vec<AlternativeSet>,
) {
    let mut seen = vec![sorted_ids(candidates, &best.set)];
    rivals.retain(|r| {
        let own = sorted_ids(candidates, &r.1.set);
        let new = !seen.contains(&own);
        seen.push(own);
        new
    });
}

fn sorted_ids(candidates: &[Candidate], set: &[usize]) -> Vec<String> {
    let mut out = ids(candidates, set);
    out.sort();
    out
}
