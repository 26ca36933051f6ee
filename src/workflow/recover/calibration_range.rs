//! Recovered loads and readings compared with the range of their calibration, which the job states in `[sensitivity] range`.

use super::task::Task;
use crate::finding::Finding;
use crate::job::Job;
use crate::job::calibrated_range::calibrated_range;
use crate::recovery::outside_calibration::{
    CalibratedLoad, RangeRules, RunLoad, check_load, check_strain,
};
use crate::recovery::{Readings, Recovery};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::LoadUnits;
use crate::units::MICROSTRAIN;

/// Returns the loads of S with a stated range, by number.
pub(super) fn with_range<'a>(
    job: &Job,
    s: &'a Sensitivity,
    units: &'a [LoadUnits],
) -> Vec<(usize, CalibratedLoad<'a>)> {
    let loads = s.loads.iter().zip(units).enumerate();
    let one = |(l, (load, unit)): (usize, (&'a crate::sensitivity::Load, &'a LoadUnits))| {
        let range = calibrated_range(job, &load.name).filter(|_| load.wanted)?;
        let load = CalibratedLoad {
            name: &load.name,
            range,
            unit: (unit.factor, &unit.name),
        };
        Some((l, load))
    };
    loads.filter_map(one).collect()
}

/// Returns the findings on runs whose loads or readings are beyond the calibration.
pub(super) fn of_runs(
    task: &Task,
    (s, readings): (&Sensitivity, &[Readings]),
    recovery: &Recovery,
    units: &[LoadUnits],
) -> Vec<Finding> {
    let rules = RangeRules::default();
    let loads = with_range(task.job, s, units);
    let values = loads.len() * recovery.runs.len();
    let of_load = |(l, load): &(usize, CalibratedLoad)| {
        let reached = recovery.runs.iter().map(|r| RunLoad {
            run: &r.estimate.run,
            value: r.estimate.values[*l],
            half: r.estimate.coverage_factor * r.estimate.sigma(*l),
        });
        let reached: Vec<RunLoad> = reached.collect();
        check_load(load, &reached, values, &rules)
    };
    let mut out: Vec<Finding> = loads.iter().filter_map(of_load).collect();
    if out.is_empty()
        && let Some(given) = &task.job.sensitivity
    {
        let largest = |g: usize| {
            let read = readings.iter().map(|r| r.strain[g]);
            let read = read.filter(|v| v.is_finite());
            read.fold(0.0_f64, |a, v| a.max(v.abs()))
        };
        let gauges = s.gauges.iter().enumerate().filter_map(|(g, name)| {
            let range = given.strain_range.get(name)?.map(|v| v * MICROSTRAIN);
            Some((name.as_str(), range, largest(g)))
        });
        out.extend(check_strain(gauges, &rules));
    }
    out
}

/// Returns the findings on a record whose smallest or largest loads, job units, are beyond the calibration. `samples` is the number of its samples.
/// `loads` are the loads of S with a stated range, by number. `halves` are half widths of the 95 % intervals of a sample.
pub(crate) fn record_beyond_calibration(
    loads: &[(usize, CalibratedLoad)],
    (file, samples): (&str, u64),
    (min, max, halves): (&[f64], &[f64], &[f64]),
) -> Vec<Finding> {
    let rules = RangeRules::default();
    let values = loads.len() * usize::try_from(samples).unwrap_or(usize::MAX / 64);
    let of_load = |(l, load): &(usize, CalibratedLoad)| {
        let at = |value: f64| RunLoad {
            run: file,
            value,
            half: halves[*l],
        };
        let mut ends = vec![at(max[*l]), at(min[*l])];
        ends.retain(|e| e.value.is_finite());
        // A record counts as one run, even if both ends are beyond the calibration.
        let (low, high) = (load.range[0].min(0.0), load.range[1].max(0.0));
        ends.sort_by(|a, b| {
            let beyond = |r: &RunLoad| (r.value - high).max(low - r.value);
            beyond(b).total_cmp(&beyond(a))
        });
        ends.truncate(1);
        check_load(load, &ends, values, &rules)
    };
    loads.iter().filter_map(of_load).collect()
}
