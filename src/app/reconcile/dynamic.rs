//! The dynamic path: record and vehicle, verdict, tables, page, extended job.

use super::dynamic_extend::{self, sized};
use super::words;
use crate::app::Session;
use crate::app::fault::Faults;
use crate::app::job::{Job, Vehicle as VehicleJob};
use crate::app::vehicle::{VehicleRecords, read_vehicle, vehicle_fault, wish_of};
use crate::finding::{Finding, Severity};
use crate::reconcile::motion::gap::{Proof, RecordGap};
use crate::reconcile::motion::{
    MotionEffect, MotionFrame, MotionOutcome, SimulatedGap, examine, simulated_gap,
};
use crate::reconcile::{Rival, Verdict};
use crate::report::figure::gap_by_channel;
use crate::report::page::{Block, Page, Paper, Section, figure_section, number, table_section};
use crate::report::vehicle::{Curve, restoring_curves, restoring_section, write_restoring_force};
use crate::vehicle::identify::{Identification, Question, identify};
use crate::vehicle::layout::Vehicle;
use crate::vehicle::motion::{Treatment, motion};
use crate::vehicle::preset::{NEXT, Wish, add_next, vehicle};
use crate::vehicle::stretch::slow_stretches;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

pub(super) fn run(job: &Job, path: &Path, session: &mut Session) -> Result<(), Faults> {
    let records = session.stage("read", |s| read_vehicle(s, job))?;
    let Some(section) = &job.vehicle else {
        return Ok(());
    };
    let frame = frame(section, &records);
    let only = job
        .reconcile
        .as_ref()
        .and_then(|r| r.effects.clone())
        .unwrap_or_default();
    let outcome = session
        .stage("search", |_| examine(&frame, &only))
        .map_err(|e| Faults::from(vehicle_fault(job, &section.data.given, &e)))?;
    let (wheels, found) =
        session.stage("wheel forces", |_| wheel_forces(&records, &frame, &outcome));
    let surface = found.as_ref().and_then(|f| restoring(&records, f));
    let named = outcome.verdict == Verdict::Named && repairable(&outcome);
    let simulation = named.then(|| session.stage("simulate", |_| simulated_gap(&frame, &outcome)));
    put(session, &outcome, &wheels)?;
    session.put("simulation", simulation.as_ref().map(simulation_json))?;
    findings(session, &outcome);
    let extended = if named {
        Some(dynamic_extend::write(job, path, session, &frame, &outcome)?)
    } else {
        None
    };
    session.put("extended_model", extended)?;
    let simulation = simulation.and_then(Result::ok);
    write_tables(
        job,
        path,
        session,
        &outcome,
        &wheels,
        simulation.as_ref(),
        surface,
    )?;
    say(session, &outcome, simulation.as_ref());
    Ok(())
}

/// A dead channel can't be put right by a model.
fn repairable(outcome: &MotionOutcome) -> bool {
    outcome
        .effects
        .iter()
        .all(|e| !e.id.starts_with("dead_channel") && !e.id.starts_with("saturated_channel"))
}

/// The frame of a job: one side of an axle is compared, the other is a witness where it was measured.
fn frame(section: &VehicleJob, records: &VehicleRecords) -> MotionFrame {
    let q = &records.question;
    let mut model = q.vehicle.clone();
    let recorded = |name: &str| {
        records.data.has(name) && records.hold_out.as_ref().is_none_or(|h| h.has(name))
    };
    let witnessed = ["a_body_other", "a_wheel_other"]
        .iter()
        .all(|c| recorded(section.columns.get(*c).map_or(*c, String::as_str)));
    if section.model == "front2" && witnessed {
        let wish = Wish {
            model: "front_pair".into(),
            ..wish_of(section)
        };
        if let Ok(pair) = vehicle(&wish) {
            model = Vehicle {
                steps: model.steps.clone(),
                ..pair
            };
        }
    }
    let bodies = if model.name == "front_pair" {
        vec![0, 1]
    } else {
        (0..model.bodies.len())
            .filter(|&b| !model.is_witness(b))
            .collect()
    };
    let next = section.columns.get(NEXT).map_or(NEXT, String::as_str);
    if recorded(next) {
        add_next(&mut model, next);
    }
    MotionFrame {
        bodies,
        vehicle: model,
        known: q.known.clone(),
        data: records.data.clone(),
        hold_out: records.hold_out.clone(),
        band: q.band,
        gravity: q.gravity,
        noise_acc: section.noise_acc,
        noise_force: section.noise_force,
        gain_tolerance: q.gain_tolerance,
        sync_tolerance_s: q.sync_tolerance_s,
        corrections: q.corrections.clone(),
        units: q.units.clone(),
    }
}

