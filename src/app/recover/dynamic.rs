//! `[dynamic]`: the vibration of the structure taken out of a record, with the modes of the model.

use super::reading::Record;
use super::task::Task;
use crate::app::fault::{Fault, Faults};
use crate::app::job::Dynamic;
use crate::app::solved::{cases_of_job, faults_of};
use crate::app::work::Work;
use crate::fe::{CaseResult, LoadCase, ModalSolution, SolveOptions, modal_loads, solve_modes};
use crate::finding::{Finding, Severity};
use crate::gauge::reading;
use crate::recovery::dynamic::{AtRest, Dynamics, ElasticMode, Unfit, readings_at_rest};
use crate::sensitivity::Sensitivity;
use serde::Serialize;

/// Modes up to this many times the highest frequency wanted answer otherwise than at rest: what is left of the next one is an eighth of its share.
const MODES_UP_TO: f64 = 3.0;
/// Modes that are looked for at first, and at most.
const FIRST_MODES: usize = 16;
const MOST_MODES: usize = 256;
/// Readings of a record that is held in memory: 0.8 GB, and as much again at rest.
const MOST_READINGS: usize = 100_000_000;

/// What the motion of the structure was taken for.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Motion {
    /// Loads are recovered up to here.
    pub up_to_hz: f64,
    /// Modes that answer otherwise than at rest.
    pub modes_hz: Vec<f64>,
    /// Time at either end of the record, and of every gap, in which no load is known.
    pub blank_s: f64,
    /// By load: root mean square of what the record taken as at rest would be off by, as a share of that of the load about its mean.
    pub change_rel: Vec<Option<f64>>,
}

/// A record at rest, and what is to be known of it.
pub(super) struct Rested {
    pub record: Record,
    pub motion: Motion,
    /// Noise variance of a reading, in units of that of a reading as measured.
    pub noise_factor: f64,
    /// By load of S: variance beyond that.
    pub load_variance: Vec<f64>,
    /// Samples blank for what is at rest alone.
    pub blank: usize,
}

/// The record without the vibration of the structure, where the job asks for that.
///
/// # Errors
/// No model that could vibrate; a band that the record does not hold, or in which the gauges don't tell the loads; a record too long.
pub(super) fn rested(
    work: &mut Work,
    task: &Task,
    record: &Record,
    s: &Sensitivity,
) -> Result<Option<Rested>, Faults> {
    let Some(asked) = task.job.dynamic else {
        return Ok(None);
    };
    let fault = |wrong: String, remedy: &str| {
        Faults::from(Fault::at(
            &*task.job.file,
            asked.line,
            "dynamic",
            wrong,
            remedy,
        ))
    };
    let samples = record.clock().samples;
    if samples.saturating_mul(s.gauges.len()) > MOST_READINGS {
        return Err(fault(
            format!(
                "the record has {samples} samples of {} gauges, and it is held in memory while the structure's vibration is taken out",
                s.gauges.len()
            ),
            "cut the record into parts of at most 100 million readings",
        ));
    }
    let dynamics = dynamics(work, task, asked, s)?;
    let (first_s, step_s) = record.first_and_step();
    let readings = record.columns()?;
    work.go_on()?;
    let noise = task.errors.noise_variance(1.0).sqrt();
    let rested = work.stage("vibration", |_| {
        readings_at_rest(s, &dynamics, noise, &readings, 1.0 / step_s)
    });
    let rested = rested.map_err(|e| fault(e.to_string(), remedy_of(&e)))?;
    drop(readings);
    let motion = motion_of(&dynamics, &rested, step_s);
    if rested.blank == samples {
        return Err(fault(
            format!(
                "no stretch of the record is longer than {:.4} s, twice what a sample at rest hangs on",
                2.0 * motion.blank_s
            ),
            "take a longer record, or a higher `up_to_hz`",
        ));
    }
    work.findings
        .push(about(&motion, asked, &task.measured.strain.given));
    Ok(Some(Rested {
        noise_factor: task.noise_factor - 1.0 + rested.noise_share,
        load_variance: rested.load_variance,
        blank: rested.blank,
        motion,
        record: record.with_readings(rested.readings, (first_s, step_s))?,
    }))
}

fn remedy_of(e: &Unfit) -> &'static str {
    match e {
        Unfit::Rate { .. } => "state a lower `up_to_hz`, or sample faster",
        Unfit::Untold { .. } => {
            "state a lower `up_to_hz`, add gauges, or give nuisance loads `expected`"
        }
        Unfit::Rings { .. } => {
            "state a lower `up_to_hz`, or add gauges that tell the loads where the others read next to nothing of them"
        }
    }
}

