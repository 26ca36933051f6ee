//! The extended model: a copy of the job whose files hold the named effects, so that every command runs it as it is.
//!
//! Effects of a channel go into the readings (`strain_extended.csv`), effects of structure into S (`sensitivity_extended.csv`), loads that
//! were left out become columns of S or loads of the job, the payload's place goes into `runs_extended.csv`.

use super::deck_frame::DeckFrame;
use super::deck_thermal;
use super::extended_deck::NamedStiffness;
use super::extended_job::ExtendedJob;
use super::extended_loads::{self, entries, side_loads};
use super::words::Sized;
use crate::app::Session;
use crate::app::fault::Faults;
use crate::app::job::Job;
use crate::finding::{Finding, Severity};
use crate::reconcile::effect::{Correction, Extension, Nuisance};
use crate::reconcile::strain::{
    StiffnessOf, StrainFrame, StrainState, corrected_readings, extended_state,
};
use crate::reconcile::{NamedEffect, Outcome};
use crate::report::csv_cell;
use crate::units::KILO;
use std::fmt::Write;
use std::path::Path;
use toml::{Table, Value};

const DECK: &str = "deck_extended.bdf";
const JOB: &str = "job_extended.toml";
const STRAIN: &str = "strain_extended.csv";
const SENSITIVITY: &str = "sensitivity_extended.csv";
const PAYLOAD: &str = "payload_extended.csv";
const RUNS: &str = "runs_extended.csv";

/// Why an effect can't be put into the model of this job; `None` where it can.
fn out_of_reach(job: &Job, e: &NamedEffect, deck: Option<&DeckFrame>) -> Option<&'static str> {
    let turned = |c: &Correction| matches!(c, Correction::AngleDeg(_) | Correction::PositionMm(_));
    match (&e.extension, deck) {
        (Extension::Channels(list), Some(_)) if list.iter().any(|(_, c)| turned(c)) => {
            Some("another angle or place of the gauge: change it in the list of gauges")
        }
        (Extension::Scale(_), Some(_)) => {
            Some("one factor on all strain: change the modulus in the deck, or the gains")
        }
        (Extension::LocalStiffness { .. } | Extension::Described { .. }, Some(_)) => {
            Some("a change of a region of the deck that no property bounds")
        }
        (
            Extension::NuisanceLoads {
                source: Nuisance::UniformTemperature,
                ..
            },
            Some(_),
        ) => Some(
            "the apparent strain of an even temperature, which no load of the deck makes: log the temperature in every run",
        ),
        (
            Extension::NuisanceLoads {
                source: Nuisance::TemperatureGradient,
                ..
            },
            Some(_),
        ) if job
            .reconcile
            .as_ref()
            .is_none_or(|r| r.temperature_set.is_none()) =>
        {
            Some(
                "a temperature that differs from place to place, and the job names no temperature set",
            )
        }
        (
            Extension::NuisanceLoads {
                source: Nuisance::Ground,
                ..
            },
            _,
        ) => Some("wheel forces of ground that is not flat: weigh every wheel where it stands"),
        (Extension::Nothing, _) => Some("no effect of the library"),
        _ => None,
    }
}

