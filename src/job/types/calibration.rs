//! `[calibration]`.

/// `[calibration]`.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationKeys {
    /// Runs that teach; `None`: every run whose loads are known.
    pub runs: Option<Vec<String>>,
    /// Columns of the runs file: runs alike in these are repeats.
    pub repeats: Vec<String>,
    /// Column of the runs file that the scale may depend on.
    pub depends_on: Option<String>,
    /// Stated relative error of the model's S, 1 sd: entry by entry, and common to a gauge.
    pub model_uncertainty_rel: f64,
    /// How far a gauge may sit from its drawing along and across its axis, 1 sd, job length; 0: it sits there.
    pub position_tolerance: f64,
    /// How far it may be turned, 1 sd; 0: it is not.
    pub angle_tolerance_deg: f64,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}
