//! How loads strain gauges at a frequency.

use super::types::{BAND_END, Dynamics};
use crate::linalg::complex::{ComplexMatrix, least_squares_gain};
use crate::linalg::{Complex, Matrix};
use crate::sensitivity::Sensitivity;
use std::f64::consts::PI;

/// Loads, modes and active gauges, with the gains at a frequency.
pub(super) struct Plant<'a> {
    dynamics: &'a Dynamics,
    /// `n x k`.
    s: ComplexMatrix,
    /// Strain of the modes' shapes, `n x m`.
    pub shapes: ComplexMatrix,
    /// Static displacement of each mode by a unit of each load, `C`, `m x k`.
    moved: ComplexMatrix,
    /// Static strain of unit loads beyond the strain by these modes, `S - Psi C`, `n x k`.
    pub rest: ComplexMatrix,
    /// Variance of the noise over the variance of each load, 0 for loads without a stated size.
    ridge: Vec<f64>,
}

/// Dynamic response of a mode beyond its static response, with its derivatives by the logarithms of frequency and damping.
pub(super) struct Answer {
    /// `a = 1 / x - 1`, `x = 1 - r^2 + 2 i zeta r`.
    pub added: Complex<f64>,
    /// `da / d ln w_j`.
    pub by_frequency: Complex<f64>,
    /// `da / d ln zeta`.
    pub by_damping: Complex<f64>,
}

impl<'a> Plant<'a> {
    /// Returns the plant of the gauges `used` of `s`, whose readings have the noise `noise`, strain.
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

    /// Returns the share of a frequency that the filter passes, 0 to 1.
    pub fn band(&self, hz: f64) -> f64 {
        let from = self.dynamics.up_to_hz;
        let share = ((hz - from) / ((BAND_END - 1.0) * from)).clamp(0.0, 1.0);
        0.5 * (1.0 + (PI * share).cos())
    }

    /// Returns the response at `hz` of a mode of the frequency `own_hz`, both Hz, and of the damping `damping`, share of critical.
    fn answer_of(own_hz: f64, damping: f64, hz: f64) -> Answer {
        let r = hz / own_hz;
        let damped = Complex::new(0.0, 2.0 * damping * r);
        let x = Complex::new(1.0 - r * r, 0.0) + damped;
        Answer {
            added: x.inv() - 1.0,
            by_frequency: (damped - 2.0 * r * r) / (x * x),
            by_damping: -damped / (x * x),
        }
    }

    /// Returns the response of mode `j` at `hz`, Hz.
    pub fn answer(&self, j: usize, hz: f64) -> Answer {
        let mode = &self.dynamics.modes[j];
        Self::answer_of(mode.hz, mode.damping, hz)
    }

    /// Returns the upper limit of the added response of modes outside the model: the response of the first of them; 0 without such modes.
    pub fn omitted_mode_response(&self, hz: f64) -> Complex<f64> {
        let first = self.dynamics.further_hz;
        let damping = self.dynamics.further_damping;
        first.map_or(Complex::default(), |own| {
            Self::answer_of(own, damping, hz).added
        })
    }

    /// Returns the strain that the modes add to the static strain of unit loads, `Psi a C`, `n x k`.
    pub fn added_strain(&self, hz: f64) -> ComplexMatrix {
        let mut by_load = self.moved.clone();
        for (j, mut row) in by_load.row_iter_mut().enumerate() {
            let added = self.answer(j, hz).added;
            row.iter_mut().for_each(|v| *v *= added);
        }
        &self.shapes * by_load
    }

    /// Returns the gain at a frequency where the modes add `added`, `k x n`; `None` if the gauges can't separate the loads at that frequency.
    pub fn gain(&self, added: &ComplexMatrix) -> Option<ComplexMatrix> {
        least_squares_gain(&(&self.s + added), &self.ridge)
    }

    /// Returns the static displacement of mode `j` by a unit of each load.
    pub fn modal_displacement(&self, j: usize) -> Vec<f64> {
        self.moved.row(j).iter().map(|v| v.re).collect()
    }

    /// Returns the static gain, `k x n`.
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
