//! Wheel loads recovered from the strain of runs that were not fitted, without and with the effects.

use super::covariance::{Selection, covariance, read_patterns};
use super::frame::StrainFrame;
use super::prediction::read_all;
use super::state::{Part, StrainState};
use crate::linalg::precision::Precision;
use crate::reconcile::effect::{Member, SizedAmplitudes};
use crate::reconcile::outcome::LoadShift;

/// Wheel loads recovered from the strain of each proof run, by generalised least squares, without and with the effects.
pub fn loads_before_after(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
) -> Vec<LoadShift> {
    let mut out = Vec::new();
    for run in frame.observations.proof_runs() {
        let (Some(before), Some(after)) = (
            recover(&frame.as_modelled(), &[], &[], run),
            recover(frame, members, unknown, run),
        ) else {
            continue;
        };
        for (l, name) in frame.load_names.iter().enumerate() {
            out.push(LoadShift {
                run: frame.observations.runs[run].clone(),
                load: name.clone(),
                unit: if frame.is_moment(l) { "kN m" } else { "kN" },
                stated: frame.loads[run * frame.n_loads() + l],
                before: before[l].0,
                after: after[l].0,
                sigma: after[l].1,
            });
        }
    }
    out
}

/// Loads of one run with their standard deviations.
fn recover(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
    run: usize,
) -> Option<Vec<(f64, f64)>> {
    let (n_l, n_g) = (frame.n_loads(), frame.n_gauges());
    let mut state = StrainState::with(frame, members);
    let [_, _, n_c] = state.shape;
    let column = |l: usize| {
        (0..n_g)
            .map(|g| state.influence[g * n_c + l])
            .collect::<Vec<f64>>()
    };
    let columns = read_patterns(frame, members, &(0..n_l).map(column).collect::<Vec<_>>());
    state.columns[run * n_c..run * n_c + n_l].fill(0.0);
    let mut rest = state.strain(run);
    read_all(frame, members, run, &mut rest, Part::Whole);
    let used = Selection::of_runs(frame, &[run]);
    let r: Vec<f64> = used
        .0
        .iter()
        .map(|&(k, g)| frame.observations.value(k, g) - rest[g])
        .collect();
    // The loads are to be found: their measured values and noise stay out.
    let mut free = frame.clone();
    free.load_noise = 0.0;
    let p = Precision::of(&covariance(&free, members, &used, unknown), used.len())?;
    let mut normal = vec![0.0; n_l * n_l];
    let mut right = vec![0.0; n_l];
    let here = |l: usize| used.0.iter().map(|e| columns[l][e.1]).collect::<Vec<f64>>();
    for l in 0..n_l {
        let w = p.apply(&here(l));
        for k in 0..n_l {
            normal[l * n_l + k] = here(k).iter().zip(&w).map(|(a, b)| a * b).sum();
        }
        right[l] = r.iter().zip(&w).map(|(a, b)| a * b).sum();
    }
    let solved = Precision::of(&normal, n_l)?;
    Some(
        solved
            .apply(&right)
            .into_iter()
            .enumerate()
            .map(|(l, v)| (v, solved.entry(l, l).max(0.0).sqrt()))
            .collect(),
    )
}
