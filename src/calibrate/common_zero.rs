//! Common zero: strain that the gauges read without load, `eps = S f + z`. Inside a calibration it is one more column of S, for a load that is 1 in
//! every run ([`add_zero_column`]). Outside, S has the loads of the task, and `z` is subtracted from the readings.
//!
//! The errors of `S` and `z` are correlated, because the runs determine best the strain at the loads in their middle. With `c` these loads,
//! `eps = S (f - c) + (z + S c)`. The two parts are taken as uncorrelated, and their covariances are stored separately ([`CentredPosterior`]).

use super::posterior::Posterior;
use super::types::{Calibration, CommonZero, KnownLoads, Task};
use crate::linalg::spd;
use crate::sensitivity::Load;

/// Name of the column in messages.
const NAME: &str = "common zero";

impl Task {
    /// Returns the number of loads that the job states.
    pub(super) fn own_loads(&self) -> usize {
        self.loads.len() - usize::from(self.is_extended())
    }

    /// Returns whether the last column is the common zero.
    pub(super) fn is_extended(&self) -> bool {
        self.common_zero == CommonZero::Column
    }
}

/// Returns the task with the column of the common zero.
pub(super) fn add_zero_column(task: &Task) -> Task {
    let mut out = task.clone();
    out.common_zero = CommonZero::Column;
    let k = task.loads.len();
    out.loads.push(Load {
        wanted: false,
        ..Load::from_name(NAME)
    });
    for run in &mut out.runs {
        let known = &run.loads.covariance;
        let entry = |i: usize| match (i / (k + 1), i % (k + 1)) {
            (l, m) if l < k && m < k => known[l * k + m],
            _ => 0.0,
        };
        run.loads.covariance = (0..(k + 1) * (k + 1)).map(entry).collect();
        run.loads.mean.push(1.0);
    }
    out.sums.iter_mut().for_each(|s| s.push(0.0));
    out
}

/// Returns the result without the column of the common zero.
pub(super) fn remove_zero_column(mut found: Calibration, k: usize) -> Calibration {
    found
        .undetermined
        .iter_mut()
        .for_each(|u| u.terms.truncate(k));
    found.range.loads.truncate(k);
    found
}

impl KnownLoads {
    /// Returns the first `k` loads.
    pub(super) fn first_loads(&self, k: usize) -> Self {
        let all = self.mean.len();
        Self {
            mean: self.mean[..k].to_vec(),
            covariance: (0..k * k)
                .map(|i| self.covariance[i / k * all + i % k])
                .collect(),
        }
    }
}

/// Returns the strain without load by gauge. It contains zeros if the task has no common zero.
pub(super) fn zero_of(task: &Task, posterior: &Posterior) -> Vec<f64> {
    let k = posterior.k;
    match task.is_extended() {
        true => (0..posterior.n)
            .map(|g| posterior.mean[g * k + k - 1])
            .collect(),
        false => vec![0.0; posterior.n],
    }
}

/// Returns the readings minus the common zero.
pub(super) fn less_zero(strain: &[f64], zero: &[f64]) -> Vec<f64> {
    strain.iter().zip(zero).map(|(y, z)| y - z).collect()
}

/// A posterior with a common zero in two independent parts.
pub(super) struct CentredPosterior {
    /// `c`, loads of unit size.
    pub center: Vec<f64>,
    /// Covariance of `z + S c`, `n x n` by rows.
    pub covariance: Vec<f64>,
}

impl CentredPosterior {
    /// Computes `c = -(sum_g Cov S_g)^-1 sum_g Cov(S_g, z_g)`, zero if loads are not determined.
    pub fn from_posterior(posterior: &Posterior) -> Self {
        let (n, all) = (posterior.n, posterior.k);
        let k = all - 1;
        let order = n * all;
        let entry = |g: usize, l: usize, h: usize, m: usize| {
            posterior.covariance[(g * all + l) * order + h * all + m]
        };
        let sum = |l: usize, m: usize| -> f64 { (0..n).map(|g| entry(g, l, g, m)).sum() };
        let of_s: Vec<f64> = (0..k * k).map(|i| sum(i / k, i % k)).collect();
        let with_zero: Vec<f64> = (0..k).map(|l| -sum(l, k)).collect();
        let center = match spd::cholesky(&of_s, k) {
            Some(lower) => {
                let inverse = spd::gram_of_lower(&spd::inverse_lower(&lower, k), k);
                let mut out = vec![0.0; k];
                spd::times(&inverse, &with_zero, &mut out);
                out
            }
            None => vec![0.0; k],
        };
        let at = |l: usize| center.get(l).copied().unwrap_or(1.0);
        let between = |g: usize, h: usize| -> f64 {
            let pairs = (0..all).flat_map(|l| (0..all).map(move |m| (l, m)));
            pairs.map(|(l, m)| at(l) * at(m) * entry(g, l, h, m)).sum()
        };
        let covariance = (0..n * n).map(|i| between(i / n, i % n)).collect();
        Self { center, covariance }
    }
}
