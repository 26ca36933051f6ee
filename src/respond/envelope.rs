//! The largest von Mises stress over load states.

use super::rows::{Place, ResponseRow};
use crate::model::{GridIx, Model};
use rayon::prelude::*;
use std::collections::HashMap;

/// Loads at one instant or of one run, in the order of the response's columns.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadState {
    /// Name of the run, or time.
    pub label: String,
    /// Loads, job units.
    pub values: Vec<f64>,
    /// Uncertainty of the loads.
    pub spread: Spread,
}

/// Uncertainty of loads.
#[derive(Clone, Debug, PartialEq)]
pub enum Spread {
    /// Covariance by rows.
    Covariance(Vec<f64>),
    /// Standard deviations, errors taken as independent.
    Sigma(Vec<f64>),
}

impl Spread {
    /// Returns the standard deviation of `g . loads`.
    pub(super) fn sd_of_combination(&self, g: &[f64]) -> f64 {
        let k = g.len();
        match self {
            Self::Covariance(c) => (0..k)
                .flat_map(|i| (0..k).map(move |j| (i, j)))
                .map(|(i, j)| g[i] * g[j] * c.get(i * k + j).copied().unwrap_or(f64::NAN))
                .sum::<f64>()
                .max(0.0)
                .sqrt(),
            Self::Sigma(s) => g
                .iter()
                .zip(s)
                .map(|(g, s)| (g * s).powi(2))
                .sum::<f64>()
                .sqrt(),
        }
    }
}

/// The largest stress at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// von Mises stress, model units.
    pub von_mises: f64,
    /// Standard deviation of the stress, from the standard deviations of the loads at that state.
    pub sigma: f64,
    /// Index of the state.
    pub at: usize,
}

fn stress(row: &ResponseRow, loads: &[f64]) -> [f64; 3] {
    let mut s = [0.0; 3];
    for (r, f) in row.stress.iter().zip(loads) {
        for (s, r) in s.iter_mut().zip(r) {
            *s += r * f;
        }
    }
    s
}

/// Returns `svm^2 = sxx^2 - sxx syy + syy^2 + 3 sxy^2` (plane stress).
fn square([x, y, s]: [f64; 3]) -> f64 {
    x * x - x * y + y * y + 3.0 * s * s
}

/// Returns the von Mises stress and its standard deviation in one state, to first order: `d svm = (ds' Q s) / svm`.
fn with_sigma(row: &ResponseRow, state: &LoadState) -> (f64, f64) {
    let s = stress(row, &state.values);
    let value = square(s).max(0.0).sqrt();
    let slope = [
        (2.0 * s[0] - s[1]) / 2.0,
        (2.0 * s[1] - s[0]) / 2.0,
        3.0 * s[2],
    ];
    let g: Vec<f64> = row
        .stress
        .iter()
        .map(|r| {
            let along: f64 = r.iter().zip(slope).map(|(r, s)| r * s).sum();
            if value > 0.0 { along / value } else { 0.0 }
        })
        .collect();
    (value, state.spread.sd_of_combination(&g))
}

/// Returns the peak of every row over all states. States with loads that are not numbers are skipped. Rows are computed in parallel.
pub fn envelope(rows: &[ResponseRow], states: &[LoadState]) -> Vec<Peak> {
    rows.par_iter()
        .map(|row| {
            let (mut top, mut at) = (-1.0, 0);
            for (i, state) in states.iter().enumerate() {
                let v = square(stress(row, &state.values));
                if v > top {
                    (top, at) = (v, i);
                }
            }
            let (von_mises, sigma) = states
                .get(at)
                .map_or((f64::NAN, f64::NAN), |s| with_sigma(row, s));
            Peak {
                von_mises,
                sigma,
                at,
            }
        })
        .collect()
}

/// Returns stress `sxx, syy, sxy`, von Mises stress and its standard deviation in every state.
pub fn von_mises_history(row: &ResponseRow, states: &[LoadState]) -> Vec<([f64; 3], f64, f64)> {
    states
        .iter()
        .map(|s| {
            let (v, sigma) = with_sigma(row, s);
            (stress(row, &s.values), v, sigma)
        })
        .collect()
}

/// Returns the rows with a higher peak than every other row on neighbouring elements (which share a grid), highest first.
pub fn hot_spots(model: &Model, rows: &[ResponseRow], peaks: &[Peak]) -> Vec<usize> {
    let grids = |row: &ResponseRow| -> Vec<GridIx> {
        match row.place {
            Place::Shell { shell, .. } => model
                .shells
                .get(shell.us())
                .map_or_else(Vec::new, |s| s.grids[..s.shape.n_corners()].to_vec()),
            Place::Beam { beam, .. } => model
                .beams
                .get(beam.us())
                .map_or_else(Vec::new, |b| b.grids.to_vec()),
        }
    };
    let mut hottest: HashMap<GridIx, usize> = HashMap::new();
    for (i, row) in rows.iter().enumerate() {
        for g in grids(row) {
            let best = hottest.entry(g).or_insert(i);
            if peaks[i].von_mises > peaks[*best].von_mises {
                *best = i;
            }
        }
    }
    let mut out: Vec<usize> = (0..rows.len())
        .filter(|i| grids(&rows[*i]).iter().all(|g| hottest.get(g) == Some(i)))
        .collect();
    out.sort_by(|a, b| peaks[*b].von_mises.total_cmp(&peaks[*a].von_mises));
    out
}
