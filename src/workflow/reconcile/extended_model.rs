//! The extended model: a copy of the job whose files contain the named effects, so that every command runs it unchanged.
//!
//! Faults of a channel become `[[correction]]` entries. Effects of structure change S (`sensitivity_extended.csv`) or the deck. Loads that were left
//! out become columns of S or loads of the job. Errors in the records of a run are corrected in `runs_extended.csv`. Readings are rewritten
//! (`strain_extended.csv`) only if no entry can express their fault.

use serde::{Serialize, Serializer};
use std::path::Path;

/// File name of the deck with effects.
pub const DECK: &str = "deck_extended.bdf";
/// File name of the corrected readings.
pub const STRAIN: &str = "strain_extended.csv";
/// File name of S with effects.
pub const SENSITIVITY: &str = "sensitivity_extended.csv";
/// File name of the signature of the payload.
pub const PAYLOAD: &str = "payload_extended.csv";
/// File name of the recorded loads and payload of each run.
pub const RUNS: &str = "runs_extended.csv";

/// Job with the named effects, and the content of its files. `result.json` contains its path.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtendedModel {
    /// File name of the job.
    pub name: &'static str,
    /// Path of the job: its name, until `ExtendedModel::put_into`.
    pub path: String,
    /// Text of the job as it was read.
    pub job_text: String,
    /// Deck; `None` if it does not change.
    pub deck: Option<Vec<u8>>,
    /// Corrections of channels, which apply to every reading.
    pub corrections: Vec<ReadingCorrection>,
    /// Corrected readings, microstrain, `n_runs x n_gauges`; `None` if [`Self::corrections`] can express the faults.
    pub readings: Option<Vec<f64>>,
    /// Nominal x of the payload, m, if the payload is at another place than recorded in every run.
    pub nominal_x_m: Option<f64>,
    /// S; `None` if it is not given or does not change.
    pub sensitivity: Option<ExtendedS>,
    /// Recorded loads and payload of the runs; `None` if they do not change.
    pub runs: Option<ExtendedRuns>,
}

impl ExtendedModel {
    /// Creates a job named `name` of this text, in which no file changes.
    pub(super) fn from_job_text(name: &'static str, job_text: String) -> Self {
        Self {
            name,
            path: name.to_owned(),
            job_text,
            deck: None,
            corrections: Vec::new(),
            readings: None,
            nominal_x_m: None,
            sensitivity: None,
            runs: None,
        }
    }

    /// Sets the path of the job for output into `folder`.
    pub(super) fn put_into(&mut self, folder: &Path) {
        let path = folder.join(self.name);
        self.path = path.display().to_string().replace('\\', "/");
    }
}

impl Serialize for ExtendedModel {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(&self.path)
    }
}

/// Correction of the readings of a channel: `(reading - offset) / factor`, as in `[[correction]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadingCorrection {
    /// Gauge.
    pub gauge: String,
    /// Reading divided by strain, with sign.
    pub factor: f64,
    /// Reading without strain, microstrain.
    pub offset_microstrain: f64,
    /// Gauge whose channel is exchanged with the channel of this gauge.
    pub exchanged_with: Option<String>,
    /// Rotation of the gauge, degrees.
    pub angle_deg: f64,
    /// Whether the channel is left out.
    pub ignore: bool,
}

/// Recorded loads and payload of the runs, with the effects in them.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtendedRuns {
    /// Wheel loads, kN and kN m, `n_runs x n_loads`.
    pub loads: Vec<f64>,
    /// Payload by run: mass, kg, distance in x and in y from its nominal place, m.
    pub payload: Vec<[f64; 3]>,
}

/// S with effects in it.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtendedS {
    /// Influence of loads and payload, microstrain, `n_gauges x n_columns`.
    pub influence: Vec<f64>,
    /// Whether the influence differs from the influence of the job. The payload signature then differs as well.
    pub changed: bool,
    /// Other loads of the job: name, microstrain per unit by gauge.
    pub known: Vec<(String, Vec<f64>)>,
    /// Loads that were left out: name, microstrain per kN, kN m or degree by gauge, and usual size in the same unit.
    pub left_out: Vec<(String, Vec<f64>, f64)>,
}
