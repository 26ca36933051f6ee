//! `smooth`: the model is off by a factor that changes smoothly from place to place. The factor is common to all loads, or each load has its own.
//! This Gaussian process competes with all effects of the library: an effect that explains no more is not proven.

use super::{Discrepancy, Extension, Parameter, Stage, StrainEffect};
use crate::linalg::{Matrix, dense};
use crate::reconcile::strain::{StrainFrame, StrainState};
use std::sync::Arc;

/// Influence of gauge g under load l times `1 + h_l(x_g)`, with `h_l` a Gaussian process over place x.
///
/// The process has the squared exponential covariance `a^2 exp(-|x - x'|^2 / (2 L^2))`. It is represented by the leading eigenvectors of its matrix:
/// `h_l(x_g) = sum_k theta_lk sqrt(lambda_k) v_kg`, with the prior standard deviation a of each theta.
#[derive(Clone, Debug)]
pub struct SmoothError {
    /// a.
    amplitude: f64,
    /// L, metres.
    pub length_m: f64,
    /// sqrt(lambda) times the vector over the gauges, for each mode.
    modes: Arc<Vec<Vec<f64>>>,
    /// One for all loads, or one for each and one for the payload.
    n_factors: usize,
}

/// Amplitudes a: a few percent (a mesh, sections, a support), and a tenth or more. If the true amplitude is 1.7 times larger or smaller, this costs
/// 0.2 of log evidence for each mode.
const AMPLITUDES: [f64; 2] = [0.04, 0.12];
/// Lengths, of the greatest distance between gauges.
const LENGTHS: [f64; 3] = [0.5, 0.25, 0.125];
/// Shortest length of a smooth process, as a multiple of the usual distance between gauges.
const SPACINGS: f64 = 1.5;
/// Smallest number of gauges that show a curve.
const FEWEST: usize = 6;
/// Largest number of modes over all factors, for one common factor and for one factor by load. The common factor needs the first number at the
/// shortest length. The second number is about five each for six loads and the payload.
const MODES: [usize; 2] = [16, 36];
/// Share of the variance that the modes must contain.
const HELD: f64 = 0.9;
/// Modes with less of the first one's variance are left out.
const LEAST: f64 = 1e-3;

impl SmoothError {
    /// Returns every length and amplitude, with one factor for all loads and with one by load. The list is empty if the place of a gauge is unknown.
    pub fn list_effects(frame: &StrainFrame) -> Vec<Self> {
        let places: Option<Vec<[f64; 3]>> = frame.gauges.iter().map(|g| g.position).collect();
        let Some(places) = places.filter(|p| p.len() >= FEWEST) else {
            return Vec::new();
        };
        let extent = pairs(&places).fold(0.0, f64::max);
        let Some(spacing) = usual_spacing(&places, 1e-3 * extent) else {
            return Vec::new();
        };
        let carried = frame.payload.iter().any(|p| p[0] != 0.0);
        let by_load = frame.n_loads() + usize::from(carried);
        let mut out = Vec::new();
        for length_m in LENGTHS.map(|l| l * extent) {
            if length_m < SPACINGS * spacing {
                break;
            }
            for (n_factors, most) in [(1, MODES[0]), (by_load, MODES[1] / by_load.max(1))] {
                if n_factors == 0 || (n_factors == 1 && by_load == 1 && most != MODES[0]) {
                    continue;
                }
                let Some(modes) = modes(&places, length_m, most).map(Arc::new) else {
                    continue;
                };
                out.extend(AMPLITUDES.map(|amplitude| Self {
                    amplitude,
                    length_m,
                    modes: modes.clone(),
                    n_factors,
                }));
            }
        }
        out
    }

    /// Returns h at a gauge for a column of the influence matrix.
    fn off_by(&self, gauge: usize, column: usize, parameters: &[f64]) -> f64 {
        let first = column.min(self.n_factors - 1) * self.modes.len();
        let own = parameters.iter().skip(first);
        self.modes.iter().zip(own).map(|(m, t)| m[gauge] * t).sum()
    }

