//! The static path: frame, verdict, tables, extended model.

use super::deck_frame::{self, DeckFrame};
use super::extend::{self, sized};
use super::matrix_frame::{self, ModelPart};
use super::{causes, tables, words};
use crate::app::Session;
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::runs::{RunRow, read_runs};
use crate::app::job::strain::{StrainRows, StrainTable, read_strain};
use crate::app::job::{HoldOut, Job, WheelForces as JobWheelForces};
use crate::finding::{Finding, Severity};
use crate::model::{Model, Vec3};
use crate::reconcile::effect::{Correction, Extension};
use crate::reconcile::strain::{
    PayloadWeight, StiffnessOf, StrainFrame, WheelForces, angle_scatter, examine, predict,
};
use crate::reconcile::{NamedEffect, Observations, Outcome, Verdict};
use crate::report::figure::GaugePoints;
use crate::report::page::Paper;
use crate::report::scene::{Mark, Scene};
use crate::report::scene::{fields_of, mark_of_gap};
use crate::report::strain::{RunStrain, reconcile_page};
use crate::units::{KILO, STANDARD_GRAVITY_M_S2};
use serde_json::{Value, json};
use std::path::Path;

/// Noise of a measured wheel force where the runs file states none: nothing is assumed better than this, kN.
const LOAD_NOISE_KN: f64 = 0.05;

pub(super) fn run(job: &Job, path: &Path, session: &mut Session) -> Result<(), Faults> {
    let observations = observations(job, session)?;
    let channels = observations.channels.clone();
    if let (Some(r), None, None) = (&job.reconcile, &job.sensitivity, &job.model)
        && !r.causes.is_empty()
    {
        return causes::run(job, r, path, session, &observations);
    }
    let (part, deck) = match (&job.sensitivity, &job.model) {
        (Some(given), _) => {
            let read = |s: &mut Session| matrix_frame::read(&mut s.inputs, job, given, &channels);
            (session.stage("signatures", read)?, None)
        }
        (None, Some(_)) => {
            let (part, deck) = deck_frame::read(session, job, &channels)?;
            (part, Some(deck))
        }
        (None, None) => {
            return Err(Faults::from(Fault::of(
                &*job.file,
                "model",
                "neither `[model]` nor `[sensitivity]`",
                "name the deck, or the CSV file with S",
            )));
        }
    };
    let mut frame = frame(job, session, observations, part)?;
    let only = job
        .reconcile
        .as_ref()
        .and_then(|r| r.effects.clone())
        .unwrap_or_default();
    let mut outcome = session.stage("search", |_| examine(&frame, &only));
    if let Some(deck) = &deck {
        // A stiffness is solved again at the size that was found, until it stays.
        for _ in 0..RESOLVED {
            if !resolve_stiffness(job, session, deck, &mut frame, &outcome)? {
                break;
            }
            outcome = session.stage("search", |_| examine(&frame, &only));
        }
    }
    report(job, path, session, &frame, &outcome, deck.as_ref())
}

/// Solutions at a size that was found: the second is at the size to a few thousandths.
const RESOLVED: usize = 2;

/// Adds to the signature of a named stiffness the solution at its size; false where nothing new is to be solved.
fn resolve_stiffness(
    job: &Job,
    session: &mut Session,
    deck: &DeckFrame,
    frame: &mut StrainFrame,
    outcome: &Outcome,
) -> Result<bool, Faults> {
    /// Percent of stiffness: nearer to a known size the interpolation is exact.
    const NEAR: f64 = 1.0;
    /// A thickness can't be taken away.
    const LEAST: f64 = -80.0;
    let mut added = false;
    for e in &outcome.best_attempt {
        let (of, place, percent) = match &e.extension {
            Extension::ZoneStiffness { place, percent } => (StiffnessOf::Zone, place, percent),
            Extension::JointStiffness { place, percent } => (StiffnessOf::Joint, place, percent),
            _ => continue,
        };
        let Some(signature) = frame
            .stiffness
            .iter_mut()
            .find(|s| s.of == of && s.place == *place)
        else {
            continue;
        };
        let known = signature
            .at_percent
            .iter()
            .any(|p| (p.0 - percent).abs() < NEAR);
        let thickness = of == StiffnessOf::Zone;
        if known || percent.abs() < NEAR || (thickness && *percent < LEAST) {
            continue;
        }
        let change = session.stage("solve zones", |_| {
            deck.stiffness_change(job, of, place, *percent)
        })?;
        signature.at_percent.push((*percent, change));
        signature.at_percent.sort_by(|a, b| a.0.total_cmp(&b.0));
        added = true;
    }
    Ok(added)
}

