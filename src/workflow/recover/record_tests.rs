//! Tests of a record on samples spread over it, before all of it is read.

use super::answer::Content;
use super::block::block;
use super::content::{check_band, check_content, content_of_loads, structure};
use super::task::Task;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::measured::record::Record;
use crate::recovery::dynamic::ReadingCovariance;
use crate::recovery::history::Filter;
use crate::recovery::{Readings, Recovery, clock, recover_samples_with_alternatives};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::alternative_rows;
use crate::strain_chain::built_in_solver::{first_mode_of, support_of_job};
use rayon::prelude::*;

/// Number of samples on which the residual of a long record is tested.
const TESTED_SAMPLES: usize = 200;
/// Largest number of samples at which a record that is read in one piece is tested in full.
const FULLY_TESTED_SAMPLES: usize = 2000;
/// Number of samples that give typical loads for the weights of a stated model error.
const TYPICAL: usize = 20_000;
/// Pieces whose content is looked at.
const LOOKED_AT: usize = 8;

/// Recovers samples spread over the record, and tests the wanted loads, the gauges and the intervals.
pub(super) fn recover_tested_samples(
    work: &mut Work,
    task: &Task,
    s: &Sensitivity,
    readings: Vec<Readings>,
) -> Recovery {
    let fields = task.prepared.fields.as_ref();
    let mut others = || alternative_rows(work, task.job, fields, &s.gauges);
    recover_samples_with_alternatives(s, readings, task.errors, (Vec::new(), &mut others))
}

/// Recovers quasi-static samples, each with its number, and tests loads, gauges and intervals. `doubt` is the covariance of their errors.
pub(super) fn recover_quasi_static_samples(
    task: &Task,
    s: &Sensitivity,
    readings: Vec<(usize, Readings)>,
    doubt: &ReadingCovariance,
) -> Recovery {
    let beyond = |(i, r): &(usize, Readings)| {
        let reads = |g: &usize| r.strain[*g].is_finite();
        let used: Vec<usize> = (0..r.strain.len()).filter(reads).collect();
        doubt.covariances_at(*i, &used)
    };
    let beyond = readings.iter().map(beyond).collect();
    let readings = readings.into_iter().map(|r| r.1).collect();
    recover_samples_with_alternatives(s, readings, task.errors, (beyond, &mut Vec::new))
}

/// Readings of samples spread over the record, less `zero`, each with the number of its sample.
///
/// # Errors
/// A piece that can't be read, a record without rows.
pub(super) fn spread_readings(
    task: &Task,
    record: &Record,
    zero: &[f64],
) -> Result<Vec<(usize, Readings)>, Faults> {
    spread((task.noise_factor, 1), record, zero)
}

/// Returns the readings of samples spread over the record, less `zero`, each with the number of its sample. `noise_factor`: noise variance of a
/// reading in units of the variance of a single reading. `apart`: number of samples after which noise is independent.
///
/// # Errors
/// See [`spread_readings`].
pub(super) fn spread(
    (noise_factor, apart): (f64, usize),
    record: &Record,
    zero: &[f64],
) -> Result<Vec<(usize, Readings)>, Faults> {
    let n = record.n_columns();
    let pieces = record.n_pieces();
    let mut readings: Vec<(usize, Readings)> = Vec::new();
    let spread = pieces.min(10);
    // A short record is tested on all of its samples, as if they were runs.
    let each = match pieces {
        1 => FULLY_TESTED_SAMPLES,
        _ => TESTED_SAMPLES.div_ceil(spread.max(1)),
    };
    for p in 0..spread {
        let piece = p * pieces / spread;
        let (times, values) = record.piece(piece).map_err(Faults::from)?;
        let first = record.first_of(piece);
        let take = times.len().min(TYPICAL);
        let row = |i: usize| values.get(i * n..(i + 1) * n).unwrap_or_default();
        // A gap has no readings to test.
        let reads = |i: &usize| row(*i).iter().any(|v| v.is_finite());
        let every = || (0..take).step_by(apart);
        let mut measured: Vec<usize> = every().filter(reads).collect();
        if measured.is_empty() {
            measured = (0..take).filter(reads).collect();
        }
        if measured.is_empty() {
            measured = every().collect();
        }
        let each = each.min(measured.len());
        for i in (0..each).map(|i| measured[i * measured.len() / each]) {
            let row = row(i);
            let strain = row.iter().zip(zero).map(|(v, z)| v - z).collect();
            let readings_of = Readings::of_sample(times[i], strain, noise_factor);
            readings.push((first + i, readings_of));
        }
    }
    if readings.is_empty() {
        return Err(Faults::from(Fault::with_line(
            record.file(),
            1,
            "rows",
            "a header and no rows",
            "write one row for each sample",
        )));
    }
    Ok(readings)
}

/// Adds a finding if the times of the record look like times in another unit.
///
/// # Errors
/// A piece that can't be read.
pub(super) fn check_times(work: &mut Work, record: &Record) -> Result<(), Faults> {
    if record.is_time_unit_open() {
        let (_, readings) = record.piece(0)?;
        let (_, step) = record.first_and_step();
        work.findings
            .extend(clock::check(step, &readings, record.n_columns()));
    }
    Ok(())
}

/// Returns the frequency content of the loads relative to the first elastic mode. Returns `None` if the frequency of this mode is not solved for
/// already.
///
/// # Errors
/// A piece that can't be read.
pub(super) fn content(
    work: &mut Work,
    task: &Task,
    (record, first_mode): (&Record, Option<f64>),
    filter: &Filter,
    names: &[String],
) -> Result<Option<Content>, Faults> {
    let fields = task.prepared.fields.as_ref();
    let first_mode = fields.and_then(|f| {
        f.first_mode
            .or(first_mode)
            .or_else(|| first_mode_of(work, task.job, &f.deck))
    });
    work.go_on()?;
    let (Some(first_elastic_mode_hz), Some(fields)) = (first_mode, fields) else {
        return Ok(None);
    };
    let held = structure(support_of_job(task.job, fields.model())?);
    let mut sigma = filter.sigma(&vec![0.0; filter.n_loads()]);
    if task.job.dynamic.is_some() {
        // The measured record also has noise outside of the band.
        let noise = task.errors.noise_variance(task.noise_factor).sqrt();
        for (l, s) in sigma.iter_mut().enumerate() {
            let weights = filter.gain_of_all_gauges().weights(l);
            *s = s.max(noise * weights.iter().map(|w| w * w).sum::<f64>().sqrt());
        }
    }
    let pieces = sampled_pieces(record, filter)?;
    let (_, step) = record.first_and_step();
    let rate = if step > 0.0 { 1.0 / step } else { 0.0 };
    let content_hz = content_of_loads(&pieces, &sigma, rate);
    // With [dynamic], the first mode that is not used is at three times the end of the band or higher. Content near this mode is beyond the band.
    work.findings.extend(match &task.job.dynamic {
        Some(dynamic) => check_band(names, &content_hz, dynamic.up_to_hz),
        None => check_content(names, &content_hz, first_elastic_mode_hz, &held),
    });
    Ok(Some(Content {
        first_elastic_mode_hz,
        content_hz,
    }))
}

/// Loads of some pieces spread over the record.
fn sampled_pieces(record: &Record, filter: &Filter) -> Result<Vec<Vec<f64>>, Fault> {
    let n = record.n_pieces();
    let taken = n.min(LOOKED_AT);
    (0..taken)
        .into_par_iter()
        .map(|i| block(record, filter, i * n / taken).map(|(b, _)| b.loads.values))
        .collect()
}
