//! Input and result of a calibration.

use crate::estimate::LoadEstimate;
use crate::finding::Finding;
use crate::linalg::Matrix;
use crate::sensitivity::{GaugeNoise, Load, Sensitivity};

/// Known loads of one run as a Gaussian distribution, job units.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownLoads {
    /// Mean by load.
    pub mean: Vec<f64>,
    /// Covariance, `k x k` by rows; zero if a load is known exactly.
    pub covariance: Vec<f64>,
}

impl KnownLoads {
    /// Returns the loads known exactly.
    pub fn from_exact(mean: Vec<f64>) -> Self {
        let k = mean.len();
        Self {
            mean,
            covariance: vec![0.0; k * k],
        }
    }
}

/// Run with known loads.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownRun {
    /// Name.
    pub run: String,
    /// Strain by gauge, zero subtracted; NaN if a gauge has no reading.
    pub strain: Vec<f64>,
    /// Noise variance of these readings in units of the variance of a single reading.
    pub noise_factor: f64,
    /// Known loads.
    pub loads: KnownLoads,
    /// Group of the run: runs with one number are repeats of each other.
    pub group: usize,
}

/// S of the model, with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct ModelPrior {
    /// `n x k`, strain per job unit.
    pub values: Matrix,
    /// Ways in which gauges may differ from their nominal positions; empty if no tolerance is stated.
    pub moves: Vec<Move>,
    /// Change of rows for gauges that are not at their nominal position; `None` if it is not known, as for a table.
    pub off_drawing: Option<OffDrawing>,
    /// Stated relative error, 1 sd: entry by entry, and common to a gauge.
    pub uncertainty_rel: f64,
}

/// Changes of rows of gauges that are not at their nominal position, `n x k` each, strain per job unit. They distinguish a rotated or displaced gauge
/// from a wrong gain. A gauge without known changes has zeros. The changes identify the cause of a shift. [`Move`] states how far a gauge may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct OffDrawing {
    /// Change per radian of rotation, right-handed about the element's normal.
    pub turned: Matrix,
    /// Change of a gauge that is installed at a right angle to the nominal direction.
    pub crossed: Matrix,
    /// Change per length along the axis of the gauge. Zeros if strain is known at only one place of an element.
    pub along: Matrix,
    /// Change per length across the axis of the gauge.
    pub across: Matrix,
    /// Length over which rows change linearly. It is about the size of an element.
    pub reach: f64,
}

/// Kind of offset of a gauge from its nominal position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// Along its axis.
    Along,
    /// Across the axis of the gauge.
    Across,
    /// Turned, right-handed about the element's normal, radians.
    Turned,
}

/// The change that a move makes: `row(move) = values - change at + change move`, where `values` and `change` belong to the move `at`.
#[derive(Clone, Debug, PartialEq)]
pub struct Move {
    /// Kind of move.
    pub kind: MoveKind,
    /// Change of the rows, `n x k`, strain per job unit and unit of the move.
    pub change: Matrix,
    /// Stated standard deviation of the move.
    pub sd: f64,
    /// Size of the move of each gauge at which `values` and `change` apply.
    pub at: Vec<f64>,
}

/// Strain without load in a task.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CommonZero {
    /// None: `eps = S f`.
    #[default]
    None,
    /// To be found: `eps = S f + z`.
    Sought,
    /// The last column of the task, for a load that is 1 in every run. A calibration uses this form inside.
    Column,
}

/// Input of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Task {
    /// Row names.
    pub gauges: Vec<String>,
    /// Columns.
    pub loads: Vec<Load>,
    /// Noise of a reading, strain, 1 sd.
    pub noise: f64,
    /// Noise of the gauges in units of `noise`; `None` if each gauge has this noise, independent of other gauges.
    pub gauge_noise: Option<GaugeNoise>,
    /// The model, if the job has one.
    pub model: Option<ModelPrior>,
    /// Runs of known load.
    pub runs: Vec<KnownRun>,
    /// Sums of loads whose intervals are also tested when runs are left out: coefficients by load.
    pub sums: Vec<Vec<f64>>,
    /// Strain of the gauges without load, equal in all runs.
    pub common_zero: CommonZero,
    /// Relative error, 1 sd, that the known loads of all runs share.
    pub scale_sd: f64,
}

