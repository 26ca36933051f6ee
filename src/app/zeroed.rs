//! Measured strain less its zero: one answer for every command that reads runs.
//!
//! The zero is a file's mean (`[measured] zero`), or what the runs of `zero_runs` read, at which no load acts: between two of them a
//! gauge's zero is taken as straight over the rows of the file, before the first and after the last as constant. How far it wanders from
//! row to row is seen between them, and the readings count with that much more noise.

use super::fault::{Fault, FaultList, Faults};
use super::job::strain::{StrainRows, StrainTable, read_strain, wanted_columns};
use super::job::strain_means::is_long_record;
use super::job::{HoldOut, Job, Measured, NamedFile};
use super::recover::zero_of;
use super::work::Work;
use crate::finding::{Finding, Severity};
use crate::recovery::{ErrorModel, Readings, plausible};
use crate::units::MICROSTRAIN;

/// A strain table less its zero.
pub(super) struct Zeroed {
    /// A reading without a zero is not a number.
    pub table: StrainTable,
    /// Noise variance of each row's readings, in units of that of a single one.
    pub noise_factor: Vec<f64>,
}

/// A strain file of the job less its zero.
///
/// # Errors
/// Faults of the files, a long record among them; zero runs that the table lacks.
pub(super) fn read_zeroed(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    named: &NamedFile,
) -> Result<Zeroed, Faults> {
    let bytes = work.inputs.read_named(job, named)?;
    if is_long_record(&bytes) {
        return Err(Fault::of(
            &*named.given,
            "run",
            "rows are samples of one record",
            "give the means of static runs, a row each, with a column `run`",
        )
        .into());
    }
    let wanted = wanted_columns(&mut work.inputs, job);
    let mut table = read_strain(&mut work.inputs, job, named, &wanted)?;
    let (zero, effective) = zero_of(work, job, measured, &table.gauges)?;
    let own = 1.0 + effective.map_or(0.0, |n| 1.0 / n);
    let rows = zeros_by_row(work, job, measured, &table)?;
    let width = table.gauges.len().max(1);
    for (i, row) in table.microstrain.chunks_exact_mut(width).enumerate() {
        for (g, v) in row.iter_mut().enumerate() {
            *v -= zero[g] / MICROSTRAIN + rows.as_ref().map_or(0.0, |z| z.zero[i][g]);
        }
    }
    let noise_factor = match rows {
        Some(z) => z.noise_factor,
        None => vec![own; table.n_rows()],
    };
    Ok(Zeroed {
        table,
        noise_factor,
    })
}

/// Readings less their zero, judged as `recover` judges its own: what is no strain becomes no reading, and findings say so, once of the
/// same gauges.
pub(super) fn judged(
    work: &mut Work,
    measured: &Measured,
    gauges: &[String],
    readings: &[Readings],
) -> Vec<Readings> {
    let errors = ErrorModel {
        noise: measured.noise_microstrain * MICROSTRAIN,
        model_rel: 0.0,
    };
    let (kept, findings) = plausible::check(gauges, readings, errors);
    for finding in findings {
        let said = |f: &Finding| f.code == finding.code && f.subject == finding.subject;
        if !work.findings.iter().any(said) {
            work.findings.push(finding);
        }
    }
    kept
}

/// Whether any reading is left to learn from.
///
/// # Errors
/// One fault where there is none.
pub(super) fn some_left(file: &str, readings: &[Readings]) -> Result<(), Faults> {
    let mut all = readings.iter().flat_map(|r| &r.strain);
    if all.any(|v| v.is_finite()) {
        return Ok(());
    }
    Err(Fault::of(
        file,
        "strain",
        "no gauge of the job has a reading that is strain",
        "state readings in microstrain (strain times 1e6), a column a gauge",
    )
    .into())
}

/// The zero that belongs to each row of a table.
pub(super) struct RowZeros {
    /// Microstrain by row and column of the table.
    pub zero: Vec<Vec<f64>>,
    /// Noise variance of each row's readings less zero, in units of that of a single one.
    pub noise_factor: Vec<f64>,
}

/// Runs of `hold_out` that the strain file lacks, as every command that reads its runs says.
fn held_out_runs(job: &Job, measured: &Measured, table: &StrainTable) -> Result<(), Faults> {
    let (HoldOut::Runs(names), StrainRows::Runs(runs)) = (&measured.hold_out, &table.rows) else {
        return Ok(());
    };
    let unknown: FaultList = names
        .iter()
        .filter(|n| !runs.contains(n))
        .map(|n| {
            Fault::at(
                &*job.file,
                measured.line,
                "measured.hold_out",
                format!("`{}` has no run `{n}`", table.file),
                "name runs of the strain file",
            )
        })
        .collect();
    Faults::check(unknown)
}

