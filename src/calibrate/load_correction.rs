//! Correction of uncertain known loads by the strain (errors in variables).

use super::types::KnownLoads;
use super::unknown_directions::{FreeDirections, project_out};
use crate::linalg::spd;

/// Loads of one run under a given S: the known loads, corrected by the readings.
pub(super) struct CorrectedLoads {
    /// Most probable loads, in loads of unit size.
    pub phi: Vec<f64>,
    /// `S (f - f0)` without the free directions. The readings plus this shift belong to the loads `phi`.
    pub shift: Vec<f64>,
    /// `S D S'` by rows: covariance of the strain from the errors of the loads.
    pub spread: Vec<f64>,
    /// Degrees of freedom, counted in readings, that the correction takes.
    pub freedom: f64,
}

/// Returns the loads from their Gaussian prior `known` and the readings `y` with covariance `r` (by rows). `s` contains rows by gauge, for loads of
/// unit size: `f = f0 + D S' (S D S' + R)^-1 (y - S f0)`. Along `free` directions the loads are unknown beforehand, and `f` replaces `f0`.
///
/// # Reference
/// W. A. Fuller, Measurement Error Models (1987), section 2.2.
pub(super) fn correct(
    (known, free): (&KnownLoads, FreeDirections),
    scales: &[f64],
    s: &[Vec<f64>],
    y: &[f64],
    r: &[f64],
) -> Option<CorrectedLoads> {
    let (n, k) = (y.len(), scales.len());
    let first: Vec<f64> = known.mean.iter().zip(scales).map(|(f, c)| f / c).collect();
    if known.covariance.iter().all(|v| *v == 0.0) && free.directions.is_empty() {
        return Some(CorrectedLoads {
            phi: first,
            shift: vec![0.0; n],
            spread: vec![0.0; n * n],
            freedom: 0.0,
        });
    }
    let d = |l: usize, m: usize| {
        known.covariance[l * k + m] / (scales[l] * scales[m]) + free.covariance(l, m)
    };
    let carried: Vec<Vec<f64>> = s
        .iter()
        .map(|row| {
            (0..k)
                .map(|m| (0..k).map(|l| row[l] * d(l, m)).sum())
                .collect()
        })
        .collect();
    let mut spread = vec![0.0; n * n];
    for (i, c) in carried.iter().enumerate() {
        for (j, row) in s.iter().enumerate() {
            spread[i * n + j] = spd::dot(c, row);
        }
    }
    let total: Vec<f64> = spread.iter().zip(r).map(|(a, b)| a + b).collect();
    let inverse = spd::gram_of_lower(&spd::inverse_lower(&spd::cholesky(&total, n)?, n), n);
    let left: Vec<f64> = s
        .iter()
        .zip(y)
        .map(|(row, y)| y - spd::dot(row, &first))
        .collect();
    let mut weighted = vec![0.0; n];
    spd::times(&inverse, &left, &mut weighted);
    let step: Vec<f64> = (0..k)
        .map(|m| carried.iter().zip(&weighted).map(|(c, w)| c[m] * w).sum())
        .collect();
    let mut off = step.clone();
    project_out(&mut off, free.directions);
    Some(CorrectedLoads {
        shift: s.iter().map(|row| spd::dot(row, &off)).collect(),
        phi: first.iter().zip(&step).map(|(a, b)| a + b).collect(),
        freedom: spd::trace_of_product(&spread, &inverse),
        spread,
    })
}
