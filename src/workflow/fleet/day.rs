//! Stored result of one file: a few kilobytes, which a merge combines to the result of a vehicle.

use crate::finding::Finding;
use crate::host::whole_file::Stamp;
use crate::recovery::UNEXPLAINED;
use crate::series::rainflow::Tally;
use crate::series::rainflow::nullable_numbers::number;
use serde::{Deserialize, Serialize};

/// One load over the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadDay {
    /// Name of the load.
    pub name: String,
    /// Unit of all numbers of the load.
    pub unit: String,
    /// Standard deviation of the noise in a sample.
    pub noise: f64,
    /// Covariance of the scale errors of this load and the scale errors of every load, row-major, `n_loads x n_loads`.
    pub scale: Vec<f64>,
    /// Cycles, levels, extremes and sums of damage.
    pub tally: Tally,
}

/// One gauge over the record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct GaugeDay {
    /// Name of the gauge.
    pub name: String,
    /// Mean reading minus the job's zero, microstrain.
    #[serde(deserialize_with = "number")]
    pub mean: f64,
    /// Standard deviation of the readings, microstrain.
    #[serde(deserialize_with = "number")]
    pub sd: f64,
    /// Noise from second differences of the readings, microstrain.
    #[serde(deserialize_with = "number")]
    pub noise: f64,
    /// Residual, rms, microstrain.
    #[serde(deserialize_with = "number")]
    pub residual: f64,
    /// Reading divided by the prediction from the loads that all gauges determine, by least squares.
    #[serde(deserialize_with = "number")]
    pub gain: f64,
    /// Mean reading minus the prediction from the other gauges, microstrain.
    #[serde(deserialize_with = "number")]
    pub offset: f64,
    /// Leverage of the gauge on its own prediction: `1 - leverage` of an error of its reading appears in its residual.
    #[serde(deserialize_with = "number")]
    pub leverage: f64,
    /// Samples without a reading.
    pub missing: u64,
    /// Parts of the record in which the gauge is dead (no readings) or stuck (constant), hours from the first sample.
    pub dead: Vec<[f64; 2]>,
}

impl GaugeDay {
    /// Returns the result of a gauge that is dead (no readings) or stuck (constant) in the whole record.
    pub fn without_readings(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            mean: f64::NAN,
            sd: f64::NAN,
            noise: f64::NAN,
            residual: f64::NAN,
            gain: f64::NAN,
            offset: f64::NAN,
            leverage: f64::NAN,
            missing: u64::MAX,
            dead: Vec::new(),
        }
    }
}

/// Findings with their chances, which results leave out and a merge needs.
mod with_chances {
    use crate::finding::Finding;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer>(findings: &[Finding], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(findings.iter().map(|f| (f, f.chance)))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<Finding>, D::Error> {
        let kept: Vec<(Finding, Option<f64>)> = Deserialize::deserialize(from)?;
        let finding = |(f, chance)| Finding { chance, ..f };
        Ok(kept.into_iter().map(finding).collect())
    }
}

/// Result of a record.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Day {
    /// Samples per second.
    pub rate_hz: f64,
    /// Duration of the samples that give a load, hours.
    pub hours: f64,
    /// Samples missing in gaps.
    pub missing: usize,
    /// Loads, in the order of the job.
    pub loads: Vec<LoadDay>,
    /// Gauges, in the order of the job.
    pub gauges: Vec<GaugeDay>,
    /// Findings of the record.
    #[serde(with = "with_chances")]
    pub findings: Vec<Finding>,
}

impl Day {
    /// Returns the duration of the samples that determine a load, hours. It is shorter than the day if the active gauges determine only some of the
    /// loads.
    pub fn hours_of(&self, load: &LoadDay) -> f64 {
        let known = |l: &LoadDay| l.tally.samples.saturating_sub(l.tally.missing) as f64;
        let most = self.loads.iter().map(known).fold(0.0, f64::max);
        let share = if most > 0.0 { known(load) / most } else { 1.0 };
        self.hours * share
    }

    /// Returns whether the loads do not explain the strain of the day. The loads and their damage are then unreliable.
    pub fn is_doubtful(&self) -> bool {
        self.findings.iter().any(|f| f.code == UNEXPLAINED)
    }
}

/// Result of a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FileResult {
    /// Path as given.
    pub path: String,
    /// Digest of the bytes; empty for a file that can't be read.
    pub sha256: String,
    /// Size and time of the file when its bytes were read.
    pub stamp: Option<Stamp>,
    /// The vehicle.
    pub vehicle: String,
    /// The day.
    pub day: String,
    /// Result of the record, or the reason why the record gives no result.
    pub result: Result<Day, String>,
}

/// Result of a record without its loads and gauges, which are large.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct DayHead {
    /// Samples per second.
    pub rate_hz: f64,
    /// Duration of the samples that give a load, hours.
    pub hours: f64,
    /// Samples missing in gaps.
    pub missing: usize,
    /// Findings of the record.
    #[serde(deserialize_with = "with_chances::deserialize")]
    pub findings: Vec<Finding>,
}

/// Result of a file in a few hundred bytes. All files of a fleet are in memory in this form.
#[derive(Clone, Debug, PartialEq)]
pub struct FileHead {
    /// Path as given.
    pub path: String,
    /// Digest of the bytes; empty for a file that can't be read.
    pub sha256: String,
    /// Size and time of the file when its bytes were read.
    pub stamp: Option<Stamp>,
    /// The vehicle.
    pub vehicle: String,
    /// The day.
    pub day: String,
    /// Result of the record, or the reason why the record gives no result.
    pub result: Result<DayHead, String>,
}

impl From<FileResult> for FileHead {
    fn from(file: FileResult) -> Self {
        Self {
            path: file.path,
            sha256: file.sha256,
            stamp: file.stamp,
            vehicle: file.vehicle,
            day: file.day,
            result: file.result.map(|d| DayHead {
                rate_hz: d.rate_hz,
                hours: d.hours,
                missing: d.missing,
                findings: d.findings,
            }),
        }
    }
}
