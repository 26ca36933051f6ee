//! `calibrate`: S from runs of known load, combined with the S of the model if there is one. It writes the job with which the other workflows use
//! this S.

mod checks;
mod installed_positions;
mod job_file;
mod known_loads;
mod outcome;
mod payloads;
mod reported_calibration;
mod run_selection;

pub use job_file::calibrated_job;
pub use outcome::*;

use crate::calibrate::{
    CommonZero, KnownRun, ModelPrior, Task, calibrate_installed_gauges, recover_checks,
};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::Work;
use crate::job::readings::stated_readings;
use crate::job::{Job, JobLoad, LoadRole, Measured, Reference, Runs, Terms};
use crate::linalg::Matrix;
use crate::measured::faults::no_gauge_column;
use crate::measured::strain_table::StrainTable;
use crate::measured::zero::{
    ZeroedTable, read_zeroed, reads_strain, some_left, test_calibration_readings,
};
use crate::recovery::Readings;
use crate::sensitivity::{Load, Sensitivity};
use crate::strain_chain::named_results::check_tables;
use crate::strain_chain::{JobSensitivity, given_as_asked, prepare, stated_noise};
use crate::units::MICROSTRAIN;
use crate::workflow::reconcile::redirect::text_of;
use crate::workflow::recover::list_load_columns;