    /// Returns `1 + h` at a gauge for a load (or for all loads if they share it), and its standard deviation. `covariance` is the joint covariance of
    /// the parameters (`n x n` by rows).
    pub fn factor(
        &self,
        gauge: usize,
        column: usize,
        parameters: &[f64],
        covariance: &[f64],
    ) -> (f64, f64) {
        let first = column.min(self.n_factors - 1) * self.modes.len();
        let w: Vec<f64> = self.modes.iter().map(|m| m[gauge]).collect();
        let n = parameters.len();
        let cell = |i: usize, j: usize| covariance.get((first + i) * n + first + j);
        let mut variance = 0.0;
        for (i, a) in w.iter().enumerate() {
            for (j, b) in w.iter().enumerate() {
                variance += a * b * cell(i, j).copied().unwrap_or(0.0);
            }
        }
        (
            1.0 + self.off_by(gauge, column, parameters),
            variance.max(0.0).sqrt(),
        )
    }

    /// Returns whether each load has a separate factor.
    pub fn is_by_load(&self) -> bool {
        self.n_factors > 1
    }

    /// Returns the number of factors: one for all loads, or one for each load and one for a payload other than zero.
    pub fn n_factors(&self) -> usize {
        self.n_factors
    }
}

/// Distances between all pairs.
fn pairs(places: &[[f64; 3]]) -> impl Iterator<Item = f64> {
    let others = |(i, p)| places.iter().skip(i + 1).map(move |q| distance(p, q));
    places.iter().enumerate().flat_map(others)
}

fn distance(p: &[f64; 3], q: &[f64; 3]) -> f64 {
    let squares = p.iter().zip(q).map(|(a, b)| (a - b) * (a - b));
    squares.sum::<f64>().sqrt()
}

/// Returns the median over gauges of the distance to the nearest gauge at another place.
fn usual_spacing(places: &[[f64; 3]], same: f64) -> Option<f64> {
    let nearest = |p: &[f64; 3]| {
        let far = places.iter().map(|q| distance(p, q));
        far.filter(|d| *d > same).min_by(f64::total_cmp)
    };
    let mut all: Vec<f64> = places.iter().filter_map(nearest).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied()
}

/// Returns the leading eigenvectors of the covariance of unit amplitude, times the roots of their eigenvalues. `None` if `most` vectors contain too
/// small a share of the variance.
fn modes(places: &[[f64; 3]], length: f64, most: usize) -> Option<Vec<Vec<f64>>> {
    let n = places.len();
    let kernel = Matrix::from_fn(n, n, |i, j| {
        (-0.5 * (distance(&places[i], &places[j]) / length).powi(2)).exp()
    });
    let d = dense::svd(&kernel)?;
    let first = d.s.first().copied()?;
    let kept: Vec<usize> = (0..d.s.len().min(most))
        .filter(|k| d.s[*k] > LEAST * first)
        .collect();
    let held: f64 = kept.iter().map(|&k| d.s[k]).sum();
    let mode = |&k: &usize| (0..n).map(|g| d.s[k].sqrt() * d.u[(g, k)]).collect();
    (held >= HELD * n as f64).then(|| kept.iter().map(mode).collect())
}

impl StrainEffect for SmoothError {
    fn id(&self) -> &str {
        "smooth"
    }
    fn discrepancy(&self) -> Option<Discrepancy> {
        Some(Discrepancy::Smooth(
            "the model is wrong by a factor that changes smoothly with position (`smooth`), and no single effect of the library explains it",
        ))
    }
    fn as_smooth_error(&self) -> Option<&SmoothError> {
        Some(self)
    }
    fn stage(&self) -> Stage {
        Stage::Structure
    }
    fn parameters(&self) -> Vec<Parameter> {
        let one = Parameter {
            unit: "1",
            neutral: 0.0,
            prior_sd: self.amplitude,
            step: 0.05 * self.amplitude,
            starts: vec![0.0],
            plausible: f64::INFINITY,
        };
        vec![one; self.n_factors * self.modes.len()]
    }
    fn alter(&self, _frame: &StrainFrame, parameters: &[f64], state: &mut StrainState) {
        let n_c = state.shape[2].max(1);
        for (g, row) in state.influence.chunks_exact_mut(n_c).enumerate() {
            for (c, cell) in row.iter_mut().enumerate() {
                *cell *= 1.0 + self.off_by(g, c, parameters);
            }
        }
    }
    fn extension(&self, _frame: &StrainFrame, _parameters: &[f64]) -> Extension {
        Extension::Nothing
    }
    fn separate_by(&self, _frame: &StrainFrame) -> String {
        "add gauges between the gauges with the largest model error: a smooth error of the model continues there, a fault of single gauges does not"
            .into()
    }
}
