//! `calibrate`: S from runs of known load, fused with the model's where there is one; the job that the other workflows run with it.

mod glued;
mod job_file;
mod known;
mod outcome;
mod said;

pub use job_file::calibrated_job;
pub use outcome::*;

use super::context::Context;
use super::fault::{Fault, Faults};
use super::job::strain::{StrainRows, StrainTable};
use super::job::{Job, LoadRole, Measured, Reference, Runs};
use super::outcome::{Outcome, StatedUnits};
use super::reconcile::redirect::text_of;
use super::strain::{Prepared, load_units, prepare};
use super::work::Work;
use super::zeroed::{Zeroed, judged, read_zeroed, some_left};
use crate::calibrate::{KnownRun, ModelPrior, Task, calibrate_as_glued};
use crate::linalg::Matrix;
use crate::recovery::Readings;
use crate::sensitivity::{Load, Sensitivity};
use crate::units::MICROSTRAIN;

/// S of a job's gauges learnt from its runs of known load.
///
/// # Errors
/// Every fault of the job and of the files it names; runs without known loads.
pub fn calibrate(job: &Job, cx: &Context) -> Result<Outcome<Calibrated>, Faults> {
    let mut work = Work::of_job(cx, job);
    let (measured, runs) = sections(job)?;
    let Zeroed {
        table,
        noise_factor,
    } = work.stage("read strain", |w| {
        read_zeroed(w, job, measured, &measured.strain)
    })?;
    let StrainRows::Runs(names) = &table.rows else {
        return Err(Fault::of(
            &*measured.strain.given,
            "time",
            "a record can't be read as runs",
            "write a row a run, its name in a column `run`",
        )
        .into());
    };
    let (prepared, prior) = prior(&mut work, job, &table)?;
    let known = known::read_known(
        &mut work,
        job,
        runs,
        measured,
        names,
        &prepared.sensitivity.loads,
    )?;
    let strain = readings(job, measured, &table, &prepared)?;
    let rows = strain.into_iter().zip(names).zip(&noise_factor);
    let read: Vec<Readings> = rows
        .map(|((strain, run), noise_factor)| Readings {
            run: run.clone(),
            strain,
            noise_factor: *noise_factor,
        })
        .collect();
    let strain = judged(&mut work, measured, &prepared.sensitivity.gauges, &read);
    some_left(&table.file, &strain)?;
    let task = Task {
        gauges: prepared.sensitivity.gauges.clone(),
        loads: prepared.sensitivity.loads.clone(),
        noise: measured.noise_microstrain * MICROSTRAIN,
        model: prior,
        runs: known
            .runs
            .iter()
            .map(|k| KnownRun {
                run: names[k.row].clone(),
                strain: strain[k.row].strain.clone(),
                noise_factor: noise_factor[k.row],
                loads: k.loads.clone(),
                group: k.group,
            })
            .collect(),
        sums: sums(job, &prepared.sensitivity.loads),
    };
    let sites = match glued::tolerance(&job.calibration) {
        Some(t) => Some((t, glued::Sites::of(job, &prepared, t)?)),
        None => None,
    };
    let found = work
        .stage("calibrate", |_| match &sites {
            Some((t, sites)) => calibrate_as_glued(&task, *t, |g, offset| sites.row(g, offset)),
            None => crate::calibrate::calibrate(&task),
        })
        .map_err(|wrong| {
            Faults::from(Fault::of(
                &*runs.file.given,
                "runs",
                wrong,
                "give known loads in the runs file, and strain of the same runs",
            ))
        })?;
    work.findings.extend(found.findings.iter().cloned());
    let units = load_units(
        job,
        &task
            .loads
            .iter()
            .map(|l| l.name.clone())
            .collect::<Vec<_>>(),
    );
    let next = work.stage("next run", |_| said::next_run(&task, &found, &units));
    let dependence = known
        .column
        .as_ref()
        .map(|column| said::dependence(&task, &found, column));
    work.findings.extend(
        dependence
            .iter()
            .flatten()
            .filter_map(DependenceSummary::finding),
    );
    let calibration = said::words(&task, &found, &units, next, dependence.flatten());
    work.findings.extend(glued::untold(&calibration.gauges));
    let glued = found.as_glued.iter().enumerate();
    let answer = Calibrated {
        calibration,
        glued: glued
            .map(|(g, a)| sites.as_ref().and_then(|(_, s)| s.found(g, a)))
            .collect(),
        sensitivity: found.sensitivity.clone(),
        model: task.model.as_ref().map(|m| m.values.clone()),
        found,
        job_text: text_of(&mut work, job)?,
        job: job.clone(),
    };
    Ok(work.finish(StatedUnits::of(job.units, &job.report_units), answer))
}

