//! `respond`: strain and stress anywhere on the structure from recovered loads, by superposition of the unit fields.

mod gauges;
mod outcome;
mod record_states;
mod states;

pub use gauges::{Check, GaugeCheck};
pub use outcome::{Element, ElementFatigue, Field, StressResponse};

use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity, list_few};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::Work;
use crate::job::{self, Job};
use crate::model::{GridIx, Model};
use crate::respond::{
    LoadState, Peak, Place, PlaceDamage, ResponseRow, StressLaw, envelope, fatigue, hot_spots,
    response_rows,
};
use crate::series::rainflow::MeanStress;
use crate::strain_chain::named_results::check_tables;
use crate::strain_chain::{JobSensitivity, WantedAt, has_covariance, prepare, read_fields};
use crate::units::factor;
use std::collections::BTreeSet;

/// Computes strain and stress by superposition of the unit fields, over all load states of a job. The elements are the ones with the highest
/// stress, or the ones that the job names.
///
/// # Errors
/// Returns every fault of the job and of the files that it names, or a given S, which has no fields.
///
/// # Example
/// The recovered loads predict the strain at the gauges to the noise of the readings, 0.5 microstrain:
/// ```
/// use strainbridge::{Context, Disk, Job, respond};
///
/// let job = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/respond.toml");
/// let found = respond(&Job::read(job, &Disk)?, &Context::new(&Disk))?;
/// assert_eq!(found.states, 9);
/// let stresses = found.elements.iter().map(|e| e.max_von_mises);
/// assert!(stresses.is_sorted_by(|a, b| a >= b));
/// assert!(found.gauges.iter().all(|g| g.residual_rms < 1.5));
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn respond(job: &Job, cx: &Context) -> Result<Outcome<StressResponse>, Faults> {
    let mut work = Work::of_job(cx, job);
    let answer = compute_response(&mut work, &job.without_validation_gauges()?)?;
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Reads the table of loads that the job names, as `respond` does, and discards it.
///
/// # Errors
/// A table that can't be read, or that lacks a load.
pub(super) fn check_inputs(work: &mut Work, job: &Job) -> Result<(), Faults> {
    let loads = job.respond.loads.as_ref();
    loads.map_or(Ok(()), |named| {
        states::from_table(work, job, named).map(|_| ())
    })
}

fn compute_response(work: &mut Work, job: &Job) -> Result<StressResponse, Faults> {
    check_tables(work, job)?;
    let calibrated = has_covariance(job) && job.model.is_some();
    if job.sensitivity.is_some() && !calibrated {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "sensitivity",
            "the job gives S, not unit fields: stress cannot be superposed",
            "give a [model] instead",
        )));
    }
    let prepared = if job.gauges.is_empty() {
        JobSensitivity {
            sensitivity: crate::sensitivity::Sensitivity {
                gauges: Vec::new(),
                loads: Vec::new(),
                values: crate::linalg::Matrix::zeros(0, job.loads.len()),
                uncertainty: None,
                noise: None,
            },
            fields: Some(read_fields(work, job, WantedAt::Anywhere)?),
            gauges: Vec::new(),
            mesh_error: Vec::new(),
        }
    } else {
        prepare(work, job)?
    };
    let Some(fields) = &prepared.fields else {
        return Err(Fault::new(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )
        .into());
    };
    let states::States { states, is_history } = states::read(work, job, &prepared)?;
    if let (Some(_), false) = (job.respond.slope, is_history) {
        return Err(no_history(job).into());
    }
    let wanted = job.respond.elements.as_ref();
    let (rows, findings) = response_rows(fields.model(), &fields.load_cases(job), |_| true);
    work.findings.extend(findings);
    if rows.is_empty() {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "model",
            "no element has strain in every load's subcase",
            "ask for STRAIN(FIBER,CENTER) = ALL in every subcase",
        )));
    }
    let peaks = work.stage("superpose", |_| envelope(&rows, &states));
    let spots = hot_spots(fields.model(), &rows, &peaks);
    let mut order: Vec<usize> = (0..rows.len()).collect();
    match wanted {
        Some(ids) => order.retain(|i| ids.contains(rows[*i].element)),
        None => {
            order.sort_by(|a, b| peaks[*b].von_mises.total_cmp(&peaks[*a].von_mises));
            order.truncate(job.respond.hottest);
        }
    }
    if order.is_empty() {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            job.respond.line,
            "respond.elements",
            "none of these elements has stress",
            "name shells, bars or beams of the deck",
        )));
    }
    report_findings(work, job, fields.model(), &rows, &peaks, &order);
    let check = gauges::check(work, job, &prepared, &states)?;
    let u = factor(job.units, job.report_units.stress);
    let entry = |i: &usize| {
        let (r, p) = (&rows[*i], &peaks[*i]);
        Element {
            element: r.element,
            surface: r.surface_word(),
            max_von_mises: p.von_mises * u,
            at: states.get(p.at).map(|s| s.label.clone()),
            sigma: p.sigma * u,
            low: (p.von_mises - NORMAL_95 * p.sigma).max(0.0) * u,
            high: (p.von_mises + NORMAL_95 * p.sigma) * u,
        }
    };
    let hottest = spots.iter().take(job.respond.hottest);
    let fatigue = match job.respond.slope {
        Some(slope) => {
            let law = law_of(job, slope, u);
            work.findings.push(about_damage(&law));
            let places: Vec<&ResponseRow> = order.iter().filter_map(|i| rows.get(*i)).collect();
            let found = work.stage("fatigue", |_| damage_of(&places, &states, law));
            check_finite(job, &law, &found)?;
            found
        }
        None => Vec::new(),
    };
    Ok(StressResponse {
        fatigue,
        elements: order.iter().map(entry).collect(),
        hot_spots: hottest.map(entry).collect(),
        states: states.len(),
        stress_unit: job.report_units.stress.name,
        gauges: check.rows.clone(),
        field: Field {
            rows,
            peaks,
            order,
            spots,
            states,
        },
        check,
        prepared,
        job: job.clone(),
    })
}