/// The restoring forces of the analyst's links on the fitted record: table and curves.
fn restoring(records: &VehicleRecords, found: &Identification) -> Option<(String, Vec<Curve>)> {
    let q = &records.question;
    let slow = slow_stretches(&found.vehicle, &found.values, &records.data, &q.corrections);
    let treatment = Treatment {
        adjust: q.corrections.clone(),
        slow,
        ..Treatment::of(q.band)
    };
    let moved = motion(&found.vehicle, &records.data, &treatment).ok()?;
    Some((
        write_restoring_force(found, &moved),
        restoring_curves(found, &moved),
    ))
}

/// Misfit of each measured wheel force, without and with the effects in, as `identify` leaves it on held-out data; and the analyst's
/// vehicle as identified.
#[allow(clippy::type_complexity, reason = "a short list and what it came from")]
fn wheel_forces(
    records: &VehicleRecords,
    frame: &MotionFrame,
    outcome: &MotionOutcome,
) -> (Vec<(String, f64, Option<f64>)>, Option<Identification>) {
    let identified = |q: &Question| identify(q, &records.data, records.hold_out.as_ref()).ok();
    let misfits = |id: &Identification| -> Vec<(String, f64)> {
        id.fit
            .iter()
            .filter(|f| id.vehicle.wheels.iter().any(|w| w.channel == f.channel))
            .map(|f| (f.channel.clone(), f.relative_rms))
            .collect()
    };
    let found = identified(&records.question);
    let before = found.as_ref().map(misfits).unwrap_or_default();
    let after = (outcome.verdict == Verdict::Named && repairable(outcome)).then(|| {
        let q = Question {
            vehicle: outcome
                .after
                .as_ref()
                .map_or_else(|| frame.vehicle.clone(), |g| g.vehicle.clone()),
            corrections: outcome.corrections.clone(),
            ..records.question.clone()
        };
        identified(&q).as_ref().map(misfits).unwrap_or_default()
    });
    let list = before
        .into_iter()
        .map(|(name, b)| {
            let a = after
                .as_ref()
                .and_then(|a| a.iter().find(|x| x.0 == name).map(|x| x.1));
            (name, b, a)
        })
        .collect();
    (list, found)
}

fn effect_json(e: &MotionEffect) -> Value {
    let first = |v: &[f64]| v.first().copied().filter(|x| x.is_finite());
    json!({
        "id": e.id,
        "where": e.place,
        "size": first(&e.size),
        "sigma": first(&e.sigma),
        "unit": e.unit,
        "sizes": e.size,
        "sigmas": e.sigma,
        "plausible": e.plausible,
    })
}

fn rival_json(r: &Rival) -> Value {
    let place = |id: &String| id.split_once(':').map(|p| p.1.to_owned());
    json!({
        "id": r.ids.join(" + "),
        "where": r.ids.iter().filter_map(place).collect::<Vec<_>>().join(" + "),
        "evidence_difference": r.evidence_difference,
        "gap_after": r.gap_after,
        "indistinguishable": r.indistinguishable,
    })
}

fn simulation_json(s: &Result<SimulatedGap, String>) -> Value {
    let s = match s {
        Ok(s) => s,
        Err(reason) => return json!({ "not_simulated": reason }),
    };
    let channels = s.channels.iter().map(|c| {
        json!({ "channel": c.channel, "measured_rms": c.measured, "before": c.before, "after": c.after })
    });
    let parameters = s.parameters.iter().map(|(name, regression, simulation)| {
        json!({ "name": name, "by_regression": regression, "by_simulation": simulation })
    });
    json!({
        "metric": "RMS of measured less simulated on held-out data, in the unit of the channel; both models fitted by simulation",
        "channels": channels.collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
    })
}