/// Estimates S of the gauges of a job from runs with known loads. S of a model or of a table, if the job has one, is the prior.
///
/// # Errors
/// Returns every fault of the job and of the files that it names, or runs without known loads.
///
/// # Example
/// Readings that are exactly `eps = S f` give S back:
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, calibrate};
///
/// const JOB: &str = r#"
/// units = "m-kg-s"
/// load = [{ name = "front" }, { name = "rear" }]
/// measured = { strain = "strain.csv", noise_microstrain = 0.01 }
/// runs = { file = "runs.csv" }
/// "#;
/// let s = [[0.10, 0.02], [0.02, 0.10], [0.05, -0.05]]; // microstrain per newton
/// let loads = [[100.0, 0.0], [0.0, 100.0], [50.0, 80.0], [80.0, -50.0], [30.0, 60.0], [90.0, 40.0]];
/// # let (mut runs, mut strain) = ("run,front,rear\n".to_owned(), "run,G1,G2,G3\n".to_owned());
/// # for (r, f) in loads.iter().enumerate() {
/// #     let eps = s.map(|row: [f64; 2]| row[0] * f[0] + row[1] * f[1]);
/// #     runs += &format!("R{r},{},{}\n", f[0], f[1]);
/// #     strain += &format!("R{r},{},{},{}\n", eps[0], eps[1], eps[2]);
/// # }
/// let files = InMemory::default().with_file("job.toml", JOB).with_file("runs.csv", runs).with_file("strain.csv", strain);
/// let found = calibrate(&Job::read("job.toml", &files)?, &Context::new(&files))?;
/// for (g, row) in s.iter().enumerate() {
///     for (l, expected) in row.iter().enumerate() {
///         assert!((1e6 * found.sensitivity.values[(g, l)] - expected).abs() < 1e-4);
///     }
/// }
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn calibrate(job: &Job, cx: &Context) -> Result<Outcome<CalibratedSensitivity>, Faults> {
    let mut work = Work::of_job(cx, job);
    let job = &job.without_validation_gauges()?;
    check_tables(&work, job)?;
    let (measured, runs) = sections(job)?;
    let zeroed = work.stage("read strain", |w| strain_of_runs(w, job, measured))?;
    let (prepared, prior) = prior(&mut work, job, &zeroed.table)?;
    let s = &prepared.sensitivity;
    let listed = list_load_columns(job, s)?;
    let origin = payload_place(job, &prepared);
    let (known, strain) = read(&mut work, job, (measured, runs), &zeroed, s, origin)?;
    let names = zeroed.runs()?;
    let noise_factor = &zeroed.noise_factor;
    let prior_is_given = prior.is_some();
    let as_run = |k: &known_loads::LoadedRun| KnownRun {
        run: names[k.row].clone(),
        strain: strain[k.row].strain.clone(),
        noise_factor: noise_factor[k.row],
        loads: k.loads.clone(),
        group: k.group,
    };
    let task = Task {
        gauges: prepared.sensitivity.gauges.clone(),
        loads: prepared.sensitivity.loads.clone(),
        noise: measured.noise_microstrain * MICROSTRAIN,
        gauge_noise: stated_noise(job, &prepared.sensitivity.gauges)?,
        model: prior,
        runs: known.runs.iter().map(as_run).collect(),
        sums: sums(job, &prepared.sensitivity.loads),
        common_zero: common_zero(job, prior_is_given)?,
        scale_sd: job.calibration.scale_sd,
    };
    let sites = match installed_positions::tolerance(&job.calibration) {
        Some(t) => Some((t, installed_positions::Sites::from_job(job, &prepared, t)?)),
        None => None,
    };
    let found = work
        .stage("calibrate", |_| match &sites {
            Some((t, sites)) => {
                calibrate_installed_gauges(&task, *t, |g, offset| sites.row(g, offset))
            }
            None => crate::calibrate::calibrate(&task),
        })
        .map_err(|wrong| {
            Faults::from(Fault::new(
                &*runs.file.given,
                "runs",
                wrong,
                "give known loads in the runs file, and strain of the same runs",
            ))
        })?;
    work.findings.extend(found.findings.iter().cloned());
    work.findings
        .extend(reported_calibration::report_unchecked_loads(&task, &listed));
    work.findings
        .extend(reported_calibration::report_uneven_loads(
            &task, &found, &listed,
        ));
    let units = &listed.units[..task.loads.len()];
    let next = work.stage("next run", |_| {
        reported_calibration::next_run(&task, &found, units)
    });
    let dependence = known
        .column
        .as_ref()
        .map(|column| reported_calibration::dependence(&task, &found, column));
    work.findings.extend(
        dependence
            .iter()
            .flatten()
            .filter_map(DependenceSummary::finding),
    );
    let mut calibration =
        reported_calibration::words(&task, &found, &listed, next, dependence.flatten());
    let checks: Vec<KnownRun> = known.checks.iter().map(as_run).collect();
    let checked = recover_checks(&found, task.noise, &checks);
    calibration.checks = checks::compare_check_loads(&checked, &listed);
    work.findings.extend(checks::finding(
        &calibration.checks,
        &listed.names[..task.loads.len()],
    ));
    work.findings
        .extend(installed_positions::report_undetermined_values(
            &calibration.gauges,
        ));
    let glued = found.as_glued.iter().enumerate();
    let answer = CalibratedSensitivity {
        calibration,
        glued: glued
            .map(|(g, a)| sites.as_ref().and_then(|(_, s)| s.locate_gauge(g, a)))
            .collect(),
        sensitivity: found.sensitivity.clone(),
        model: task.model.as_ref().map(|m| m.values.clone()),
        found,
        job_text: text_of(&mut work, job)?,
        job: job.clone(),
    };
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Returns how strain without load is treated: not at all, or as a common zero that is estimated.
///
/// # Errors
/// An intercept together with a model, whose S goes through zero, or with an error that all known loads share.
fn common_zero(job: &Job, has_prior: bool) -> Result<CommonZero, Faults> {
    match (job.calibration.terms, has_prior) {
        (Terms::Linear, _) => Ok(CommonZero::None),
        (Terms::Intercept, false) if job.calibration.scale_sd > 0.0 => Err(Fault::with_line(
            &*job.file,
            job.calibration.line,
            "calibration.scale_sd",
            "an error common to all known loads is not available together with terms = \"intercept\"",
            "delete one of the two",
        )
        .into()),
        (Terms::Intercept, false) => Ok(CommonZero::Sought),
        (Terms::Intercept, true) => Err(Fault::with_line(
            &*job.file,
            job.calibration.line,
            "calibration.terms",
            "`intercept` needs an S that comes from the runs alone, and the job gives a [model] or a [sensitivity]",
            "write terms = \"linear\" and take the zero from a run without load ([measured] zero or zero_runs), or delete [model]",
        )
        .into()),
    }
}

/// Reads the data that [`calibrate`] uses without solving a model, and discards it. This applies to a job with `[calibration]`, and to a job that
/// only `calibrate` can use.
///
/// # Errors
/// Every fault of these files.
pub(super) fn check_inputs(work: &mut Work, job: &Job) -> Result<(), Faults> {
    let (Some(measured), Some(runs)) = (&job.measured, &job.runs) else {
        return Ok(());
    };
    let alone = !reads_strain(job) && job.vehicle.is_none() && !job.loads.is_empty();
    if job.calibration.line == 0 && !alone {
        return Ok(());
    }
    let zeroed = strain_of_runs(work, job, measured)?;
    let s = match &job.sensitivity {
        Some(_) => given_as_asked(work, job)?,
        None => stated_alone(job, &zeroed.table),
    };
    list_load_columns(job, &s)?;
    read(work, job, (measured, runs), &zeroed, &s, [0.0; 2]).map(|_| ())
}

/// Returns the strain of the runs minus their zero.
///
/// # Errors
/// The faults of the strain file, and a record instead of runs.
fn strain_of_runs(work: &mut Work, job: &Job, measured: &Measured) -> Result<ZeroedTable, Faults> {
    let zeroed = read_zeroed(work, job, measured, &measured.strain)?;
    zeroed.runs()?;
    Ok(zeroed)
}

/// Reads the known loads, and the strain of all rows by gauge of `s`, and tests the readings.
///
/// # Errors
/// Faults of the files; no reading at all.
fn read(
    work: &mut Work,
    job: &Job,
    (measured, runs): (&Measured, &Runs),
    zeroed: &ZeroedTable,
    s: &Sensitivity,
    origin: [f64; 2],
) -> Result<(known_loads::KnownRuns, Vec<Readings>), Faults> {
    let names = zeroed.runs()?;
    let known = known_loads::read_known(work, job, (runs, measured), names, &s.loads, origin)?;
    check_readings(job, measured, &zeroed.table, &s.gauges)?;
    let read = zeroed.readings(&s.gauges);
    let strain = test_calibration_readings(work, job, measured, &s.gauges, read);
    some_left(&zeroed.table.file, &strain)?;
    Ok((known, strain))
}

/// Returns the place in plan, m, of the grid at which the payload acts; zeros without a model.
fn payload_place(job: &Job, prepared: &JobSensitivity) -> [f64; 2] {
    let model = prepared.fields.as_ref().map(|f| f.model());
    let grid = model.zip(job.payload_grid()).and_then(|(model, id)| {
        let at = model.grids.get(model.grid_ix(id)?.us())?;
        Some([at.x[0], at.x[1]].map(|x| x * job.units.length_m()))
    });
    grid.unwrap_or([0.0; 2])
}

/// Returns the two sections that calibration needs, or a fault for each missing section.
fn sections(job: &Job) -> Result<(&Measured, &Runs), Faults> {
    let lacks = |section: &str, remedy: &str| {
        Fault::new(
            &*job.file,
            section,
            format!("the job has no [{section}]"),
            remedy,
        )
    };
    match (&job.measured, &job.runs) {
        (Some(m), Some(r)) => Ok((m, r)),
        (m, r) => {
            let mut list = Vec::new();
            if m.is_none() {
                list.push(lacks(
                    "measured",
                    "name the strain of the runs: [measured] strain = \"strain.csv\"",
                ));
            }
            if r.is_none() {
                list.push(lacks(
                    "runs",
                    "name the known loads: [runs] file = \"runs.csv\"",
                ));
            }
            Err(Faults::or(
                list,
                lacks("runs", "name the known loads: [runs] file = \"runs.csv\""),
            ))
        }
    }
}

/// Gauges and loads with the model's S as prior, or with none.
fn prior(
    work: &mut Work,
    job: &Job,
    table: &StrainTable,
) -> Result<(JobSensitivity, Option<ModelPrior>), Faults> {
    if job.model.is_some() || job.sensitivity.is_some() {
        let prepared = prepare(work, job)?;
        let prior = ModelPrior {
            values: prepared.sensitivity.values.clone(),
            moves: Vec::new(),
            off_drawing: installed_positions::off_drawing(job, &prepared)?,
            uncertainty_rel: job.calibration.model_uncertainty_rel,
        };
        return Ok((prepared, Some(prior)));
    }
    if job.loads.is_empty() {
        return Err(Fault::new(
            &*job.file,
            "load",
            "the job contains no loads",
            "add [[load]] with a `name` for each load that acts",
        )
        .into());
    }
    let prepared = JobSensitivity {
        sensitivity: stated_alone(job, table),
        fields: None,
        gauges: Vec::new(),
        mesh_error: Vec::new(),
    };
    Ok((prepared, None))
}

/// Returns an S of zeros with the gauges and loads of the job. If the job states no gauges, they are the gauges of the strain file. A gauge without a
/// column in the file is left out, because it can't be calibrated.
fn stated_alone(job: &Job, table: &StrainTable) -> Sensitivity {
    let mut gauges = stated_readings(job);
    match gauges.is_empty() {
        true => gauges.clone_from(&table.gauges),
        false => gauges.retain(|g| table.gauges.contains(g)),
    }
    let load = |l: &JobLoad| Load {
        expected: l.expected,
        wanted: l.role == LoadRole::Wanted,
        quantity: l.quantity(),
        ..Load::from_name(&l.name)
    };
    let loads: Vec<Load> = job.loads.iter().map(load).collect();
    Sensitivity {
        values: Matrix::zeros(gauges.len(), loads.len()),
        gauges,
        loads,
        uncertainty: None,
        noise: None,
    }
}

/// Checks that known loads are changes from zero, and that the strain file has a column of a gauge.
///
/// # Errors
/// A file of another reference, or a file without a column for any gauge.
fn check_readings(
    job: &Job,
    measured: &Measured,
    table: &StrainTable,
    gauges: &[String],
) -> Result<(), Faults> {
    if measured.reference != Reference::None {
        let wrong = "known loads are changes from the state at which the gauges read zero";
        return Err(Fault::with_line(
            &*job.file,
            measured.line,
            "measured.reference",
            wrong,
            "write reference = \"none\"",
        )
        .into());
    }
    match gauges.iter().any(|g| table.gauges.contains(g)) {
        true => Ok(()),
        false => Err(no_gauge_column(job, &measured.strain.given, &table.gauges, gauges).into()),
    }
}

/// Returns the coefficients of the job's combinations. Without combinations, returns the sum of all wanted loads, whose interval must also be
/// correct.
fn sums(job: &Job, loads: &[Load]) -> Vec<Vec<f64>> {
    let of = |terms: &[(String, f64)]| -> Vec<f64> {
        let factor = |l: &Load| terms.iter().filter(|t| t.0 == l.name).map(|t| t.1).sum();
        loads.iter().map(factor).collect()
    };
    if job.combinations.is_empty() && loads.len() > 1 {
        return vec![
            loads
                .iter()
                .map(|l| if l.wanted { 1.0 } else { 0.0 })
                .collect(),
        ];
    }
    job.combinations.iter().map(|c| of(&c.terms)).collect()
}
