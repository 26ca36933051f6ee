//! Inputs that runs and records share: measured strain, S, zero and reference, stated errors.

use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{Job, Measured, Reference};
use crate::measured::reference::reference_strain;
use crate::measured::zero::zero_of;
use crate::recovery::ErrorModel;
use crate::sensitivity::Sensitivity;
use crate::strain_chain::{JobSensitivity, stated_errors};
use std::collections::HashSet;

/// Inputs that runs and records share.
pub(super) struct Task<'a> {
    pub job: &'a Job,
    pub measured: &'a Measured,
    pub prepared: &'a JobSensitivity,
    pub errors: ErrorModel,
    /// Strain subtracted from readings, by gauge of S.
    pub zero: Vec<f64>,
    /// Rows of S from which loads are estimated.
    pub estimating: Vec<usize>,
    /// Rows of S of the validation gauges. The estimate is compared with their readings.
    pub validation: Vec<usize>,
    /// Noise variance of a reading minus zero, in units of the variance of a single reading.
    pub noise_factor: f64,
}

/// Returns `[measured]` of a job.
pub(super) fn measured_of(job: &Job) -> Result<&Measured, Faults> {
    job.measured.as_ref().ok_or_else(|| {
        Faults::from(Fault::new(
            &*job.file,
            "measured",
            "the job has no [measured]",
            "name the strain file: [measured] strain = \"strain.csv\"",
        ))
    })
}

/// Returns the finding that loads are changes, if no reference is stated.
pub(super) fn changes(measured: &Measured) -> Option<Finding> {
    (measured.reference == Reference::None).then(|| {
        Finding::new(
            Severity::Info,
            "loads-are-changes",
            "measured.reference",
            "loads are changes from the state at which the gauges read zero",
            "state `reference` to get totals",
        )
    })
}

/// Prepares the inputs that runs and records share: zero, reference, stated errors.
pub(super) fn task_of<'a>(
    work: &mut Work,
    job: &'a Job,
    measured: &'a Measured,
    prepared: &'a JobSensitivity,
) -> Result<Task<'a>, Faults> {
    let mut task = without_reference(work, job, measured, prepared)?;
    let reference = reference_strain(job, measured, prepared)?;
    for (z, r) in task.zero.iter_mut().zip(reference) {
        *z -= r;
    }
    Ok(task)
}

/// Prepares these inputs without the strain of the reference state.
pub(super) fn without_reference<'a>(
    work: &mut Work,
    job: &'a Job,
    measured: &'a Measured,
    prepared: &'a JobSensitivity,
) -> Result<Task<'a>, Faults> {
    let (zero, n_zero) = zero_of(work, job, measured, &prepared.sensitivity.gauges)?;
    if !measured.states_noise {
        work.findings.push(Finding::new(
            Severity::Info,
            "noise-assumed",
            "measured.noise_microstrain",
            format!(
                "the job does not state the noise of the readings: {} microstrain (1 sd) is assumed, and all intervals depend on it",
                measured.noise_microstrain
            ),
            "state noise_microstrain: the scatter of a gauge at rest",
        ));
    }
    let (validation, estimating) = validation_rows(job, &prepared.sensitivity);
    Ok(Task {
        estimating,
        validation,
        job,
        measured,
        prepared,
        errors: stated_errors(measured, &prepared.sensitivity, prepared.fields.as_ref()),
        zero,
        noise_factor: 1.0 + n_zero.map_or(0.0, |n| 1.0 / n),
    })
}

/// Returns the rows of S of the job's validation gauges, then all other rows.
pub(super) fn validation_rows(job: &Job, s: &Sensitivity) -> (Vec<usize>, Vec<usize>) {
    let names: HashSet<String> = job.validation_readings().into_iter().collect();
    (0..s.gauges.len()).partition(|&g| names.contains(&s.gauges[g]))
}
