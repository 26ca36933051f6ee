//! Comparison of a smooth error of the model with the best set of effects. The smooth error replaces all or some of the effects.

use super::explanation::{discrepancy, named_part};
use super::frame::StrainFrame;
use super::likelihood::{Fit, Likelihood};
use super::own_covariance::{reference_of, under_own_covariance};
use crate::reconcile::effect::{Candidate, Discrepancy, Extension};
use crate::reconcile::outcome::SmoothAt;
use crate::reconcile::search::{Addition, ScoredSet, Scorer, settle};

/// Number of best lengths and amplitudes that are tried with every part of the effects.
const KEPT: usize = 2;

/// Returns whether a candidate is a smooth error of the model.
pub(super) fn is_smooth(candidates: &[Candidate], c: usize) -> bool {
    matches!(discrepancy(candidates, c), Some(Discrepancy::Smooth(_)))
}

/// Returns the set of the smooth error and as few effects of `best` as it needs. `None` unless it is decisively ahead of the same set without the
/// smooth error, and explains the runs as well as `best`. Its log evidence is then indistinguishable from the log evidence of `best`, or behind by
/// less than the cost of the effects that it saves.
///
/// `ln p(y | lengths, a) = -(r' C^-1 r + theta' theta / a^2) / 2 - ln det(C) / 2 - ln det(a^2 H) / 2`, with H the Hessian at the best theta. The
/// determinants penalise a smooth error with many possible shapes.
pub(super) fn smooth_instead(
    frame: &StrainFrame,
    candidates: &[Candidate],
    best: &ScoredSet<Fit>,
) -> Option<ScoredSet<Fit>> {
    let names = named_part(candidates, &best.set);
    let smooth: Vec<usize> = (0..candidates.len())
        .filter(|c| is_smooth(candidates, *c))
        .collect();
    if names.is_empty() || smooth.is_empty() || frame.stop.is_asked() {
        return None;
    }
    let runs = frame.observations.fit_runs();
    let reference = reference_of(best);
    let mut likelihood = Likelihood::new(frame, candidates, &runs, &reference);
    let best = likelihood.score(&best.set, Some((best, None)))?;
    let mut tried: Vec<ScoredSet<Fit>> = Vec::new();
    let mut ranked = smooth.clone();
    for without in parts(&names) {
        // If all effects or one effect are left out, every length and amplitude is tried. Otherwise only the best ones so far are tried.
        let whole = without.len() == names.len() || without.len() == 1;
        let some = if whole { smooth.len() } else { KEPT };
        for &s in ranked.iter().take(some) {
            if frame.stop.is_asked() {
                return None;
            }
            let kept = best.set.iter().copied().filter(|c| !without.contains(c));
            let mut set: Vec<usize> = kept.chain([s]).collect();
            set.sort_unstable();
            let n = candidates.get(s).map_or(0, |c| c.effect.parameters().len());
            let start = Addition {
                candidate: s,
                gain: 0.0,
                parameters: vec![0.0; n],
                sizes: Vec::new(),
            };
            tried.extend(likelihood.score(&set, Some((&best, Some(&start)))));
        }
        let most = |s: &usize| {
            let own = tried.iter().filter(|t| t.set.contains(s));
            own.map(|t| t.log_evidence)
                .fold(f64::NEG_INFINITY, f64::max)
        };
        ranked.sort_by(|a, b| most(b).total_cmp(&most(a)));
    }
    let found = settle(&tried, frame.rules.decisive)?;
    // Each set is evaluated under its own covariance, as in the comparison of alternative explanations.
    let found = under_own_covariance(frame, candidates, &found.set, &found)?;
    // The smooth error must decisively improve on the set without it, even if it explains nearly as much as the effects.
    let rest = found.set.iter().copied();
    let rest: Vec<usize> = rest.filter(|c| !is_smooth(candidates, *c)).collect();
    let without = under_own_covariance(frame, candidates, &rest, &found)?;
    if found.log_evidence < without.log_evidence + frame.rules.decisive {
        return None;
    }
    let saved = frame.rules.decisive * (best.set.len() as f64 - found.set.len() as f64);
    // One factor for all gauges is itself a smooth error, so another smooth error replaces it only if it explains more.
    let only_scale = (names.iter().filter(|c| !found.set.contains(c)))
        .filter_map(|&c| candidates.get(c))
        .all(|c| matches!(c.effect.extension(frame, &[]), Extension::Scale(_)));
    let margin = if only_scale {
        0.0
    } else {
        frame.rules.indistinguishable
    };
    (best.log_evidence - found.log_evidence < saved.max(margin)).then_some(found)
}

/// Returns all parts of `names` except the empty one: the whole first, then single names, then all other parts.
fn parts(names: &[usize]) -> Vec<Vec<usize>> {
    let of = |bits: usize| -> Vec<usize> {
        let set = names.iter().enumerate();
        set.filter(|(i, _)| bits >> i & 1 == 1)
            .map(|n| *n.1)
            .collect()
    };
    let mut out: Vec<Vec<usize>> = (1..1usize << names.len()).map(of).collect();
    out.sort_by_key(|p| match p.len() {
        n if n == names.len() => 0,
        n => n,
    });
    out
}

/// Returns the curve of the smooth error in a set by gauge, for all loads or for each load.
pub(super) fn curve(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> Vec<SmoothAt> {
    let mut first = 0;
    for (&c, parameters) in scored.set.iter().zip(&scored.fit.parameters) {
        let Some(smooth) = candidates.get(c).and_then(|c| c.effect.as_smooth_error()) else {
            first += parameters.len();
            continue;
        };
        let (n, width) = (parameters.len(), scored.fit.covariance.len().isqrt());
        let own = |k: usize| (first + k / n) * width + first + k % n;
        let cell = |k: usize| scored.fit.covariance.get(own(k)).copied().unwrap_or(0.0);
        let covariance: Vec<f64> = (0..n * n).map(cell).collect();
        let mut columns: Vec<(usize, Option<String>)> = vec![(0, None)];
        if smooth.is_by_load() {
            let payload = "payload".to_owned();
            let loads = frame.load_names.iter().cloned().chain([payload]);
            columns = loads.map(Some).enumerate().collect();
            columns.truncate(smooth.n_factors());
        }
        let at = |(column, load): &(usize, Option<String>)| {
            let gauges = frame.gauges.iter().enumerate();
            let one = |(g, f): (usize, &super::frame::GaugeFacts)| {
                let (factor, sd) = smooth.factor(g, *column, parameters, &covariance);
                Some(SmoothAt {
                    gauge: f.name.clone(),
                    place_m: f.position?,
                    load: load.clone(),
                    factor,
                    sd,
                })
            };
            gauges.filter_map(one).collect::<Vec<SmoothAt>>()
        };
        return columns.iter().flat_map(at).collect();
    }
    Vec::new()
}
