//! Change of readings by `[conditioning]`, as results state it.

use serde::Serialize;

/// Change of the readings of one gauge by one step of `[conditioning]`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConditioningStep {
    /// Step: `constant`, `spikes`, `temperature`, `drift`, `zero`, `low_pass` or `high_pass`.
    pub step: &'static str,
    /// Name of the column, as the job names its gauge.
    pub gauge: String,
    /// Samples that changed.
    pub samples: usize,
    /// Root mean square of the change over the record, microstrain.
    pub rms_microstrain: f64,
    /// Largest change of the subtracted drift line if a part of the record is left out, microstrain. It shows how far loads tilt the line.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_microstrain: Option<f64>,
}
