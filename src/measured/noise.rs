//! Noise of gauges from a zero record.

use super::columns::columns_of_gauges;
use super::means::read_strain_file;
use super::strain_file::wanted_columns;
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{Job, Measured};
use crate::recovery::{ErrorModel, noise_without_load};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::{JobSensitivity, prepare};
use crate::units::MICROSTRAIN;

/// Returns S of the job's gauges with their noise. The noise is stated in the job or determined from the zero record.
///
/// # Errors
/// Faults of [`prepare`] and of the zero file.
pub(crate) fn prepare_with_noise(work: &mut Work, job: &Job) -> Result<JobSensitivity, Faults> {
    let mut prepared = prepare(work, job)?;
    if let Some(measured) = &job.measured {
        take_noise_of_zero(work, job, measured, &mut prepared.sensitivity)?;
    }
    Ok(prepared)
}

/// Sets the noise of S to the noise of the zero record. It applies if the job states no noise by gauge and the record contradicts equal and
/// independent noise.
///
/// # Errors
/// Faults of the zero file.
fn take_noise_of_zero(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    s: &mut Sensitivity,
) -> Result<(), Faults> {
    let Some(named) = measured.zero.as_ref().filter(|_| s.noise.is_none()) else {
        return Ok(());
    };
    let wanted = wanted_columns(&mut work.inputs, job);
    let file = read_strain_file(&mut work.inputs, job, named, &wanted)?;
    let columns = columns_of_gauges(file.gauges(), &s.gauges);
    let strain = |row: &[f64], column: &Option<usize>| {
        let read = column.and_then(|c| row.get(c));
        read.map_or(f64::NAN, |v| v * MICROSTRAIN)
    };
    let rows: Vec<Vec<f64>> = (file.rows())
        .map(|row| columns.iter().map(|c| strain(row, c)).collect())
        .collect();
    let errors = ErrorModel {
        noise: measured.noise_microstrain * MICROSTRAIN,
        model_rel: 0.0,
    };
    let (noise, finding) = noise_without_load(s, &rows, errors);
    s.noise = noise;
    work.findings.extend(finding);
    Ok(())
}
