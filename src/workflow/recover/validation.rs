//! Validation gauges: no load is estimated from them, and the loads predict their readings.

use super::task::Task;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::Fault;
use crate::host::outcome::finite_or_none;
use crate::job::correct::channel_of;
use crate::measured::columns::columns_of_gauges;
use crate::measured::record::Record;
use crate::recovery::validation::prediction_variance;
use crate::recovery::{Gain, Readings, Recovery};
use crate::sensitivity::{Sensitivity, Uncertainty};
use crate::units::MICROSTRAIN;
use serde::Serialize;

/// Ratio of measured to expected difference above which a validation gauge contradicts its prediction. By chance, one gauge in 370 exceeds it in a
/// single run, and fewer in several runs.
const CONTRADICTED: f64 = 3.0;

/// Comparison of a gauge with its prediction. No load was estimated from this gauge.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ValidationGauge {
    /// Gauge.
    pub name: String,
    /// Number of runs or samples that were compared.
    pub n: u64,
    /// Root mean square of reading minus prediction. `None` if nothing was compared.
    pub rms_microstrain: Option<f64>,
    /// Root mean square that stated errors explain: noise, model error, uncertainty of the loads.
    pub expected_rms_microstrain: Option<f64>,
}

/// Differences of one gauge.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Differences {
    n: u64,
    /// Sum of squares, strain^2.
    squares: f64,
    /// Sum of their expected variances, strain^2.
    expected: f64,
}

impl Differences {
    fn into_validation_gauge(self, name: &str) -> ValidationGauge {
        let rms = |sum: f64| match self.n {
            0 => None,
            n => finite_or_none((sum / n as f64).sqrt() / MICROSTRAIN),
        };
        ValidationGauge {
            name: name.to_owned(),
            n: self.n,
            rms_microstrain: rms(self.squares),
            expected_rms_microstrain: rms(self.expected),
        }
    }
}

/// Returns a warning that names the validation gauges that differ from their prediction by more than stated errors explain.
pub(super) fn report_contradictions(list: &[ValidationGauge]) -> Option<Finding> {
    let ratio = |g: &ValidationGauge| Some(g.rms_microstrain? / g.expected_rms_microstrain?);
    let off = list
        .iter()
        .filter(|g| ratio(g).is_some_and(|r| r > CONTRADICTED));
    let names: Vec<&str> = off.map(|g| g.name.as_str()).collect();
    let largest = list.iter().filter_map(ratio).fold(0.0, f64::max);
    (!names.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "prediction-poor",
            list_few(&names),
            format!(
                "these validation gauges differ from their prediction by up to {largest:.1} times the stated errors: either they or the \
                 recovered loads are wrong by more than their intervals"
            ),
            "check these gauges and their place in the model, then run `reconcile`",
        )
        .with_numbers(largest, CONTRADICTED)
    })
}

/// A gauge that is predicted.
struct PredictedGauge<'a> {
    task: &'a Task<'a>,
    /// Row in S.
    row: usize,
    s: Vec<f64>,
    /// Uncertainty of that row.
    uncertainty: Option<Uncertainty>,
}

impl<'a> PredictedGauge<'a> {
    fn from_validation_gauges(task: &'a Task<'a>) -> Vec<Self> {
        let s = &task.prepared.sensitivity;
        let of = |&row: &usize| Self {
            task,
            row,
            s: s.values.row(row).iter().copied().collect(),
            uncertainty: s.uncertainty.as_ref().map(|u| u.of_gauges(&[row])),
        };
        task.validation.iter().map(of).collect()
    }

    fn name(&self) -> &str {
        &self.task.prepared.sensitivity.gauges[self.row]
    }

    /// Returns the strain at loads `f`; not a number if a load is unknown.
    fn strain(&self, f: &[f64]) -> f64 {
        self.s.iter().zip(f).map(|(s, f)| s * f).sum()
    }

    /// Returns the expected variance of reading minus prediction, strain^2.
    fn variance(&self, gain: &Gain, f: &[f64], noise_factor: f64) -> f64 {
        let own = self.uncertainty.as_ref();
        let of_row: f64 = own.map_or(0.0, |u| u.strain_covariance(1, f).iter().sum());
        let noise = self.task.prepared.sensitivity.noise.as_ref();
        let noise_factor = noise_factor * noise.map_or(1.0, |n| n.variance(self.row));
        of_row + prediction_variance((gain, &self.s), self.task.errors, f, noise_factor)
    }
}

/// Compares the readings of the runs, by all rows of S, with their prediction from the loads. `s` and `readings` are the data of the estimate,
/// without the loads that are known beforehand.
pub(super) fn of_runs(
    task: &Task,
    (s, readings): (&Sensitivity, &[Readings]),
    all: &[Readings],
    recovery: &Recovery,
) -> Vec<ValidationGauge> {
    let gauges = PredictedGauge::from_validation_gauges(task);
    if gauges.is_empty() {
        return Vec::new();
    }
    let mut sums = vec![Differences::default(); gauges.len()];
    let mut kept: Option<(Vec<usize>, f64, Option<Gain>)> = None;
    for ((own, all), run) in readings.iter().zip(all).zip(&recovery.runs) {
        let reads = |g: &usize| own.strain[*g].is_finite();
        let used: Vec<usize> = (0..own.strain.len()).filter(reads).collect();
        let is_kept = kept
            .as_ref()
            .is_some_and(|k| k.0 == used && k.1 == own.noise_factor);
        if !is_kept {
            let gain = Gain::new(s, &used, task.errors, own.noise_factor, &recovery.typical);
            kept = Some((used, own.noise_factor, gain));
        }
        let Some(gain) = kept.as_ref().and_then(|k| k.2.as_ref()) else {
            continue;
        };
        let f = &run.estimate.values;
        for (sum, gauge) in sums.iter_mut().zip(&gauges) {
            let off = all.strain[gauge.row] - gauge.strain(f);
            if off.is_finite() {
                sum.n += 1;
                sum.squares += off * off;
                sum.expected += gauge.variance(gain, f, own.noise_factor);
            }
        }
    }
    let found = sums.iter().zip(&gauges);
    found
        .map(|(sum, g)| sum.into_validation_gauge(g.name()))
        .collect()
}

