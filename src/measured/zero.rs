//! Measured strain minus its zero, the same for every command that reads runs.
//!
//! The zero is a file's mean (`[measured] zero`), or the readings of the runs of `zero_runs`, at which no load acts. Between two of these runs, a
//! gauge's zero is linear over the rows of the file. It is constant before the first and after the last. The change of the zero from row to row is
//! estimated between these runs, and increases the noise of the readings.

use super::columns::{columns_of, gauges_without_strain, strain_without_gauge};
use super::common_zero::common_zero;
use super::faults::no_runs;
use super::means::is_long_record;
use super::means::read_strain_file;
use super::open::{MeasuredStrain, open};
use super::strain_file::{gauge_names, read_strain, wanted_columns, without_column};
use super::strain_table::{StrainRows, StrainTable};
use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::{HoldOut, Job, Measured, NamedFile};
use crate::recovery::{ErrorModel, Readings, reading_plausibility};
use crate::units::MICROSTRAIN;

/// A strain table after subtraction of its zero.
pub(crate) struct ZeroedTable {
    /// Table of net readings. A reading without a zero is NaN.
    pub table: StrainTable,
    /// Noise variance of each row's readings, relative to the noise variance of a single reading.
    pub noise_factor: Vec<f64>,
}

impl ZeroedTable {
    /// Returns the names of the runs.
    ///
    /// # Errors
    /// A fault if the strain file is a record, not a table of runs.
    pub fn runs(&self) -> Result<&[String], Faults> {
        match &self.table.rows {
            StrainRows::Runs(names) => Ok(names),
            StrainRows::Times(_) => Err(no_runs(&self.table.file).into()),
        }
    }

    /// Returns the readings of these gauges in each row, strain; NaN for a gauge without a column.
    pub fn readings(&self, gauges: &[String]) -> Vec<Readings> {
        let table = &self.table;
        let column = |g: &String| table.gauges.iter().position(|h| h == g);
        let columns: Vec<Option<usize>> = gauges.iter().map(column).collect();
        let of_row = |(i, noise_factor): (usize, &f64)| {
            let row = table.row(i);
            let reading = |c: &Option<usize>| c.and_then(|c| row.get(c)).copied();
            let strain = columns.iter().map(reading);
            Readings {
                run: match &table.rows {
                    StrainRows::Runs(names) => names.get(i).cloned().unwrap_or_default(),
                    StrainRows::Times(times) => {
                        times.get(i).map(f64::to_string).unwrap_or_default()
                    }
                },
                strain: strain
                    .map(|v| v.unwrap_or(f64::NAN) * MICROSTRAIN)
                    .collect(),
                noise_factor: *noise_factor,
            }
        };
        self.noise_factor.iter().enumerate().map(of_row).collect()
    }
}

/// Reads a strain file of the job and subtracts its zero.
///
/// # Errors
/// Faults of the files, a long record among them; zero runs that the table lacks.
pub(crate) fn read_zeroed(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    named: &NamedFile,
) -> Result<ZeroedTable, Faults> {
    let bytes = work.inputs.read_named(job, named)?;
    if is_long_record(&bytes) {
        return Err(no_runs(&named.given).into());
    }
    let wanted = wanted_columns(&mut work.inputs, job);
    let mut table = read_strain(&mut work.inputs, job, named, &wanted)?;
    note_columns(work, job, named, (&table.gauges, &wanted));
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
    Ok(ZeroedTable {
        table,
        noise_factor,
    })
}

/// Adds a warning of gauges without a column in a strain file, and a warning of columns that belong to no gauge. `wanted` are the requested columns.
pub(crate) fn note_columns(
    work: &mut Work,
    job: &Job,
    named: &NamedFile,
    (columns, wanted): (&[String], &[String]),
) {
    let silent = without_column(&mut work.inputs, job, columns);
    let silent: Vec<&str> = silent.iter().map(String::as_str).collect();
    let unknown = columns.iter().filter(|g| !wanted.contains(g));
    let unknown: Vec<&str> = unknown.map(String::as_str).collect();
    let finding = gauges_without_strain(named, &silent, &unknown);
    work.findings.extend(finding);
    let gauges = gauge_names(&mut work.inputs, job);
    if gauges.is_empty() {
        return;
    }
    let of_file = format!("`{}`: ", named.given);
    let finding = strain_without_gauge(&of_file, columns, &gauges);
    let new = finding.filter(|f| !work.findings.contains(f));
    work.findings.extend(new);
}