/// What calibration can't do without.
fn sections(job: &Job) -> Result<(&Measured, &Runs), Faults> {
    let lacks = |section: &str, remedy: &str| {
        Fault::of(
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
) -> Result<(Prepared, Option<ModelPrior>), Faults> {
    if job.model.is_some() || job.sensitivity.is_some() {
        let prepared = prepare(work, job)?;
        let prior = ModelPrior {
            values: prepared.sensitivity.values.clone(),
            moves: Vec::new(),
            off_drawing: glued::off_drawing(job, &prepared)?,
            uncertainty_rel: job.calibration.model_uncertainty_rel,
        };
        return Ok((prepared, Some(prior)));
    }
    if job.loads.is_empty() {
        return Err(Fault::of(
            &*job.file,
            "load",
            "the job names no loads",
            "add [[load]] with a `name` for each load that acts",
        )
        .into());
    }
    let gauges: Vec<String> = if job.gauges.is_empty() {
        table.gauges.clone()
    } else {
        job.gauges.iter().map(|g| g.name.clone()).collect()
    };
    let loads: Vec<Load> = job
        .loads
        .iter()
        .map(|l| Load {
            expected: l.expected,
            wanted: l.role == LoadRole::Wanted,
            quantity: l.quantity(),
            ..Load::named(&l.name)
        })
        .collect();
    let sensitivity = Sensitivity {
        values: Matrix::zeros(gauges.len(), loads.len()),
        gauges,
        loads,
        uncertainty: None,
    };
    let prepared = Prepared {
        sensitivity,
        fields: None,
        gauges: Vec::new(),
        mesh_error: Vec::new(),
    };
    Ok((prepared, None))
}

/// Strain of every row of the table by gauge.
fn readings(
    job: &Job,
    measured: &Measured,
    table: &StrainTable,
    prepared: &Prepared,
) -> Result<Vec<Vec<f64>>, Faults> {
    if measured.reference != Reference::None {
        let wrong = "known loads are changes from the state at which the gauges read zero";
        return Err(Fault::at(
            &*job.file,
            measured.line,
            "measured.reference",
            wrong,
            "write reference = \"none\"",
        )
        .into());
    }
    let gauges = prepared.sensitivity.gauges.iter();
    let columns: Vec<Option<usize>> = gauges
        .map(|g| table.gauges.iter().position(|h| h == g))
        .collect();
    if columns.iter().all(Option::is_none) {
        return Err(Fault::at(
            &*measured.strain.given,
            1,
            "gauge",
            "no column is named after a gauge of the job",
            "name the columns after the gauges",
        )
        .into());
    }
    let of_row = |i: usize| -> Vec<f64> {
        let row = table.row(i);
        let reading = |c: &Option<usize>| c.and_then(|c| row.get(c)).copied().unwrap_or(f64::NAN);
        columns.iter().map(|c| reading(c) * MICROSTRAIN).collect()
    };
    Ok((0..table.n_rows()).map(of_row).collect())
}

/// Coefficients of the job's combinations; where it names none, the sum of all wanted loads, whose interval is to hold all the same.
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
