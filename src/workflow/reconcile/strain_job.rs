//! Named effects of strain in a job: names of the files that contain them, and loads that were left out.

use super::answer::StrainPart;
use super::channel_corrections::entry;
use super::deck_thermal;
use super::extended_columns::{sensitivity_columns, typical_size};
use super::extended_loads::{component_word, entries, side_loads};
use super::extended_model::{DECK, ExtendedModel, ExtendedS, PAYLOAD, RUNS, SENSITIVITY, STRAIN};
use crate::job::Job;
use crate::reconcile::NamedEffect;
use crate::reconcile::effect::{Extension, Nuisance};
use crate::reconcile::strain::StrainFrame;
use crate::units::KILO;
use toml::{Table, Value};

/// Puts the effects into the job's text, a table.
pub(super) fn edit(table: &mut Table, job: &Job, found: &StrainPart, extended: &ExtendedModel) {
    let effects = &found.outcome.effects;
    if extended.readings.is_some() {
        put_readings(table, job, &found.frame);
    }
    add_to(table, "correction", |list| {
        list.extend(extended.corrections.iter().map(entry));
    });
    if let Some(s) = &extended.sensitivity {
        edit_sensitivity(table, job, &found.frame, s);
    }
    if let Some(fields) = &found.fields {
        let side = side_loads(job, effects);
        add_to(table, "load", |list| {
            list.extend(entries(job, &found.frame, &side));
            list.extend(deck_thermal::entry(job, fields.model(), effects));
        });
    }
    if extended.runs.is_some() {
        set(table, "runs", "file", RUNS);
        if let Some(Value::Table(runs)) = table.get_mut("runs") {
            runs.remove("columns");
            in_units_of_the_extended_file(runs, job);
            let units = [
                ("force", "kN"),
                ("moment", "kN m"),
                ("mass", "kg"),
                ("length", "m"),
            ];
            runs.insert("units".into(), Value::Table(words_of(&units)));
        }
    }
    let ground = ground_found(effects).unwrap_or(found.frame.ground);
    if ground > 0.0
        && let Some(runs) = &job.runs
    {
        // The extended runs file is in kN.
        let unit = match extended.runs {
            Some(_) => KILO,
            None => runs.units.force.si,
        };
        set_key(table, "runs", "ground", Value::Float(ground * KILO / unit));
    }
    if let Some(x_m) = extended.nominal_x_m {
        let x = x_m / job.units.length_m();
        set_key(table, "payload", "nominal_x", Value::Float(x));
    }
    let weighs = |e: &Extension| matches!(e, Extension::PayloadWeight);
    if effects.iter().any(|e| weighs(&e.extension)) {
        set_key(table, "payload", "weight_in_model", Value::Boolean(true));
    }
    if extended.deck.is_some() {
        set(table, "model", "deck", DECK);
    }
    let accepted: Vec<&str> = effects.iter().filter_map(id_of_described).collect();
    drop_accepted(table, &accepted);
}

/// Returns the usual change of a wheel force, kN, if uneven ground was named.
pub(super) fn ground_found(effects: &[NamedEffect]) -> Option<f64> {
    let of = |e: &NamedEffect| match &e.extension {
        Extension::NuisanceLoads {
            source: Nuisance::Ground,
            ..
        } => e.size.first().copied(),
        _ => None,
    };
    effects.iter().find_map(of)
}

/// Returns the id of a hypothesis that the user described.
fn id_of_described(e: &NamedEffect) -> Option<&str> {
    match &e.extension {
        Extension::Described { id, .. } => Some(id),
        _ => None,
    }
}

/// Takes hypotheses that are in the model now out of `[reconcile]`.
fn drop_accepted(table: &mut Table, accepted: &[&str]) {
    let Some(Value::Table(section)) = table.get_mut("reconcile") else {
        return;
    };
    let is_one = |v: Option<&Value>| {
        v.and_then(Value::as_str)
            .is_some_and(|id| accepted.contains(&id))
    };
    if let Some(Value::Array(list)) = section.get_mut("effect") {
        list.retain(|e| !is_one(e.get("id")));
        if list.is_empty() {
            section.remove("effect");
        }
    }
    if let Some(Value::Array(list)) = section.get_mut("effects") {
        list.retain(|e| !is_one(Some(e)));
        if list.is_empty() {
            // An empty list would mean all effects.
            section.remove("effects");
        }
    }
}

