//! Answer of `recover`.

use super::compare::Comparison;
use super::damage::LoadDamage;
use super::history::History;
use super::motion::Motion;
use super::sections::{SectionLoad, Sections};
use super::sink::RecordHead;
use super::trace::Spans;
use super::validation::ValidationGauge;
use crate::host::outcome::Answer;
use crate::host::words::count_of;
use crate::job::Job;
use crate::measured::conditioning_step::ConditioningStep;
use crate::recovery::{Readings, Recovery, Sums};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::{Conditioning, GaugeMeshError, JobSensitivity, LoadUnits};
use crate::units::{MICROSTRAIN, half_width};
use serde::Serialize;
use std::sync::Arc;

/// Results in addition to the loads: validation, comparison and sections.
#[derive(Default)]
pub(super) struct AdditionalResults {
    pub validation: Vec<ValidationGauge>,
    pub comparison: Comparison,
    pub sections: Vec<SectionLoad>,
    pub reading_conditioning: Vec<ConditioningStep>,
}

/// Loads from measured strain.
#[derive(Serialize)]
pub struct RecoveredLoads {
    /// Rank and condition numbers of S.
    #[serde(flatten)]
    pub conditioning: Conditioning,
    /// Recovered loads of the runs or of the record.
    #[serde(flatten)]
    pub states: States,
    /// Changes of the readings by `[conditioning]`, by step and gauge.
    #[serde(rename = "conditioning", skip_serializing_if = "Vec::is_empty")]
    pub reading_conditioning: Vec<ConditioningStep>,
    /// Gauges from which no load was estimated, each compared with its prediction.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub validation: Vec<ValidationGauge>,
    /// Comparison of recovered with recorded loads, if loads were recorded.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Loads by section and over the duty cycle, if the job has sections.
    #[serde(flatten)]
    pub sections: Option<Sections>,
    /// Mesh error of the deck by gauge, if the job requests it. It is subtracted from S, and its possible remainder is part of the uncertainty.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh_error: Vec<GaugeMeshError>,
    /// S, gauges, model and strain fields.
    #[serde(skip)]
    pub prepared: JobSensitivity,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for RecoveredLoads {
    const COMMAND: &'static str = "recover";
    const RESULT: &'static str = "The recovered loads";

    fn verdict(&self) -> String {
        let spans = self.spans();
        let measured = match &self.states {
            States::Runs(runs) => count_of(runs.runs.len(), "run"),
            States::Record(record) => count_of(record.samples as usize, "sample"),
        };
        let known = spans.iter().filter(|s| s.share().is_finite());
        let least_certain = known.max_by(|a, b| a.share().total_cmp(&b.share()));
        let least_certain = least_certain.map_or_else(String::new, |s| {
            format!(
                ", least certain {} {} {}",
                s.name,
                half_width(s.half),
                s.unit
            )
        });
        format!(
            "{} from {measured}{least_certain}; residual {}.",
            count_of(spans.len(), "load"),
            self.states.residual()
        )
    }
}

impl RecoveredLoads {
    /// Returns the loads of static runs. `None` if a record was measured.
    pub fn runs(&self) -> Option<&RecoveredRuns> {
        match &self.states {
            States::Runs(runs) => Some(runs),
            States::Record(_) => None,
        }
    }

    /// Returns the loads of a record. `None` if runs were measured.
    pub fn record(&self) -> Option<&RecoveredRecord> {
        match &self.states {
            States::Record(record) => Some(record),
            States::Runs(_) => None,
        }
    }
}

/// Recovered loads of static runs, or of a record.
#[derive(Serialize)]
#[serde(untagged)]
pub enum States {
    /// Static states, a row each.
    Runs(Box<RecoveredRuns>),
    /// Samples over time.
    Record(Box<RecoveredRecord>),
}

/// Loads of the static runs of a job, including sums of loads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoveredRuns {
    /// Loads of each run.
    pub loads: Vec<RecoveredLoad>,
    /// Root mean square of all residuals over their degrees of freedom.
    pub residual_rms_microstrain: f64,
    /// Agreement of each gauge.
    pub gauges: Vec<GaugeResidual>,
    /// Agreement of each run.
    pub runs: Vec<RunFit>,
    /// Readings of the runs, with zero, reference and known payload taken into account.
    #[serde(skip)]
    pub readings: Vec<Readings>,
    /// The estimates, job units.
    #[serde(skip)]
    pub recovery: Recovery,
    /// Loads, then combinations.
    #[serde(skip)]
    pub names: Vec<String>,
    /// Units of loads and combinations.
    #[serde(skip)]
    pub units: Vec<LoadUnits>,
}

/// Load of a run, report units; NaN if the active gauges don't determine it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoveredLoad {
    /// Run.
    pub run: String,
    /// Load or combination.
    pub name: String,
    /// Estimate.
    pub value: f64,
    /// One standard deviation.
    pub sigma: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of this interval.
    pub high: f64,
    /// Report unit.
    pub unit: String,
}

