//! `[calibration]`.

/// Terms of the strain of a gauge as a function of the loads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Terms {
    /// `eps = S f`.
    #[default]
    Linear,
    /// `eps = S f + z`, with the strain `z` that the gauges read without load.
    Intercept,
}

/// `[calibration]`.
#[derive(Clone, Debug, PartialEq)]
pub struct CalibrationKeys {
    /// Runs to calibrate with. `None` means every run with known loads.
    pub runs: Option<Vec<String>>,
    /// Columns of the runs file; runs with equal values in these columns are repeats.
    pub repeats: Vec<String>,
    /// Column of the runs file on which the scale may depend.
    pub depends_on: Option<String>,
    /// Stated relative error of the model's S, 1 sd: entry by entry, and common to a gauge.
    pub model_uncertainty_rel: f64,
    /// Distance of a gauge from its nominal position along and across its axis, 1 sd, job length. 0 means no distance.
    pub position_tolerance: f64,
    /// Rotation of a gauge from its nominal direction, 1 sd. 0 means no rotation.
    pub angle_tolerance_deg: f64,
    /// Relative error that all known loads share, 1 sd; 0: none.
    pub scale_sd: f64,
    /// Terms of the model of the strain.
    pub terms: Terms,
    /// Runs of known load that are not calibrated with, but recovered and compared.
    pub check: Vec<String>,
    /// Line of the job; 0 where the section is absent.
    pub line: u32,
}
