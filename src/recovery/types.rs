//! Inputs and results of a recovery.

use crate::estimate::LoadEstimate;
use crate::estimate::NORMAL_95;
use crate::finding::Finding;
use crate::sensitivity::{GaugeNoise, Sensitivity};

/// Code of a finding on a gauge with a significant error.
pub const GAUGE_SUSPECT: &str = "gauge-suspect";

/// Readings of one static state.
#[derive(Clone, Debug, PartialEq)]
pub struct Readings {
    /// Run name.
    pub run: String,
    /// Strain by gauge, with zero and reference subtracted or added. NaN for a gauge without a reading.
    pub strain: Vec<f64>,
    /// Noise variance of these readings, relative to a single reading: `1/n_run + 1/n_zero` for means of `n` effective samples.
    pub noise_factor: f64,
}

impl Readings {
    /// Returns the readings of these gauges, by number and in this order.
    pub fn of_gauges(&self, gauges: &[usize]) -> Self {
        let reading = |g: &usize| self.strain.get(*g).copied().unwrap_or(f64::NAN);
        Self {
            strain: gauges.iter().map(reading).collect(),
            ..self.clone()
        }
    }

    /// Returns the readings of a sample of a record at `time_s`.
    pub fn of_sample(time_s: f64, strain: Vec<f64>, noise_factor: f64) -> Self {
        Self {
            // Round to the nanosecond, which removes the rounding error of start plus number over rate.
            run: format!("t = {}", (time_s * 1e9).round() / 1e9),
            strain,
            noise_factor,
        }
    }
}

/// The estimate of one run with its residual.
#[derive(Clone, Debug, PartialEq)]
pub struct RunEstimate {
    /// Loads with covariance.
    pub estimate: LoadEstimate,
    /// Predicted strain by gauge.
    pub predicted: Vec<f64>,
    /// Reading minus prediction. NaN for a gauge without a reading.
    pub residual: Vec<f64>,
    /// Standard deviation of each reading from stated noise and model error together. NaN for a gauge without a reading.
    pub sd: Vec<f64>,
    /// Minimum of the sum of squares of residuals relative to their covariance, plus nuisance loads relative to their stated sizes.
    pub chi2: f64,
    /// Degrees of freedom of `chi2`: readings less loads without a stated size.
    pub dof: usize,
    /// Leverage by gauge.
    pub leverage: Vec<f64>,
    /// Rank of the system. If it is below the number of loads, some of the values are arbitrary.
    pub rank: usize,
}

impl RunEstimate {
    /// Returns whether the readings determine load `l`. Otherwise its value is blank or arbitrary.
    pub fn determines_load(&self, l: usize) -> bool {
        let value = self.estimate.values.get(l);
        value.is_some_and(|v| v.is_finite()) && self.estimate.sigma(l).is_finite()
    }
}

/// Estimates of all runs, with the statistics of their residuals.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovery {
    /// Estimates in the order of the readings.
    pub runs: Vec<RunEstimate>,
    /// Root mean square of all residuals, strain, over the degrees of freedom.
    pub residual_rms: f64,
    /// Root mean square residual by gauge, strain.
    pub gauge_residual_rms: Vec<f64>,
    /// Mean leverage by gauge.
    pub gauge_leverage: Vec<f64>,
    /// Findings of the recovery.
    pub findings: Vec<Finding>,
    /// Widening of the intervals by the residuals.
    pub widening: Widening,
    /// Root mean square of each load over the runs that determine it. It is 0 if no run does. The stated model error is weighted at these loads.
    pub typical: Vec<f64>,
    /// Noise from the residuals, by gauge of S, if they contradict equal and independent noise.
    pub noise: Option<GaugeNoise>,
}

impl Recovery {
    /// Returns S with the noise that the residuals show.
    pub fn s(&self, s: &Sensitivity) -> Sensitivity {
        let noise = self.noise.as_ref().or(s.noise.as_ref());
        Sensitivity {
            noise: noise.cloned(),
            ..s.clone()
        }
    }
}

/// Widening of the intervals relative to stated errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Widening {
    /// Factor on every covariance (Birge). It is 1 if the residuals are as small as the stated errors predict.
    pub variance_factor: f64,
    /// Factor on sigma of a 95 % interval: normal, or Student's if the residuals determine the scale.
    pub coverage_factor: f64,
    /// Significant errors of single gauges.
    pub shifts: Vec<Shift>,
}

/// Error of one gauge that shifts the loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Shift {
    /// Gauge of S.
    pub gauge: usize,
    /// Kind of the error.
    pub kind: ShiftKind,
    /// Size of the error: a share of the reading, or strain.
    pub size: f64,
}

/// Kinds of error of a gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShiftKind {
    /// One share of the strain in every run.
    Gain,
    /// One strain in every run.
    Offset,
}

impl Widening {
    /// Returns the intervals of stated errors, without widening.
    pub fn none() -> Self {
        Self {
            variance_factor: 1.0,
            coverage_factor: NORMAL_95,
            shifts: Vec::new(),
        }
    }
}
