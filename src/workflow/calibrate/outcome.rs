//! What `calibrate` answers.

use crate::calibrate::Calibration;
use crate::fe::strain_tensor::Surface;
use crate::gauge::{Gauge, GaugeSpec};
use crate::host::outcome::{Answer, counted};
use crate::job::Job;
use crate::linalg::Matrix;
use crate::model::Vec3;
use crate::sensitivity::Sensitivity;
use serde::Serialize;
use std::collections::BTreeMap;

/// A calibrated S.
#[derive(Serialize)]
pub struct Calibrated {
    /// What the runs taught.
    pub calibration: CalibrationSummary,
    /// S with its covariance.
    #[serde(skip)]
    pub sensitivity: Sensitivity,
    /// The model's S, where there is one.
    #[serde(skip)]
    pub model: Option<Matrix>,
    /// Gauges where they sit, `None` for those on bars; empty where `[calibration]` states no tolerance.
    #[serde(skip)]
    pub glued: Vec<Option<GluedGauge>>,
    /// All of it.
    #[serde(skip)]
    pub found: Calibration,
    /// The job's text.
    #[serde(skip)]
    pub job_text: String,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for Calibrated {
    const COMMAND: &'static str = "calibrate";
    const RESULT: &'static str = "The calibrated sensitivities";

    fn verdict(&self) -> String {
        let c = &self.calibration;
        let prior = match c.prior {
            "model" => "and the model",
            _ => "without a model",
        };
        format!(
            "Sensitivities of {} to {} from {} {prior}; the 95 % intervals contain {} of {} runs left out one by one.",
            counted(self.sensitivity.gauges.len(), "gauge"),
            counted(self.sensitivity.loads.len(), "load"),
            counted(c.runs, "run"),
            c.coverage.held,
            c.coverage.of
        )
    }
}

/// `calibration` of `result.json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CalibrationSummary {
    /// Runs that taught.
    pub runs: usize,
    /// `model` or `none`.
    pub prior: &'static str,
    /// By gauge.
    pub gauges: Vec<CalibratedGauge>,
    /// Scatter between repeats over the strain; null where noise explains everything.
    pub repeat_scatter_rel: Option<f64>,
    /// Noise over the strain.
    pub noise_rel: f64,
    /// Runs left out one by one.
    pub coverage: CoverageSummary,
    /// The next known load worth applying.
    pub next_run: Option<NextRunSummary>,
    /// Relative error of the model as the runs show it.
    pub model_error: Option<ModelErrorSummary>,
    /// Left-out runs: what the others say of their loads.
    pub left_out: Vec<LeftOutSummary>,
    /// Runs that were not used because they contradict the others.
    pub refused: Vec<String>,
    /// Combinations of loads that no run determines.
    pub undetermined: Vec<BTreeMap<String, f64>>,
    /// Whether the scale depends on a column.
    pub dependence: Option<DependenceSummary>,
}

/// One gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct CalibratedGauge {
    pub name: String,
    /// Distance from the model in prior sigmas.
    pub shift: f64,
    /// Calibrated row along the model's.
    pub scale: f64,
    /// `none`, `gain`, `angle`, `place`, `sign`, `dead`, `exchanged`, `undetermined`.
    pub looks_like: &'static str,
    /// Where it sits, as the runs say; null where `[calibration]` states no tolerance.
    pub as_glued: Option<AsGluedSummary>,
}

/// How a gauge was glued: off its drawing along and across its axis (job units), turned (degrees, right-handed about the element's
/// normal); null where no tolerance is stated.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct AsGluedSummary {
    pub along: Option<GlueSummary>,
    pub across: Option<GlueSummary>,
    pub angle_deg: Option<GlueSummary>,
    /// Factor on its readings.
    pub gain: GlueSummary,
}

/// One size of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct GlueSummary {
    /// Posterior mean.
    pub value: f64,
    /// 1 sd.
    pub sigma: f64,
    /// Whether the runs tell it: at least half of the stated variance is gone.
    pub told: bool,
}

/// A gauge laid onto the model where the runs say that it sits.
#[derive(Clone, Debug)]
pub struct GluedGauge {
    /// There.
    pub gauge: Gauge,
    /// On the reference surface, basic frame.
    pub at: Vec3,
    /// Whether strain is read at that point; else in the middle of its element.
    pub by_position: bool,
    /// As drawn.
    pub spec: GaugeSpec,
    /// Its wiring, as a job writes it.
    pub bridge: &'static str,
    /// Element and side of the other pair of a bridge.
    pub pair: Option<(u32, Surface)>,
    /// Factor on its readings.
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

/// A load worth applying.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NextRunSummary {
    /// Loads, report units.
    pub loads: BTreeMap<String, f64>,
    /// Half the log of the ratio of determinants of the covariance of S.
    pub information: f64,
    /// The load that gains most, with its standard deviation before and after, report units.
    pub load: String,
    /// Before.
    pub sigma_before: f64,
    /// After.
    pub sigma_after: f64,
    /// Unit of both.
    pub unit: String,
}

/// Relative error of the model.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ModelErrorSummary {
    /// Common to a gauge.
    pub common_rel: f64,
    /// Entry by entry.
    pub entry_rel: f64,
}

/// A left-out run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LeftOutSummary {
    /// Its name.
    pub run: String,
    /// Distance from what is known, sigmas, root mean square over loads.
    pub distance: f64,
    /// By load, then by combination.
    pub loads: Vec<LeftOutLoad>,
}

/// A load of a left-out run, or a combination, report units.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(missing_docs)]
pub struct LeftOutLoad {
    pub name: String,
    /// As `[runs]` gives it; `None` where it does not.
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
    /// Its standard deviation.
    pub sigma: f64,
    /// Chance of such a slope where there is none.
    pub chance: f64,
    /// Degrees of freedom behind `sigma`.
    pub dof: f64,
}