/// Damage law of the job; `unit` is the number of report units of stress in one job unit.
fn law_of(job: &Job, slope: f64, unit: f64) -> StressLaw {
    StressLaw {
        slope,
        mean_stress: job.respond.mean_stress,
        unit,
        class: job.respond.fatigue_class,
    }
}

/// The fault of a slope without a history.
fn no_history(job: &Job) -> Fault {
    Fault::with_line(
        &*job.file,
        job.respond.line,
        "respond.slope",
        "the loads are the loads of runs, which are not consecutive in time: they form no cycles",
        "name the loads of a record: [respond] loads = \"job.out/loads.csv\", or delete slope",
    )
}

/// Returns the pseudo-damage of places in the form of the answer.
fn damage_of(places: &[&ResponseRow], states: &[LoadState], law: StressLaw) -> Vec<ElementFatigue> {
    let found = fatigue(places, states, law);
    let one = |(row, d): (&&ResponseRow, PlaceDamage)| ElementFatigue {
        element: row.element,
        surface: row.surface_word(),
        damage: d.value,
        damage_low: d.low,
        damage_high: d.high,
        angle_deg: d.angle_deg,
        life_share: law.life_share(d.value),
        life_share_low: law.life_share(d.low),
        life_share_high: law.life_share(d.high),
    };
    places.iter().zip(found).map(one).collect()
}

/// Refuses a mean stress, or an upper end of its interval, that reaches the ultimate strength, and damage beyond the range of numbers.
fn check_finite(job: &Job, law: &StressLaw, found: &[ElementFatigue]) -> Result<(), Faults> {
    let beyond = found.iter().find(|f| !f.damage_high.is_finite());
    beyond.map_or(Ok(()), |f| {
        let element = f.element;
        let (field, wrong, remedy) = match law.mean_stress {
            MeanStress::Goodman { .. } => (
                "respond.ultimate",
                format!(
                    "the mean stress of a cycle at element {element} reaches this strength, within its 95 % interval: Goodman's line ends there"
                ),
                "correct the strength, or exclude the element with `elements`",
            ),
            _ => (
                "respond.slope",
                format!("the damage at element {element} exceeds the range of numbers"),
                "report stress in a larger unit, or state a lower slope",
            ),
        };
        let line = job.respond.line;
        Err(Fault::with_line(&*job.file, line, field, wrong, remedy).into())
    })
}

