//! S to begin with where no model gives one: from the runs whose loads are known.

use super::posterior::{Equation, Posterior, solve};
use super::prior::RowPrior;
use super::types::{KnownRun, Task};
use crate::linalg::spd;

/// Share of the largest eigenvalue of the loads' squares from which a combination counts as applied.
pub(super) const SPANNED: f64 = 1e-6;
/// Share of a load's size from which its sd makes it unknown.
pub(super) const UNKNOWN: f64 = 0.5;

/// Whether every load of a run is known to better than [`UNKNOWN`] of its size.
pub(super) fn is_known(run: &KnownRun, sizes: &[f64]) -> bool {
    let k = sizes.len();
    (0..k).all(|l| {
        let variance = run.loads.covariance.get(l * k + l).copied();
        variance.unwrap_or(0.0).sqrt() <= UNKNOWN * sizes[l]
    })
}

/// S from the runs whose loads are known, where there are others and these tell all loads; `None` else. What a run weighed by its sum carries
/// where is told by S alone: begun with none, all loads look alike, and what tells them apart is taken for scatter.
pub(super) fn from_known(
    task: &Task,
    runs: &[&KnownRun],
    scales: &[f64],
    prior: &[RowPrior],
) -> Option<Posterior> {
    let k = scales.len();
    let known: Vec<&KnownRun> = runs
        .iter()
        .copied()
        .filter(|r| is_known(r, scales))
        .collect();
    if known.len() == runs.len() {
        return None;
    }
    let mut gram = vec![0.0; k * k];
    let mut equations = Vec::with_capacity(known.len());
    for run in known {
        let phi: Vec<f64> = (run.loads.mean.iter().zip(scales))
            .map(|(f, c)| f / c)
            .collect();
        spd::add_outer(&mut gram, &phi, 1.0);
        let gauges: Vec<usize> = (0..prior.len())
            .filter(|&g| run.strain.get(g).is_some_and(|v| v.is_finite()))
            .collect();
        let m = gauges.len();
        let noise = (task.noise * task.noise * run.noise_factor).max(f64::MIN_POSITIVE);
        let mut covariance = vec![0.0; m * m];
        covariance
            .iter_mut()
            .step_by(m + 1)
            .for_each(|v| *v = noise);
        equations.push(Equation {
            y: gauges.iter().map(|&g| run.strain[g]).collect(),
            gauges,
            phi,
            covariance,
        });
    }
    let values = spd::eigenvalues(&gram, k);
    let (least, most) = (values.first()?, values.last()?);
    if *least <= SPANNED * most {
        return None;
    }
    solve(prior, &equations)
}