/// Readings of the strain file and of a held-out file, runs by name.
fn observations(job: &Job, session: &mut Session) -> Result<Observations, Faults> {
    let Some(measured) = &job.measured else {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "measured",
            "no `[measured]`",
            "name the strain file",
        )));
    };
    let table = read_strain(&mut session.inputs, job, &measured.strain)?;
    let runs_of = |t: &StrainTable| match &t.rows {
        StrainRows::Runs(runs) => Ok(runs.clone()),
        StrainRows::Times(_) => {
            let wrong = "rows are samples of one record";
            Err(Faults::from(Fault::of(
                &*t.file,
                "run",
                wrong,
                "give the means of static runs, a row each, with a column `run`",
            )))
        }
    };
    let mut out = Observations {
        runs: runs_of(&table)?,
        channels: table.gauges.clone(),
        values: table.microstrain.clone(),
        held_out: Vec::new(),
    };
    out.held_out = match &measured.hold_out {
        HoldOut::Runs(names) => {
            let unknown: FaultList = names
                .iter()
                .filter(|n| !out.runs.contains(n))
                .map(|n| {
                    let wrong = format!("`{}` has no run `{n}`", table.file);
                    Fault::at(
                        &*job.file,
                        measured.line,
                        "measured.hold_out",
                        wrong,
                        "name runs of the strain file",
                    )
                })
                .collect();
            Faults::check(unknown)?;
            out.runs.iter().map(|r| names.contains(r)).collect()
        }
        _ => vec![false; out.runs.len()],
    };
    if let HoldOut::File(named) = &measured.hold_out {
        let kept = read_strain(&mut session.inputs, job, named)?;
        if kept.gauges != out.channels {
            return Err(Faults::from(Fault::of(
                &*kept.file,
                "header",
                "other gauges than the strain file",
                "give the same columns",
            )));
        }
        let names = runs_of(&kept)?;
        out.held_out.extend(vec![true; names.len()]);
        out.runs.extend(names);
        out.values.extend(&kept.microstrain);
    }
    if out.held_out.iter().all(|h| *h) || out.runs.len() < 2 {
        let wrong = "fewer than one run to fit and one to prove";
        return Err(Faults::from(Fault::of(
            &*table.file,
            "run",
            wrong,
            "measure more runs, keep some from `hold_out`",
        )));
    }
    if !out.held_out.iter().any(|h| *h) {
        session.findings.push(Finding::new(
            Severity::Warning,
            "no-hold-out",
            &*table.file,
            "no run is held out: the gap is cross-validated, every run in turn judged by what the others tell",
            "keep a third of the runs with `hold_out`",
        ));
    }
    Ok(out)
}