fn put(
    session: &mut Session,
    outcome: &MotionOutcome,
    wheels: &[(String, f64, Option<f64>)],
) -> Result<(), Faults> {
    let ids: Vec<&str> = outcome.effects.iter().map(|e| e.id.as_str()).collect();
    session.put("verdict", outcome.verdict.word())?;
    session.put("named", ids)?;
    let list = |e: &[MotionEffect]| e.iter().map(effect_json).collect::<Vec<_>>();
    session.put("effects", list(&outcome.effects))?;
    session.put("best_attempt", list(&outcome.best_attempt))?;
    session.put(
        "rivals",
        outcome.rivals.iter().map(rival_json).collect::<Vec<_>>(),
    )?;
    session.put(
        "gap",
        json!({
            "metric": format!(
                "RMS of the equations' residual / RMS of the measured quantity (wheel force, mass times acceleration), in band, \
                 on {}, root mean square over equations",
                outcome.judged_by.words()
            ),
            "judged_by": outcome.judged_by,
            "before": outcome.gap.before,
            "after": outcome.gap.after,
            "floor": outcome.gap.floor,
            "explained_share": outcome.gap.explained_share(),
        }),
    )?;
    let smallest = outcome
        .smallest
        .iter()
        .map(|s| json!({ "id": s.id, "size": s.size, "unit": s.unit }));
    session.put("detectable", smallest.collect::<Vec<_>>())?;
    session.put("evidence", outcome.evidence)?;
    let [before, after] = outcome.reduced_chi2;
    session.put("reduced_chi2", json!({ "before": before, "after": after }))?;
    session.put("remains", &outcome.remains)?;
    session.put("next_measurement", &outcome.next_measurement)?;
    let forces: Vec<Value> = wheels
        .iter()
        .map(|(n, b, a)| json!({ "channel": n, "before": b, "after": a }))
        .collect();
    session.put("wheel_force", forces)
}

fn findings(session: &mut Session, outcome: &MotionOutcome) {
    if outcome.verdict == Verdict::Unknown {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "gap-unexplained",
                "model",
                format!(
                    "There is a gap that nothing in the library closes. {}",
                    outcome.remains
                ),
                outcome.next_measurement.clone(),
            )
            .with_numbers(outcome.reduced_chi2[1], 1.0),
        );
    }
    if outcome.judged_by != Proof::HeldOut {
        session.findings.push(Finding::new(
            Severity::Warning,
            "no-hold-out",
            "vehicle.hold_out",
            format!(
                "No record was held out: gaps are those of {}.",
                outcome.judged_by.words()
            ),
            "Name a record of another stretch of road as `hold_out` in [vehicle].",
        ));
    }
    if outcome.verdict == Verdict::BelowDetectability
        && let Some(hint) = outcome.rivals.first()
    {
        let sizes: Vec<String> = outcome
            .smallest
            .iter()
            .filter(|s| hint.ids.contains(&s.id))
            .map(|s| format!("`{}` {:.3e} {}", s.id, s.size, s.unit))
            .collect();
        session.findings.push(
            Finding::new(
                Severity::Info,
                "below-detectability",
                hint.ids.join(" + "),
                format!(
                    "There is a hint, too small for this record to name. The smallest size that would have been named: {}.",
                    sizes.join(", ")
                ),
                outcome.next_measurement.clone(),
            )
            .with_numbers(-hint.evidence_difference, outcome.decisive),
        );
    }
    if outcome.verdict == Verdict::Named {
        for r in outcome.rivals.iter().filter(|r| r.indistinguishable) {
            session.findings.push(
                Finding::new(
                    Severity::Warning,
                    "rival",
                    r.ids.join(" + "),
                    "Explains these data as well as what was named.",
                    outcome.next_measurement.clone(),
                )
                .with_numbers(r.evidence_difference, 3.0),
            );
        }
    }
}

