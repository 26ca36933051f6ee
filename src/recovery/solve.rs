//! One weighted least-squares solution.

use crate::linalg::dense::{self, RANK_TOLERANCE};
use crate::linalg::{Matrix, Vector};

/// `f = A^+ y` with what is needed to judge it.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Loads.
    pub f: Vec<f64>,
    /// Their covariance for readings of the stated variances.
    pub covariance: Matrix,
    /// `n_loads x n_readings`: `f = gain y`.
    pub gain: Matrix,
    /// Diagonal of the hat matrix: how much each reading decides its own prediction.
    pub leverage: Vec<f64>,
    /// Rank of the weighted system; under the number of loads, `f` is the smallest of many solutions.
    pub rank: usize,
}

/// Least squares by singular value decomposition of `diag(1/sd) S diag(scale)`, with a row `1/prior_sd` for each load that has one.
///
/// `s` is `n x k`; `variances` of the readings; `prior_sd`: what is known of a load beforehand (mean 0), `None` for wanted loads.
/// `scales` bring the columns to comparable size. `None` where numbers are not finite.
pub fn fit(
    s: &Matrix,
    y: &[f64],
    variances: &[f64],
    prior_sd: &[Option<f64>],
    scales: &[f64],
) -> Option<Fit> {
    let (n, k) = s.shape();
    let priors: Vec<(usize, f64)> = prior_sd
        .iter()
        .enumerate()
        .filter_map(|(l, p)| p.map(|p| (l, p)))
        .collect();
    let rows = (n + priors.len()).max(k);
    let mut a = Matrix::zeros(rows, k);
    for g in 0..n {
        let w = 1.0 / variances[g].sqrt();
        for l in 0..k {
            a[(g, l)] = w * s[(g, l)] * scales[l];
        }
    }
    for (i, &(l, sd)) in priors.iter().enumerate() {
        a[(n + i, l)] = scales[l] / sd;
    }
    let d = dense::svd(&a)?;
    let limit = d.s.first().copied().unwrap_or(0.0) * RANK_TOLERANCE;
    let rank = d.s.iter().filter(|&&v| v > limit && v > 0.0).count();
    // gain = scale V S^-1 U' W
    let mut gain = Matrix::zeros(k, n);
    let mut covariance = Matrix::zeros(k, k);
    let mut leverage = vec![0.0; n];
    for i in 0..rank {
        for g in 0..n {
            leverage[g] += d.u[(g, i)] * d.u[(g, i)];
            let u = d.u[(g, i)] / (d.s[i] * variances[g].sqrt());
            for l in 0..k {
                gain[(l, g)] += scales[l] * d.v[(l, i)] * u;
            }
        }
        for l in 0..k {
            for m in 0..k {
                covariance[(l, m)] +=
                    scales[l] * scales[m] * d.v[(l, i)] * d.v[(m, i)] / (d.s[i] * d.s[i]);
            }
        }
    }
    // Directions that the readings don't see at all are unknown: their loads have no finite standard deviation.
    for i in rank..d.s.len() {
        for l in 0..k {
            if d.v[(l, i)].abs() > UNSEEN {
                covariance[(l, l)] = f64::INFINITY;
            }
        }
    }
    let f = (&gain * Vector::from_column_slice(y))
        .iter()
        .copied()
        .collect();
    Some(Fit {
        f,
        covariance,
        gain,
        leverage,
        rank,
    })
}

/// Share of a load in a combination that the readings don't see, from which the load counts as unknown.
const UNSEEN: f64 = 1e-6;