/// Joins what the model says with what was measured.
fn frame(
    job: &Job,
    session: &mut Session,
    observations: Observations,
    part: ModelPart,
) -> Result<StrainFrame, Faults> {
    let Some(runs) = &job.runs else {
        let remedy = "add `[runs]` with the wheel forces and the payload of each run";
        return Err(Faults::from(Fault::of(
            &*job.file,
            "runs",
            "no `[runs]`",
            remedy,
        )));
    };
    let rows = read_runs(&mut session.inputs, job, runs)?;
    let gravity = job
        .payload
        .as_ref()
        .and_then(|p| p.gravity_m_s2)
        .unwrap_or(STANDARD_GRAVITY_M_S2);
    let mut faults = FaultList::new();
    let (mut loads, mut payload) = (Vec::new(), Vec::new());
    for run in &observations.runs {
        let Some(row) = rows.iter().find(|r| r.run == *run) else {
            faults.push(Fault::of(
                &*runs.file.given,
                "run",
                format!("no row for run `{run}`"),
                "give every run of the strain file a row",
            ));
            continue;
        };
        for name in &part.load_names {
            match row.loads_si.get(name) {
                Some(n) => loads.push(n / KILO),
                None => faults.push(Fault::at(
                    &*runs.file.given,
                    row.line,
                    name.clone(),
                    format!("run `{run}` has no value for load `{name}`"),
                    "give the load in the runs file, and its column in `runs.columns`",
                )),
            }
        }
        payload.push(payload_of(row, gravity, part.payload_origin));
    }
    Faults::check(faults)?;
    let load_noise = runs
        .noise
        .force
        .map_or(LOAD_NOISE_KN, |f| f * runs.units.force.si / KILO);
    let measured = job.measured.as_ref();
    let mut frame = StrainFrame {
        observations,
        gauges: part.gauges,
        load_names: part.load_names,
        load_positions: part.load_positions,
        influence: part.influence,
        tensors: part.tensors,
        per_mm: part.per_mm,
        loads,
        payload,
        payload_origin: part.payload_origin,
        payload_weight: if job.payload.as_ref().is_none_or(|p| p.weight_in_model) {
            PayloadWeight::InModel
        } else {
            PayloadWeight::Missing
        },
        wheel_forces: match runs.wheel_forces {
            JobWheelForces::Measured => WheelForces::Measured,
            JobWheelForces::FlatGroundModel => WheelForces::FlatGroundModel,
        },
        other_loads: part.other_loads,
        nuisance: part.nuisance,
        thermal_uniform: part.thermal_uniform,
        thermal_gradient: part.thermal_gradient,
        masses: part.masses,
        stiffness: part.stiffness,
        noise: measured.map_or(1.0, |m| m.noise_microstrain),
        load_noise,
        model_rel: measured.map_or(0.0, |m| m.model_uncertainty_rel),
        as_modelled: part.as_modelled,
        scatter: part.scatter,
    };
    // From a deck it is known at the gauges themselves, and there already.
    let stated = job.reconcile.as_ref().and_then(|r| r.angle_tolerance_deg);
    if let (Some(_), Some(degrees)) = (&job.sensitivity, stated.filter(|d| *d > 0.0)) {
        let scatter = angle_scatter(&frame, degrees);
        frame.scatter.push(scatter);
    }
    Ok(frame)
}

fn payload_of(row: &RunRow, gravity: f64, origin: [f64; 2]) -> [f64; 3] {
    let mass = row
        .payload_mass_kg
        .or(row.payload_force_n.map(|f| f / gravity))
        .unwrap_or(0.0);
    [
        mass,
        row.payload_x_m.map_or(0.0, |x| x - origin[0]),
        row.payload_y_m.map_or(0.0, |y| y - origin[1]),
    ]
}

/// The size of a fault that has no parameter: -1 for a turned sign, 0 for a channel that says nothing, 1 for an exchange.
fn channel_size(e: &NamedEffect) -> Option<f64> {
    let Extension::Channels(list) = &e.extension else {
        return None;
    };
    match &list.first()?.1 {
        Correction::Sign => Some(-1.0),
        Correction::Ignore => Some(0.0),
        _ => Some(1.0),
    }
}

fn effect_json(e: &NamedEffect) -> Value {
    let first = |v: &[f64]| v.first().copied().filter(|x| x.is_finite());
    json!({
        "id": e.id,
        "where": e.place,
        "size": first(&e.size).or(channel_size(e)),
        "sigma": first(&e.sigma),
        "unit": e.unit,
        "sizes": e.size,
        "sigmas": e.sigma,
        "plausible": e.plausible,
    })
}

