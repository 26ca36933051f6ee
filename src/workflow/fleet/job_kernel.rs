//! The kernel of a job: S, zero, errors, classes.

use super::kernel::Kernel;
use super::record_recovery::UnderWay;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::Job;
use crate::job::calibrated_range::calibrated_range;
use crate::job::correct::channel_of;
use crate::measured::conditioning::check_zeros;
use crate::measured::noise::prepare_with_noise;
use crate::measured::reference::reference_strain;
use crate::measured::zero::no_zero_runs;
use crate::measured::zero::zero_of;
use crate::sensitivity::check_separability;
use crate::series::rainflow::{Knee, Law};
use crate::strain_chain::named_results::check_tables;
use crate::strain_chain::{alternative_rows, stated_errors};
use crate::workflow::recover::{VerticalLoads, VibrationModel, list_load_columns};

/// Classes up to the expected size of a load.
const CLASSES: f64 = 32.0;

/// Prepares the inputs that all records of a job share: S solved or read, zero and reference, stated errors, S-N line, classes.
///
/// # Errors
/// Every fault of the job and of the files it names.
pub fn kernel_of(work: &mut Work, job: &Job) -> Result<Kernel, Faults> {
    let job = &job.without_validation_gauges()?;
    check_tables(work, job)?;
    let Some(measured) = &job.measured else {
        let remedy = "add [measured] with the noise and the model's uncertainty";
        return Err(Fault::new(&*job.file, "measured", "the job has no [measured]", remedy).into());
    };
    no_zero_runs(job, measured, "FILES")?;
    check_zeros(job)?;
    let prepared = prepare_with_noise(work, job)?;
    let s = &prepared.sensitivity;
    work.findings.extend(check_separability(s));
    let (mut zero, effective) = zero_of(work, job, measured, &s.gauges)?;
    // A gauge without a zero reading would be missing in every record.
    let wanted = |g: &usize| !channel_of(&job.corrections, &s.gauges[*g]).ignore;
    let blank = (0..zero.len()).filter(wanted).find(|g| zero[*g].is_nan());
    if let (Some(named), Some(g)) = (&measured.zero, blank) {
        let remedy = "repair the channel of the zero file, or remove its gauge from the job";
        return Err(Fault::new(&*named.given, &*s.gauges[g], "no zero reading", remedy).into());
    }
    for (z, r) in zero
        .iter_mut()
        .zip(reference_strain(job, measured, &prepared)?)
    {
        *z -= r;
    }
    let listed = list_load_columns(job, s)?;
    let section = job.fleet.as_ref();
    let law = Law {
        slope: job.recover.slope,
        knee: section.and_then(|f| {
            Some(Knee {
                range: f.knee_range?,
                slope: f.slope_below_knee,
            })
        }),
    };
    let expected = |l: usize| s.loads.get(l)?.expected.filter(|e| *e > 0.0);
    let of_sum = |terms: &Vec<(usize, f64)>| -> Option<f64> {
        let each = terms.iter().map(|(l, c)| Some(c.abs() * expected(*l)?));
        each.sum::<Option<f64>>().filter(|e| *e > 0.0)
    };
    let loads = (0..s.loads.len()).map(expected);
    let widths = loads
        .chain(listed.sums.iter().map(of_sum))
        .zip(&listed.units)
        .map(|(e, u)| e.map_or(1.0, |e| round(e * u.factor / CLASSES)))
        .collect();
    let errors = stated_errors(measured, s, prepared.fields.as_ref());
    let loads = prepared.sensitivity.loads.iter();
    let ranges = loads.map(|l| calibrated_range(job, &l.name)).collect();
    let fields = prepared.fields.as_ref();
    let alternatives = alternative_rows(work, job, fields, &prepared.sensitivity.gauges);
    let vertical = VerticalLoads::of_job(job);
    let vibration = VibrationModel::of_job(work, job, &prepared, &prepared.sensitivity)?;
    Ok(Kernel {
        alternatives,
        vertical,
        ranges,
        sensitivity: prepared.sensitivity,
        zero,
        errors,
        noise_factor: 1.0 + effective.map_or(0.0, |n| 1.0 / n),
        listed,
        law,
        widths,
        job: job.clone(),
        vibration,
        under_way: UnderWay::default(),
    })
}

/// 1, 2 or 5 times a power of ten, the next above: a width that depends on the job alone.
fn round(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    let first = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .find(|d| d * power >= x * (1.0 - 1e-9));
    first.unwrap_or(10.0) * power
}