/// Returns readings after subtraction of their zero, tested as `recover` tests its readings. Readings that are not strain become missing. Findings
/// report them, with one finding for equal gauges.
pub(crate) fn subtract_and_test_zero(
    work: &mut Work,
    measured: &Measured,
    gauges: &[String],
    readings: &[Readings],
) -> Vec<Readings> {
    let errors = ErrorModel {
        noise: measured.noise_microstrain * MICROSTRAIN,
        model_rel: 0.0,
    };
    let (kept, findings) = reading_plausibility::check(gauges, readings, errors);
    for finding in findings {
        let said = |f: &Finding| f.code == finding.code && f.subject == finding.subject;
        if !work.findings.iter().any(said) {
            work.findings.push(finding);
        }
    }
    kept
}

/// Returns whether readings are strain according to the job: with a model or a given S. Readings for a calibration alone may be any signal.
pub(crate) fn reads_strain(job: &Job) -> bool {
    job.model.is_some() || job.sensitivity.is_some()
}

/// Tests readings like [`subtract_and_test_zero`], for a job that may have no S yet. Readings are then compared only with their noise.
pub(crate) fn test_calibration_readings(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    gauges: &[String],
    readings: Vec<Readings>,
) -> Vec<Readings> {
    if reads_strain(job) {
        return subtract_and_test_zero(work, measured, gauges, &readings);
    }
    let errors = ErrorModel {
        noise: measured.noise_microstrain * MICROSTRAIN,
        model_rel: 0.0,
    };
    work.findings
        .extend(reading_plausibility::check_signal(&readings, errors));
    readings
}

/// Checks that at least one reading is left.
///
/// # Errors
/// One fault if no reading is left.
pub(crate) fn some_left(file: &str, readings: &[Readings]) -> Result<(), Faults> {
    let mut all = readings.iter().flat_map(|r| &r.strain);
    if all.any(|v| v.is_finite()) {
        return Ok(());
    }
    Err(Fault::new(
        file,
        "strain",
        "no gauge of the job has a reading in the range of strain",
        "state readings in microstrain (strain times 1e6), one column for each gauge",
    )
    .into())
}

/// Returns the zero readings, strain by gauge, plus the common zero of a calibration with an intercept. The second value is the effective number of
/// samples. Without a file, the result is the common zero and `None`. A gauge that the file does not contain has NaN and is left out.
pub(crate) fn zero_of(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    gauges: &[String],
) -> Result<(Vec<f64>, Option<f64>), Faults> {
    let common = common_zero(work, job, gauges)?;
    let Some(named) = &measured.zero else {
        return Ok((common, None));
    };
    let wanted = wanted_columns(&mut work.inputs, job);
    let file = read_strain_file(&mut work.inputs, job, named, &wanted)?;
    let columns = columns_of(work, named, file.gauges(), gauges);
    let readings = file.readings();
    let mut effective = f64::INFINITY;
    let mut zero = vec![f64::NAN; gauges.len()];
    for ((z, c), of_common) in zero.iter_mut().zip(&columns).zip(common) {
        let series = c.and_then(|c| readings.get(c));
        if let Some((series, mean)) = series.and_then(|s| Some((s, s.mean()?))) {
            *z = mean * MICROSTRAIN + of_common;
            effective = effective.min(series.effective_samples());
        }
    }
    Ok((zero, effective.is_finite().then_some(effective)))
}

/// The zero that belongs to each row of a table.
pub(crate) struct RowZeros {
    /// Zero of each row and column of the table, microstrain.
    pub zero: Vec<Vec<f64>>,
    /// Noise variance of each row's readings minus zero, relative to the noise variance of a single reading.
    pub noise_factor: Vec<f64>,
}

