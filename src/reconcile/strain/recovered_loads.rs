//! Wheel loads recovered from the strain of runs that were not fitted, without and with the effects.
//!
//! The solution is as in `recover` for readings with dependent errors. The covariance differs: it contains the errors that remain with the effects,
//! their amplitudes in this run and gauges as read with faults. It follows the recorded loads, which `recover` does not have.

use super::covariance::{Selection, covariance, read_patterns};
use super::frame::StrainFrame;
use super::prediction::read_all;
use super::state::{Part, StrainState};
use crate::estimate::{LinearGaussian, ReadingErrors};
use crate::linalg::Matrix;
use crate::reconcile::effect::{Member, SizedAmplitudes};
use crate::reconcile::outcome::LoadShift;

/// Returns the wheel loads recovered from the strain of each held-out run, by generalised least squares, without and with the effects.
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

/// Recovers the loads of one run with their standard deviations.
fn recover(
    frame: &StrainFrame,
    members: &[Member<'_>],
    unknown: &[SizedAmplitudes],
    run: usize,
) -> Option<Vec<(f64, f64)>> {
    let (n_l, n_g) = (frame.n_loads(), frame.n_gauges());
    let mut state = StrainState::from_members(frame, members);
    let [_, _, n_c] = state.shape;
    let column = |l: usize| {
        (0..n_g)
            .map(|g| state.influence[g * n_c + l])
            .collect::<Vec<f64>>()
    };
    let columns: Vec<Vec<f64>> = (0..n_l).map(column).collect();
    let columns = read_patterns(frame, members, &columns, run);
    state.columns[run * n_c..run * n_c + n_l].fill(0.0);
    let mut rest = state.strain(run);
    read_all(frame, members, run, &mut rest, Part::Whole);
    let used = Selection::of_runs(frame, &[run]);
    let r: Vec<f64> = used
        .0
        .iter()
        .map(|&(k, g)| frame.observations.value(k, g) - rest[g])
        .collect();
    // The loads are unknown here, so their measured values and noise are left out. The ground is left out as well, since the recovered loads contain
    // it.
    let mut free = frame.clone();
    free.load_noise = 0.0;
    free.ground = 0.0;
    let covariance = covariance(&free, members, &used, unknown);
    let s = Matrix::from_fn(used.len(), n_l, |i, l| columns[l][used.0[i].1]);
    let scale = |l: usize| {
        let norm = s.column(l).norm();
        if norm > 0.0 { 1.0 / norm } else { 1.0 }
    };
    let scales: Vec<f64> = (0..n_l).map(scale).collect();
    let model = LinearGaussian {
        rows: &s,
        errors: ReadingErrors::Covariance(&covariance),
        prior_sd: &vec![None; n_l],
        scales: &scales,
    };
    let fit = model.estimate(&r)?;
    let sigma = |l: usize| fit.covariance[(l, l)].max(0.0).sqrt();
    let loads = fit.value.iter().enumerate().map(|(l, v)| (*v, sigma(l)));
    (fit.rank == n_l).then(|| loads.collect())
}
