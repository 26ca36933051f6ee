//! Payloads compared with the range of known payloads that S was calibrated with.

use super::model::Parts;
use super::task::Task;
use crate::estimate::NORMAL_95;
use crate::finding::Finding;
use crate::job::calibrated_range::calibrated_range;
use crate::job::payload_loads::part_of;
use crate::payload::{WeighedRun, Weighing};
use crate::recovery::by_calibration::report_untested_intervals;
use crate::recovery::outside_calibration::{CalibratedLoad, RangeRules, RunLoad, check_load};
use crate::strain_chain::has_covariance;

/// Returns the findings on weights and moments beyond the calibration, and on a weight that no calibration run tested. Moments are weights times
/// their distance from the nominal place.
pub(super) fn findings(task: &Task, parts: &Parts, weighing: &Weighing) -> Vec<Finding> {
    let Some(prepared) = parts.prepared.as_ref().filter(|_| has_covariance(task.job)) else {
        return Vec::new();
    };
    let uncertainty = prepared.sensitivity.uncertainty.as_ref();
    let is_tested = uncertainty.is_none_or(|u| u.is_tested);
    let mut out: Vec<Finding> = (!is_tested)
        .then(report_untested_intervals)
        .into_iter()
        .collect();
    let rules = RangeRules::default();
    let weighed = || weighing.runs.iter().filter(|r| r.refused.is_none());
    let loads = prepared.sensitivity.loads.iter();
    let loads: Vec<([f64; 3], CalibratedLoad)> = loads
        .filter_map(|load| {
            let parts = part_of(task.job, &load.name)?;
            let unit = match parts[0] == 0.0 {
                true => task.job.report_units.moment,
                false => task.job.report_units.force,
            };
            let load = CalibratedLoad {
                name: &load.name,
                range: calibrated_range(task.job, &load.name)?,
                unit: (crate::units::factor(task.job.units, unit), unit.name),
            };
            Some((parts, load))
        })
        .collect();
    let values = loads.len() * weighed().count();
    let of_load = |(parts, load): &(_, CalibratedLoad)| {
        let reached = weighed().map(|r| of_run(task, r, *parts));
        let reached: Vec<RunLoad> = reached.collect();
        check_load(load, &reached, values, &rules)
    };
    out.extend(loads.iter().filter_map(of_load));
    out
}

/// Returns a load of the payload, job units: `parts` of the weight `W`, of `W dx` and of `W dy`.
fn of_run<'a>(task: &Task, run: &'a WeighedRun, parts: [f64; 3]) -> RunLoad<'a> {
    let half_weight = 0.5 * (run.interval[1] - run.interval[0]) / task.force;
    let weight = run.force / task.force;
    let [dx, dy] = run.shift.map(|d| d / task.length);
    let arm = parts[0] + parts[1] * dx + parts[2] * dy;
    let [xx, xy, _, yy] = run.shift_covariance.map(|c| c / task.length.powi(2));
    let of_place =
        parts[1] * parts[1] * xx + 2.0 * parts[1] * parts[2] * xy + parts[2] * parts[2] * yy;
    RunLoad {
        run: &run.run,
        value: weight * arm,
        half: (half_weight * arm).hypot(NORMAL_95 * weight * of_place.max(0.0).sqrt()),
    }
}