impl RecoveredLoad {
    /// Returns the half width of the 95 % interval.
    pub fn half_width(&self) -> f64 {
        (self.high - self.low) / 2.0
    }
}

/// Residual of a gauge over all runs, or over a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GaugeResidual {
    /// Gauge.
    pub name: String,
    /// Root mean square residual.
    pub residual_rms_microstrain: f64,
    /// Influence of the gauge on its own prediction, 0 to 1.
    pub leverage: f64,
}

/// The residual of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunFit {
    /// Run.
    pub run: String,
    /// Sum of squares of the residuals, relative to the stated errors.
    pub chi2: f64,
    /// Degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Factor on sigma of the 95 % interval.
    pub coverage_factor: f64,
}

/// Loads of a record, including sums of loads.
#[derive(Serialize)]
pub struct RecoveredRecord {
    /// Result for each load.
    pub loads: Vec<RecordLoad>,
    /// Root mean square of all residuals over their degrees of freedom.
    pub residual_rms_microstrain: f64,
    /// Agreement of each gauge.
    pub gauges: Vec<GaugeResidual>,
    /// Number of samples, including samples with gaps.
    pub samples: u64,
    /// Number of samples in which a gauge has no reading.
    pub gaps: u64,
    /// Time from the first to the last sample.
    pub duration_s: f64,
    /// Number of steps between samples, divided by the duration.
    pub sample_rate_hz: Option<f64>,
    /// `loads.csv` has a row for every n-th sample, with this n.
    pub csv_every: usize,
    /// Frequency content of the loads compared with the first elastic mode, if this mode is known.
    #[serde(flatten)]
    pub content: Option<Content>,
    /// Vibration that was removed from the record.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub motion: Option<Motion>,
    /// Cycles and pseudo-damage by load, if requested or if the record is short.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Vec<LoadDamage>>,
    /// S of the active gauges.
    #[serde(skip)]
    pub sensitivity: Sensitivity,
    /// Names, units, estimate, clock.
    #[serde(skip)]
    pub head: Arc<RecordHead>,
    /// Sums over the record, job units.
    #[serde(skip)]
    pub sums: Sums,
    /// Smallest, mean and largest by span of time, job units.
    #[serde(skip)]
    pub spans: Spans,
    /// Every sample, if the samples were kept in memory.
    #[serde(skip)]
    pub history: Option<History>,
}

/// Frequency content of the loads of a record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Content {
    /// Frequency of the first elastic mode of the structure with the job's support.
    pub first_elastic_mode_hz: f64,
    /// Highest frequency with content of each load; `None` if the content does not exceed the noise.
    pub content_hz: Vec<Option<f64>>,
}

/// A load over a record, report units.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecordLoad {
    /// The file.
    pub run: String,
    /// Load or combination.
    pub name: String,
    /// Mean.
    pub value: f64,
    /// One standard deviation of a sample at the root mean square of all loads.
    pub sigma: f64,
    /// Report unit.
    pub unit: String,
    /// Smallest sample.
    pub min: f64,
    /// Largest sample.
    pub max: f64,
    /// Root mean square.
    pub rms: f64,
}

impl RecoveredRuns {
    /// Builds the answer in report units. `units` are the units of the estimated loads.
    pub(super) fn from_recovery(
        s: &Sensitivity,
        readings: Vec<Readings>,
        recovery: Recovery,
        names: Vec<String>,
        units: Vec<LoadUnits>,
    ) -> Self {
        let loads = recovery.runs.iter().flat_map(|r| {
            units.iter().enumerate().map(move |(l, u)| {
                let [low, high] = r.estimate.interval(l).map(|v| v * u.factor);
                RecoveredLoad {
                    run: r.estimate.run.clone(),
                    name: r.estimate.names[l].clone(),
                    value: r.estimate.values[l] * u.factor,
                    sigma: r.estimate.sigma(l) * u.factor,
                    low,
                    high,
                    unit: u.name.clone(),
                }
            })
        });
        let gauges = s.gauges.iter().enumerate().map(|(g, name)| GaugeResidual {
            name: name.clone(),
            residual_rms_microstrain: recovery.gauge_residual_rms[g] / MICROSTRAIN,
            leverage: recovery.gauge_leverage[g],
        });
        let runs = recovery.runs.iter().map(|r| RunFit {
            run: r.estimate.run.clone(),
            chi2: r.chi2,
            degrees_of_freedom: r.dof,
            coverage_factor: r.estimate.coverage_factor,
        });
        Self {
            loads: loads.collect(),
            residual_rms_microstrain: recovery.residual_rms / MICROSTRAIN,
            gauges: gauges.collect(),
            runs: runs.collect(),
            readings,
            recovery,
            names,
            units,
        }
    }
}