/// Reports runs of `hold_out` that the strain file lacks; every command that reads its runs reports them in this way.
fn held_out_runs(job: &Job, measured: &Measured, table: &StrainTable) -> Result<(), Faults> {
    let (HoldOut::Runs(names), StrainRows::Runs(runs)) = (&measured.hold_out, &table.rows) else {
        return Ok(());
    };
    let unknown: FaultList = names
        .iter()
        .filter(|n| !runs.contains(n))
        .map(|n| {
            Fault::with_line(
                &*job.file,
                measured.line,
                "measured.hold_out",
                format!("`{}` does not contain run `{n}`", table.file),
                "name runs of the strain file",
            )
        })
        .collect();
    Faults::check(unknown)
}

/// Computes the zeros of all rows from the runs of `zero_runs`. `None` if the job has no `zero_runs`.
///
/// A run of `zero_runs` itself gets its zero from the other runs of `zero_runs`, so that its loads show how well the zero was followed.
///
/// # Errors
/// Runs that the table lacks, including runs of `hold_out`; rows that are samples.
pub(crate) fn zeros_by_row(
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
    let drift = Drift::from_zero_runs(table, &at, measured.noise_microstrain);
    let step = (drift.walk + drift.steady).sqrt();
    let noise = measured.noise_microstrain * measured.noise_microstrain;
    let (mut zero, mut noise_factor) = (Vec::new(), Vec::new());
    for i in 0..names.len() {
        let others: Vec<usize> = at.iter().copied().filter(|a| *a != i).collect();
        let ZeroWeights {
            weights,
            wander,
            outside,
        } = zero_run_weights(if others.is_empty() { &at } else { &others }, i);
        let of = |g: usize| -> f64 {
            let parts = weights.iter().map(|(a, w)| w * table.row(*a)[g]);
            parts.sum()
        };
        zero.push((0..table.gauges.len()).map(of).collect());
        let of_zero: f64 = weights.iter().map(|(_, w)| w * w).sum();
        let gone = drift.steady * (outside * outside);
        noise_factor.push(1.0 + of_zero + (drift.walk * wander + gone) / noise);
    }
    work.findings.push(
        Finding::new(
            Severity::Info,
            "zero-followed",
            "measured.zero_runs",
            format!(
                "the zero is interpolated between {} runs without load; it changes by {:.2} microstrain from run to run (rms over gauges)",
                at.len(),
                step
            ),
            "",
        )
        .with_numbers(step, measured.noise_microstrain),
    );
    Ok(Some(RowZeros { zero, noise_factor }))
}

/// Returns the rows of the runs of `zero_runs`. If runs are held out in a separate file, each file needs at least one of these runs. The drift of a
/// zero between two files is unknown.
///
/// # Errors
/// Runs that no file contains; a file without any of these runs.
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
        for other in both.into_iter().filter(|f| f.given != table.file) {
            if let MeasuredStrain::Runs(other) = open(&mut work.inputs, job, measured, other)? {
                known.extend_from_slice(other.runs());
            }
        }
    }
    let fault = |wrong: String, remedy: &str| {
        Fault::with_line(
            &*job.file,
            measured.line,
            "measured.zero_runs",
            wrong,
            remedy,
        )
    };
    let missing = measured.zero_runs.iter().filter(|r| !known.contains(r));
    let remedy = "name runs without load";
    let faults: FaultList = missing
        .map(|run| fault(format!("{files} run `{run}`"), remedy))
        .collect();
    Faults::check(faults)?;
    let place = |run: &String| names.iter().position(|n| n == run);
    let at: Vec<usize> = measured.zero_runs.iter().filter_map(place).collect();
    if at.is_empty() {
        let wrong = format!("`{}` contains none of these runs", table.file);
        let remedy = "add a run without load that was measured together with its runs, and name it here too; or move its runs into the strain file and name them in `hold_out`";
        return Err(fault(wrong, remedy).into());
    }
    Ok(at)
}

/// Refuses `zero_runs` for a record, which has no runs.
///
/// # Errors
/// `zero_runs` of a job whose strain is a record.
pub(crate) fn no_zero_runs(job: &Job, measured: &Measured, file: &str) -> Result<(), Faults> {
    if measured.zero_runs.is_empty() {
        return Ok(());
    }
    Err(Fault::with_line(
        &*job.file,
        measured.line,
        "measured.zero_runs",
        format!("`{file}` is a record and has no runs"),
        "name a zero file: zero = \"zero.csv\"",
    )
    .into())
}