/// The channels of a record that contain validation gauges.
pub(super) struct Channels<'a> {
    record: Record,
    gauges: Vec<PredictedGauge<'a>>,
    /// Gauge of each channel.
    of: Vec<usize>,
}

/// Sums over a part of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct ValidationSums {
    sums: Vec<Differences>,
    /// Samples in which all loads are known, and sums of squares of the loads.
    samples: u64,
    loads: Vec<f64>,
}

impl ValidationSums {
    /// Adds the sums of another part.
    pub fn merge(&mut self, other: &Self) {
        self.sums.resize(other.sums.len(), Differences::default());
        self.loads.resize(other.loads.len(), 0.0);
        for (a, b) in self.sums.iter_mut().zip(&other.sums) {
            a.n += b.n;
            a.squares += b.squares;
        }
        for (a, b) in self.loads.iter_mut().zip(&other.loads) {
            *a += b;
        }
        self.samples += other.samples;
    }
}

impl<'a> Channels<'a> {
    /// Returns the channels of the job's validation gauges in a record. `None` if the record has none of them.
    pub fn from_record(task: &'a Task<'a>, record: &Record) -> Option<Self> {
        let gauges = PredictedGauge::from_validation_gauges(task);
        if gauges.is_empty() {
            return None;
        }
        let all = &task.prepared.sensitivity.gauges;
        let found = columns_of_gauges(&record.names, all);
        let (mut of, mut columns) = (Vec::new(), Vec::new());
        for (i, gauge) in gauges.iter().enumerate() {
            let channel = channel_of(&task.job.corrections, gauge.name());
            if found[gauge.row].is_some() && !channel.ignore {
                of.push(i);
                columns.push((found[gauge.row], channel));
            }
        }
        let record = record.clone().with_columns(columns);
        Some(Self { record, gauges, of })
    }

    /// Returns a note that the gauges are not compared, because their readings contain the vibration that `[dynamic]` removes from the loads.
    pub fn not_compared(&self) -> Finding {
        let names: Vec<&str> = self.gauges.iter().map(PredictedGauge::name).collect();
        Finding::new(
            Severity::Info,
            "gauges-not-compared",
            list_few(&names),
            "these validation gauges are not compared with their prediction: their readings contain the vibration that [dynamic] subtracts \
             from the loads",
            "delete [dynamic] to compare them",
        )
    }

    /// Compares the predictions with a piece of the record. `loads` contains `width` numbers for each sample. The loads of S come first.
    ///
    /// # Errors
    /// A piece that can't be read.
    pub fn compare(
        &self,
        piece: usize,
        loads: &[f64],
        width: usize,
    ) -> Result<ValidationSums, Fault> {
        let k = self.gauges.first().map_or(0, |g| g.s.len());
        let mut out = ValidationSums {
            sums: vec![Differences::default(); self.gauges.len()],
            samples: 0,
            loads: vec![0.0; k],
        };
        if self.of.is_empty() {
            return Ok(out);
        }
        let (_, values) = self.record.piece(piece)?;
        let rows = values.chunks_exact(self.of.len());
        for (row, f) in rows.zip(loads.chunks_exact(width.max(1))) {
            let f = f.get(..k).unwrap_or(f);
            if f.iter().all(|v| v.is_finite()) {
                out.samples += 1;
                out.loads.iter_mut().zip(f).for_each(|(s, v)| *s += v * v);
            }
            for (reading, &i) in row.iter().zip(&self.of) {
                let gauge = &self.gauges[i];
                let off = reading - gauge.task.zero[gauge.row] - gauge.strain(f);
                if off.is_finite() {
                    out.sums[i].n += 1;
                    out.sums[i].squares += off * off;
                }
            }
        }
        Ok(out)
    }

    /// Returns the comparison of all parts; the expected difference is computed at the root mean square of the loads.
    pub fn compare_gauges(&self, compared: &ValidationSums, gain: &Gain) -> Vec<ValidationGauge> {
        let samples = compared.samples.max(1) as f64;
        let typical = compared.loads.iter().map(|v| (v / samples).sqrt());
        let typical: Vec<f64> = typical.collect();
        let of = |(i, gauge): (usize, &PredictedGauge)| {
            let mut sum = compared.sums.get(i).copied().unwrap_or_default();
            if sum.n > 0 {
                let variance = gauge.variance(gain, &typical, gauge.task.noise_factor);
                sum.expected = sum.n as f64 * variance;
            }
            sum.into_validation_gauge(gauge.name())
        };
        self.gauges.iter().enumerate().map(of).collect()
    }
}
