//! `ballast`: lumped masses that bring the model's reactions to the measured ones, and the deck with them in it.

mod answer;
mod completed_deck;
mod task;

pub use answer::{BallastAnswer, HungMass, Reaction, TotalMass};
pub use task::CompletedDeck;

use crate::fe::floor::solve_standing;
use crate::finding::{Finding, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::Work;
use crate::job::{Ballast, Job};
use crate::measured::runs_file::read_runs;
use crate::measured::wheels::{floor_fault, wheels_of};
use crate::model::{GridIx, Vec3};
use crate::payload::{BallastFit, BallastSpec, Carriers, size_ballast, spread};
use crate::strain_chain::deck::DeckModel;
use crate::strain_chain::job_deck::read_deck;
use crate::strain_chain::named_results::{MissingResults, check_named, check_tables};
use crate::units::{Quantity, number};
use nastran::bdf::{Edits, write_edited};
use task::{Task, force};

/// Noise of a measured reaction over the mean reaction, if the job states no noise.
const ASSUMED_NOISE: f64 = 0.01;

/// Finds lumped masses that fit the reactions of the model to the measured reactions. Returns the masses with the completed deck, which is read and
/// solved as a check.
///
/// # Errors
/// Returns every fault of the job and its deck, a region without a place for a mass, or a model that already weighs more.
///
/// # Example
/// The reactions in `examples/frame` include a gearbox of 250 kg at (3.0 m, 0.1 m), which the deck lacks:
/// ```
/// use strainbridge::{Context, Disk, Job, ballast};
///
/// let job = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/ballast.toml");
/// let found = ballast(&Job::read(job, &Disk)?, &Context::new(&Disk))?;
/// let gearbox = &found.masses[0];
/// assert!((gearbox.mass - 250.0).abs() < 0.5); // kg
/// assert!((gearbox.position[0] - 3.0).abs() < 0.005); // m
/// // Statics alone give the sum of the missing masses.
/// assert!((found.together.mass - gearbox.mass).abs() < 0.5);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn ballast(job: &Job, cx: &Context) -> Result<Outcome<BallastAnswer>, Faults> {
    let mut work = Work::of_job(cx, job);
    let read = read_asked(&mut work, job)?;
    let job = &job.with_property_ids(&read.model.property_names)?;
    let ballast = ballast_section(job)?;
    let wheels = wheels_of(job, &read.model)?;
    let standing = work
        .stage("solve", |_| {
            solve_standing(&read.model, wheels.axis, &wheels.grids, &[], None)
        })
        .map_err(|e| floor_fault(job, &e))?;
    let task = Task {
        job,
        ballast,
        read: &read,
        wheels,
        standing,
        gravity: ballast.gravity_m_s2 / job.units.length_m(),
    };
    let (run, measured, sigma) = read_measured_reactions(&mut work, &task)?;
    let carriers = Carriers::from_model(&read.model, task.wheels.axis, |p| {
        ballast
            .properties
            .as_ref()
            .is_none_or(|ids| ids.contains(p))
    });
    let (region, height) = region(&task, &carriers)?;
    let before = task.standing.under_weight(&read.model, task.gravity);
    let lacking: f64 = measured.iter().sum::<f64>() - before.iter().sum::<f64>();
    let largest = largest_mass_weight(&task, &run, lacking)?;
    let spec = BallastSpec {
        masses: ballast.masses,
        region,
        largest,
        sigma: sigma.clone(),
    };
    let fit = work.stage("size", |_| {
        size(&task, &carriers, height, [&before, &measured], &spec)
    })?;
    let (cards, text) = completed_deck::cards(&task, &carriers, &fit, height);
    let mut edits = Edits::default();
    edits.insert_cards(&read.deck, &text);
    let edited = write_edited(&read.deck, &edits);
    let after = work.stage("solve completed deck", |s| {
        completed_deck::solve_completed(s, &task, &edited)
    })?;
    answer::report_mass_findings(&mut work, &task, &run, &measured, &after, &fit, &spec);
    work.findings
        .extend(answer::far_beyond(&task, &run, &before, &fit));
    let sized = answer::BallastSizing {
        run,
        measured: &measured,
        sigma: &sigma,
        before: &before,
        after: &after,
        fit: &fit,
        cards: &cards,
        height,
    };
    let answer = answer::report_ballast(&task, &sized);
    let deck = CompletedDeck {
        deck: read.deck,
        edited,
    };
    let answer = answer(deck);
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

fn missing_section(job: &Job, field: &str, example: &str) -> Faults {
    Faults::from(Fault::new(
        &*job.file,
        field,
        format!("the job has no [{field}]"),
        example,
    ))
}

/// Returns the section of the job.
///
/// # Errors
/// A fault if the job has no `[ballast]`.
fn ballast_section(job: &Job) -> Result<&Ballast, Faults> {
    job.ballast.as_ref().ok_or_else(|| {
        missing_section(
            job,
            "ballast",
            "state the unknown masses: [ballast] masses = 2, region = [[x0, x1], [y0, y1]]",
        )
    })
}

/// Checks the sections of the job and reads its deck. Findings on the deck are added to the work.
fn read_asked(work: &mut Work, job: &Job) -> Result<DeckModel, Faults> {
    ballast_section(job)?;
    let files = job.model.as_ref().ok_or_else(|| {
        missing_section(job, "model", "name the deck: [model] deck = \"model.bdf\"")
    })?;
    check_named(work, job, MissingResults::Refused)?;
    check_tables(work, job)?;
    let read = work.stage("read model", |s| read_deck(s, job, files))?;
    if read.deck.sources.is_empty() {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "model.deck",
            "an OP2 is not a deck, and cannot be completed",
            "name the deck",
        )));
    }
    Ok(read)
}