/// Writes the extended job; its path, relative to the folder the command was called in. `None`, with a finding for each effect that can't be
/// put into the model, where there is one.
pub(super) fn write(
    job: &Job,
    path: &Path,
    session: &mut Session,
    frame: &StrainFrame,
    outcome: &Outcome,
    deck: Option<&DeckFrame>,
) -> Result<Option<String>, Faults> {
    let not_in: Vec<Finding> = outcome
        .effects
        .iter()
        .filter_map(|e| out_of_reach(job, e, deck).map(|why| effect_not_in_model(&e.id, why)))
        .collect();
    if !not_in.is_empty() {
        session.findings.extend(not_in);
        return Ok(None);
    }
    let extended_deck = match deck {
        Some(d) => match deck_with(job, d, outcome) {
            Ok(bytes) => bytes,
            Err(finding) => {
                session.findings.push(finding);
                return Ok(None);
            }
        },
        None => None,
    };
    let names: Vec<&str> = outcome.effects.iter().map(|e| e.id.as_str()).collect();
    let mut extended = ExtendedJob::of(job, path, session, &names)?;
    let table = &mut extended.table;
    let mut files: Vec<(&str, String)> = Vec::new();
    if let Some(readings) = corrected_readings(frame, &outcome.effects) {
        files.push((STRAIN, strain_csv(frame, &readings)));
        set(table, "measured", "strain", STRAIN);
    }
    let state = extended_state(frame, &outcome.effects);
    let side = side_loads(job, &outcome.effects);
    match deck {
        None => files.extend(matrix_with(table, frame, outcome, &state)),
        Some(d) => {
            let list = table
                .entry("load")
                .or_insert_with(|| Value::Array(Vec::new()));
            if let Value::Array(list) = list {
                list.extend(entries(job, frame, &side));
                list.extend(deck_thermal::entry(job, d.fields.model(), &outcome.effects));
            }
        }
    }
    if outcome.effects.iter().any(|e| changes_notes(&e.extension)) {
        files.push((RUNS, runs_csv(frame, &state)));
        set(table, "runs", "file", RUNS);
        if let Some(Value::Table(runs)) = table.get_mut("runs") {
            runs.remove("columns");
            runs.insert(
                "units".into(),
                Value::Table(words_of(&[
                    ("force", "kN"),
                    ("mass", "kg"),
                    ("length", "m"),
                ])),
            );
        }
    }
    if outcome
        .effects
        .iter()
        .any(|e| matches!(e.extension, Extension::PayloadWeight))
    {
        let payload = table
            .entry("payload")
            .or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(p) = payload {
            p.insert("weight_in_model".into(), Value::Boolean(true));
        }
    }
    if extended_deck.is_some() {
        set(table, "model", "deck", DECK);
    }
    let output = session.output_for(path)?;
    for (name, content) in &files {
        output
            .write_bytes(name, content.as_bytes())
            .map_err(Faults::from)?;
    }
    if let Some(bytes) = &extended_deck {
        output.write_bytes(DECK, bytes).map_err(Faults::from)?;
    }
    extended
        .write(JOB, path, session, outcome.effects.iter().map(sized))
        .map(Some)
}

fn effect_not_in_model(id: &str, why: &str) -> Finding {
    Finding::new(
        Severity::Warning,
        "effect-not-in-model",
        id,
        format!("no extended model is written, since this effect can't be put into it: {why}"),
        "put it into the model by hand, then run `reconcile` again",
    )
}

/// The deck with the effects that it can hold; `None` where it stays as it is.
fn deck_with(job: &Job, deck: &DeckFrame, outcome: &Outcome) -> Result<Option<Vec<u8>>, Finding> {
    let mut stiffness: Vec<NamedStiffness> = Vec::new();
    let mut masses: Vec<(String, f64)> = Vec::new();
    for e in &outcome.effects {
        match &e.extension {
            Extension::ZoneStiffness { place, percent } => {
                stiffness.push((StiffnessOf::Zone, place.clone(), *percent))
            }
            Extension::JointStiffness { place, percent } => {
                stiffness.push((StiffnessOf::Joint, place.clone(), *percent))
            }
            Extension::Mass { place, kilogram } => masses.push((place.clone(), *kilogram)),
            _ => {}
        }
    }
    let side = side_loads(job, &outcome.effects);
    if stiffness.is_empty() && masses.is_empty() && side.is_empty() {
        return Ok(None);
    }
    let ids = || {
        outcome
            .effects
            .iter()
            .map(|e| e.id.as_str())
            .collect::<Vec<_>>()
            .join(" + ")
    };
    let why = "the cards of the deck could not be edited (a property that is no PSHELL or PBUSH, files that do not join)";
    deck.extended(job, &stiffness, &masses, &side)
        .map(Some)
        .ok_or_else(|| effect_not_in_model(&ids(), why))
}

