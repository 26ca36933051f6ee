//! How loads strain gauges at a frequency.

use super::types::{BAND_END, Dynamics};
use crate::linalg::complex::{ComplexMatrix, least_squares_gain};
use crate::linalg::{Complex, Matrix};
use crate::sensitivity::Sensitivity;
use std::f64::consts::PI;

/// Loads, modes and the gauges that read.
pub(super) struct Plant<'a> {
    dynamics: &'a Dynamics,
    /// `n x k`.
    s: ComplexMatrix,
    /// Strain of the modes' shapes, `n x m`.
    pub shapes: ComplexMatrix,
    /// What a unit load moves each mode by at rest, `C`, `m x k`.
    moved: ComplexMatrix,
    /// Strain of unit loads at rest that these modes don't hold, `S - Psi C`, `n x k`.
    pub rest: ComplexMatrix,
    /// Variance of the noise over that of each load, 0 for loads without a stated size.
    ridge: Vec<f64>,
}

/// What a mode adds to its answer at rest, and how that changes with the logarithms of frequency and damping.
pub(super) struct Answer {
    /// `a = 1 / x - 1`, `x = 1 - r^2 + 2 i zeta r`.
    pub added: Complex<f64>,
    /// `da / d ln w_j`.
    pub by_frequency: Complex<f64>,
    /// `da / d ln zeta`.
    pub by_damping: Complex<f64>,
}

impl<'a> Plant<'a> {
    /// Of the gauges `used` of `s`, whose readings have the noise `noise`, strain.
    pub fn new(s: &Sensitivity, used: &[usize], dynamics: &'a Dynamics, noise: f64) -> Self {
        let (n, k, modes) = (used.len(), s.loads.len(), &dynamics.modes);
        let real = |v: f64| Complex::new(v, 0.0);
        let omega2 = |j: usize| (2.0 * PI * modes[j].hz).powi(2);
        let ridge = |prior: Option<f64>| prior.map_or(0.0, |p| (noise / p).powi(2));
        let at_rest = ComplexMatrix::from_fn(n, k, |g, l| real(s.values[(used[g], l)]));
        let shapes = ComplexMatrix::from_fn(n, modes.len(), |g, j| real(modes[j].strain[used[g]]));
        let moved =
            ComplexMatrix::from_fn(modes.len(), k, |j, l| real(modes[j].work[l] / omega2(j)));
        Self {
            dynamics,
            rest: &at_rest - &shapes * &moved,
            s: at_rest,
            shapes,
            moved,
            ridge: s.priors().into_iter().map(ridge).collect(),
        }
    }

    /// How much of a frequency is let through, 0 to 1.
    pub fn band(&self, hz: f64) -> f64 {
        let from = self.dynamics.up_to_hz;
        let share = ((hz - from) / ((BAND_END - 1.0) * from)).clamp(0.0, 1.0);
        0.5 * (1.0 + (PI * share).cos())
    }

    /// What a mode of the frequency `own_hz` answers at a frequency.
    fn answer_of(&self, own_hz: f64, hz: f64) -> Answer {
        let r = hz / own_hz;
        let damped = Complex::new(0.0, 2.0 * self.dynamics.damping * r);
        let x = Complex::new(1.0 - r * r, 0.0) + damped;
        Answer {
            added: x.inv() - 1.0,
            by_frequency: (damped - 2.0 * r * r) / (x * x),
            by_damping: -damped / (x * x),
        }
    }

    /// What mode `j` answers at a frequency.
    pub fn answer(&self, j: usize, hz: f64) -> Answer {
        self.answer_of(self.dynamics.modes[j].hz, hz)
    }

    /// What the modes that are not told answer at most beyond their answer at rest: as the first of them; 0 where there are none.
    pub fn further(&self, hz: f64) -> Complex<f64> {
        let first = self.dynamics.further_hz;
        first.map_or(Complex::default(), |own| self.answer_of(own, hz).added)
    }

    /// What the modes add to the strain of unit loads at rest, `Psi a C`, `n x k`.
    pub fn added(&self, hz: f64) -> ComplexMatrix {
        let mut by_load = self.moved.clone();
        for (j, mut row) in by_load.row_iter_mut().enumerate() {
            let added = self.answer(j, hz).added;
            row.iter_mut().for_each(|v| *v *= added);
        }
        &self.shapes * by_load
    }

    /// The gain at a frequency where the modes add `added`, `k x n`; `None` where the gauges can't tell the loads apart there.
    pub fn gain(&self, added: &ComplexMatrix) -> Option<ComplexMatrix> {
        least_squares_gain(&(&self.s + added), &self.ridge)
    }

    /// What a unit of each load moves mode `j` by at rest.
    pub fn moved(&self, j: usize) -> Vec<f64> {
        self.moved.row(j).iter().map(|v| v.re).collect()
    }

    /// The static gain, `k x n`.
    pub fn gain_at_rest(&self) -> Option<Matrix> {
        let gain = least_squares_gain(&self.s, &self.ridge)?;
        Some(gain.map(|v| v.re))
    }

    pub fn n_gauges(&self) -> usize {
        self.s.nrows()
    }

    pub fn n_loads(&self) -> usize {
        self.s.ncols()
    }

    pub fn n_modes(&self) -> usize {
        self.shapes.ncols()
    }

    pub fn dynamics(&self) -> &Dynamics {
        self.dynamics
    }
}
