//! Answer of `calibrate`.

use crate::calibrate::Calibration;
use crate::fe::strain_tensor::Surface;
use crate::gauge::{Gauge, GaugeSpec};
use crate::host::outcome::Answer;
use crate::host::words::count_of;
use crate::job::Job;
use crate::linalg::Matrix;
use crate::model::Vec3;
use crate::sensitivity::Sensitivity;
use serde::Serialize;
use std::collections::BTreeMap;

/// A calibrated S.
#[derive(Serialize)]
pub struct CalibratedSensitivity {
    /// Summary of the calibration.
    pub calibration: CalibrationSummary,
    /// S with its covariance.
    #[serde(skip)]
    pub sensitivity: Sensitivity,
    /// S of the model, if there is one.
    #[serde(skip)]
    pub model: Option<Matrix>,
    /// Gauges at their installed positions, `None` for gauges on bars; empty if `[calibration]` states no tolerance.
    #[serde(skip)]
    pub glued: Vec<Option<InstalledGauge>>,
    /// Complete result of the calibration.
    #[serde(skip)]
    pub found: Calibration,
    /// The job's text.
    #[serde(skip)]
    pub job_text: String,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for CalibratedSensitivity {
    const COMMAND: &'static str = "calibrate";
    const RESULT: &'static str = "The calibrated sensitivities";

    fn verdict(&self) -> String {
        let c = &self.calibration;
        let prior = match c.prior {
            "model" => "and the model",
            _ => "without a model",
        };
        format!(
            "Sensitivities of {} to {} from {} {prior}. In the leave-one-out test the 95 % intervals contain {} of {} runs.",
            count_of(self.sensitivity.gauges.len(), "gauge"),
            count_of(self.sensitivity.loads.len(), "load"),
            count_of(c.runs, "run"),
            c.coverage.held,
            c.coverage.of
        )
    }
}

/// `calibration` of `result.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CalibrationSummary {
    /// Number of calibration runs.
    pub runs: usize,
    /// `model` or `none`.
    pub prior: &'static str,
    /// Result for each gauge.
    pub gauges: Vec<CalibratedGauge>,
    /// Scatter between repeats over the strain; null if noise explains all scatter.
    pub repeat_scatter_rel: Option<f64>,
    /// Noise over the strain.
    pub noise_rel: f64,
    /// Smallest and largest known load of the calibration runs by load, report units.
    pub range: BTreeMap<String, [f64; 2]>,
    /// Smallest and largest reading of the calibration runs by gauge, microstrain.
    pub strain_range: BTreeMap<String, [f64; 2]>,
    /// Runs left out one by one.
    pub coverage: CoverageSummary,
    /// Terms of the model of the strain: `linear`, `intercept`.
    pub terms: &'static str,
    /// Tests of the linear model against further terms; empty if there are too few runs.
    pub lack_of_fit: Vec<LackOfFitSummary>,
    /// Errors of left-out runs by least squares with either set of terms; null if there are too few runs.
    pub held_out_error: Option<HeldOutSummary>,
    /// Residual of the runs by load.
    pub residuals: Vec<LoadResidual>,
    /// Check runs: loads applied and recovered, which S was not calibrated with.
    pub checks: Vec<CheckLoad>,
    /// Next known load that would improve the result most.
    pub next_run: Option<NextRunSummary>,
    /// Relative error of the model, as estimated from the runs.
    pub model_error: Option<ModelErrorSummary>,
    /// Left-out runs with their loads predicted from the other runs.
    pub left_out: Vec<LeftOutSummary>,
    /// Runs that were not used because they contradict the other runs.
    pub refused: Vec<String>,
    /// Combinations of loads that no run determines.
    pub undetermined: Vec<BTreeMap<String, f64>>,
    /// Whether the scale depends on a column.
    pub dependence: Option<DependenceSummary>,
}

/// Result for one gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct CalibratedGauge {
    pub name: String,
    /// Distance from the model in prior sigmas.
    pub shift: f64,
    /// Size of the calibrated row along the model's row.
    pub scale: f64,
    /// `none`, `gain`, `angle`, `place`, `sign`, `dead`, `exchanged`, `undetermined`.
    pub looks_like: &'static str,
    /// Installed position and gain from the runs; null if `[calibration]` states no tolerance.
    pub as_glued: Option<InstalledPositionSummary>,
}

/// Offset of a gauge from its nominal position along and across its axis (job units), and its rotation (degrees, right-handed about the element's
/// normal). A value is null if no tolerance is stated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct InstalledPositionSummary {
    pub along: Option<GlueSummary>,
    pub across: Option<GlueSummary>,
    pub angle_deg: Option<GlueSummary>,
    /// Factor on the readings of the gauge.
    pub gain: GlueSummary,
}