impl Task {
    /// Returns the covariance of the noise of gauges `g` and `h` in units of the square of [`Self::noise`].
    pub(super) fn noise_between(&self, g: usize, h: usize) -> f64 {
        match &self.gauge_noise {
            Some(noise) => noise.covariance_between(g, h),
            None => f64::from(u8::from(g == h)),
        }
    }
}

/// Smallest and largest value of the calibration runs by column; not a number if no run has one.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibratedRange {
    /// Known load, job units.
    pub loads: Vec<[f64; 2]>,
    /// Reading by gauge, strain.
    pub strain: Vec<[f64; 2]>,
}

/// Test of the linear model against further terms.
#[derive(Clone, Debug, PartialEq)]
pub struct LackOfFit {
    /// Test of each kind of term. Empty if there are too few runs.
    pub tests: Vec<TermTest>,
    /// Root mean square error of left-out runs over the largest load, over all loads, by least squares. There is one value for a straight line
    /// through zero, and one value for a line with a common zero. `None` if runs are too few.
    pub held_out: Option<HeldOutError>,
}

/// Kind of term that is tested.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// Strain without load.
    CommonZero,
    /// Squares of loads.
    Squares,
    /// Products of two loads.
    Products,
}

impl Term {
    /// Returns the name in `result.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::CommonZero => "common zero",
            Self::Squares => "squares",
            Self::Products => "products",
        }
    }
}

/// Test of one kind of term.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermTest {
    /// Kind of term.
    pub term: Term,
    /// Probability of a term of at least this significance if the strain contains no such term. It covers all gauges and all terms of the kind.
    pub p: f64,
}

/// See [`LackOfFit::held_out`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOutError {
    /// `eps = S f`.
    pub linear: f64,
    /// `eps = S f + z`.
    pub intercept: f64,
}

/// Number of left-out runs within their 95 % regions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coverage {
    /// Number of left-out runs whose known loads are within their 95 % region.
    pub held: usize,
    /// Number of left-out runs.
    pub of: usize,
    /// Applied factor on sigma.
    pub factor: f64,
}

/// Error of the model as determined from the runs: 1 sd, relative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelError {
    /// Error that is common to a gauge.
    pub common: f64,
    /// Separate error of each entry.
    pub entry: f64,
}

/// Calibrated S with all results of the calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// Posterior mean, with covariance and scatter.
    pub sensitivity: Sensitivity,
    /// Relative error of the model as used: the stated error, corrected by the runs; `None` without a model.
    pub model_error: Option<ModelError>,
    /// Strain without load, by gauge; empty for a model through zero. S and its intervals apply to readings less this strain.
    pub common_zero: Vec<f64>,
    /// Tests of further terms.
    pub lack_of_fit: LackOfFit,
    /// Shift of each gauge from the model.
    pub shifts: Vec<GaugeShift>,
    /// Installed position and gain by gauge; empty if no tolerance is stated.
    pub as_glued: Vec<InstalledPositionEstimate>,
    /// Scatter between repeats of one loading, divided by the strain: root mean square over gauges. `None` without repeats.
    pub repeat_scatter_rel: Option<f64>,
    /// Noise over the strain, both root mean squares.
    pub noise_rel: f64,
    /// Runs left out one by one.
    pub left_out: Vec<LeftOut>,
    /// Tally of the left-out runs.
    pub coverage: Coverage,
    /// Runs that clearly contradict the other runs and were not used, by number.
    pub refused: Vec<usize>,
    /// Range of the loads and readings of the runs that were used.
    pub range: CalibratedRange,
    /// Combinations of loads that no run determines.
    pub undetermined: Vec<UndeterminedCombination>,
    /// Findings on runs, gauges and model.
    pub findings: Vec<Finding>,
}