/// Returns the note that explains pseudo-damage of stress.
fn about_damage(law: &StressLaw) -> Finding {
    let (range, mean) = match law.mean_stress {
        MeanStress::None => ("range", "without mean stress".to_owned()),
        MeanStress::Goodman { ultimate } => (
            "reversed range",
            format!("corrected for mean stress by Goodman with an ultimate strength of {ultimate}"),
        ),
        MeanStress::SmithWatsonTopper => (
            "reversed range",
            "corrected for mean stress by Smith, Watson and Topper".to_owned(),
        ),
        MeanStress::Sensitivity { m } => (
            "reversed range",
            format!("corrected for mean stress by the sensitivity M = {m} of the FKM guideline"),
        ),
    };
    let slope = law.slope;
    let life = match law.class {
        None => "It compares places and records and is not a life".to_owned(),
        Some(class) => format!(
            "`life_share` divides it by 2e6 times {class} to the power {slope}: 1 is the life of the detail"
        ),
    };
    Finding::new(
        Severity::Info,
        "pseudo-damage",
        "fatigue",
        format!(
            "rainflow counts by ASTM E1049-85 of the normal stress on the plane of largest damage. Pseudo-damage is the sum of cycles \
             times {range} to the power {slope}, {mean} and without a fatigue limit. {life}. Its interval shifts all ranges together by their own 95 % interval, from the intervals of the loads"
        ),
        "state the slope of the part's S-N curve: [respond] slope",
    )
}

/// Returns the corner grids of the shell, or the grids of the beam, of a result row.
pub fn grids(model: &Model, row: &ResponseRow) -> Vec<GridIx> {
    match row.place {
        Place::Shell { shell, .. } => model
            .shells
            .get(shell.us())
            .map_or_else(Vec::new, |s| s.grids[..s.shape.n_corners()].to_vec()),
        Place::Beam { beam, .. } => model
            .beams
            .get(beam.us())
            .map_or_else(Vec::new, |b| b.grids.to_vec()),
    }
}

fn report_findings(
    work: &mut Work,
    job: &Job,
    model: &Model,
    rows: &[ResponseRow],
    peaks: &[Peak],
    order: &[usize],
) {
    let joints: BTreeSet<GridIx> = model
        .rigids
        .iter()
        .flat_map(|r| r.kind.grids())
        .chain(
            model
                .joints
                .iter()
                .flat_map(|j| &j.ends)
                .flat_map(|e| e.motion.iter().map(|m| m.0)),
        )
        .collect();
    let at_joint: Vec<String> = order
        .iter()
        .filter(|i| grids(model, &rows[**i]).iter().any(|g| joints.contains(g)))
        .map(|i| rows[*i].element.to_string())
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    if !at_joint.is_empty() {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "hot-at-a-joint",
                list_few(&at_joint),
                "these elements touch a rigid element: their stress is the stress of the idealised joint and grows as the mesh is refined",
                "assess the joint by its forces, or by elements a plate thickness away",
            )
            .with_numbers(at_joint.len() as f64, 0.0),
        );
    }
    if job
        .measured
        .as_ref()
        .is_none_or(|m| m.reference == job::Reference::None)
    {
        // A correction for mean stress needs the static stress too.
        let (severity, also) = match job.respond.mean_stress {
            _ if job.measured.is_none() => (Severity::Info, ""),
            MeanStress::None => (Severity::Info, ""),
            _ => (
                Severity::Warning,
                ". Mean stresses lack the static stress of this state, and so does the damage",
            ),
        };
        work.findings.push(Finding::new(
            severity,
            "stress-is-change",
            "respond",
            format!("loads are changes from the state at which the gauges read zero, and stress is the change from this state{also}"),
            "state [measured] reference to get totals",
        ));
    }
    if let Some(p) = order.first().map(|i| &peaks[*i])
        && p.sigma > 0.1 * p.von_mises
    {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "stress-uncertain",
                "respond",
                "the loads are so uncertain that the largest stress has a standard deviation above 10 %",
                "improve the gauge layout (`place`), or lower the noise",
            )
            .with_numbers(p.sigma / p.von_mises, 0.1),
        );
    }
}
