//! `payload`: mass of a payload, and its position if the data determine it, from strain, from wheel forces, or from both.

mod answer;
mod calibration_range;
mod faults;
mod model;
mod payload_findings;
mod readings;
mod stated_payload;
mod task;

pub use answer::{Ellipse, SingleGauge, WeighedPayload, WeighedPayloads};
pub use readings::NetReading;

use crate::estimate::{NORMAL_95, student_95};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::Work;
use crate::job::Job;
use crate::payload::{PayloadModel, PayloadRun, Support, WeighSpec, weigh};
use crate::sensitivity::Sensitivity;
use crate::strain_chain::has_covariance;
use crate::strain_chain::named_results::check_tables;
use crate::units::factor;
use model::Parts;
use task::Task;

/// Computes the mass of a payload from strain, wheel forces or both. It also computes the position if the data determine it.
///
/// # Errors
/// Returns every fault of the job and of the files that it names, or a job with neither strain nor wheel forces.
///
/// # Example
/// A table on three wheels: the weight is the sum of the wheel forces, and the lever rule gives its position.
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, payload};
///
/// # const DECK: &str = "SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,2.,-1.,0.\nGRID,3,,2.,1.,0.\nGRID,9,,1.,0.,0.
/// # CBAR,1,1,9,1,0.,0.,1.\nCBAR,2,1,9,2,0.,0.,1.\nCBAR,3,1,9,3,0.,0.,1.\nPBAR,1,1,1.-3,1.-6,1.-6,1.-6
/// # MAT1,1,2.1+11,,.3,7850.\nENDDATA\n";
/// const JOB: &str = r#"
/// units = "m-kg-s"
/// model = { deck = "table.bdf", support = "free" }
/// load = [
///     { name = "front", grid = 1, component = "FZ" },
///     { name = "left", grid = 2, component = "FZ" },
///     { name = "right", grid = 3, component = "FZ" },
/// ]
/// runs = { file = "runs.csv", noise = { force = 1.0 }, wheel_forces = "measured" }
/// payload = { grid = 9, position = "free", use = ["reactions"] }
/// "#;
/// let files = InMemory::default()
///     .with_file("table.bdf", DECK)
///     .with_file("job.toml", JOB)
///     .with_file("runs.csv", "run,front,left,right\nR1,500.0,200.0,300.0\n");
/// let found = payload(&Job::read("job.toml", &files)?, &Context::new(&files))?;
/// let p = &found.payload[0];
/// assert!((p.mass.unwrap() - 1000.0 / 9.80665).abs() < 1e-6);
/// assert!((p.position[0].unwrap() - 2.0 * 500.0 / 1000.0).abs() < 1e-5); // m
/// assert!((p.position[1].unwrap() - (300.0 - 200.0) / 1000.0).abs() < 1e-5);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn payload(job: &Job, cx: &Context) -> Result<Outcome<WeighedPayloads>, Faults> {
    let mut work = Work::of_job(cx, job);
    let job = &job.without_validation_gauges()?;
    check_tables(&work, job)?;
    let Some(payload) = &job.payload else {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "payload",
            "the job has no [payload]",
            "state the unknown payload: [payload] grid = 9101, position = \"known\"",
        )));
    };
    let use_strain = payload.use_strain && job.measured.is_some();
    let use_reactions = payload.use_reactions && job.runs.is_some();
    if !use_strain && !use_reactions {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            payload.line,
            "payload.use",
            "the job has neither strain nor reactions that determine a payload",
            "add [measured] strain = \"strain.csv\" or [runs] file = \"runs.csv\", and name them in `use`",
        )));
    }
    let si = job.report_units.mass.si / job.report_units.force.si;
    let mut task = Task {
        job,
        payload,
        weight_of_mass: payload.gravity_m_s2 * si,
        force: factor(job.units, job.report_units.force),
        length: factor(job.units, job.report_units.length),
        nominal: [0.0; 2],
        empty: Vec::new(),
        wheels: Vec::new(),
    };
    let parts = model::model_of(&mut work, &mut task, use_strain)?;
    let mut readings =
        readings::runs_of(&mut work, &task, &parts.model, use_strain, use_reactions)?;
    payload_findings::readings(&mut work, &task, &parts, &mut readings.runs);
    let runs = &readings.runs;
    let spec = spec_of(&task, &parts, runs);
    let weighing = work.stage("weigh", |_| weigh(&parts.model, runs, &spec));
    payload_findings::findings(&mut work, &task, &parts, runs, &spec, &weighing);
    let outside = calibration_range::findings(&task, &parts, &weighing);
    work.findings.extend(outside);
    faults::search(&mut work, &task, &parts, runs, (&spec, &weighing));
    let place = stated_payload::place_contradicted(&task, &parts, runs, &spec, &weighing);
    work.findings.extend(place);
    let mass = stated_payload::mass_contradicted(&mut work, &task, &weighing)?;
    work.findings.extend(mass);
    let answer = answer::report_payload(&task, parts, readings, &spec, weighing);
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Returns the weight at the nominal place for which the most strained gauge gives the largest of all readings. Returns 1 if there is no such weight.
fn by_strongest(model: &PayloadModel, runs: &[PayloadRun]) -> f64 {
    let readings = runs.iter().flat_map(|r| &r.strain).map(|e| e.abs());
    let largest = readings.filter(|e| e.is_finite()).fold(0.0, f64::max);
    let unit = model.unit_strain([0.0; 2], Support::Floor);
    let strongest = unit.iter().fold(0.0, |a: f64, e| a.max(e.abs()));
    let weight = largest / strongest;
    if weight > 0.0 && weight.is_finite() {
        weight
    } else {
        1.0
    }
}

