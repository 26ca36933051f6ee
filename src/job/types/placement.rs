//! `[placement]`.

use crate::gauge::Bridge;
use crate::placement::Loss;

/// Gauges of the job that remain in the layout.
#[derive(Clone, Debug, PartialEq)]
pub enum Keep {
    /// No gauge: the layout is new.
    None,
    /// All gauges.
    All,
    /// The named gauges.
    Named(Vec<String>),
}

/// Optimality criterion of a placement, as a job states it. [`crate::placement::Criterion`] also contains the columns and weights, and one of its
/// forms serves several of these criteria.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimality {
    /// Determinant for all loads.
    D,
    /// Determinant for the wanted loads, nuisance loads estimated along.
    Ds,
    /// Least sum of the wanted loads' weighted variances, each in shares of its expected size.
    A,
    /// Least mean variance of the strain predicted at the candidates.
    I,
    /// Determinant for all loads, each known beforehand to its expected size.
    BayesianD,
    /// Least condition number of S with columns in the loads' expected sizes.
    Condition,
}

impl Optimality {
    /// Returns the name in a job.
    pub fn name(self) -> &'static str {
        match self {
            Self::D => "D",
            Self::Ds => "Ds",
            Self::A => "A",
            Self::I => "I",
            Self::BayesianD => "Bayesian-D",
            Self::Condition => "condition",
        }
    }
}

/// `[placement]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Placement {
    /// Number of gauges. `None` means twice the number of loads. The command reports this default.
    pub gauges: Option<usize>,
    /// Criterion; default `Ds` with nuisance loads, else `D`.
    pub criterion: Optimality,
    /// Whether `place` tries to prove that no layout is better. The job has no such key: `init` tries its proposals without a proof.
    pub proof: bool,
    /// Smallest distance between gauges; default 0.
    pub spacing: f64,
    /// Noise, microstrain; default: the noise of `[measured]`, else 1.
    pub noise_microstrain: f64,
    /// Gluing tolerance, degrees, 1 sd; default 0.
    pub angle_tolerance_deg: f64,
    /// Model uncertainty, of the predicted strain; default: the model uncertainty of `[measured]`, else 0.
    pub model_uncertainty_rel: f64,
    /// Seed of everything random.
    pub seed: u64,
    /// Misplacement along each direction, 1 sd, job units; default 0.
    pub position_tolerance: f64,
    /// Tolerance of the gauge factor, 1 sd, a fraction; default 0.
    pub gauge_factor_rel: f64,
    /// Noise of a reading of each wiring, microstrain, for wirings that differ from `noise_microstrain`.
    pub noise_by_bridge: Vec<(Bridge, f64)>,
    /// Whether the layout is optimal after the worst loss of a gauge.
    pub loss: Loss,
    /// Gauges of the job that stay installed. `gauges` counts the added gauges.
    pub keep: Keep,
    /// Axis (0 to 2) of the mirror plane through 0. Gauges are placed in pairs that mirror each other at this plane.
    pub symmetric: Option<usize>,
    /// Cost of each wiring by name (`quarter`, .., `rosette`), in channels. The default is 1, and 3 for a rosette.
    pub costs: Vec<(String, f64)>,
    /// Largest cost of a layout; default: `gauges`.
    pub budget: Option<f64>,
    /// Gauge counts for the curve. An empty list means no curve.
    pub curve: Vec<usize>,
    /// Gauges reserved for validation.
    pub reserve: usize,
    /// Named reference points of the gluing sheet: grids.
    pub references: Vec<(String, u32)>,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}