/// Modes of the job's structure at the gauges and loads of S.
fn dynamics(
    work: &mut Work,
    task: &Task,
    asked: Dynamic,
    s: &Sensitivity,
) -> Result<Dynamics, Faults> {
    let job = task.job;
    let fault = |field: &str, wrong: String, remedy: &str| {
        Faults::from(Fault::at(&*job.file, asked.line, field, wrong, remedy))
    };
    let Some(fields) = &task.prepared.fields else {
        return Err(fault(
            "dynamic",
            "S is given without a model: nothing is known of the structure's modes".to_owned(),
            "give a [model], or take [dynamic] out and low-pass the strain",
        ));
    };
    let deck = &fields.deck;
    let cases = cases_of_job(job, deck)?;
    let end_hz = MODES_UP_TO * asked.up_to_hz;
    let solved = modes_up_to(work, deck, &cases, end_hz)?;
    if solved.modes.last().is_some_and(|m| m.frequency < end_hz) && solved.modes.len() == MOST_MODES
    {
        return Err(fault(
            "dynamic.up_to_hz",
            format!("the structure has more than {MOST_MODES} modes below {end_hz:.4} Hz"),
            "state a lower `up_to_hz`",
        ));
    }
    let n = solved.modes.iter().filter(|m| m.frequency < end_hz).count();
    let work_of =
        modal_loads(&deck.model, &cases, &solved.modes[..n]).map_err(|e| faults_of(&e, deck))?;
    let mut columns = Vec::with_capacity(s.loads.len());
    for load in &s.loads {
        let Some(l) = job.loads.iter().position(|l| l.name == load.name) else {
            return Err(fault(
                "load",
                format!("where load `{}` acts is not known", load.name),
                "give it a [[load]] with `grid` and `component`, or take [dynamic] out",
            ));
        };
        columns.push(l);
    }
    let strain_of = |case: &CaseResult| -> Result<Vec<f64>, Faults> {
        let at = |name: &String| {
            let gauge = task.prepared.gauges.iter().find(|g| g.name == *name);
            gauge.and_then(|g| reading(g, case)).ok_or_else(|| {
                fault(
                    "gauge",
                    format!("gauge `{name}` has no strain in the structure's modes"),
                    "take it out, or move it to an element of the deck",
                )
            })
        };
        s.gauges.iter().map(at).collect()
    };
    let modes = (0..n)
        .map(|j| {
            let of_load = |l: &usize| work_of[*l][j] / job.loads[*l].applied;
            Ok(ElasticMode {
                hz: solved.modes[j].frequency,
                strain: strain_of(&solved.strain.cases[j])?,
                work: columns.iter().map(of_load).collect(),
            })
        })
        .collect::<Result<_, Faults>>()?;
    Ok(Dynamics {
        modes,
        up_to_hz: asked.up_to_hz,
        damping: asked.damping,
        frequency_sd: asked.frequency_uncertainty_rel,
        damping_sd: asked.damping_uncertainty_rel,
    })
}

/// The modes of the structure as the cases hold it, beyond `end_hz` where it has as many.
fn modes_up_to(
    work: &mut Work,
    deck: &crate::app::deck::DeckModel,
    cases: &[LoadCase],
    end_hz: f64,
) -> Result<ModalSolution, Faults> {
    let spc = cases.first().and_then(|c| c.spc);
    let mut count = FIRST_MODES;
    loop {
        let options = SolveOptions {
            stop: work.cx.progress.stop(),
            ..SolveOptions::default()
        };
        let solved = work
            .stage("modes", |_| {
                solve_modes(&deck.model, spc, deck.model.mpc, count, &options)
            })
            .map_err(|e| faults_of(&e, deck))?;
        let beyond = solved.modes.last().is_none_or(|m| m.frequency >= end_hz);
        if beyond || solved.modes.len() < count || count == MOST_MODES {
            return Ok(solved);
        }
        count = (2 * count).min(MOST_MODES);
    }
}

fn motion_of(dynamics: &Dynamics, rested: &AtRest, step_s: f64) -> Motion {
    let share = |(moves, load): (&f64, &f64)| Some((moves / load).sqrt()).filter(|r| r.is_finite());
    Motion {
        up_to_hz: dynamics.up_to_hz,
        modes_hz: dynamics.modes.iter().map(|m| m.hz).collect(),
        blank_s: rested.reach as f64 * step_s,
        change_rel: rested.motion.iter().zip(&rested.load).map(share).collect(),
    }
}

/// What was done to the record.
fn about(motion: &Motion, asked: Dynamic, file: &str) -> Finding {
    let known = motion.change_rel.iter().flatten();
    let most = known.fold(0.0_f64, |a, b| a.max(*b));
    let first = motion.modes_hz.first();
    let first = first.map_or_else(String::new, |f| format!(", the first at {f:.2} Hz"));
    Finding::new(
        Severity::Info,
        "vibration-taken-out",
        file,
        format!(
            "loads up to {} Hz, with {} modes{first}, damping {}: taken as at rest, a load would be off by up to {:.1} % of its rms about the mean; \
             {:.3} s at either end and beside gaps are blank",
            asked.up_to_hz,
            motion.modes_hz.len(),
            asked.damping,
            100.0 * most,
            motion.blank_s
        ),
        "",
    )
    .with_numbers(most, 0.0)
}

/// Says that runs don't vibrate.
pub(super) fn without_record() -> Finding {
    Finding::new(
        Severity::Warning,
        "dynamic-without-record",
        "dynamic",
        "the strain file holds runs, which are taken as at rest: [dynamic] does nothing",
        "name a record, or take [dynamic] out",
    )
}
