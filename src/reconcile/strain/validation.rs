//! The gap of a set of effects on runs that were not fitted: those that are held out, else every run in turn.

use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::gap::{FoundAnew, Judged, before, judged_after};
use super::likelihood::{Fit, Likelihood};
use crate::reconcile::effect::Candidate;
use crate::reconcile::outcome::{ChannelGap, Gap, GapBasis};
use crate::reconcile::search::{Scored, Scorer};
use rayon::prelude::*;

/// Groups of runs that are left out in turn where no run is held out: each set is fitted as many times.
const FOLDS: usize = 6;

/// Residuals judged with amplitudes found anew, and with the loads besides.
pub(super) type Both = [Judged; 2];

/// Runs to be judged, with their residuals by the analyst's model.
struct Proven {
    frame: StrainFrame,
    /// Amplitudes found anew; with the loads besides. Empty where the covariance has no factor.
    ways: Vec<(FoundAnew, Vec<f64>)>,
}

impl Proven {
    fn of(frame: StrainFrame) -> Self {
        let ways = [FoundAnew::Amplitudes, FoundAnew::AmplitudesAndLoads];
        let before = before(&frame, &ways).unwrap_or_default();
        Self {
            ways: ways.into_iter().zip(before).collect(),
            frame,
        }
    }

    fn judged(&self, candidates: &[Candidate], scored: &Scored<Fit>) -> Both {
        let e = Explanation::of(&self.frame, candidates, scored);
        let both = judged_after(&self.frame, &e.members, &e.unknown, &self.ways);
        both.and_then(|b| b.try_into().ok()).unwrap_or_default()
    }
}

/// The runs by which sets of effects are judged: those that are held out, else every run in turn. Made once for all sets; none where the
/// work is to stop.
pub struct Proofs<'a> {
    /// What is judged.
    pub frame: &'a StrainFrame,
    parts: Vec<Proven>,
}

impl<'a> Proofs<'a> {
    /// Of the runs of `frame`.
    pub fn of(frame: &'a StrainFrame) -> Self {
        let going = |_: &usize| !frame.stop.is_asked();
        if frame.observations.held_out.iter().any(|h| *h) {
            let whole = (!frame.stop.is_asked()).then(|| Proven::of(frame.clone()));
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
            Proven::of(part)
        };
        Self {
            frame,
            parts: (0..folds).into_par_iter().filter(going).map(part).collect(),
        }
    }
}

fn refitted(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
) -> Option<Scored<Fit>> {
    let reference: Vec<(usize, Vec<f64>)> = scored
        .set
        .iter()
        .copied()
        .zip(scored.fit.parameters.clone())
        .collect();
    let runs = frame.observations.fit_runs();
    Likelihood::new(frame, candidates, &runs, &reference).score(&scored.set, Some((scored, None)))
}

/// The gap over all and by gauge: on held-out runs, else every run in turn. Effects of single runs (two exchanged, a wrong note) can't show
/// on runs that they don't touch: those they touch are judged besides, half of the gauges by what was fitted without it.
pub fn validated(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
) -> (Gap, Vec<ChannelGap>) {
    let frame = proofs.frame;
    let [plain, loads_found] = residuals_on(proofs, candidates, scored, &scored.set);
    let basis = match frame.observations.held_out.iter().any(|h| *h) {
        true => GapBasis::HeldOut,
        false => GapBasis::CrossValidated,
    };
    plain.gap(frame, basis, &loads_found)
}

/// Returns the residuals of `scored` on the readings that the set `of` is compared on: those of the runs that its effects touch as well.
pub(super) fn residuals_on(
    proofs: &Proofs<'_>,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
    of: &[usize],
) -> Both {
    let frame = proofs.frame;
    let held_out = frame.observations.held_out.iter().any(|h| *h);
    let [mut plain, mut loads_found] = match proofs.parts.as_slice() {
        [one] if held_out => one.judged(candidates, scored),
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
            let [a, b] = judged_by_halves(frame, candidates, scored, &touched, half);
            plain.extend(a);
            loads_found.extend(b);
        }
    }
    [plain, loads_found]
}

fn in_turn(parts: &[Proven], candidates: &[Candidate], scored: &Scored<Fit>) -> Both {
    let one = |part: &Proven| {
        if part.frame.stop.is_asked() {
            return None;
        }
        let fitted = refitted(&part.frame, candidates, scored)?;
        Some(part.judged(candidates, &fitted))
    };
    let judged: Vec<Option<Both>> = parts.par_iter().map(one).collect();
    let mut out = Both::default();
    for part in judged.into_iter().flatten() {
        for (all, more) in out.iter_mut().zip(part) {
            all.extend(more);
        }
    }
    out
}

/// The gauges of one half in the runs `touched`, judged by what all other readings tell.
fn judged_by_halves(
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
    touched: &[usize],
    half: usize,
) -> Both {
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
    let Some(fitted) = refitted(&hidden, candidates, scored) else {
        return Both::default();
    };
    let mut proof = frame.clone();
    proof.observations.held_out = (0..frame.n_runs()).map(|r| touched.contains(&r)).collect();
    Proven::of(proof)
        .judged(candidates, &fitted)
        .map(|j| j.half(half))
}
