//! `recover`: loads from measured strain.
//!
//! [`runs`] static states, a row each; [`stream`] records of any length and format ([`crate::series::record`]), at constant memory;
//! [`derived`] what else is made of the loads.

mod answer;
mod combined;
mod content;
mod derived;
mod history_files;
mod known_payload;
mod record;
mod runs;
mod stream;
mod trace;

pub use answer::{GaugeResidual, RecoveredLoad, RecoveredRuns, RunFit};

use super::context::Context;
use super::fault::{Fault, Faults};
use super::job::{self, Job, Measured, Reference};
use super::outcome::{Outcome, StatedUnits};
use super::solved::stands_on_wheels;
use super::strain::{Prepared, prepare};
use super::wheels::{floor_fault, wheels_of};
use super::work::Work;
use super::{JobArguments, Session};
use crate::fe::floor::solve_standing;
use crate::finding::{Finding, Severity};
use crate::gauge::reading;
use crate::model::Model;
use crate::recovery::{ErrorModel, Readings, Recovery};
use crate::sensitivity::check_separability;
use crate::series::record::csv::Layout;
use crate::series::record::is_format;
use crate::units::MICROSTRAIN;

/// What runs and records share.
struct Task<'a> {
    job: &'a Job,
    measured: &'a Measured,
    prepared: &'a Prepared,
    errors: ErrorModel,
    /// Strain subtracted from readings, by gauge of S.
    zero: Vec<f64>,
    /// Noise variance of a reading less zero, in units of that of a reading.
    noise_factor: f64,
}

/// Loads of the static runs of a job with their intervals.
///
/// # Errors
/// Every fault of the job and of what it names; a record, whose loads are written as they come (`run`).
pub fn recover_runs(job: &Job, cx: &Context) -> Result<Outcome<RecoveredRuns>, Faults> {
    let mut work = Work::of_job(cx, job);
    let measured = measured_of(job)?;
    let prepared = prepare(&mut work, job)?;
    let s = &prepared.sensitivity;
    work.findings.extend(check_separability(s));
    let task = task_of(&mut work, job, measured, &prepared)?;
    work.findings.extend(changes(measured));
    let (_, recovery, listed) = runs::listed_runs(&mut work, &task)?;
    let answer = RecoveredRuns::of(s, &recovery, &listed.units);
    Ok(work.finish(StatedUnits::of(job.units, &job.report_units), answer))
}

/// `[measured]` of a job.
fn measured_of(job: &Job) -> Result<&Measured, Faults> {
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
fn changes(measured: &Measured) -> Option<Finding> {
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

/// Reads, recovers, writes `loads.csv` and the report.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read job", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &job.report_units);
    let measured = measured_of(&job)?;
    let prepared = prepare(session, &job)?;
    session.put_conditioning(&prepared.sensitivity)?;
    let task = task_of(session, &job, measured, &prepared)?;
    session.findings.extend(changes(measured));
    let bytes = session
        .inputs
        .read_named(&job, &measured.strain)
        .map_err(Faults::from)?;
    if is_format(&bytes) || Layout::of(&bytes).is_ok_and(|l| l.is_record()) {
        session.stage("stream", |s| stream::run(s, arguments, &task, bytes))
    } else {
        runs::run(session, arguments, &task)
    }
}

/// What runs and records share: zero, reference, stated errors.
fn task_of<'a>(
    session: &mut Work,
    job: &'a Job,
    measured: &'a Measured,
    prepared: &'a Prepared,
) -> Result<Task<'a>, Faults> {
    let (mut zero, n_zero) = runs::zero_of(session, job, measured, &prepared.sensitivity.gauges)?;
    for (z, r) in zero
        .iter_mut()
        .zip(reference_strain(job, measured, prepared)?)
    {
        *z -= r;
    }
    Ok(Task {
        job,
        measured,
        prepared,
        errors: ErrorModel {
            noise: measured.noise_microstrain * MICROSTRAIN,
            model_rel: measured.model_uncertainty_rel,
        },
        zero,
        noise_factor: 1.0 + n_zero.map_or(0.0, |n| 1.0 / n),
    })
}

/// Readings and recovered loads of the job's static runs, for commands that go on from there.
///
/// # Errors
/// Unreadable tables; a record, which `recover` streams.
pub(super) fn recovered_runs(
    session: &mut Work,
    job: &Job,
    measured: &Measured,
    prepared: &Prepared,
) -> Result<(Vec<Readings>, Recovery), Faults> {
    let task = task_of(session, job, measured, prepared)?;
    runs::solve(session, &task)
}

/// Strain of the reference state by gauge: it is added to the readings, so that loads are totals.
pub(super) fn reference_strain(
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
            let case = fields.subcase(id).ok_or_else(|| {
                fault(
                    format!("the results have no subcase {id}"),
                    "name the subcase of the reference state",
                )
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
    let reactions = standing.under_weight(model, job.units.standard_gravity());
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