/// Largest weight that is searched, over the weight that makes the largest reading. Readings, not the mass of the model, limit a payload.
const FAR: f64 = 1.0e3;

/// Returns the relative error of each strain coefficient and of all of them together, 1 sd. It combines the stated error with the error from the
/// covariance of a calibrated S. Few repeats determine their own scatter poorly. The ratio of Student's factor to the factor of the normal
/// distribution therefore widens the error.
fn model_rel(job: &Job, s: Option<&Sensitivity>) -> f64 {
    let measured = job.measured.as_ref();
    let stated = measured.map_or(0.0, |m| m.model_uncertainty_rel);
    let calibrated = s.filter(|_| has_covariance(job));
    match calibrated.and_then(|s| Some((s, s.uncertainty.as_ref()?))) {
        Some((s, u)) => stated.hypot(s.relative_sd() * student_95(u.dof) / NORMAL_95),
        None => stated,
    }
}

fn spec_of(task: &Task, parts: &Parts, runs: &[PayloadRun]) -> WeighSpec {
    let (job, model) = (task.job, &parts.model);
    let s = parts.prepared.as_ref().map(|p| &p.sensitivity);
    let reactions = runs.iter().flat_map(|r| &r.reactions).map(|r| r.abs());
    let largest_reaction = reactions.filter(|r| r.is_finite()).fold(0.0, f64::max);
    let stated = job
        .runs
        .as_ref()
        .and_then(|r| Some(r.noise.force? * r.units.force.si / job.report_units.force.si))
        .filter(|s| *s > 0.0);
    let region = task.payload.region.as_deref().and_then(|r| match r {
        [x, y, ..] => Some([x, y].map(|v| v.map(|v| v * task.length))),
        _ => None,
    });
    // Without a stated region, the region is between the wheels.
    let between = model.arms.as_ref().map(|arms| {
        [0, 1].map(|k| {
            arms.iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |r, a| {
                    [r[0].min(a[k]), r[1].max(a[k])]
                })
        })
    });
    WeighSpec {
        place: task.payload.position,
        model_rel: model_rel(job, s),
        reaction_sigma: stated.unwrap_or(readings::ASSUMED_NOISE * largest_reaction),
        largest: FAR * by_strongest(model, runs),
        region: region
            .map(|r| [0, 1].map(|k| r[k].map(|v| v - task.nominal[k])))
            .or(between),
    }
}