/// Edits S, the payload's signature and nuisance loads of a job in matrix form.
fn edit_sensitivity(table: &mut Table, job: &Job, frame: &StrainFrame, s: &ExtendedS) {
    set(table, "sensitivity", "file", SENSITIVITY);
    if let Some(Value::Table(section)) = table.get_mut("sensitivity") {
        // Names and units remain as in the job, because its other tables use them.
        let columns: Table = sensitivity_columns(job, frame, s)
            .into_iter()
            .map(|c| (c.load, Value::String(c.column)))
            .collect();
        section.insert("columns".into(), Value::Table(columns));
        if s.changed
            && let Some(Value::Table(signatures)) = section.get_mut("signatures")
        {
            signatures.insert("payload".into(), Value::String(PAYLOAD.into()));
        }
    }
    add_to(table, "load", |list| {
        for (name, _, size) in &s.left_out {
            let mut t = Table::new();
            t.insert("name".into(), Value::String(name.clone()));
            // With a given S, a load acts at no grid of a model. Grid and component only state whether it is a force or a moment.
            t.insert("grid".into(), Value::Integer(0));
            t.insert(
                "component".into(),
                Value::String(component_word(name).into()),
            );
            t.insert("role".into(), Value::String("nuisance".into()));
            let size = typical_size(job, name, *size);
            t.insert("expected".into(), Value::Float(size));
            list.push(Value::Table(t));
        }
    });
}

/// Sets the corrected readings as the strain of the job. They include its old corrections and zeros. Held-out runs are listed by name.
fn put_readings(table: &mut Table, job: &Job, frame: &StrainFrame) {
    set(table, "measured", "strain", STRAIN);
    let o = &frame.observations;
    if let Some(Value::Table(measured)) = table.get_mut("measured") {
        measured.remove("zero");
        measured.remove("zero_runs");
        if o.held_out.contains(&true) {
            let held_out = o.runs.iter().zip(&o.held_out).filter(|r| *r.1);
            let names = held_out.map(|r| Value::String(r.0.clone())).collect();
            measured.insert("hold_out".into(), Value::Array(names));
        }
    }
    table.remove("correction");
    // The readings don't contain the angle of a turned gauge, so its correction stays.
    let turned = job.corrections.iter().filter_map(|c| {
        let mut t = Table::new();
        t.insert("gauge".into(), Value::String(c.gauge.clone()));
        t.insert("angle_deg".into(), Value::Float(c.angle_deg?));
        Some(Value::Table(t))
    });
    add_to(table, "correction", |list| list.extend(turned));
}

/// Adds to a list of sections; one that would be empty is not written.
fn add_to(table: &mut Table, name: &str, add: impl FnOnce(&mut Vec<Value>)) {
    let mut more = Vec::new();
    add(&mut more);
    if more.is_empty() {
        return;
    }
    let list = table
        .entry(name)
        .or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(list) = list {
        list.extend(more);
    }
}

/// Sets a key of a section, and adds the section if it is missing.
fn set_key(table: &mut Table, section: &str, key: &str, value: Value) {
    let section = table
        .entry(section)
        .or_insert_with(|| Value::Table(Table::new()));
    if let Value::Table(t) = section {
        t.insert(key.into(), value);
    }
}

/// Converts the noise of the runs file from its units to the units of the extended file: kN, kN m, kg, m.
fn in_units_of_the_extended_file(runs: &mut Table, job: &Job) {
    let (Some(stated), Some(Value::Table(noise))) = (&job.runs, runs.get_mut("noise")) else {
        return;
    };
    let u = &stated.units;
    let factors = [
        ("force", u.force.si / KILO),
        ("moment", u.moment.si / KILO),
        ("mass", u.mass.si),
        ("length", u.length.si),
    ];
    for (key, factor) in factors {
        let value = noise.get_mut(key);
        let number = value.as_ref().and_then(|v| {
            let whole = || v.as_integer().map(|i| i as f64);
            v.as_float().or_else(whole)
        });
        if let (Some(value), Some(number)) = (value, number) {
            *value = Value::Float(number * factor);
        }
    }
}

fn words_of(pairs: &[(&str, &str)]) -> Table {
    pairs
        .iter()
        .map(|(k, v)| ((*k).to_owned(), Value::String((*v).to_owned())))
        .collect()
}

fn set(table: &mut Table, section: &str, key: &str, value: &str) {
    if let Some(Value::Table(t)) = table.get_mut(section) {
        t.insert(key.into(), Value::String(value.into()));
    }
}
