//! What goes in and what comes out.

use crate::estimate::LoadEstimate;
use crate::estimate::NORMAL_95;
use crate::finding::Finding;
use crate::sensitivity::{GaugeNoise, Sensitivity};

/// Code of a finding on a gauge whose error stands out.
pub const GAUGE_SUSPECT: &str = "gauge-suspect";

/// Readings of one static state.
#[derive(Clone, Debug, PartialEq)]
pub struct Readings {
    /// Run name.
    pub run: String,
    /// Strain by gauge, zero and reference taken into account; NaN where a gauge gave nothing.
    pub strain: Vec<f64>,
    /// Noise variance of these readings in units of that of a single one: `1/n_run + 1/n_zero` for means of `n` effective samples.
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

    /// Those of a sample of a record at `time_s`.
    pub fn of_sample(time_s: f64, strain: Vec<f64>, noise_factor: f64) -> Self {
        Self {
            // To the nanosecond: what start plus number over rate leaves behind it is no time.
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
    /// Reading less prediction; NaN where a gauge gave nothing.
    pub residual: Vec<f64>,
    /// 1 sd of each reading, stated noise and model error together; NaN where a gauge gave nothing.
    pub sd: Vec<f64>,
    /// Least sum of squares of residuals (and of nuisance loads over their stated sizes) over their own covariance.
    pub chi2: f64,
    /// Its degrees of freedom: readings less loads without a stated size.
    pub dof: usize,
    /// Leverage by gauge.
    pub leverage: Vec<f64>,
    /// Rank of the system; under the number of loads, some of the values are arbitrary.
    pub rank: usize,
}

impl RunEstimate {
    /// Whether the readings tell load `l`; its value is blank or arbitrary where they don't.
    pub fn tells(&self, l: usize) -> bool {
        let value = self.estimate.values.get(l);
        value.is_some_and(|v| v.is_finite()) && self.estimate.sigma(l).is_finite()
    }
}

/// All runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovery {
    /// In the order given.
    pub runs: Vec<RunEstimate>,
    /// Root mean square of all residuals, strain, over the degrees of freedom.
    pub residual_rms: f64,
    /// Root mean square residual by gauge, strain.
    pub gauge_residual_rms: Vec<f64>,
    /// Mean leverage by gauge.
    pub gauge_leverage: Vec<f64>,
    /// What was noticed.
    pub findings: Vec<Finding>,
    /// What the residuals do to the intervals.
    pub widening: Widening,
    /// Root mean square of each load over the runs that tell it, 0 where none does: the weights of a stated model error are those at these
    /// loads.
    pub typical: Vec<f64>,
    /// Noise that the residuals show where they contradict equal and independent noise, by gauge of S.
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

/// How much wider than stated errors make them the intervals are.
#[derive(Clone, Debug, PartialEq)]
pub struct Widening {
    /// Factor on every covariance (Birge); 1 where the residuals are as small as stated.
    pub variance_factor: f64,
    /// Factor on sigma of a 95 % interval: normal, or Student's where the scale was judged from residuals.
    pub coverage_factor: f64,
    /// Errors of single gauges that stand out.
    pub shifts: Vec<Shift>,
}

/// What the error of one gauge does to the loads.
#[derive(Clone, Debug, PartialEq)]
pub struct Shift {
    /// Gauge of S.
    pub gauge: usize,
    /// What its error is like.
    pub kind: ShiftKind,
    /// Its size: a share of the reading, or strain.
    pub size: f64,
}

/// Kinds of error of a gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShiftKind {
    /// The same share of the strain in every run.
    Gain,
    /// The same strain in every run.
    Offset,
}

impl Widening {
    /// Intervals as stated errors make them.
    pub fn none() -> Self {
        Self {
            variance_factor: 1.0,
            coverage_factor: NORMAL_95,
            shifts: Vec::new(),
        }
    }
}
