//! Recovered loads by load: smallest, mean and largest over all runs or samples, with the half width of their intervals.

use super::answer::{RecordLoad, RecoveredLoads, RecoveredRecord, RecoveredRuns, States};
use crate::units::{factor, number};

/// A load over all runs, or over a record, report units.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadSpan {
    /// Load or combination.
    pub name: String,
    /// Smallest value.
    pub smallest: f64,
    /// Mean value.
    pub mean: f64,
    /// Largest value.
    pub largest: f64,
    /// Half width of the widest 95 % interval. NaN if no run determines the load.
    pub half: f64,
    /// Report unit.
    pub unit: String,
    /// Expected size of the load, or its largest value if the job states no size.
    pub size: f64,
}

impl LoadSpan {
    /// Returns the half width divided by the size of the load.
    pub fn share(&self) -> f64 {
        self.half / self.size
    }

    /// Returns the largest value by magnitude, with its sign.
    pub fn peak(&self) -> f64 {
        match self.smallest.abs() > self.largest.abs() {
            true => self.smallest,
            false => self.largest,
        }
    }
}

impl RecoveredLoads {
    /// Returns the loads over all runs or samples, including combinations, in the order of the job.
    pub fn spans(&self) -> Vec<LoadSpan> {
        let mut spans = match &self.states {
            States::Runs(runs) => of_runs(runs),
            States::Record(record) => of_record(record),
        };
        for s in &mut spans {
            let of_job = self.job.loads.iter().find(|l| l.name == s.name);
            let expected = of_job.and_then(|l| {
                let unit = l.report_unit(&self.job.report_units);
                Some(l.expected? * unit.map_or(1.0, |u| factor(self.job.units, u)))
            });
            s.size = expected.unwrap_or_else(|| s.peak()).abs();
        }
        spans
    }
}

fn of_runs(runs: &RecoveredRuns) -> Vec<LoadSpan> {
    let span = |(l, name): (usize, &String)| {
        let of_load = || {
            let list = runs.loads.iter().skip(l).step_by(runs.names.len().max(1));
            list.filter(|r| r.value.is_finite())
        };
        let n = of_load().count() as f64;
        LoadSpan {
            name: name.clone(),
            smallest: of_load().map(|r| r.value).fold(f64::NAN, f64::min),
            mean: of_load().map(|r| r.value).sum::<f64>() / n,
            largest: of_load().map(|r| r.value).fold(f64::NAN, f64::max),
            half: of_load().map(|r| r.half_width()).fold(f64::NAN, f64::max),
            unit: runs
                .units
                .get(l)
                .map_or_else(String::new, |u| u.name.clone()),
            size: f64::NAN,
        }
    };
    runs.names.iter().enumerate().map(span).collect()
}

fn of_record(record: &RecoveredRecord) -> Vec<LoadSpan> {
    let factor = record.head.filter.coverage_factor();
    let span = |l: &RecordLoad| LoadSpan {
        name: l.name.clone(),
        smallest: l.min,
        mean: l.value,
        largest: l.max,
        half: factor * l.sigma,
        unit: l.unit.clone(),
        size: f64::NAN,
    };
    record.loads.iter().map(span).collect()
}

impl States {
    /// Returns the residual as text. For runs, the text contains the ratio to the expected residual, because the errors of each run are known.
    pub(super) fn residual(&self) -> String {
        match self {
            Self::Record(record) => {
                format!(
                    "{} microstrain rms",
                    number(record.residual_rms_microstrain)
                )
            }
            Self::Runs(runs) => {
                let chi2: f64 = runs.runs.iter().map(|r| r.chi2).sum();
                let dof: usize = runs.runs.iter().map(|r| r.degrees_of_freedom).sum();
                let rms = number(runs.residual_rms_microstrain);
                match dof {
                    // With as many loads as readings there is no residual.
                    0 => "none, with as many loads as readings".to_owned(),
                    n => format!(
                        "{rms} microstrain, {:.1} times expected",
                        (chi2 / n as f64).sqrt()
                    ),
                }
            }
        }
    }
}
