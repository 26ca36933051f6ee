//! `[placement]`.

use crate::gauge::Bridge;
use crate::placement::Loss;

/// Gauges of the job that stay.
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
    /// Number of gauges; `None` is twice the number of loads, which the command reports.
    pub gauges: Option<usize>,
    /// Criterion; default `Ds` with nuisance loads, else `D`.
    pub criterion: Optimality,
    /// Whether to try a proof that no layout is better. No key of a job: `init` tries its proposals without.
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
    /// Noise of a wiring's reading, microstrain, where it is not `noise_microstrain`.
    pub noise_by_bridge: Vec<(Bridge, f64)>,
    /// Whether the layout is optimal after the worst loss of a gauge.
    pub loss: Loss,
    /// Gauges of the job that stay; `gauges` counts those to be added.
    pub keep: Keep,
    /// Pairs that mirror each other at the plane through 0 normal to this axis (0 to 2).
    pub symmetric: Option<usize>,
    /// Cost of a wiring's name (`quarter`, .., `rosette`) in channels; default 1, a rosette 3.
    pub costs: Vec<(String, f64)>,
    /// Largest cost of a layout; default: `gauges`.
    pub budget: Option<f64>,
    /// Numbers of gauges for the curve; empty: no curve.
    pub curve: Vec<usize>,
    /// Gauges reserved for validation.
    pub reserve: usize,
    /// Named reference points of the gluing sheet: grids.
    pub references: Vec<(String, u32)>,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}