/// `gap.csv`, the gap by band, time and amplitude, and the page.
fn write_tables(
    job: &Job,
    path: &Path,
    session: &mut Session,
    outcome: &MotionOutcome,
    wheels: &[(String, f64, Option<f64>)],
    simulation: Option<&SimulatedGap>,
    surface: Option<(String, Vec<Curve>)>,
) -> Result<(), Faults> {
    let mut gap = String::from("equation,before,after,floor\n");
    // Equation, upper edge of the stretch, before, after.
    let mut bands = String::from("equation,up_to_hz,before,after\n");
    let mut times = String::from("equation,up_to_s,before,after\n");
    let mut sizes = String::from("equation,up_to_size_over_rms,before,after\n");
    // Gap before, after, floor.
    let mut gaps: Vec<(String, [f64; 3])> = Vec::new();
    let after_of = |name: &str, g: &Option<RecordGap>| {
        g.as_ref()
            .and_then(|g| g.equations.iter().find(|e| e.name == name).cloned())
    };
    for e in outcome.before.iter().flat_map(|g| &g.equations) {
        let after = after_of(&e.name, &outcome.after);
        let left = after.as_ref().map_or(f64::NAN, |a| a.gap);
        let _ = writeln!(gap, "{},{:.6},{left:.6},{:.6}", e.name, e.gap, e.floor);
        gaps.push((e.name.clone(), [e.gap, left, e.floor].map(|v| 100.0 * v)));
        let lists = [
            (&mut bands, &e.by_band, after.as_ref().map(|a| &a.by_band)),
            (
                &mut times,
                &e.profile.by_time,
                after.as_ref().map(|a| &a.profile.by_time),
            ),
            (
                &mut sizes,
                &e.profile.by_amplitude,
                after.as_ref().map(|a| &a.profile.by_amplitude),
            ),
        ];
        for (table, before, after) in lists {
            for (i, b) in before.iter().enumerate() {
                let a = after.and_then(|a| a.get(i)).map_or(f64::NAN, |a| a[1]);
                let _ = writeln!(table, "{},{:.3},{:.6},{a:.6}", e.name, b[0], b[1]);
            }
        }
    }
    let effects: Vec<Vec<String>> = outcome
        .best_attempt
        .iter()
        .map(|e| {
            let sizes: Vec<String> = e
                .size
                .iter()
                .zip(&e.sigma)
                .map(|(v, s)| format!("{v:.5e} +- {s:.1e}"))
                .collect();
            vec![e.id.clone(), sizes.join(", "), e.unit.clone()]
        })
        .collect();
    let rivals: Vec<Vec<String>> = outcome
        .rivals
        .iter()
        .map(|r| {
            vec![
                r.ids.join(" + "),
                format!("{:.1}", r.evidence_difference),
                format!("{:.2}", 100.0 * r.gap_after),
            ]
        })
        .collect();
    let forces: Vec<Vec<String>> = wheels
        .iter()
        .map(|(n, b, a)| {
            vec![
                n.clone(),
                format!("{:.2}", 100.0 * b),
                a.map_or("-".into(), |a| format!("{:.2}", 100.0 * a)),
            ]
        })
        .collect();
    let rows: Vec<Vec<String>> = gaps
        .iter()
        .map(|(name, values)| {
            let cells = values.map(|v| format!("{v:.2}"));
            std::iter::once(name.clone()).chain(cells).collect()
        })
        .collect();
    let verdict = format!("{}.", outcome.verdict.word());
    let mut sections: Vec<Section> = vec![
        Section::new(
            "Verdict",
            vec![
                Block::Stressed(verdict, outcome.remains.clone()),
                Block::Stressed("Next measurement:".into(), outcome.next_measurement.clone()),
            ],
        ),
        figure_section(
            "Gap before and after",
            gap_by_channel(&gaps, "% of the measured quantity,"),
            &format!(
                "On {}, by equation of motion; stroke: the floor.",
                outcome.judged_by.words()
            ),
        ),
        table_section(
            "Gap by equation, % of the measured quantity",
            &["equation", "before", "after", "floor"],
            &rows,
            "",
        ),
        table_section("Effects", &["effect", "size", "unit"], &effects, ""),
        table_section(
            "Other explanations",
            &["effects", "log evidence behind", "gap after, %"],
            &rivals,
            "",
        ),
        table_section(
            "Wheel force, % left over",
            &["channel", "before", "after"],
            &forces,
            "",
        ),
    ];
    if let Some(s) = simulation {
        let cells = s.channels.iter().map(|c| {
            let values = [c.measured, c.before, c.after].map(number);
            std::iter::once(c.channel.clone()).chain(values).collect()
        });
        sections.push(table_section(
            "Simulated held-out data, RMS in the unit of the channel",
            &["channel", "measured", "error before", "error after"],
            &cells.collect::<Vec<Vec<String>>>(),
            "Both models with the parameters that simulate the fitted record best.",
        ));
    }
    let (table, curves) = surface.unwrap_or_default();
    sections.push(restoring_section(&curves));
    let page = Page::new(
        &job.title,
        "Where vehicle model and record disagree, and what is missing",
        &session.findings,
        sections,
    );
    let output = session.output_for(path)?;
    for (name, text) in [
        ("gap.csv", gap),
        ("gap_bands.csv", bands),
        ("gap_times.csv", times),
        ("gap_amplitudes.csv", sizes),
        ("restoring_force.csv", table),
    ] {
        output
            .write_bytes(name, text.as_bytes())
            .map_err(Faults::from)?;
    }
    session.write_page(path, page.on_paper(Paper::Report))
}

fn say(session: &mut Session, outcome: &MotionOutcome, simulation: Option<&SimulatedGap>) {
    let effects = outcome.effects.iter().map(sized);
    words::say(
        session,
        outcome.verdict,
        effects,
        &outcome.gap,
        &outcome.rivals,
        outcome.judged_by.words(),
    );
    for c in simulation.iter().flat_map(|s| &s.channels) {
        session.say(format!(
            "simulated {}: error {} before, {} after, of {}",
            c.channel,
            number(c.before),
            number(c.after),
            number(c.measured)
        ));
    }
    session.say(&outcome.remains);
    session.say(format!("next measurement: {}", outcome.next_measurement));
}
