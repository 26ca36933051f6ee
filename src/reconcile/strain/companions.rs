//! Effects of a set that its evidence does not require.

use super::alternatives::WORTH_NAMING;
use super::explanation::{discrepancy, ids, is_unmodelled, named_part};
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::own_covariance::{own_evidence, under_own_covariance, with_members};
use crate::reconcile::effect::{Candidate, Discrepancy, full_id};
use crate::reconcile::search::ScoredSet;
use rayon::prelude::*;

/// Returns `set` without effects that raise its log evidence by no more than the limit for indistinguishable causes, and a sentence on the removed
/// effects. `None` if it requires every effect.
///
/// Each set is fitted under its own covariance. A set with one effect less may have noise in place of that effect. This noise exceeds the stated
/// noise, or is correlated from run to run. One effect always stays, and the checks of the set compare it with no effect.
pub(super) fn without_companions(
    frame: &StrainFrame,
    candidates: &[Candidate],
    set: &ScoredSet<Fit>,
) -> Option<(ScoredSet<Fit>, String)> {
    if is_unmodelled(candidates, &set.set).is_some() {
        return None;
    }
    let mut best = set.clone();
    let mut reasons = Vec::new();
    loop {
        let names = named_part(candidates, &best.set);
        if names.len() < 2 || frame.stop.is_asked() {
            break;
        }
        let level = own_evidence(frame, candidates, &best);
        let fewer = |c: &usize| Some((*c, remove_effect(frame, candidates, &best, (*c, level))?));
        let fewer: Vec<(usize, ScoredSet<Fit>)> = names.par_iter().filter_map(fewer).collect();
        let least = fewer
            .into_iter()
            .max_by(|a, b| a.1.log_evidence.total_cmp(&b.1.log_evidence));
        let Some((c, rest)) = least else {
            break;
        };
        let ahead = level - rest.log_evidence;
        if ahead > frame.rules.indistinguishable {
            break;
        }
        reasons.push(format!(
            "{} is not reported: the log evidence with it exceeds the log evidence without it by {ahead:.1}, limit {:.1}",
            ids(candidates, &[c]).concat(),
            frame.rules.indistinguishable
        ));
        best = rest;
    }
    (!reasons.is_empty()).then(|| (best, reasons.join("; ")))
}

/// Returns `set`, with the log evidence `level`, without one effect. Either no effect or the best form of noise takes the place of this effect.
fn remove_effect(
    frame: &StrainFrame,
    candidates: &[Candidate],
    set: &ScoredSet<Fit>,
    (effect, level): (usize, f64),
) -> Option<ScoredSet<Fit>> {
    let rest: Vec<usize> = set.set.iter().copied().filter(|c| *c != effect).collect();
    let alone = under_own_covariance(frame, candidates, &rest, set)?;
    if level - alone.log_evidence > WORTH_NAMING {
        return Some(alone);
    }
    let id = |c: usize| candidates.get(c).map(|c| full_id(c.effect.as_ref()));
    let noise = (0..candidates.len()).filter(|c| {
        let is_noise = matches!(discrepancy(candidates, *c), Some(Discrepancy::Noise(_)));
        is_noise && rest.iter().all(|m| id(*m) != id(*c))
    });
    let with_noise: Vec<ScoredSet<Fit>> = noise
        .collect::<Vec<usize>>()
        .into_par_iter()
        .filter_map(|c| {
            let mut members = [rest.as_slice(), &[c]].concat();
            members.sort_unstable();
            with_members(frame, candidates, &members, &alone)
        })
        .collect();
    let all = with_noise.into_iter().chain([alone]);
    all.max_by(|a, b| a.log_evidence.total_cmp(&b.log_evidence))
}