fn report(
    job: &Job,
    path: &Path,
    session: &mut Session,
    frame: &StrainFrame,
    outcome: &Outcome,
    deck: Option<&DeckFrame>,
) -> Result<(), Faults> {
    session.put("verdict", outcome.verdict.word())?;
    session.put(
        "named",
        outcome
            .effects
            .iter()
            .map(|e| e.id.clone())
            .collect::<Vec<_>>(),
    )?;
    session.put(
        "effects",
        outcome.effects.iter().map(effect_json).collect::<Vec<_>>(),
    )?;
    session.put(
        "best_attempt",
        outcome
            .best_attempt
            .iter()
            .map(effect_json)
            .collect::<Vec<_>>(),
    )?;
    let rivals: Vec<Value> = outcome
        .rivals
        .iter()
        .map(|r| {
            let place = |id: &String| id.split_once(':').map(|p| p.1.to_owned());
            json!({
                "id": r.ids.join(" + "),
                "where": r.ids.iter().filter_map(place).collect::<Vec<_>>().join(" + "),
                "evidence_difference": r.evidence_difference,
                "gap_after": r.gap_after,
                "indistinguishable": r.indistinguishable,
            })
        })
        .collect();
    session.put("rivals", rivals)?;
    session.put(
        "gap",
        json!({
            "metric": "RMS(reading - model) / RMS(reading); amplitudes of the named effects that differ from run to run are found from one \
                       half of the gauges and judged on the other; nothing else is found anew, before, after or in the floor",
            "basis": outcome.gap.basis.words(),
            "before": outcome.gap.before,
            "after": outcome.gap.after,
            "floor": outcome.gap.floor,
            "mesh": outcome.gap.mesh,
            "explained_share": outcome.gap.explained_share(),
            "loads_found": outcome.gap.loads_found.map(|g| json!({ "before": g.before, "after": g.after, "floor": g.floor })),
        }),
    )?;
    session.put("evidence", outcome.evidence)?;
    session.put("wins_of_100", outcome.wins)?;
    session.put("noise_factor", outcome.noise_factor)?;
    let n = outcome.covariance.len().isqrt();
    session.put(
        "covariance",
        outcome.covariance.chunks(n.max(1)).collect::<Vec<_>>(),
    )?;
    let [before, after, held_out] = outcome.reduced_chi2;
    session.put(
        "reduced_chi2",
        json!({ "before": before, "after": after, "held_out": held_out }),
    )?;
    session.put("sits", &outcome.sits)?;
    session.put("remains", &outcome.remains)?;
    session.put("next_measurement", &outcome.next_measurement)?;
    session.put(
        "detectable",
        outcome
            .detectable
            .iter()
            .map(|d| json!({ "id": d.id, "size": d.size, "unit": d.unit }))
            .collect::<Vec<_>>(),
    )?;
    let off = |m: &crate::reconcile::Misfit| json!({ "name": m.name, "reduced_chi2": m.reduced_chi2, "deviate": m.deviate });
    session.put(
        "gauges_off_before",
        outcome
            .gauges_off_before
            .iter()
            .map(off)
            .collect::<Vec<_>>(),
    )?;
    session.put(
        "gauges_off",
        outcome.gauges_off.iter().map(off).collect::<Vec<_>>(),
    )?;
    session.put(
        "runs_off",
        outcome.runs_off.iter().map(off).collect::<Vec<_>>(),
    )?;
    findings(session, outcome);
    tables::write(session, path, outcome)?;
    let extended = if outcome.verdict == Verdict::Named {
        extend::write(job, path, session, frame, outcome, deck)?
    } else {
        None
    };
    session.put("extended_model", extended)?;
    say(session, outcome);
    let model = deck.map(|d| d.fields.model());
    let metres = if model.is_some() {
        job.units.length_m()
    } else {
        1.0
    };
    let marks: Vec<Mark> = frame
        .gauges
        .iter()
        .zip(&outcome.channels)
        .filter_map(|(g, gap)| {
            let at = Vec3::from(g.position?) / metres;
            Some(mark_of_gap(at, gap))
        })
        .collect();
    // Where S is given there is no model to draw: the gauges alone.
    let nothing = Model::default();
    let scene = (!marks.is_empty()).then(|| Scene {
        model: model.unwrap_or(&nothing),
        marks,
        fields: deck.map_or_else(Vec::new, |d| fields_of(job, &d.fields)),
        arrows: Vec::new(),
    });
    let strain = run_strain(frame);
    let page = reconcile_page(
        &job.title,
        outcome,
        scene.as_ref(),
        &strain,
        &session.findings,
    );
    session.write_page(path, page.on_paper(Paper::Report))
}

