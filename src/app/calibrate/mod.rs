//! `calibrate`: S from runs of known load, fused with the model's where there is one; the job that the other workflows run with it.

mod job_file;
mod known;
mod outcome;
mod said;

pub use job_file::calibrated_job;
pub use outcome::*;

use super::context::Context;
use super::fault::{Fault, Faults};
use super::job::strain::{StrainRows, StrainTable, read_strain};
use super::job::{Job, Measured, Reference, Role, Runs};
use super::outcome::{Outcome, StatedUnits};
use super::reconcile::redirect::text_of;
use super::strain::{Prepared, load_units, prepare};
use super::work::Work;
use crate::calibrate::{KnownRun, ModelPrior, Task};
use crate::linalg::Matrix;
use crate::recovery::net::effective_samples;
use crate::sensitivity::{Load, Sensitivity};

/// Strain in one microstrain.
const MICRO: f64 = 1e-6;

/// S of a job's gauges learnt from its runs of known load.
///
/// # Errors
/// Every fault of the job and of the files it names; runs without known loads.
pub fn calibrate(job: &Job, cx: &Context) -> Result<Outcome<Calibrated>, Faults> {
    let mut work = Work::of_job(cx, job);
    let (measured, runs) = sections(job)?;
    let table = work.stage("read strain", |w| {
        read_strain(&mut w.inputs, job, &measured.strain)
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
    let strain = readings(&mut work, job, measured, &table, &prepared)?;
    let task = Task {
        gauges: prepared.sensitivity.gauges.clone(),
        loads: prepared.sensitivity.loads.clone(),
        noise: measured.noise_microstrain * MICRO,
        model: prior,
        runs: known
            .runs
            .iter()
            .map(|k| KnownRun {
                run: names[k.row].clone(),
                strain: strain.rows[k.row].clone(),
                noise_factor: strain.noise_factor,
                loads: k.loads.clone(),
                group: k.group,
            })
            .collect(),
        sums: sums(job, &prepared.sensitivity.loads),
    };
    let found = work
        .stage("calibrate", |_| crate::calibrate::calibrate(&task))
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
    let answer = Calibrated {
        calibration: said::words(&task, &found, &units, next, dependence.flatten()),
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
            turned: None,
            uncertainty_rel: job.calibration.model_uncertainty_rel,
            angle_rad: 0.0,
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
            wanted: l.role == Role::Wanted,
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

/// Strain of every row of the table by gauge, zero subtracted.
struct Strain {
    rows: Vec<Vec<f64>>,
    noise_factor: f64,
}

fn readings(
    work: &mut Work,
    job: &Job,
    measured: &Measured,
    table: &StrainTable,
    prepared: &Prepared,
) -> Result<Strain, Faults> {
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
    let gauges = &prepared.sensitivity.gauges;
    let place = |t: &StrainTable, g: &String| t.gauges.iter().position(|h| h == g);
    let columns: Vec<Option<usize>> = gauges.iter().map(|g| place(table, g)).collect();
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
    let (mut zero, mut effective) = (vec![0.0; gauges.len()], f64::INFINITY);
    if let Some(named) = &measured.zero {
        let unloaded = read_strain(&mut work.inputs, job, named)?;
        for (z, g) in zero.iter_mut().zip(gauges) {
            let column = place(&unloaded, g);
            let cell = |i: usize| column.and_then(|c| unloaded.row(i).get(c).copied());
            let v: Vec<f64> = (0..unloaded.n_rows())
                .filter_map(cell)
                .filter(|v| v.is_finite())
                .collect();
            if v.is_empty() {
                *z = f64::NAN;
                continue;
            }
            *z = v.iter().sum::<f64>() / v.len() as f64;
            effective = effective.min(effective_samples(&v));
        }
    }
    let of_row = |i: usize| -> Vec<f64> {
        let row = table.row(i);
        let reading = |c: &Option<usize>| c.and_then(|c| row.get(c)).copied().unwrap_or(f64::NAN);
        let pairs = columns.iter().zip(&zero);
        pairs.map(|(c, z)| (reading(c) - z) * MICRO).collect()
    };
    Ok(Strain {
        rows: (0..table.n_rows()).map(of_row).collect(),
        noise_factor: 1.0 + 1.0 / effective,
    })
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
