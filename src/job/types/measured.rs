//! `[measured]`.

use super::named_file::NamedFile;

/// State that is added to make loads totals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// Loads are changes.
    None,
    /// The structure's own weight.
    Gravity,
    /// A subcase of the results.
    Subcase(u32),
}

/// Data that no fit uses.
#[derive(Clone, Debug, PartialEq)]
pub enum HoldOut {
    /// Nothing.
    None,
    /// These runs of the strain file.
    Runs(Vec<String>),
    /// A separate strain file.
    File(NamedFile),
}

/// `[measured]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Strain file.
    pub strain: NamedFile,
    /// Record or runs whose mean is subtracted.
    pub zero: Option<NamedFile>,
    /// Runs of the strain file without load. The zero is interpolated between these runs.
    pub zero_runs: Vec<String>,
    /// Changes or totals.
    pub reference: Reference,
    /// Noise, microstrain, 1 sd. The default is 1. If noise is stated by gauge, it is the root mean square over the gauges.
    pub noise_microstrain: f64,
    /// Noise of each gauge, microstrain, 1 sd. Empty if all gauges have equal noise.
    pub noise_by_gauge: Vec<(String, f64)>,
    /// Correlation of the noise of any two gauges; default 0.
    pub noise_correlation: f64,
    /// Whether the job states the noise.
    pub states_noise: bool,
    /// Model uncertainty of the predicted strain, 1 sd; default 0.
    pub model_uncertainty_rel: f64,
    /// Runs kept from fitting.
    pub hold_out: HoldOut,
    /// Seconds in the unit of the column `time`, where the job states it.
    pub time_unit_s: Option<f64>,
    /// Line of the job.
    pub line: u32,
}
