//! The effects of a set with the sizes that were found.

use super::covariance::{Selection, patterns_read};
use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::likelihood::Fit;
use super::size::{RunBlocks, amplitudes_found};
use super::smooth_alternative::curve;
use crate::estimate::rms;
use crate::reconcile::effect::{Candidate, Discrepancy, SizedAmplitudes, StrainEffect, full_id};
use crate::reconcile::outcome::NamedEffect;
use crate::reconcile::search::ScoredSet;

/// Returns the effects of a set with their sizes, without noise.
pub(super) fn effects_with_sizes(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> Vec<NamedEffect> {
    let mut out = Vec::new();
    let found = found_amplitudes(frame, candidates, scored);
    for (m, &c) in scored.set.iter().enumerate() {
        let Some(candidate) = candidates
            .get(c)
            .filter(|c| !matches!(c.effect.discrepancy(), Some(Discrepancy::Noise(_))))
        else {
            continue;
        };
        let effect = candidate.effect.as_ref();
        if effect.as_smooth_error().is_some() {
            out.push(smooth_found(frame, candidates, scored, effect));
            continue;
        }
        let parameters = scored.fit.parameters.get(m).cloned().unwrap_or_default();
        let described = effect.parameters();
        let mut size = parameters.clone();
        let mut sigma = scored.fit.sigma.get(m).cloned().unwrap_or_default();
        let mut unit = described.first().map_or("1", |p| p.unit);
        let mut plausible = described
            .iter()
            .zip(&parameters)
            .all(|(p, v)| (v - p.neutral).abs() <= p.plausible);
        let found = (scored.fit.sizes.iter().position(|s| s.0 == c)).and_then(|k| found.get(k));
        if let (Some(a), Some(found)) = (effect.amplitudes(frame), found) {
            // Root mean square over the runs, with the repeating and the scattering part together.
            plausible &= found
                .iter()
                .zip(&a.plausible)
                .all(|(f, most)| f[0] <= *most);
            sigma.extend(found.iter().map(|f| f[1]));
            size.extend(found.iter().map(|f| f[0]));
            unit = a.unit;
        }
        out.push(NamedEffect {
            id: full_id(effect),
            place: effect.place(),
            size,
            sigma,
            unit,
            plausible,
            extension: effect.extension(frame, &parameters),
        });
    }
    out
}

/// Returns root mean square and standard deviation of the amplitudes of a set, by family (in the order of its sizes) and kind.
fn found_amplitudes(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> Vec<Vec<[f64; 2]>> {
    if scored.fit.sizes.is_empty() {
        return Vec::new();
    }
    let e = Explanation::from_fit(frame, candidates, scored);
    let read = |u: &SizedAmplitudes| {
        let mut read = u.clone();
        read.amplitudes.patterns = patterns_read(frame, &e.members, &u.amplitudes.patterns);
        read
    };
    let unknown: Vec<SizedAmplitudes> = e.unknown.iter().map(read).collect();
    let selection = Selection::of_runs(frame, &frame.observations.fit_runs());
    let blocks = RunBlocks::from_selection(frame, &e.members, &selection);
    amplitudes_found(&blocks, &scored.fit.residual, &unknown)
}

/// Returns a smooth error with the root mean square of its factors minus one, and of their standard deviations.
fn smooth_found(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    effect: &dyn StrainEffect,
) -> NamedEffect {
    let curve = curve(frame, candidates, scored);
    NamedEffect {
        id: full_id(effect),
        place: None,
        size: vec![rms(curve.iter().map(|c| c.factor - 1.0))],
        sigma: vec![rms(curve.iter().map(|c| c.sd))],
        unit: "1",
        plausible: true,
        extension: effect.extension(frame, &[]),
    }
}
