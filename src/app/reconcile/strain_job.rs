//! The named effects of strain in a job: names of the files that hold them, loads that were left out.

use super::answer::StrainPart;
use super::deck_thermal;
use super::extended::{DECK, ExtendedModel, ExtendedS, PAYLOAD, RUNS, SENSITIVITY, STRAIN};
use super::extended_loads::{component_word, entries, side_loads};
use crate::app::job::Job;
use crate::reconcile::effect::Extension;
use toml::{Table, Value};

/// Puts the effects into the job's text, a table.
pub(super) fn edit(table: &mut Table, job: &Job, found: &StrainPart, extended: &ExtendedModel) {
    let effects = &found.outcome.effects;
    if extended.readings.is_some() {
        set(table, "measured", "strain", STRAIN);
    }
    if let Some(s) = &extended.sensitivity {
        edit_sensitivity(table, &found.frame.load_names, s);
    }
    if let Some(fields) = &found.fields {
        let side = side_loads(job, effects);
        add_loads(table, |list| {
            list.extend(entries(job, &found.frame, &side));
            list.extend(deck_thermal::entry(job, fields.model(), effects));
        });
    }
    if extended.runs.is_some() {
        set(table, "runs", "file", RUNS);
        if let Some(Value::Table(runs)) = table.get_mut("runs") {
            runs.remove("columns");
            let units = [("force", "kN"), ("mass", "kg"), ("length", "m")];
            runs.insert("units".into(), Value::Table(words_of(&units)));
        }
    }
    let weighs = |e: &Extension| matches!(e, Extension::PayloadWeight);
    if effects.iter().any(|e| weighs(&e.extension)) {
        let payload = table
            .entry("payload")
            .or_insert_with(|| Value::Table(Table::new()));
        if let Value::Table(p) = payload {
            p.insert("weight_in_model".into(), Value::Boolean(true));
        }
    }
    if extended.deck.is_some() {
        set(table, "model", "deck", DECK);
    }
}

/// S, the payload's signature and nuisance loads of a job in matrix form.
fn edit_sensitivity(table: &mut Table, load_names: &[String], s: &ExtendedS) {
    set(table, "sensitivity", "file", SENSITIVITY);
    if let Some(Value::Table(section)) = table.get_mut("sensitivity") {
        // The extended files count in kN, kN m and kg.
        let per = words_of(&[
            ("force", "kN"),
            ("moment", "kN m"),
            ("mass", "kg"),
            ("length", "m"),
        ]);
        section.insert("per".into(), Value::Table(per));
        let names = load_names.iter().chain(s.besides().map(|n| n.0));
        let columns: Table = names
            .map(|n| (n.clone(), Value::String(n.clone())))
            .collect();
        section.insert("columns".into(), Value::Table(columns));
        if s.changed
            && let Some(Value::Table(signatures)) = section.get_mut("signatures")
        {
            signatures.insert("payload".into(), Value::String(PAYLOAD.into()));
        }
    }
    add_loads(table, |list| {
        for (name, _, size) in &s.left_out {
            let mut t = Table::new();
            t.insert("name".into(), Value::String(name.clone()));
            // Where S is given a load acts nowhere on a model: grid and component stand for nothing but its kind.
            t.insert("grid".into(), Value::Integer(0));
            t.insert(
                "component".into(),
                Value::String(component_word(name).into()),
            );
            t.insert("role".into(), Value::String("nuisance".into()));
            t.insert("expected".into(), Value::Float(*size));
            list.push(Value::Table(t));
        }
    });
}

fn add_loads(table: &mut Table, add: impl FnOnce(&mut Vec<Value>)) {
    let list = table
        .entry("load")
        .or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(list) = list {
        add(list);
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