/// Does an effect change what was noted of runs?
fn changes_notes(e: &Extension) -> bool {
    use Extension::{LoadScale, PayloadOffset, RunExchange, RunRecord};
    matches!(
        e,
        PayloadOffset { .. } | LoadScale { .. } | RunExchange { .. } | RunRecord { .. }
    )
}

fn words_of(pairs: &[(&str, &str)]) -> Table {
    pairs
        .iter()
        .map(|(k, v)| ((*k).to_owned(), Value::String((*v).to_owned())))
        .collect()
}

/// S, the payload's signature and nuisance loads of a job in matrix form.
fn matrix_with(
    table: &mut Table,
    frame: &StrainFrame,
    outcome: &Outcome,
    state: &StrainState,
) -> Vec<(&'static str, String)> {
    let nuisance = nuisance(frame, &outcome.effects);
    let changed = state.influence != frame.influence;
    let mut files = Vec::new();
    if !changed && nuisance.is_empty() {
        return files;
    }
    let known = frame
        .nuisance
        .iter()
        .map(|n| (n.name.clone(), n.per_unit.clone()));
    let columns: Vec<(String, Vec<f64>)> = known
        .chain(nuisance.iter().map(|n| (n.0.clone(), n.1.clone())))
        .collect();
    files.push((
        SENSITIVITY,
        sensitivity_csv(frame, &state.influence, &columns),
    ));
    set(table, "sensitivity", "file", SENSITIVITY);
    if let Some(Value::Table(s)) = table.get_mut("sensitivity") {
        // The extended files count in kN, kN m and kg.
        let per = words_of(&[
            ("force", "kN"),
            ("moment", "kN m"),
            ("mass", "kg"),
            ("length", "m"),
        ]);
        s.insert("per".into(), Value::Table(per));
        let names = frame.load_names.iter().chain(columns.iter().map(|n| &n.0));
        let columns: Table = names
            .map(|n| (n.clone(), Value::String(n.clone())))
            .collect();
        s.insert("columns".into(), Value::Table(columns));
    }
    if changed {
        files.push((PAYLOAD, payload_csv(frame, &state.influence)));
        if let Some(Value::Table(signatures)) = table
            .get_mut("sensitivity")
            .and_then(|s| s.get_mut("signatures"))
        {
            signatures.insert("payload".into(), Value::String(PAYLOAD.into()));
        }
    }
    let list = table
        .entry("load")
        .or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(list) = list {
        for (name, _, size) in &nuisance {
            let mut t = Table::new();
            t.insert("name".into(), Value::String(name.clone()));
            // Where S is given a load acts nowhere on a model: grid and component stand for nothing but its kind.
            let component = extended_loads::component_word(name);
            t.insert("grid".into(), Value::Integer(0));
            t.insert("component".into(), Value::String(component.into()));
            t.insert("role".into(), Value::String("nuisance".into()));
            t.insert("expected".into(), Value::Float(*size));
            list.push(Value::Table(t));
        }
    }
    files
}

/// An effect with its sizes, as words are made of it.
pub(super) fn sized(e: &NamedEffect) -> Sized<'_> {
    Sized {
        id: &e.id,
        size: &e.size,
        sigma: &e.sigma,
        unit: e.unit,
    }
}

fn set(table: &mut Table, section: &str, key: &str, value: &str) {
    if let Some(Value::Table(t)) = table.get_mut(section) {
        t.insert(key.into(), Value::String(value.into()));
    }
}

/// Columns of loads that were left out, with their usual size in the units of the job (forces count in kN in the column: so do degrees).
fn nuisance(frame: &StrainFrame, effects: &[NamedEffect]) -> Vec<(String, Vec<f64>, f64)> {
    let mut out = Vec::new();
    for e in effects {
        let Extension::NuisanceLoads { source, loads, .. } = &e.extension else {
            continue;
        };
        let pattern = |name: &String| match source {
            Nuisance::SideLoads => frame
                .other_loads
                .iter()
                .find(|o| o.0 == *name)
                .map(|o| o.1.clone()),
            Nuisance::UniformTemperature => frame.thermal_uniform.clone(),
            Nuisance::TemperatureGradient => frame.thermal_gradient.clone(),
            Nuisance::Ground => None,
        };
        let found = |k: usize| e.size.get(k).copied();
        let largest = e.size.iter().copied().fold(0.0, f64::max);
        for (k, (name, usual)) in loads.iter().enumerate() {
            // What was found, where there is one size a load; else what is usual, scaled up to what was found at most.
            let size = if loads.len() == 1 {
                found(k).unwrap_or(*usual)
            } else {
                usual.max(largest)
            };
            out.extend(pattern(name).map(|p| (name.clone(), p, size * KILO)));
        }
    }
    out
}