/// Zeros from the runs of `zero_runs`; `None` where the job names none.
///
/// A run of `zero_runs` itself gets its zero from the others, so that its loads show how well the zero was followed.
///
/// # Errors
/// Runs that the table lacks, those of `hold_out` among them; rows that are samples.
pub(super) fn zeros_by_row(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    table: &StrainTable,
) -> Result<Option<RowZeros>, Faults> {
    held_out_runs(job, measured, table)?;
    if measured.zero_runs.is_empty() {
        return Ok(None);
    }
    let StrainRows::Runs(names) = &table.rows else {
        no_zero_runs(job, measured, &table.file)?;
        return Ok(None);
    };
    let mut at = zero_rows(work, job, measured, table, names)?;
    at.sort_unstable();
    at.dedup();
    let drift = drift_variance(table, &at, measured.noise_microstrain);
    let noise = measured.noise_microstrain * measured.noise_microstrain;
    let (mut zero, mut noise_factor) = (Vec::new(), Vec::new());
    for i in 0..names.len() {
        let others: Vec<usize> = at.iter().copied().filter(|a| *a != i).collect();
        let Between { weights, wander } = between(if others.is_empty() { &at } else { &others }, i);
        let of = |g: usize| -> f64 {
            let parts = weights.iter().map(|(a, w)| w * table.row(*a)[g]);
            parts.sum()
        };
        zero.push((0..table.gauges.len()).map(of).collect());
        let of_zero: f64 = weights.iter().map(|(_, w)| w * w).sum();
        noise_factor.push(1.0 + of_zero + drift * wander / noise);
    }
    work.findings.push(
        Finding::new(
            Severity::Info,
            "zero-followed",
            "measured.zero_runs",
            format!(
                "the zero is followed through {} runs without load; it wanders by {:.2} microstrain from run to run (rms over gauges)",
                at.len(),
                drift.sqrt()
            ),
            "",
        )
        .with_numbers(drift.sqrt(), measured.noise_microstrain),
    );
    Ok(Some(RowZeros { zero, noise_factor }))
}

/// Rows of the runs of `zero_runs`. Where runs are held out in a file of their own, its zeros are its own: between two files nothing says
/// how far a zero has wandered, so each needs one of these runs at least.
///
/// # Errors
/// Runs that no file has, a file without any.
fn zero_rows(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    table: &StrainTable,
    names: &[String],
) -> Result<Vec<usize>, Faults> {
    let mut known = names.to_vec();
    let mut files = format!("`{}` has no", table.file);
    if let HoldOut::File(hold_out) = &measured.hold_out
        && measured.zero_runs.iter().any(|r| !names.contains(r))
    {
        let both = [&measured.strain, hold_out];
        files = format!("neither `{}` nor `{}` has a", both[0].given, both[1].given);
        let wanted = wanted_columns(&mut work.inputs, job);
        for other in both.into_iter().filter(|f| f.given != table.file) {
            let other = read_strain(&mut work.inputs, job, other, &wanted)?;
            if let StrainRows::Runs(runs) = other.rows {
                known.extend(runs);
            }
        }
    }
    let fault = |wrong: String, remedy: &str| {
        Fault::at(
            &*job.file,
            measured.line,
            "measured.zero_runs",
            wrong,
            remedy,
        )
    };
    let missing = measured.zero_runs.iter().filter(|r| !known.contains(r));
    let remedy = "name runs at which no load acts";
    let faults: FaultList = missing
        .map(|run| fault(format!("{files} run `{run}`"), remedy))
        .collect();
    Faults::check(faults)?;
    let place = |run: &String| names.iter().position(|n| n == run);
    let at: Vec<usize> = measured.zero_runs.iter().filter_map(place).collect();
    if at.is_empty() {
        let wrong = format!("`{}` has none of these runs", table.file);
        let remedy = "add to it a run without load, measured beside its runs, and name that run here too; or move its runs into the strain file and name them in `hold_out`";
        return Err(fault(wrong, remedy).into());
    }
    Ok(at)
}

/// A record has no runs.
///
/// # Errors
/// `zero_runs` of a job whose strain is a record.
pub(super) fn no_zero_runs(job: &Job, measured: &Measured, file: &str) -> Result<(), Faults> {
    if measured.zero_runs.is_empty() {
        return Ok(());
    }
    Err(Fault::at(
        &*job.file,
        measured.line,
        "measured.zero_runs",
        format!("`{file}` is a record and has no runs"),
        "name a zero file: zero = \"zero.csv\"",
    )
    .into())
}

/// Rows whose readings make a zero, with their weights, and the variance of a walk there in units of that of one step.
struct Between {
    weights: Vec<(usize, f64)>,
    wander: f64,
}

fn between(at: &[usize], i: usize) -> Between {
    let after = at.partition_point(|a| *a < i);
    let steps = |a: usize| (i as f64 - a as f64).abs();
    match (after.checked_sub(1).and_then(|b| at.get(b)), at.get(after)) {
        (Some(&a), Some(&b)) => {
            let (from, to) = (steps(a), steps(b));
            let w = from / (from + to);
            Between {
                weights: vec![(a, 1.0 - w), (b, w)],
                wander: from * to / (from + to),
            }
        }
        (Some(&a), None) | (None, Some(&a)) => Between {
            weights: vec![(a, 1.0)],
            wander: steps(a),
        },
        (None, None) => Between {
            weights: Vec::new(),
            wander: 0.0,
        },
    }
}

/// Variance of a gauge's zero from one row to the next, mean over gauges, microstrain^2: differences between one zero run and the next less
/// what their noise makes.
fn drift_variance(table: &StrainTable, at: &[usize], noise: f64) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for pair in at.windows(2) {
        let rows = table.row(pair[0]).iter().zip(table.row(pair[1]));
        for (a, b) in rows.filter(|(a, b)| a.is_finite() && b.is_finite()) {
            sum += ((b - a).powi(2) - 2.0 * noise * noise) / (pair[1] - pair[0]) as f64;
            count += 1.0;
        }
    }
    if count > 0.0 {
        (sum / count).max(0.0)
    } else {
        0.0
    }
}
