//! The extended model: a copy of the job whose files hold the named effects, so that every command runs it as it is.
//!
//! Effects of a channel go into the readings (`strain_extended.csv`), effects of structure into S (`sensitivity_extended.csv`), loads that
//! were left out become columns of S or loads of the job, the payload's place goes into `runs_extended.csv`.

use super::deck_frame::DeckFrame;
use super::deck_thermal;
use super::extended_deck::NamedStiffness;
use super::extended_job::ExtendedJob;
use super::extended_loads::{entries, side_loads};
use super::words::Sized;
use crate::app::Session;
use crate::app::fault::Faults;
use crate::app::job::Job;
use crate::reconcile::effect::Extension;
use crate::reconcile::strain::{Correction, StrainFrame, corrected_readings, extended_influence};
use crate::reconcile::{NamedEffect, Outcome};
use crate::report::csv_cell;
use std::fmt::Write;
use std::path::Path;
use toml::{Table, Value};

const DECK: &str = "deck_extended.bdf";
const JOB: &str = "job_extended.toml";
const STRAIN: &str = "strain_extended.csv";
const SENSITIVITY: &str = "sensitivity_extended.csv";
const PAYLOAD: &str = "payload_extended.csv";
const RUNS: &str = "runs_extended.csv";

/// Writes the extended job of a job in matrix form; its path, relative to the folder the command was called in.
pub(super) fn write(
    job: &Job,
    path: &Path,
    session: &mut Session,
    frame: &StrainFrame,
    outcome: &Outcome,
    deck: Option<&DeckFrame>,
) -> Result<Option<String>, Faults> {
    let names: Vec<&str> = outcome.effects.iter().map(|e| e.id.as_str()).collect();
    let mut extended = ExtendedJob::of(job, path, session, &names)?;
    let table = &mut extended.table;
    let extensions: Vec<&Extension> = outcome.effects.iter().map(|e| &e.extension).collect();
    let mut files: Vec<(&str, String)> = Vec::new();
    let corrections = Correction::of(frame, &extensions);
    if !corrections.is_empty() {
        files.push((
            STRAIN,
            strain_csv(frame, &corrected_readings(frame, &corrections)),
        ));
        set(table, "measured", "strain", STRAIN);
    }
    let influence = extended_influence(frame, &extensions);
    let nuisance: Vec<(String, Vec<f64>)> = nuisance(frame, &extensions);
    if job.sensitivity.is_some() && (influence.is_some() || !nuisance.is_empty()) {
        let values = influence.as_deref().unwrap_or(&frame.influence);
        files.push((SENSITIVITY, sensitivity_csv(frame, values, &nuisance)));
        set(table, "sensitivity", "file", SENSITIVITY);
        if let Some(Value::Table(s)) = table.get_mut("sensitivity") {
            // The extended files count in kN, kN m and kg.
            let mut per = Table::new();
            for (k, v) in [
                ("force", "kN"),
                ("moment", "kN m"),
                ("mass", "kg"),
                ("length", "m"),
            ] {
                per.insert(k.into(), Value::String(v.into()));
            }
            s.insert("per".into(), Value::Table(per));
            let columns = frame.load_names.iter().chain(nuisance.iter().map(|n| &n.0));
            let columns: Table = columns
                .map(|n| (n.clone(), Value::String(n.clone())))
                .collect();
            s.insert("columns".into(), Value::Table(columns));
        }
    }
    if let Some(values) = influence.as_ref().filter(|_| job.sensitivity.is_some()) {
        files.push((PAYLOAD, payload_csv(frame, values)));
        if let Some(Value::Table(signatures)) = table
            .get_mut("sensitivity")
            .and_then(|s| s.get_mut("signatures"))
        {
            signatures.insert("payload".into(), Value::String(PAYLOAD.into()));
        }
    }
    if let Some((dx, dy)) = extensions.iter().find_map(|e| {
        if let Extension::PayloadOffset { dx, dy } = e {
            Some((*dx, *dy))
        } else {
            None
        }
    }) {
        files.push((RUNS, runs_csv(frame, dx, dy)));
        set(table, "runs", "file", RUNS);
        if let Some(Value::Table(runs)) = table.get_mut("runs") {
            runs.remove("columns");
            let units: Table = [("force", "kN"), ("mass", "kg"), ("length", "m")]
                .iter()
                .map(|(k, v)| ((*k).to_owned(), Value::String((*v).into())))
                .collect();
            runs.insert("units".into(), Value::Table(units));
        }
    }
    if extensions
        .iter()
        .any(|e| matches!(e, Extension::PayloadWeight))
    {
        let payload = table
            .entry("payload")
            .or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(p) = payload {
            p.insert("weight_in_model".into(), Value::Boolean(true));
        }
    }
    let stiffness: Vec<NamedStiffness> = extensions
        .iter()
        .filter_map(|e| match e {
            Extension::Stiffness { id, place, percent } => Some((*id, place.clone(), *percent)),
            _ => None,
        })
        .collect();
    let masses: Vec<(String, f64)> = extensions
        .iter()
        .filter_map(|e| match e {
            Extension::Mass { place, kilogram } => Some((place.clone(), *kilogram)),
            _ => None,
        })
        .collect();
    let side = side_loads(job, &outcome.effects);
    if let Some(d) = deck {
        let list = table
            .entry("load")
            .or_insert_with(|| Value::Array(Vec::new()));
        if let Value::Array(list) = list {
            list.extend(entries(job, frame, &side));
            list.extend(deck_thermal::entry(job, d.fields.model(), &outcome.effects));
        }
    }
    let extended_deck = deck.and_then(|d| d.extended(job, &stiffness, &masses, &side));
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

/// Columns of loads that were left out.
fn nuisance(frame: &StrainFrame, extensions: &[&Extension]) -> Vec<(String, Vec<f64>)> {
    let mut out = Vec::new();
    for e in extensions {
        let Extension::NuisanceLoads { id, .. } = e else {
            continue;
        };
        match *id {
            "lateral_wheel_loads" => out.extend(frame.other_loads.clone()),
            "thermal_uniform" => {
                out.extend(frame.thermal_uniform.clone().map(|t| ((*id).to_owned(), t)))
            }
            "thermal_gradient" => out.extend(
                frame
                    .thermal_gradient
                    .clone()
                    .map(|t| ((*id).to_owned(), t)),
            ),
            _ => {}
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

fn runs_csv(frame: &StrainFrame, dx: f64, dy: f64) -> String {
    let [at_x, at_y] = frame.payload_origin;
    let names: Vec<_> = frame.load_names.iter().map(|n| csv_cell(n)).collect();
    let mut out = format!("run,payload_mass,payload_x,payload_y,{}\n", names.join(","));
    for (r, run) in frame.observations.runs.iter().enumerate() {
        let [mass, x, y] = frame.payload.get(r).copied().unwrap_or([0.0; 3]);
        let loads: Vec<String> = frame
            .loads
            .iter()
            .skip(r * frame.n_loads())
            .take(frame.n_loads())
            .map(|f| format!("{f:.6}"))
            .collect();
        let _ = writeln!(
            out,
            "{},{mass:.6},{:.6},{:.6},{}",
            csv_cell(run),
            at_x + x + dx,
            at_y + y + dy,
            loads.join(",")
        );
    }
    out
}