/// Returns the largest weight of one mass, in job units: `max_mass` of the job, or else the total weight that the model lacks.
fn largest_mass_weight(task: &Task, run: &str, lacking: f64) -> Result<f64, Faults> {
    let (job, ballast) = (task.job, task.ballast);
    let largest = ballast
        .max_mass
        .map_or(lacking.max(0.0), |m| m * task.gravity);
    if !(largest > 0.0) {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            ballast.line,
            "ballast",
            format!(
                "the model already weighs {} {} more than the measured weight of run `{run}`",
                number(-lacking * force(job)),
                job.report_units.force.name
            ),
            "remove masses from the deck, or check the units of the runs file",
        )));
    }
    Ok(largest)
}

/// Masses that bring the reactions from those `before` to the `measured` ones.
fn size(
    task: &Task,
    carriers: &Carriers,
    height: f64,
    [before, measured]: [&[f64]; 2],
    spec: &BallastSpec,
) -> Result<BallastFit, Faults> {
    let model = &task.read.model;
    let on_a_line = std::cell::Cell::new(false);
    let fit = size_ballast(
        before,
        measured,
        |place| match hung(task, carriers, place, height, 1.0) {
            Some(forces) => task.standing.under_forces(model, &forces),
            None => {
                on_a_line.set(true);
                vec![0.0; measured.len()]
            }
        },
        spec,
    );
    if on_a_line.get() {
        return Err(Faults::from(Fault::with_line(
            &*task.job.file,
            task.ballast.line,
            "ballast.region",
            "the grids near part of the region are on a line and cannot carry a mass",
            "name properties of both rails in `properties`, or reduce the region",
        )));
    }
    Ok(fit)
}

/// Name of the requested run, and its reactions and their sd in job units, in the order of the wheels.
fn read_measured_reactions(
    work: &mut Work,
    task: &Task,
) -> Result<(String, Vec<f64>, Vec<f64>), Faults> {
    let job = task.job;
    let Some(runs) = &job.runs else {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "runs",
            "the job has no [runs]",
            "name the measured reactions: [runs] file = \"runs.csv\"",
        )));
    };
    let rows = read_runs(&mut work.inputs, job, runs)?;
    let row = match &task.ballast.run {
        Some(name) => rows.iter().find(|r| r.run == *name),
        None => rows.first(),
    };
    let Some(row) = row else {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            task.ballast.line,
            "ballast.run",
            format!("`{}` does not contain this run", runs.file.given),
            "name a run of the runs file",
        )));
    };
    let newton = job.units.si(Quantity::Force);
    let mut faults = FaultList::new();
    let mut values = Vec::new();
    for l in &task.wheels.loads {
        let name = &job.loads[*l].name;
        match row.loads_si.get(name) {
            Some(v) => values.push(v / newton),
            None => faults.push(Fault::with_line(
                &*runs.file.given,
                row.line,
                name.clone(),
                format!("run `{}` has no reaction of `{name}`", row.run),
                "measure every wheel, or remove its load from the job",
            )),
        }
    }
    Faults::check(faults)?;
    let mean = values.iter().sum::<f64>().abs() / values.len() as f64;
    let sigma = match runs.noise.force.filter(|s| *s > 0.0) {
        Some(s) => s * runs.units.force.si / newton,
        None => {
            work.findings.push(
                Finding::new(
                    Severity::Info,
                    "reaction-noise-assumed",
                    "runs.noise.force",
                    "the job does not state the noise of the reactions: 1 % of their mean is assumed",
                    "state [runs] noise = { force = 0.06 }",
                )
                .with_numbers(ASSUMED_NOISE * mean * force(job), 0.0),
            );
            ASSUMED_NOISE * mean
        }
    };
    let n = values.len();
    Ok((row.run.clone(), values, vec![sigma; n]))
}

/// Returns the area in plan in which masses may be placed, and their height.
fn region(task: &Task, carriers: &Carriers) -> Result<([[f64; 2]; 2], f64), Faults> {
    let Some([b, c, up]) = carriers.extent() else {
        return Err(Faults::from(Fault::with_line(
            &*task.job.file,
            task.ballast.line,
            "ballast.properties",
            "no shell, bar or beam has such a property",
            "name properties that can carry a mass",
        )));
    };
    Ok(match task.ballast.region.as_deref() {
        Some([x, y]) => ([*x, *y], up[1]),
        Some([x, y, z, ..]) => ([*x, *y], (z[0] + z[1]) / 2.0),
        _ => ([b, c], up[1]),
    })
}

/// Forces of a unit weight times `weight` at a place on the grids that carry it.
fn hung(
    task: &Task,
    carriers: &Carriers,
    place: [f64; 2],
    height: f64,
    weight: f64,
) -> Option<Vec<(GridIx, Vec3)>> {
    let mut down = Vec3::zeros();
    down[task.wheels.axis] = -weight;
    spread(
        &task.read.model,
        &carriers.arms(place),
        carriers.point(place, height),
        down,
    )
}