/// Measured and predicted strain of the runs, by the model as it was given.
fn run_strain(frame: &StrainFrame) -> RunStrain {
    let predicted = predict(frame, &[]);
    let o = &frame.observations;
    let n = frame.n_gauges();
    let held = |run: &usize| o.held_out.get(*run).copied().unwrap_or(false);
    let (held_out, used): (Vec<usize>, Vec<usize>) = (0..frame.n_runs()).partition(held);
    let points = (0..n)
        .map(|g| {
            let pairs = [&used, &held_out].map(|runs| -> Vec<(f64, f64)> {
                let of = |r: &usize| (predicted[r * n + g], o.value(*r, g));
                runs.iter().map(of).collect()
            });
            let square = |p: &(f64, f64)| (p.1 - p.0).powi(2);
            let known: Vec<f64> = pairs.iter().flatten().map(square).collect();
            let known: Vec<f64> = known.into_iter().filter(|v| v.is_finite()).collect();
            GaugePoints {
                name: o.channels.get(g).cloned().unwrap_or_default(),
                residual: (known.iter().sum::<f64>() / known.len().max(1) as f64).sqrt(),
                points: pairs,
            }
        })
        .collect();
    let names = |runs: &[usize]| runs.iter().map(|r| o.runs[*r].clone()).collect();
    RunStrain {
        points,
        used: names(&used),
        held_out: names(&held_out),
    }
}

fn findings(session: &mut Session, outcome: &Outcome) {
    /// A stated noise is known to 15 %: what the readings show beyond is told.
    const NOISE_KNOWN: f64 = 1.15;
    if outcome.noise_factor > NOISE_KNOWN {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "noise-above-stated",
                "measured.noise_microstrain",
                format!("the readings scatter {:.2} times as much as their stated noise allows, alike at all gauges", outcome.noise_factor),
                "find what scatters (repeat a run three times), or state the noise that the repeats show",
            )
            .with_numbers(outcome.noise_factor, NOISE_KNOWN),
        );
    }
    match outcome.verdict {
        Verdict::Unknown => session.findings.push(
            Finding::new(
                Severity::Warning,
                "gap-unexplained",
                "model",
                format!(
                    "there is a gap that nothing in the library closes: {}",
                    outcome.remains
                ),
                outcome.next_measurement.clone(),
            )
            .with_numbers(outcome.reduced_chi2[1], 1.0),
        ),
        Verdict::BelowDetectability => {
            let hint = outcome
                .rivals
                .first()
                .map(|r| r.ids.join(" + "))
                .unwrap_or_default();
            let size = outcome.detectable.iter().find(|d| d.id == hint).map(|d| {
                format!(
                    "; the smallest that would be seen: {:.3} {}",
                    d.size, d.unit
                )
            });
            session.findings.push(Finding::new(
                Severity::Info,
                "below-detectability",
                hint,
                format!(
                    "a hint of an effect, too small to name{}",
                    size.unwrap_or_default()
                ),
                outcome.next_measurement.clone(),
            ));
        }
        Verdict::Named => {
            for r in outcome.rivals.iter().filter(|r| r.indistinguishable) {
                session.findings.push(
                    Finding::new(
                        Severity::Warning,
                        "rival",
                        r.ids.join(" + "),
                        "explains these data as well as what was named",
                        outcome.next_measurement.clone(),
                    )
                    .with_numbers(r.evidence_difference, 3.0),
                );
            }
            for l in outcome.loads.iter().filter(|l| l.moved()) {
                session.findings.push(
                    Finding::new(
                        Severity::Info,
                        "load-moved",
                        format!("{} in {}", l.load, l.run),
                        format!(
                            "the recovered load moves from {:.2} to {:.2} kN with the effect in",
                            l.before, l.after
                        ),
                        "use the extended model",
                    )
                    .with_numbers((l.after - l.before).abs(), 2.0 * l.sigma),
                );
            }
        }
        Verdict::None => {}
    }
}

fn say(session: &mut Session, outcome: &Outcome) {
    let effects = outcome.effects.iter().map(sized);
    words::say(
        session,
        outcome.verdict,
        effects,
        &outcome.gap,
        &outcome.rivals,
        &format!("{} runs", outcome.gap.basis.words()),
    );
    session.say(format!("where: {}", outcome.sits));
    session.say(format!("left: {}", outcome.remains));
    session.say(format!("next measurement: {}", outcome.next_measurement));
}