/// Rows whose readings give a zero, with their weights, and the variance of a random walk there relative to the variance of one step.
struct ZeroWeights {
    weights: Vec<(usize, f64)>,
    wander: f64,
    /// Steps over which a steady drift goes on unseen: none between two rows.
    outside: f64,
}

fn zero_run_weights(at: &[usize], i: usize) -> ZeroWeights {
    let after = at.partition_point(|a| *a < i);
    let steps = |a: usize| (i as f64 - a as f64).abs();
    match (after.checked_sub(1).and_then(|b| at.get(b)), at.get(after)) {
        (Some(&a), Some(&b)) => {
            let (from, to) = (steps(a), steps(b));
            let w = from / (from + to);
            ZeroWeights {
                weights: vec![(a, 1.0 - w), (b, w)],
                wander: from * to / (from + to),
                outside: 0.0,
            }
        }
        (Some(&a), None) | (None, Some(&a)) => ZeroWeights {
            weights: vec![(a, 1.0)],
            wander: steps(a),
            outside: steps(a),
        },
        (None, None) => ZeroWeights {
            weights: Vec::new(),
            wander: 0.0,
            outside: 0.0,
        },
    }
}

/// Change of zeros from one row to the next: mean squares over gauges, microstrain^2.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Drift {
    /// Variance of a walk.
    walk: f64,
    /// Square of a steady change, which a straight line between two zeros follows; 0 if two zeros alone do not distinguish it from a walk.
    steady: f64,
}

impl Drift {
    /// From the differences between one zero run and the next, `d_j` over `t_j` rows, of which noise makes `2 s^2`.
    ///
    /// A steady change is `u = sum d_j / T`, `T = sum t_j`; the remainder is a walk: `E (d_j - u t_j)^2 = walk (t_j - t_j^2 / T) + s^2 (2 - 2 (t_j /
    /// T) e_j + 2 (t_j / T)^2)`, `e_j` how many ends of the whole stretch the difference has, and `E u^2 = steady + walk / T + 2 s^2 / T^2`.
    fn from_zero_runs(table: &StrainTable, at: &[usize], noise: f64) -> Self {
        let noise = noise * noise;
        let (mut walk, mut free) = (0.0, 0.0);
        let mut slopes = Vec::new();
        // Sum and count for gauges with a single difference.
        let (mut alone, mut count) = (0.0, 0.0);
        for g in 0..table.gauges.len() {
            let read = |a: &usize| Some((*a as f64, table.row(*a).get(g).copied()?));
            let zeros: Vec<(f64, f64)> = (at.iter().filter_map(read))
                .filter(|z| z.1.is_finite())
                .collect();
            let steps: Vec<(f64, f64)> = zeros
                .windows(2)
                .map(|z| (z[1].0 - z[0].0, z[1].1 - z[0].1))
                .collect();
            let total: f64 = steps.iter().map(|s| s.0).sum();
            if steps.len() < 2 {
                for (t, d) in steps {
                    alone += (d * d - 2.0 * noise) / t;
                    count += 1.0;
                }
                continue;
            }
            let slope = steps.iter().map(|s| s.1).sum::<f64>() / total;
            for (j, (t, d)) in steps.iter().enumerate() {
                let share = t / total;
                let ends = f64::from(u8::from(j == 0)) + f64::from(u8::from(j + 1 == steps.len()));
                let of_noise = noise * (2.0 - 2.0 * share * ends + 2.0 * share * share);
                walk += ((d - slope * t).powi(2) - of_noise) / t;
                free += 1.0 - share;
            }
            slopes.push((slope, total));
        }
        if free <= 0.0 {
            let walk = if count > 0.0 {
                (alone / count).max(0.0)
            } else {
                0.0
            };
            return Self { walk, steady: 0.0 };
        }
        let walk = (walk / free).max(0.0);
        let squares = slopes
            .iter()
            .map(|(u, total)| u * u - walk / total - 2.0 * noise / (total * total));
        Self {
            walk,
            steady: (squares.sum::<f64>() / slopes.len() as f64).max(0.0),
        }
    }
}

#[cfg(test)]
mod tests;
