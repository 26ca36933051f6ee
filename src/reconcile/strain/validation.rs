//! The gap of a set of effects on runs that were not fitted: those that are held out, else every run in turn.

use super::explanation::Explanation;
use super::frame::StrainFrame;
use super::gap::{FoundAnew, Judged, judged};
use super::likelihood::{Fit, Likelihood};
use crate::reconcile::effect::Candidate;
use crate::reconcile::outcome::{ChannelGap, Gap, GapBasis};
use crate::reconcile::search::{Scored, Scorer};

/// Groups of runs that are left out in turn where no run is held out: each set is fitted as many times.
const FOLDS: usize = 6;

/// Residuals judged with amplitudes found anew, and with the loads besides.
type Both = [Judged; 2];

fn judged_both(frame: &StrainFrame, candidates: &[Candidate], scored: &Scored<Fit>) -> Both {
    let e = Explanation::of(frame, candidates, scored);
    [FoundAnew::Amplitudes, FoundAnew::AmplitudesAndLoads]
        .map(|a| judged(frame, &e.members, &e.unknown, a).unwrap_or_default())
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
    frame: &StrainFrame,
    candidates: &[Candidate],
    scored: &Scored<Fit>,
) -> (Gap, Vec<ChannelGap>) {
    let held_out = frame.observations.held_out.iter().any(|h| *h);
    let [mut plain, mut loads_found] = if held_out {
        judged_both(frame, candidates, scored)
    } else {
        in_turn(frame, candidates, scored)
    };
    let effects = scored.set.iter().filter_map(|&c| candidates.get(c));
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
    if !touched.is_empty() && held_out {
        for half in [0, 1] {
            let [a, b] = judged_by_halves(frame, candidates, scored, &touched, half);
            plain.extend(a);
            loads_found.extend(b);
        }
    }
    let basis = if held_out {
        GapBasis::HeldOut
    } else {
        GapBasis::CrossValidated
    };
    plain.gap(frame, basis, &loads_found)
}

fn in_turn(frame: &StrainFrame, candidates: &[Candidate], scored: &Scored<Fit>) -> Both {
    let n = frame.n_runs();
    let folds = FOLDS.min(n);
    let mut out = Both::default();
    for fold in 0..folds {
        let mut part = frame.clone();
        part.observations.held_out = (0..n).map(|r| r % folds == fold).collect();
        let Some(fitted) = refitted(&part, candidates, scored) else {
            continue;
        };
        for (all, more) in out.iter_mut().zip(judged_both(&part, candidates, &fitted)) {
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
    judged_both(&proof, candidates, &fitted).map(|j| j.half(half))
}
