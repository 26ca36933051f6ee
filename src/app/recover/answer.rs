//! What `recover` answers for static runs.

use crate::app::outcome::Answer;
use crate::app::strain::{Conditioning, LoadUnits};
use crate::recovery::Recovery;
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;
use serde::Serialize;

/// Loads of the static runs of a job, sums of loads among them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoveredRuns {
    /// Rank and condition numbers of S.
    #[serde(flatten)]
    pub conditioning: Conditioning,
    /// By run, then by load.
    pub loads: Vec<RecoveredLoad>,
    /// Root mean square of all residuals over their degrees of freedom.
    pub residual_rms_microstrain: f64,
    /// How well each gauge agrees.
    pub gauges: Vec<GaugeResidual>,
    /// How well each run agrees.
    pub runs: Vec<RunFit>,
}

impl Answer for RecoveredRuns {
    const COMMAND: &'static str = "recover";
}

/// A load of a run, report units; not a number where the gauges that read don't tell it.
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
    /// Upper end.
    pub high: f64,
    /// Report unit.
    pub unit: String,
}

/// A gauge over all runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GaugeResidual {
    /// Gauge.
    pub name: String,
    /// Root mean square residual.
    pub residual_rms_microstrain: f64,
    /// How much it decides its own prediction, 0 to 1.
    pub leverage: f64,
}

/// The residual of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunFit {
    /// Run.
    pub run: String,
    /// Sum of squares over stated errors.
    pub chi2: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Factor on sigma of the 95 % interval.
    pub coverage_factor: f64,
}

impl RecoveredRuns {
    /// The answer in report units; `units` are those of the loads that the estimates list.
    pub(super) fn of(s: &Sensitivity, recovery: &Recovery, units: &[LoadUnits]) -> Self {
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
            conditioning: Conditioning::of(s),
            loads: loads.collect(),
            residual_rms_microstrain: recovery.residual_rms / MICROSTRAIN,
            gauges: gauges.collect(),
            runs: runs.collect(),
        }
    }
}
