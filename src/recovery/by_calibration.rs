//! Recovers all runs by a calibrated S, and handles suspect gauges, runs that no loads explain, and runs with several loads.

use super::calibrated_loads::estimate;
use super::errors::ErrorModel;
use super::misfit::Alternatives;
use super::types::{Readings, RunEstimate};
use super::verdict::NOT_SOLVABLE;
use super::{misfit, simultaneous_loads, uncalibrated_strain};
use crate::finding::{Finding, Severity};
use crate::input_faults::FaultTreatment;
use crate::sensitivity::{Sensitivity, Uncertainty};
use rayon::prelude::*;

/// Returns the loads of every run, and findings. Gauges that contradict the other gauges are reported. They are excluded if S was estimated from runs
/// and `handling` asks for it. A run that no loads explain gets wider intervals ([`uncalibrated_strain::estimate_loosely`]). A run with several loads
/// at once, after calibration runs with one load each, is widened as well ([`simultaneous_loads::check`]).
pub(super) fn recover(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    (known, (handling, alternatives)): (&Uncertainty, (FaultTreatment, &mut Alternatives)),
) -> (Vec<RunEstimate>, Vec<Finding>) {
    // If the error of S is stated and not estimated, such as the error of a mesh, the readings are used as measured.
    let handling = match known.dof.is_finite() {
        true => handling,
        false => FaultTreatment::AsMeasured,
    };
    // Without an estimated scatter the deviation of a gauge has no limit to be tested against.
    let (mut findings, readings) = match known.is_tested {
        true => misfit::faults_by_calibration(s, readings, errors, known, (handling, alternatives)),
        false => (vec![report_untested_intervals()], readings.to_vec()),
    };
    let mut runs: Vec<RunEstimate> = readings
        .par_iter()
        .map(|r| estimate(s, r, errors, known))
        .collect();
    if known.is_tested {
        findings.extend(uncalibrated_strain::check(&s.gauges, &runs, known));
    }
    for (run, r) in runs.iter_mut().zip(&readings) {
        if uncalibrated_strain::is_unlike(run, known) {
            *run = uncalibrated_strain::estimate_loosely(s, r, errors, known);
        }
    }
    findings.extend(simultaneous_loads::check(&mut runs, known));
    let unsolved = runs.iter().filter(|r| r.rank < s.loads.len());
    findings.extend(unsolved.map(|r| {
        Finding::new(
            Severity::Error,
            NOT_SOLVABLE,
            &r.estimate.run,
            "the gauges with readings in this run do not separate the loads: some values are arbitrary",
            "repair the gauges without readings, drop loads, or state `expected` for loads with role \"nuisance\"",
        )
    }));
    (runs, findings)
}

/// Returns the finding on a calibration whose intervals no run tested.
pub fn report_untested_intervals() -> Finding {
    Finding::new(
        Severity::Error,
        "coverage-not-tested",
        "calibration",
        "every calibration run was needed to determine S. The scatter of the runs is unknown, and the intervals do \
         not include it",
        "calibrate with further runs; repeats of one loading cost least",
    )
}
