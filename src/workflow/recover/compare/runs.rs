//! Recovered runs against the loads that a runs file records of them.

use super::{Comparison, Differences, POINTS, Pair};
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{HoldOut, Job, Runs};
use crate::measured::recorded_loads::{RecordedLoads, noise_si, read_recorded};
use crate::measured::runs_file::{RunRow, read_runs};
use crate::recovery::{Gain, Readings, Recovery, Widening};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::{LoadUnits, has_covariance};
use crate::workflow::recover::known_payload::KnownLoads;
use crate::workflow::recover::task::Task;

/// Compares the recovered loads of runs with the recorded loads of `[compare]`, or else of `[runs]`. Known loads and calibration runs are not
/// compared, because the comparison would not be independent.
///
/// # Errors
/// Files that can't be read; a `[compare]` that names a record, or has none of the runs.
pub fn runs(
    work: &mut Work,
    task: &Task,
    (s, readings): (&Sensitivity, &[Readings]),
    (recovery, units): (&Recovery, &[LoadUnits]),
    known: &KnownLoads,
) -> Result<Comparison, Faults> {
    let job = task.job;
    let Some((file, rows)) = rows(work, job, s)? else {
        return Ok(Comparison::default());
    };
    let row_of = |run: &str| rows.iter().find(|r| r.run == run);
    if job.compare.is_some() && !readings.iter().any(|r| row_of(&r.run).is_some()) {
        let wrong = format!(
            "`{}` contains none of the runs of the strain file",
            file.file.given
        );
        let remedy = "give the runs the same names in both files";
        return Err(Fault::with_line(&*job.file, file.line, "compare.file", wrong, remedy).into());
    }
    let taught = |row: &RunRow| job.compare.is_none() && is_calibration_run(job, s, row);
    let left_out: Vec<&str> = readings
        .iter()
        .filter_map(|r| row_of(&r.run))
        .filter(|row| taught(row) && !row.loads_si.is_empty())
        .map(|row| row.run.as_str())
        .collect();
    work.findings.extend(not_compared(&left_out));
    let own: Vec<Vec<f64>> = readings
        .iter()
        .zip(&recovery.runs)
        .map(|(r, found)| own_share(task, s, r, &found.estimate.values))
        .collect();
    let mut out = Comparison::default();
    for (l, (load, unit)) in s.loads.iter().zip(units).enumerate() {
        let si = job
            .quantity_of_load(&load.name)
            .map_or(1.0, |q| job.units.si(q));
        let noise = load.quantity.map_or(0.0, |q| noise_si(file, q)) / si * unit.factor;
        let mut sums = Differences::of_blocks(1);
        for (r, (reading, found)) in readings.iter().zip(&recovery.runs).enumerate() {
            let is_known = known[r].iter().any(|k| k.0 == l);
            let row = row_of(&reading.run).filter(|row| !is_known && !taught(row));
            let recorded = row.and_then(|row| row.loads_si.get(&load.name));
            let Some(recorded) = recorded.filter(|_| found.determines_load(l)) else {
                continue;
            };
            let sigma = found.estimate.sigma(l) * unit.factor;
            let factor = found.estimate.coverage_factor;
            // Student's factor widens sigma, also together with the noise of the recorded load.
            let wide = factor / NORMAL_95 * sigma;
            let pair = Pair {
                recovered: found.estimate.values[l] * unit.factor,
                recorded: recorded / si * unit.factor,
                sigma: wide.hypot(noise),
                own_sigma: (wide * own[r][l]).hypot(noise),
                factor: NORMAL_95,
            };
            sums.add(0, &pair);
            if sums.points.len() < POINTS {
                sums.points.push([pair.recorded, pair.recovered]);
            }
        }
        let deviations = sums.deviations(true);
        if let Some(found) = sums.into_comparison(&load.name, &unit.name) {
            work.findings
                .extend(found.outside_intervals_finding(deviations));
            out.loads.push(found);
        }
    }
    Ok(out)
}

/// Returns the file of recorded loads of a job and its rows; `None` if no load is recorded.
fn rows<'a>(
    work: &mut Work,
    job: &'a Job,
    s: &Sensitivity,
) -> Result<Option<(&'a Runs, Vec<RunRow>)>, Faults> {
    let of_runs = match &job.runs {
        Some(runs) => Some((runs, read_runs(&mut work.inputs, job, runs)?)),
        None => None,
    };
    let Some(compare) = &job.compare else {
        return Ok(of_runs);
    };
    let names: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    match read_recorded(&mut work.inputs, job, compare, &names)? {
        RecordedLoads::Runs(rows) => Ok(Some((&compare.recorded, rows))),
        RecordedLoads::Record(_) => Err(Fault::with_line(
            &*job.file,
            compare.line,
            "compare.file",
            "the recorded loads are a record, and the strain file has runs",
            "name runs with the same names, a row each with a column `run`, or a strain record",
        )
        .into()),
    }
}

/// Returns whether S was calibrated with this run, because `[calibration] runs` names it. Without that list, a calibration run has all of its loads
/// recorded and is not held out.
fn is_calibration_run(job: &Job, s: &Sensitivity, row: &RunRow) -> bool {
    let held_out = job
        .measured
        .as_ref()
        .is_some_and(|m| matches!(&m.hold_out, HoldOut::Runs(list) if list.contains(&row.run)));
    has_covariance(job)
        && match &job.calibration.runs {
            Some(list) => list.contains(&row.run),
            None => {
                !held_out
                    && !job.calibration.check.contains(&row.run)
                    && s.loads.iter().all(|l| row.loads_si.contains_key(&l.name))
            }
        }
}

fn not_compared(runs: &[&str]) -> Option<Finding> {
    (!runs.is_empty()).then(|| {
        Finding::new(
            Severity::Info,
            "calibration-runs-not-compared",
            list_few(runs),
            "S was calibrated with the recorded loads of these runs. Their recovered loads therefore agree, and they are not compared",
            "leave some runs out of the calibration ([calibration] runs, or [measured] hold_out) and compare these",
        )
        .with_numbers(runs.len() as f64, 0.0)
    })
}

/// Returns by load the ratio of two standard deviations: from the errors of the run alone, and from all errors. Errors of S are common to all runs.
fn own_share(task: &Task, s: &Sensitivity, r: &Readings, loads: &[f64]) -> Vec<f64> {
    let plain = Widening {
        variance_factor: 1.0,
        coverage_factor: NORMAL_95,
        shifts: Vec::new(),
    };
    let reads = |g: &usize| r.strain[*g].is_finite();
    let used: Vec<usize> = (0..r.strain.len()).filter(reads).collect();
    let known: Vec<f64> = loads
        .iter()
        .map(|v| if v.is_finite() { *v } else { 0.0 })
        .collect();
    let gain = Gain::new(s, &used, task.errors, r.noise_factor, &known);
    let Some(gain) = gain else {
        return vec![1.0; loads.len()];
    };
    let both = gain.own_sigma().into_iter().zip(gain.sigma(&known, &plain));
    both.map(|(own, all)| if all > 0.0 { own / all } else { 1.0 })
        .collect()
}
