//! Recovered runs compared with the loads that the runs file records of them.

use super::known_payload::KnownLoads;
use super::task::Task;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::input_faults::{RecordedRuns, findings_of_recorded_loads};
use crate::job::Job;
use crate::measured::runs_file::read_runs;
use crate::recovery::{Readings, Recovery};
use crate::sensitivity::Sensitivity;

/// Returns the findings on recorded loads with the other sign, in another unit, or exchanged. A job without `[runs]` has no such findings.
///
/// The recovered strain of loads that the runs file does not record is subtracted from the readings. Recorded loads do not influence the recovered
/// loads. A finding is therefore an error only if the readings may be wrong.
///
/// # Errors
/// The faults of the runs file.
pub(super) fn wrong_records(
    work: &mut Work,
    task: &Task,
    (s, readings): (&Sensitivity, &[Readings]),
    recovery: &Recovery,
    known: &KnownLoads,
) -> Result<Vec<Finding>, Faults> {
    let job = task.job;
    let Some(runs) = &job.runs else {
        return Ok(Vec::new());
    };
    let rows = read_runs(&mut work.inputs, job, runs)?;
    let row_of = |run: &str| rows.iter().find(|r| r.run == run);
    let unrecorded = readings.iter().filter(|r| row_of(&r.run).is_none());
    let unrecorded: Vec<&str> = unrecorded.map(|r| r.run.as_str()).collect();
    let missing = without_row(&runs.file.given, &unrecorded, readings.len());
    work.findings.extend(missing);
    let is_taken_out = |l: usize| known.iter().flatten().any(|k| k.0 == l);
    let is_recorded = |l: &usize| {
        let column = rows
            .iter()
            .any(|r| r.loads_si.contains_key(&s.loads[*l].name));
        column && !is_taken_out(*l)
    };
    let (recorded, other): (Vec<usize>, Vec<usize>) = (0..s.loads.len()).partition(is_recorded);
    if recorded.is_empty() {
        return Ok(Vec::new());
    }
    let per_job_unit: Vec<f64> = recorded
        .iter()
        .map(|l| si_of(job, &s.loads[*l].name))
        .collect();
    let size = |run: &str, i: usize| -> Option<f64> {
        let si = row_of(run)?.loads_si.get(&s.loads[recorded[i]].name)?;
        Some(si / per_job_unit[i])
    };
    let sizes: Vec<Vec<Option<f64>>> = readings
        .iter()
        .map(|r| (0..recorded.len()).map(|i| size(&r.run, i)).collect())
        .collect();
    let of_recorded = readings.iter().zip(&recovery.runs).map(|(r, found)| {
        let strain = r.strain.iter().enumerate();
        strain
            .map(|(g, v)| {
                let others = other.iter();
                let rest = others.map(|l| s.values[(g, *l)] * found.estimate.values[*l]);
                v - rest.sum::<f64>()
            })
            .collect()
    });
    let recorded_runs = RecordedRuns {
        loads: recorded.iter().map(|l| s.loads[*l].name.as_str()).collect(),
        readings: of_recorded.collect(),
        strain_of: Box::new(|g, r, l, from| {
            s.values[(g, recorded[l])] * sizes[r][from].unwrap_or(0.0)
        }),
        quantities: recorded.iter().map(|l| s.loads[*l].quantity).collect(),
        known: sizes
            .iter()
            .map(|r| r.iter().all(Option::is_some))
            .collect(),
        excluded: Vec::new(),
        noise: task.errors.noise,
        model_rel: task.errors.model_rel,
    };
    let mut found = findings_of_recorded_loads(&recorded_runs, &format!("`{}`", runs.file.given));
    for f in &mut found {
        let whose = f.code != "inputs-exchanged" && f.subject == "all";
        f.severity = if whose {
            Severity::Error
        } else {
            Severity::Warning
        };
    }
    Ok(found)
}

/// Returns the finding on `runs` for which the runs file has no row, out of `all` measured runs. It is a warning if the file has a row for no run.
fn without_row(file: &str, runs: &[&str], all: usize) -> Option<Finding> {
    let severity = match runs.len() == all {
        true => Severity::Warning,
        false => Severity::Info,
    };
    (!runs.is_empty()).then(|| {
        Finding::new(
            severity,
            "run-without-record",
            list_few(runs),
            format!(
                "`{file}` has no row for {} of {all} measured runs: they are not compared with recorded loads",
                runs.len()
            ),
            "give the runs the same names in both files, or add their rows",
        )
        .with_numbers(runs.len() as f64, 0.0)
    })
}

/// Returns SI units of one job unit of a load.
fn si_of(job: &Job, name: &str) -> f64 {
    job.quantity_of_load(name).map_or(1.0, |q| job.units.si(q))
}
