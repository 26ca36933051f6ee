//! What runs and records share: measured strain, S, zero and reference, stated errors.

use crate::app::fault::{Fault, Faults};
use crate::app::job::strain::wanted_columns;
use crate::app::job::strain_means::read_strain_file;
use crate::app::job::suggest;
use crate::app::job::{Job, Measured, NamedFile, Reference};
use crate::app::solved::stands_on_wheels;
use crate::app::strain::{Prepared, stated_errors};
use crate::app::wheels::{floor_fault, wheels_of};
use crate::app::work::Work;
use crate::fe::floor::solve_standing;
use crate::finding::{Finding, Severity, few};
use crate::gauge::reading;
use crate::model::Model;
use crate::recovery::ErrorModel;
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;
use std::collections::{HashMap, HashSet};

/// What runs and records share.
pub(super) struct Task<'a> {
    pub job: &'a Job,
    pub measured: &'a Measured,
    pub prepared: &'a Prepared,
    pub errors: ErrorModel,
    /// Strain subtracted from readings, by gauge of S.
    pub zero: Vec<f64>,
    /// Rows of S from which loads are estimated.
    pub estimating: Vec<usize>,
    /// Rows of S of the gauges that the estimate is compared with.
    pub validation: Vec<usize>,
    /// Noise variance of a reading less zero, in units of that of a reading.
    pub noise_factor: f64,
}

/// `[measured]` of a job.
pub(super) fn measured_of(job: &Job) -> Result<&Measured, Faults> {
    job.measured.as_ref().ok_or_else(|| {
        Faults::from(Fault::of(
            &*job.file,
            "measured",
            "the job has no [measured]",
            "name the strain file: [measured] strain = \"strain.csv\"",
        ))
    })
}

/// Says that loads are changes, where no reference is stated.
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

/// What runs and records share: zero, reference, stated errors.
pub(super) fn task_of<'a>(
    work: &mut Work,
    job: &'a Job,
    measured: &'a Measured,
    prepared: &'a Prepared,
) -> Result<Task<'a>, Faults> {
    let mut task = without_reference(work, job, measured, prepared)?;
    let reference = reference_strain(job, measured, prepared)?;
    for (z, r) in task.zero.iter_mut().zip(reference) {
        *z -= r;
    }
    Ok(task)
}

/// The same, the strain of the reference state left out of the readings.
pub(super) fn without_reference<'a>(
    work: &mut Work,
    job: &'a Job,
    measured: &'a Measured,
    prepared: &'a Prepared,
) -> Result<Task<'a>, Faults> {
    let (zero, n_zero) = zero_of(work, job, measured, &prepared.sensitivity.gauges)?;
    if !measured.states_noise {
        work.findings.push(Finding::new(
            Severity::Info,
            "noise-assumed",
            "measured.noise_microstrain",
            format!(
                "the job does not say how much readings scatter: {} microstrain (1 sd) is taken, and all intervals rest on it",
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

/// Where a gauge's column stands; `None`: it has none.
pub(super) fn columns_of(
    work: &mut Work,
    named: &NamedFile,
    header: &[String],
    gauges: &[String],
) -> Vec<Option<usize>> {
    let columns = columns_of_gauges(header, gauges);
    let silent = gauges.iter().zip(&columns).filter(|(_, c)| c.is_none());
    let silent: Vec<&str> = silent.map(|(g, _)| g.as_str()).collect();
    let unknown = unknown_columns(header, gauges);
    work.findings
        .extend(gauges_without_strain(named, &silent, &unknown));
    let of_file = format!("`{}`: ", named.given);
    work.findings
        .extend(strain_without_gauge(&of_file, header, gauges));
    columns
}

/// Returns where each gauge's column is; `None`: it has none.
pub(super) fn columns_of_gauges(header: &[String], gauges: &[String]) -> Vec<Option<usize>> {
    let places: HashMap<&String, usize> =
        header.iter().rev().zip((0..header.len()).rev()).collect();
    gauges.iter().map(|g| places.get(g).copied()).collect()
}

/// A warning of gauges that a file of strain has no column of; `unknown` are its columns that belong to no gauge.
pub(in crate::app) fn gauges_without_strain(
    named: &NamedFile,
    silent: &[&str],
    unknown: &[&str],
) -> Option<Finding> {
    let of_file = format!("`{}`: ", named.given);
    (!silent.is_empty()).then(|| gauge_without_column(&of_file, silent, unknown))
}

/// Returns the warning of gauges without a column; `of_file` goes before its message.
pub(in crate::app) fn gauge_without_column(
    of_file: &str,
    silent: &[&str],
    unknown: &[&str],
) -> Finding {
    Finding::new(
        Severity::Warning,
        "gauge-without-strain",
        few(silent),
        format!("{of_file}gauges without a column are left out"),
        suggest::column_remedy(silent, unknown),
    )
}

pub(in crate::app) fn unknown_columns<'a>(header: &'a [String], gauges: &[String]) -> Vec<&'a str> {
    let known: HashSet<&String> = gauges.iter().collect();
    let unknown = header.iter().filter(|h| !known.contains(h));
    unknown.map(String::as_str).collect()
}

/// A warning of columns of strain that S has no row for; `of_file` goes before its message.
pub(in crate::app) fn strain_without_gauge(
    of_file: &str,
    header: &[String],
    gauges: &[String],
) -> Option<Finding> {
    let unknown = unknown_columns(header, gauges);
    (!unknown.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "strain-without-gauge",
            few(&unknown),
            format!("{of_file}columns that belong to no gauge are left out"),
            "add the gauges, or drop the columns",
        )
    })
}