/// Offset, rotation or gain with its uncertainty.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GlueSummary {
    /// Posterior mean.
    pub value: f64,
    /// 1 sd.
    pub sigma: f64,
    /// Whether the runs determine the value: they remove at least half of the stated variance.
    pub told: bool,
}

/// Gauge on the model at its installed position, as determined from the runs.
#[derive(Clone, Debug)]
pub struct InstalledGauge {
    /// Gauge at its installed position.
    pub gauge: Gauge,
    /// Position on the reference surface, basic frame.
    pub at: Vec3,
    /// Whether strain is read at `at`. Otherwise it is read in the middle of the element.
    pub by_position: bool,
    /// Specification of the gauge, at its nominal position.
    pub spec: GaugeSpec,
    /// Wiring, as a job writes it.
    pub bridge: &'static str,
    /// Element and side of the second pair of a bridge.
    pub pair: Option<(u32, Surface)>,
    /// Factor on the readings.
    pub gain: f64,
}

/// Tally of left-out runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct CoverageSummary {
    pub held: usize,
    pub of: usize,
    pub factor: f64,
}

/// A load that would improve the result.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextRunSummary {
    /// Loads, report units.
    pub loads: BTreeMap<String, f64>,
    /// Half the log of the ratio of determinants of the covariance of S.
    pub information: f64,
    /// Load that gains most, with its standard deviation before and after the run, report units.
    pub load: String,
    /// Standard deviation before the run.
    pub sigma_before: f64,
    /// Standard deviation after the run.
    pub sigma_after: f64,
    /// Unit of both.
    pub unit: String,
}

/// Relative error of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelErrorSummary {
    /// Error that is common to a gauge.
    pub common_rel: f64,
    /// Separate error of each entry.
    pub entry_rel: f64,
}

/// A left-out run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOutSummary {
    /// Name of the run.
    pub run: String,
    /// Distance from the known loads, root mean square over the loads, in standard deviations.
    pub distance: f64,
    /// Result for each load, then for each combination.
    pub loads: Vec<LeftOutLoad>,
}

/// A load of a left-out run, or a combination, report units.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct LeftOutLoad {
    pub name: String,
    /// Known load of the runs table; `None` if the table does not contain it.
    pub known: Option<f64>,
    pub value: f64,
    pub sigma: f64,
    pub unit: String,
    /// Ends of the 95 % interval.
    pub low: f64,
    pub high: f64,
}

/// Change of the scale with a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DependenceSummary {
    /// The column.
    pub column: String,
    /// Relative change of the loads' sum per unit of the column.
    pub slope_rel: f64,
    /// Standard deviation of the slope.
    pub sigma: f64,
    /// Probability of a slope of this size if the scale does not depend on the column.
    pub chance: f64,
    /// Degrees of freedom behind `sigma`.
    pub dof: f64,
}

/// Test of the linear model against one kind of term.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LackOfFitSummary {
    /// `common zero`, `squares`, `products`.
    pub test: &'static str,
    /// Probability of a term of at least this significance if the strain has no such term, over all gauges and terms of the kind.
    pub p: f64,
}

/// Root mean square error of left-out runs, percent of the largest load.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeldOutSummary {
    /// Error without a common zero.
    pub linear_percent: f64,
    /// Error with a common zero.
    pub intercept_percent: f64,
    /// `linear`, or `intercept` if the error with an intercept is clearly smaller.
    pub recommended: &'static str,
}

/// Recovered minus known load over the calibration runs, percent of full scale, which is the largest known load.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadResidual {
    /// Load.
    pub load: String,
    /// Largest known load.
    pub full_scale: f64,
    /// Unit of the load.
    pub unit: String,
    /// Root mean square over the runs that S was calibrated with.
    pub rms_percent: f64,
    /// Largest residual.
    pub max_percent: f64,
    /// Root mean square over left-out runs. Null if no run was left out.
    pub left_out_rms_percent: Option<f64>,
    /// Largest value over left-out runs.
    pub left_out_max_percent: Option<f64>,
    /// Run with this residual.
    pub left_out_max_run: Option<String>,
}

/// A load, or a combination, of a check run, report units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckLoad {
    /// Run.
    pub run: String,
    /// Load or combination.
    pub load: String,
    /// Applied load, from the runs table.
    pub applied: f64,
    /// Load recovered with the calibrated S.
    pub recovered: f64,
    /// Lower end of the 95 % interval of the difference, around `recovered`. It includes the error of the applied load.
    pub low: f64,
    /// Upper end of this interval.
    pub high: f64,
    /// Unit.
    pub unit: String,
    /// Whether the interval contains the applied load.
    pub inside: bool,
}
