//! Recovered loads compared with recorded ones: of runs by their names, of records at the same times.

mod curves;
mod record;
mod runs;

pub use curves::{ComparisonSpectra, LoadLevels, LoadSpectra};
pub(super) use record::{Gap, record, record_of_job};
pub(super) use runs::runs;

use crate::estimate::Deviations;
use crate::finding::{Finding, Severity};
use crate::host::outcome::finite_or_none;
use crate::host::words::format_number;
use crate::units::percent;
use serde::Serialize;

/// Comparison of recovered with recorded loads.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Comparison {
    /// Result for each load.
    #[serde(rename = "comparison", skip_serializing_if = "Vec::is_empty")]
    pub loads: Vec<LoadComparison>,
    /// Time shift of a record of loads.
    #[serde(rename = "comparison_shift", skip_serializing_if = "Option::is_none")]
    pub shift: Option<ComparisonShift>,
    /// Spectra and coherence of a record.
    #[serde(rename = "comparison_spectra", skip_serializing_if = "Option::is_none")]
    pub spectra: Option<ComparisonSpectra>,
    /// Level crossings of a record, by load.
    #[serde(skip)]
    pub levels: Vec<LoadLevels>,
}

/// Time shift that converts the times of the recorded loads to times of the strain record.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonShift {
    /// File of the recorded loads.
    pub file: String,
    /// The shift, s.
    pub shift_s: f64,
    /// Half width of its 95 % interval, s; `None` where the job states the shift.
    pub half_width_s: Option<f64>,
    /// Mean correlation coefficient of recovered and recorded loads at an estimated shift.
    pub correlation: Option<f64>,
}

/// Comparison of a load, recovered minus recorded, report unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadComparison {
    /// Load or combination.
    pub load: String,
    /// Report unit.
    pub unit: String,
    /// Number of runs or samples that are compared.
    pub n: u64,
    /// Mean difference.
    pub bias: f64,
    /// Root mean square difference.
    pub rms: f64,
    /// Share of the recorded loads inside the 95 % interval of the recovered loads.
    pub share_within: f64,
    /// Damage of the recovered load divided by the damage of the recorded load. `None` for runs.
    pub damage_ratio: Option<f64>,
    /// Lower end of its 95 % interval.
    pub damage_ratio_low: Option<f64>,
    /// Upper end of this interval.
    pub damage_ratio_high: Option<f64>,
    /// Recorded and recovered load of some of the runs or samples.
    #[serde(skip)]
    pub points: Vec<[f64; 2]>,
}

/// Sums over the differences of a load, report unit.
#[derive(Clone, Debug, Default, PartialEq)]
struct Differences {
    n: u64,
    sum: f64,
    squares: f64,
    within: u64,
    /// Sum of squares over sigma, and number, by block.
    blocks: Vec<(f64, u64)>,
    /// Sums of the variances of the differences, and of their part that no two samples have in common.
    variance: f64,
    independent: f64,
    points: Vec<[f64; 2]>,
}

/// Largest number of points of a cross plot.
const POINTS: usize = 1500;

/// Recovered and recorded value of a load, with standard deviations of their difference. `sigma` contains all errors, and `own_sigma` the errors of
/// the sample alone. Intervals are `factor` times `sigma`.
struct Pair {
    recovered: f64,
    recorded: f64,
    sigma: f64,
    own_sigma: f64,
    factor: f64,
}

impl Differences {
    fn of_blocks(blocks: usize) -> Self {
        Self {
            blocks: vec![(0.0, 0); blocks],
            ..Self::default()
        }
    }

    fn add(&mut self, block: usize, pair: &Pair) {
        let d = pair.recovered - pair.recorded;
        self.n += 1;
        self.sum += d;
        self.squares += d * d;
        self.within += u64::from(d.abs() <= pair.factor * pair.sigma);
        self.variance += pair.sigma * pair.sigma;
        self.independent += pair.own_sigma * pair.own_sigma;
        let over = d / pair.sigma;
        if let Some((sum, n)) = self.blocks.get_mut(block).filter(|_| over.is_finite()) {
            *sum += over * over;
            *n += 1;
        }
    }

    fn merge(&mut self, other: &Self) {
        self.n += other.n;
        self.sum += other.sum;
        self.squares += other.squares;
        self.within += other.within;
        self.variance += other.variance;
        self.independent += other.independent;
        for (a, b) in self.blocks.iter_mut().zip(&other.blocks) {
            a.0 += b.0;
            a.1 += b.1;
        }
        self.points.extend_from_slice(&other.points);
    }

    /// Returns the comparison of a load; `None` if the load is not compared.
    fn into_comparison(self, load: &str, unit: &str) -> Option<LoadComparison> {
        let n = self.n as f64;
        (self.n > 0).then(|| LoadComparison {
            load: load.to_owned(),
            unit: unit.to_owned(),
            n: self.n,
            bias: self.sum / n,
            rms: (self.squares / n).sqrt(),
            share_within: self.within as f64 / n,
            damage_ratio: None,
            damage_ratio_low: None,
            damage_ratio_high: None,
            points: self.points,
        })
    }

    /// Returns the root mean square of the standard deviation of a difference.
    fn sigma(&self) -> f64 {
        (self.variance / self.n.max(1) as f64).sqrt()
    }

    /// Returns the differences divided by their standard deviation. `each_independent` states that no sample depends on the previous one.
    fn deviations(&self, each_independent: bool) -> Option<Deviations> {
        let filled = self.blocks.iter().filter(|b| b.1 > 0);
        let means: Vec<f64> = filled.clone().map(|b| b.0 / b.1 as f64).collect();
        let n: u64 = filled.clone().map(|b| b.1).sum();
        let mean_square = finite_or_none(filled.map(|b| b.0).sum::<f64>() / n as f64)?;
        let effective = match each_independent || means.len() < 2 {
            true => n as f64,
            false => Deviations::effective_count(&means).min(n as f64),
        };
        Some(Deviations {
            mean_square,
            effective,
            common: 1.0 - self.independent / self.variance,
        })
    }
}

impl LoadComparison {
    /// Returns the warning on a load whose differences exceed its intervals.
    fn outside_intervals_finding(&self, deviations: Option<Deviations>) -> Option<Finding> {
        let deviations = deviations.filter(Deviations::is_significant)?;
        let message = format!(
            "{} of the recorded values are inside the 95 % interval of the recovered load, 95 % expected. The difference is {} {unit} rms, {} times \
             its standard deviation; its mean is {} {unit}",
            percent(self.share_within),
            format_number(self.rms),
            format_number(deviations.mean_square.sqrt()),
            format_number(self.bias),
            unit = self.unit
        );
        let remedy = "compare sign, unit, place and direction of the recorded load with the job. If they agree, the model or the gauges err by more than \
             the job states: run `reconcile` or `calibrate`, or state a larger model_uncertainty_rel";
        Some(
            Finding::new(
                Severity::Warning,
                "recorded-loads-outside-intervals",
                format!("load `{}`", self.load),
                message,
                remedy,
            )
            .with_numbers(self.share_within, 0.95),
        )
    }
}
