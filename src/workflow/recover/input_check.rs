//! Tests of measured strain before its loads are recovered, for `check`.

use super::listed_loads::list_load_columns;
use super::task::{Task, task_of, without_reference};
use super::{open_strain, record, runs};
use crate::host::fault::{FaultList, Faults};
use crate::host::work::Work;
use crate::job::{Job, Measured, Reference};
use crate::measured::MeasuredStrain;
use crate::measured::zero::reads_strain;
use crate::recovery::reading_plausibility;
use crate::sensitivity::{Sensitivity, check_separability};
use crate::strain_chain::JobSensitivity;

/// Reads the measured strain of a job, its zero and its known payload, as `recover` does. Tests readings and times, and returns every fault.
/// `sensitivity` is the job's given S. If S needs a solution, it contains only the names of the gauges.
pub(crate) fn check_inputs(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    sensitivity: Sensitivity,
) -> FaultList {
    let prepared = JobSensitivity {
        sensitivity,
        fields: None,
        gauges: Vec::new(),
        mesh_error: Vec::new(),
    };
    // A reference state from the model needs a solution.
    let known = match job.model.is_none() && !prepared.sensitivity.loads.is_empty() {
        true => KnownSensitivity::S,
        false => KnownSensitivity::Names,
    };
    let task = match known {
        KnownSensitivity::S => task_of(work, job, measured, &prepared),
        KnownSensitivity::Names => without_reference(work, job, measured, &prepared),
    };
    let faults_of = |read: Result<(), Faults>| read.err().map_or_else(Vec::new, Faults::into_list);
    let first = match task {
        Ok(task) => return faults_of(readings(work, &task, known)),
        Err(faults) => faults,
    };
    // Faults of the readings are reported together with the faults of their zero.
    let mut bare = measured.clone();
    (bare.zero, bare.reference) = (None, Reference::None);
    let mut faults = first.into_list();
    match without_reference(work, job, &bare, &prepared) {
        Ok(task) => faults.extend(faults_of(readings(work, &task, KnownSensitivity::Names))),
        Err(more) => faults.extend(more),
    }
    faults
}

/// Known part of S.
#[derive(Clone, Copy, PartialEq)]
enum KnownSensitivity {
    /// Complete S, which loads are recovered with.
    S,
    /// Names of the gauges.
    Names,
}

/// Reads and tests the readings.
fn readings(work: &mut Work, task: &Task, known: KnownSensitivity) -> Result<(), Faults> {
    let s = &task.prepared.sensitivity;
    if known == KnownSensitivity::S {
        // A job for `reconcile` may list loads that only the runs file distinguishes.
        if task.job.reconcile.is_none() {
            work.findings
                .extend(check_separability(&s.without_prior_loads()));
        }
        list_load_columns(task.job, s)?;
    }
    let (s, readings) = match open_strain(work, task.job, task.measured)? {
        MeasuredStrain::Record(record) => record::sample_readings(work, task, &record)?,
        MeasuredStrain::Runs(table) => (s.clone(), runs::read(work, task, &table)?.0),
    };
    let found = match reads_strain(task.job) {
        true => reading_plausibility::check(&s.gauges, &readings, task.errors).1,
        false => {
            work.findings.retain(|f| f.code != "reading-impossible");
            reading_plausibility::check_signal(&readings, task.errors)
        }
    };
    // The readings don't contain the strain of the reference state, which may be the whole strain.
    let all = known == KnownSensitivity::S || task.measured.reference == Reference::None;
    let holds = |code: &str| all || code != "readings-below-noise";
    work.findings
        .extend(found.into_iter().filter(|f| holds(f.code)));
    Ok(())
}

/// Returns the gauges that the strain file of a job contains, if the job itself names no gauges.
///
/// # Errors
/// A file that can't be read.
pub(crate) fn gauges_of_file(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
) -> Result<Vec<String>, Faults> {
    Ok(open_strain(work, job, measured)?.gauges().to_vec())
}