fn strain_csv(frame: &StrainFrame, values: &[f64]) -> String {
    let channels = frame.observations.channels.iter();
    let channels: Vec<_> = channels.map(|c| csv_cell(c)).collect();
    let mut out = format!("run,{}\n", channels.join(","));
    for (run, row) in frame
        .observations
        .runs
        .iter()
        .zip(values.chunks_exact(frame.n_gauges().max(1)))
    {
        let cells: Vec<String> = row
            .iter()
            .map(|v| {
                if v.is_finite() {
                    format!("{v:.4}")
                } else {
                    String::new()
                }
            })
            .collect();
        let _ = writeln!(out, "{},{}", csv_cell(run), cells.join(","));
    }
    out
}

fn sensitivity_csv(
    frame: &StrainFrame,
    influence: &[f64],
    nuisance: &[(String, Vec<f64>)],
) -> String {
    let names: Vec<_> = frame
        .load_names
        .iter()
        .chain(nuisance.iter().map(|n| &n.0))
        .map(|n| csv_cell(n))
        .collect();
    let mut out = format!("gauge,{}\n", names.join(","));
    for (g, gauge) in frame.gauges.iter().enumerate() {
        let row = influence
            .iter()
            .skip(g * frame.n_columns())
            .take(frame.n_loads());
        let more = nuisance.iter().filter_map(|n| n.1.get(g));
        let cells: Vec<String> = row.chain(more).map(|v| format!("{v:.9e}")).collect();
        let _ = writeln!(out, "{},{}", csv_cell(&gauge.name), cells.join(","));
    }
    out
}

fn payload_csv(frame: &StrainFrame, influence: &[f64]) -> String {
    let mut out = String::from("gauge,b0,b_dx,b_dy,b_dxdy\n");
    for (gauge, row) in frame
        .gauges
        .iter()
        .zip(influence.chunks_exact(frame.n_columns()))
    {
        let cells: Vec<String> = row
            .iter()
            .skip(frame.n_loads())
            .map(|v| format!("{v:.9e}"))
            .collect();
        let _ = writeln!(out, "{},{}", csv_cell(&gauge.name), cells.join(","));
    }
    out
}

/// What acts in each run of the extended model, as a runs file.
fn runs_csv(frame: &StrainFrame, state: &StrainState) -> String {
    let [at_x, at_y] = frame.payload_origin;
    let (n_l, n_c) = (frame.n_loads(), frame.n_columns());
    let names: Vec<_> = frame.load_names.iter().map(|n| csv_cell(n)).collect();
    let mut out = format!("run,payload_mass,payload_x,payload_y,{}\n", names.join(","));
    for (r, (run, row)) in frame
        .observations
        .runs
        .iter()
        .zip(state.columns.chunks_exact(n_c.max(1)))
        .enumerate()
    {
        let noted = frame.payload.get(r).copied().unwrap_or([0.0; 3]);
        // Columns of the payload are its mass times 1, x, y; without its weight in the model, what was noted stands.
        let [mass, x, y] = match row.get(n_l..n_l + 3) {
            Some([m, mx, my]) if *m > 0.0 => [*m, mx / m, my / m],
            _ => noted,
        };
        let loads: Vec<String> = row.iter().take(n_l).map(|f| format!("{f:.6}")).collect();
        let _ = writeln!(
            out,
            "{},{mass:.6},{:.6},{:.6},{}",
            csv_cell(run),
            at_x + x,
            at_y + y,
            loads.join(",")
        );
    }
    out
}
