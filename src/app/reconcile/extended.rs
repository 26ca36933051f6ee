//! The extended model: a copy of the job whose files hold the named effects, so that every command runs it as it is.
//!
//! Effects of a channel go into the readings (`strain_extended.csv`), effects of structure into S (`sensitivity_extended.csv`), loads that
//! were left out become columns of S or loads of the job, the payload's place goes into `runs_extended.csv`.

use serde::{Serialize, Serializer};
use std::path::Path;

/// The deck with effects in it.
pub const DECK: &str = "deck_extended.bdf";
/// Readings, corrected.
pub const STRAIN: &str = "strain_extended.csv";
/// S with effects in it.
pub const SENSITIVITY: &str = "sensitivity_extended.csv";
/// Signature of the payload.
pub const PAYLOAD: &str = "payload_extended.csv";
/// What acts in each run.
pub const RUNS: &str = "runs_extended.csv";

/// The job with the named effects in it, and what its files hold; in `result.json` its path.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtendedModel {
    /// File name of the job.
    pub name: &'static str,
    /// Path of the job: its name, until [`ExtendedModel::put_into`].
    pub path: String,
    /// Text of the job as it was read.
    pub job_text: String,
    /// The deck, where it changes.
    pub deck: Option<Vec<u8>>,
    /// Readings, microstrain, `n_runs x n_gauges`, where they change.
    pub readings: Option<Vec<f64>>,
    /// S, where it is given and changes.
    pub sensitivity: Option<ExtendedS>,
    /// What acts, `n_runs x n_columns`: wheel loads, then payload mass times 1, dx, dy, dx dy; where it changes.
    pub runs: Option<Vec<f64>>,
}

impl ExtendedModel {
    /// A job named `name` of this text, in which no file changes.
    pub(super) fn of(name: &'static str, job_text: String) -> Self {
        Self {
            name,
            path: name.to_owned(),
            job_text,
            deck: None,
            readings: None,
            sensitivity: None,
            runs: None,
        }
    }

    /// Its path once it is written into `folder`.
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

/// S with effects in it.
#[derive(Clone, Debug, PartialEq)]
pub struct ExtendedS {
    /// Influence of loads and payload, microstrain, `n_gauges x n_columns`.
    pub influence: Vec<f64>,
    /// Whether the influence is another than the job's: then the payload's signature is, too.
    pub changed: bool,
    /// Loads that the job knows besides: name, microstrain per unit by gauge.
    pub known: Vec<(String, Vec<f64>)>,
    /// Loads that were left out: name, microstrain per unit by gauge, usual size.
    pub left_out: Vec<(String, Vec<f64>, f64)>,
}

impl ExtendedS {
    /// Names and columns of the loads besides, those that were left out last.
    pub fn besides(&self) -> impl Iterator<Item = (&String, &Vec<f64>)> {
        let left_out = self.left_out.iter().map(|n| (&n.0, &n.1));
        self.known.iter().map(|n| (&n.0, &n.1)).chain(left_out)
    }
}