/// The zero readings, strain by gauge, and the effective number of samples behind them; zeros and `None` without a file. Not a number for a
/// gauge that the file says nothing of: its readings have no zero, and it is left out.
pub(in crate::app) fn zero_of(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    gauges: &[String],
) -> Result<(Vec<f64>, Option<f64>), Faults> {
    let Some(named) = &measured.zero else {
        return Ok((vec![0.0; gauges.len()], None));
    };
    let wanted = wanted_columns(&mut work.inputs, job);
    let file = read_strain_file(&mut work.inputs, job, named, &wanted)?;
    let columns = columns_of(work, named, file.gauges(), gauges);
    let readings = file.readings();
    let mut effective = f64::INFINITY;
    let mut zero = vec![f64::NAN; gauges.len()];
    for (z, c) in zero.iter_mut().zip(&columns) {
        let series = c.and_then(|c| readings.get(c));
        if let Some((series, mean)) = series.and_then(|s| Some((s, s.mean()?))) {
            *z = mean * MICROSTRAIN;
            effective = effective.min(series.effective_samples());
        }
    }
    Ok((zero, effective.is_finite().then_some(effective)))
}

/// Strain of the reference state by gauge: it is added to the readings, so that loads are totals.
pub(in crate::app) fn reference_strain(
    job: &Job,
    measured: &Measured,
    prepared: &Prepared,
) -> Result<Vec<f64>, Faults> {
    let n = prepared.sensitivity.gauges.len();
    let fault = |wrong: String, remedy: &str| {
        Faults::from(Fault::at(
            &*job.file,
            measured.line,
            "measured.reference",
            wrong,
            remedy,
        ))
    };
    match (measured.reference, &prepared.fields) {
        (Reference::None, _) => Ok(vec![0.0; n]),
        (Reference::Subcase(id), Some(fields)) => {
            let case = fields.subcase(id).ok_or_else(|| match fields.is_solved_here() {
                true => fault(
                    format!("the deck has no static subcase {id} with a load, and there are no results"),
                    "name a subcase of the deck: the state in which the gauges read zero",
                ),
                false => fault(
                    format!("the results have no subcase {id}"),
                    "name the subcase of the reference state",
                ),
            })?;
            prepared
                .gauges
                .iter()
                .map(|g| {
                    reading(g, case).ok_or_else(|| {
                        fault(
                            format!("gauge `{}` has no strain in subcase {id}", g.name),
                            "ask for STRAIN of its element there",
                        )
                    })
                })
                .collect()
        }
        (Reference::Gravity, Some(fields)) => Ok(standing_strain(job, fields.model(), prepared)?),
        (_, None) => Err(fault(
            "a given S has no subcases and no weight".to_owned(),
            "write reference = \"none\", or give a [model] instead of [sensitivity]",
        )),
    }
}

/// Strain by gauge of the model standing on its wheels under its own weight: `S R`, `R` the reactions at the job's wheels on a flat floor.
/// A free structure that gravity and its reactions hold in balance is strained by the reactions with their inertia relief alone.
fn standing_strain(job: &Job, model: &Model, prepared: &Prepared) -> Result<Vec<f64>, Faults> {
    stands_on_wheels(job, model, "the reference \"gravity\"")?;
    let wheels = wheels_of(job, model)?;
    let standing = solve_standing(model, wheels.axis, &wheels.grids, &[], None)
        .map_err(|e| floor_fault(job, &e))?;
    let reactions = standing.under_weight(model, job.gravity());
    let s = &prepared.sensitivity;
    Ok((0..s.gauges.len())
        .map(|g| {
            let by_wheel = wheels.loads.iter().zip(&reactions);
            by_wheel
                .filter_map(|(l, r)| {
                    let name = &job.loads.get(*l)?.name;
                    let column = s.loads.iter().position(|c| c.name == *name)?;
                    Some(s.values[(g, column)] * r)
                })
                .sum()
        })
        .collect())
}