/// A run that was left out.
#[derive(Clone, Debug, PartialEq)]
pub struct LeftOut {
    /// Number of the run.
    pub number: usize,
    /// Loads recovered with the calibration from the other runs, with covariance.
    pub estimate: LoadEstimate,
    /// Known loads of the run.
    pub known: Vec<f64>,
    /// Squared distance between `estimate` and `known` in units of the sum of their covariances.
    pub distance: f64,
    /// Number of independent combinations of loads that are known and compared.
    pub loads: usize,
    /// Degrees of freedom behind the covariance.
    pub dof: f64,
    /// Mean squared distance of the individually known loads, each in units of its variance.
    pub each: f64,
    /// Number of individually known loads.
    pub alone: usize,
    /// Squared distance of each sum of loads of the task, in units of its variance.
    pub sums: Vec<f64>,
    /// Residual strain relative to the expected residual: chi2 divided by its degrees of freedom.
    pub misfit: f64,
}

/// Cause of a change of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShiftWord {
    /// No change beyond the model's error.
    None,
    /// Dead gauge: no signal.
    Dead,
    /// Reversed polarity.
    Sign,
    /// Wrong gain: the readings of all loads have one factor.
    Gain,
    /// Gauge turned by an angle.
    Angle,
    /// Gauge at another place.
    Place,
    /// Undetermined: not clearly a gain, an angle or a place.
    Undetermined,
    /// Exchanged with another gauge: the rows of the two gauges match each other's row of the model.
    Exchanged {
        /// Number of the other gauge.
        with: usize,
    },
}

impl ShiftWord {
    /// Returns the name in `result.json`.
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Dead => "dead",
            Self::Sign => "sign",
            Self::Gain => "gain",
            Self::Angle => "angle",
            Self::Place => "place",
            Self::Undetermined => "undetermined",
            Self::Exchanged { .. } => "exchanged",
        }
    }
}

/// Shift of one gauge from the model.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeShift {
    /// Name.
    pub name: String,
    /// Distance between model and calibrated row in prior sigmas, root mean square over loads; 0 without a model. The prior has the model error that
    /// the gauges without a reported cause show, without this gauge.
    pub shift: f64,
    /// Size of the calibrated row along the model's row: 1 if the size of the model's row is right, or without a model.
    pub scale: f64,
    /// Cause of the change.
    pub word: ShiftWord,
}

/// Gain or offset of a gauge, as determined from the runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glue {
    /// Posterior mean.
    pub value: f64,
    /// 1 sd.
    pub sigma: f64,
    /// 1 sd before any run.
    pub stated: f64,
}

/// Share of the stated sd from which on a value is undetermined.
const DETERMINED_SD_REL: f64 = 0.7;

impl Glue {
    /// Returns whether the runs determine the value: they remove at least half of the stated variance.
    pub fn is_determined(&self) -> bool {
        self.sigma < DETERMINED_SD_REL * self.stated
    }
}

/// Gain and installed position of a gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct InstalledPositionEstimate {
    /// Factor on the gauge's readings.
    pub gain: Glue,
    /// Offset from the nominal position, for each move of the task.
    pub moves: Vec<(MoveKind, Glue)>,
}

impl InstalledPositionEstimate {
    /// Returns the size of a move from the runs; `None` if the task has no such move.
    pub fn find_move(&self, kind: MoveKind) -> Option<Glue> {
        self.moves.iter().find(|m| m.0 == kind).map(|m| m.1)
    }
}

/// A combination that no run determines.
#[derive(Clone, Debug, PartialEq)]
pub struct UndeterminedCombination {
    /// Share of each load, in job units, the largest 1.
    pub terms: Vec<f64>,
}
