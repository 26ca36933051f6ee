//! Gap of a set of effects on runs that were not fitted: the held-out runs or, without held-out runs, every run in turn.

use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::gap::{
    ReestimatedUnknowns, ValidationResiduals, proof_residuals_before, verdict_after_removal,
};
use super::likelihood::{Fit, Likelihood};
use crate::reconcile::effect::Candidate;
use crate::reconcile::outcome::{ChannelGap, Gap, GapBasis};
use crate::reconcile::search::{ScoredSet, Scorer};
use rayon::prelude::*;

/// Number of groups of runs that are left out in turn if no run is held out. Each set is fitted as many times.
const FOLDS: usize = 6;

/// Residuals with amplitudes estimated again in each run, then residuals with amplitudes and errors of the recorded loads estimated again.
pub(super) type ValidationResidualPair = [ValidationResiduals; 2];

/// Validation runs, with their residuals under the analyst's model.
struct ValidationFold {
    frame: StrainFrame,
    /// Residuals under the analyst's model in the order of [`ValidationResidualPair`]. Empty if the covariance has no factor.
    ways: Vec<(ReestimatedUnknowns, Vec<f64>)>,
}

impl ValidationFold {
    fn from_frame(frame: StrainFrame) -> Self {
        let ways = [
            ReestimatedUnknowns::Amplitudes,
            ReestimatedUnknowns::AmplitudesAndLoads,
        ];
        let before = proof_residuals_before(&frame, &ways).unwrap_or_default();
        Self {
            ways: ways.into_iter().zip(before).collect(),
            frame,
        }
    }

    fn validation_residuals(
        &self,
        candidates: &[Candidate],
        scored: &ScoredSet<Fit>,
    ) -> ValidationResidualPair {
        let e = Explanation::from_fit(&self.frame, candidates, scored);
        let both = verdict_after_removal(&self.frame, &e.members, &e.unknown, &self.ways);
        both.and_then(|b| b.try_into().ok()).unwrap_or_default()
    }
}

/// Validation runs for sets of effects: the held-out runs or, without held-out runs, every run in turn. They are prepared once for all sets, and
/// empty if a stop is requested.
pub struct Proofs<'a> {
    /// Static problem with all runs.
    pub frame: &'a StrainFrame,
    parts: Vec<ValidationFold>,
}

impl<'a> Proofs<'a> {
    /// Prepares the validation runs of `frame`.
    pub fn from_frame(frame: &'a StrainFrame) -> Self {
        let going = |_: &usize| !frame.stop.is_asked();
        if frame.observations.held_out.iter().any(|h| *h) {
            let whole = (!frame.stop.is_asked()).then(|| ValidationFold::from_frame(frame.clone()));
            return Self {
                frame,
                parts: whole.into_iter().collect(),
            };
        }
        let n = frame.n_runs();
        let folds = FOLDS.min(n);
        let part = |fold: usize| {
            let mut part = frame.clone();
            part.observations.held_out = (0..n).map(|r| r % folds == fold).collect();
            ValidationFold::from_frame(part)
        };
        Self {
            frame,
            parts: (0..folds).into_par_iter().filter(going).map(part).collect(),
        }
    }
}

fn refit_set(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> Option<ScoredSet<Fit>> {
    let reference: Vec<(usize, Vec<f64>)> = scored
        .set
        .iter()
        .copied()
        .zip(scored.fit.parameters.clone())
        .collect();
    let runs = frame.observations.fit_runs();
    Likelihood::new(frame, candidates, &runs, &reference).score(&scored.set, Some((scored, None)))
}

/// Returns the gap over all gauges and by gauge, on held-out runs or, without held-out runs, on every run in turn. Effects of single runs (two
/// exchanged, a wrong record) change only those runs. These runs are therefore tested in addition: each half of the gauges is tested with a fit
/// without this half.
pub fn validate_set(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> (Gap, Vec<ChannelGap>) {
    let frame = proofs.frame;
    let [plain, loads_found] = residuals_on(proofs, candidates, scored, &scored.set);
    let basis = match frame.observations.held_out.iter().any(|h| *h) {
        true => GapBasis::HeldOut,
        false => GapBasis::CrossValidated,
    };
    plain.gap(frame, basis, &loads_found)
}

/// Returns the residuals of `scored` on the readings that the set `of` is compared on. They include the runs that single-run effects of `of` change.
pub(super) fn residuals_on(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    of: &[usize],
) -> ValidationResidualPair {
    let frame = proofs.frame;
    let held_out = frame.observations.held_out.iter().any(|h| *h);
    let [mut plain, mut loads_found] = match proofs.parts.as_slice() {
        [one] if held_out => one.validation_residuals(candidates, scored),
        parts => in_turn(parts, candidates, scored),
    };
    let effects = of.iter().filter_map(|&c| candidates.get(c));
    let mut touched: Vec<usize> = effects.flat_map(|c| c.effect.runs()).collect();
    touched.sort_unstable();
    touched.dedup();
    touched.retain(|r| {
        !frame
            .observations
            .held_out
            .get(*r)
            .copied()
            .unwrap_or(false)
    });
    if !touched.is_empty() && !frame.stop.is_asked() {
        for half in [0, 1] {
            let [a, b] = test_by_halves(frame, candidates, scored, &touched, half);
            plain.extend(a);
            loads_found.extend(b);
        }
    }
    [plain, loads_found]
}

fn in_turn(
    parts: &[ValidationFold],
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
) -> ValidationResidualPair {
    let one = |part: &ValidationFold| {
        if part.frame.stop.is_asked() {
            return None;
        }
        let fitted = refit_set(&part.frame, candidates, scored)?;
        Some(part.validation_residuals(candidates, &fitted))
    };
    let tested: Vec<Option<ValidationResidualPair>> = parts.par_iter().map(one).collect();
    let mut out = ValidationResidualPair::default();
    for part in tested.into_iter().flatten() {
        for (all, more) in out.iter_mut().zip(part) {
            all.extend(more);
        }
    }
    out
}

/// Returns the residuals of one half of the gauges in the runs `touched`, with `scored` refitted to all other readings.
fn test_by_halves(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &ScoredSet<Fit>,
    touched: &[usize],
    half: usize,
) -> ValidationResidualPair {
    let mut hidden = frame.clone();
    for (run, row) in hidden
        .observations
        .values
        .chunks_exact_mut(frame.n_gauges().max(1))
        .enumerate()
    {
        let masked = row
            .iter_mut()
            .enumerate()
            .filter(|(g, _)| touched.contains(&run) && g % 2 == half);
        masked.for_each(|(_, v)| *v = f64::NAN);
    }
    let Some(fitted) = refit_set(&hidden, candidates, scored) else {
        return ValidationResidualPair::default();
    };
    let mut proof = frame.clone();
    proof.observations.held_out = (0..frame.n_runs()).map(|r| touched.contains(&r)).collect();
    ValidationFold::from_frame(proof)
        .validation_residuals(candidates, &fitted)
        .map(|j| j.half(half))
}
