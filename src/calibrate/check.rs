//! Check runs: known loads that S was not calibrated with, recovered and compared.

use super::common_zero::less_zero;
use super::types::{Calibration, KnownRun};
use crate::estimate::LoadEstimate;
use crate::recovery::{ErrorModel, Readings, recover};

/// Loads of a check run as `recover` computes them, with the applied loads.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedRun {
    /// Recovered loads.
    pub estimate: LoadEstimate,
    /// Applied load.
    pub run: KnownRun,
}

/// Recovers the loads of check runs with a calibrated S. `noise` is the standard deviation of a reading, strain.
pub fn recover_checks(found: &Calibration, noise: f64, runs: &[KnownRun]) -> Vec<CheckedRun> {
    let errors = ErrorModel {
        noise,
        model_rel: 0.0,
    };
    let zero = match found.common_zero.is_empty() {
        true => vec![0.0; found.sensitivity.gauges.len()],
        false => found.common_zero.clone(),
    };
    let readings: Vec<Readings> = runs
        .iter()
        .map(|r| Readings {
            run: r.run.clone(),
            strain: less_zero(&r.strain, &zero),
            noise_factor: r.noise_factor,
        })
        .collect();
    if readings.is_empty() {
        return Vec::new();
    }
    let recovered = recover(&found.sensitivity, &readings, errors);
    let pairs = recovered.runs.into_iter().zip(runs);
    pairs
        .map(|(found, run)| CheckedRun {
            estimate: found.estimate,
            run: run.clone(),
        })
        .collect()
}

impl Calibration {
    /// Recovers the loads of the runs that S was calibrated with. The runs are stated by their number in the task.
    pub fn recover_used_runs(&self, noise: f64, runs: &[KnownRun]) -> Vec<(usize, CheckedRun)> {
        let used = (0..runs.len()).filter(|r| !self.refused.contains(r));
        let used: Vec<usize> = used.collect();
        let taken: Vec<KnownRun> = used.iter().map(|r| runs[*r].clone()).collect();
        used.into_iter()
            .zip(recover_checks(self, noise, &taken))
            .collect()
    }
}
