//! The job with the named effects of motion in it: terms, couplings, a change of mass, corrections of channels.

use super::extend::redirect;
use super::relative::relative;
use crate::cli::Session;
use crate::cli::fault::{Fault, Faults};
use crate::cli::job::Job;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::{MotionEffect, MotionFrame, MotionOutcome};
use std::fmt::Write;
use std::path::Path;
use toml::{Table, Value};

const JOB: &str = "extended_job.toml";

/// Writes the extended job; its path, relative to the folder the command was called in.
pub(super) fn write(
    job: &Job,
    path: &Path,
    session: &mut Session,
    frame: &MotionFrame,
    outcome: &MotionOutcome,
) -> Result<String, Faults> {
    let text = session
        .inputs
        .read_text(Path::new(""), &job.file)
        .map_err(|f| vec![f])?;
    let malformed = |what: String| vec![Fault::of(&*job.file, "job", what, "write valid TOML")];
    let mut table: Table = text
        .parse()
        .map_err(|e: toml::de::Error| malformed(e.to_string()))?;
    let folder = session.output_for(path)?.folder().to_owned();
    redirect(&mut table, &relative(&folder, &job.folder));
    let title = table
        .get("title")
        .and_then(Value::as_str)
        .unwrap_or("job")
        .to_owned();
    let names: Vec<&str> = outcome.effects.iter().map(|e| e.id.as_str()).collect();
    table.insert(
        "title".into(),
        Value::String(format!("{title}, with {}", names.join(" and "))),
    );
    if let Some(Value::Table(section)) = table.get_mut("vehicle") {
        extend(section, frame, outcome);
    }
    let mut out =
        String::from("# The job with the named effects in it; `size` and `sigma` as found.\n");
    for e in &outcome.effects {
        let _ = writeln!(out, "# {}", in_words(e));
    }
    out.push_str(&toml::to_string(&table).map_err(|e| malformed(e.to_string()))?);
    session
        .output_for(path)?
        .write_bytes(JOB, out.as_bytes())
        .map_err(|f| vec![f])?;
    Ok(folder.join(JOB).display().to_string().replace('\\', "/"))
}

fn in_words(e: &MotionEffect) -> String {
    let sizes: Vec<String> = e
        .size
        .iter()
        .zip(&e.sigma)
        .map(|(v, s)| format!("{v:.6e} +- {s:.1e}"))
        .collect();
    format!("{}: {} {}", e.id, sizes.join(", "), e.unit)
}

/// Puts the changes into `[vehicle]`.
fn extend(section: &mut Table, frame: &MotionFrame, outcome: &MotionOutcome) {
    let mut terms: Vec<String> = match section.get("terms") {
        Some(Value::Array(a)) => a
            .iter()
            .filter_map(|v| v.as_str().map(str::to_owned))
            .collect(),
        _ => vec![],
    };
    if terms.is_empty() {
        // What a job without terms stands for.
        for l in &frame.vehicle.links {
            terms.extend(["k", "c"].map(|t| format!("{t}_{}", l.name)));
        }
    }
    for e in &outcome.effects {
        match &e.change {
            Change::Terms { link, terms: new } => {
                if let Some(l) = frame.vehicle.links.get(*link) {
                    terms.extend(new.iter().map(|t| format!("{}:{}", t.text(), l.name)));
                }
            }
            Change::Links(links) => {
                section.insert("model".into(), Value::String(frame.vehicle.name.clone()));
                for l in links {
                    terms.extend(l.terms.iter().map(|t| format!("{}_{}", t.symbol(), l.name)));
                }
            }
            Change::Step(step) => {
                let mut change = Table::new();
                let body = frame.vehicle.bodies.get(step.body);
                change.insert(
                    "body".into(),
                    Value::String(body.map_or("b".into(), |b| b.name.clone())),
                );
                change.insert("at_s".into(), Value::Float(step.at_s));
                change.insert("over_s".into(), Value::Float(step.over_s));
                change.insert("weight".into(), Value::Boolean(step.gravity != 0.0));
                section.insert("mass_change".into(), Value::Table(change));
            }
            Change::Swap { a, b } => {
                let columns = section
                    .entry("columns")
                    .or_insert_with(|| Value::Table(Table::new()));
                if let Value::Table(columns) = columns {
                    let key = |columns: &Table, name: &str| {
                        columns
                            .iter()
                            .find(|(_, v)| v.as_str() == Some(name))
                            .map_or_else(|| name.to_owned(), |(k, _)| k.clone())
                    };
                    let (ka, kb) = (key(columns, a), key(columns, b));
                    columns.insert(ka, Value::String(b.clone()));
                    columns.insert(kb, Value::String(a.clone()));
                }
            }
            Change::Gain { .. } | Change::Delay { .. } | Change::Flip { .. } => {}
        }
    }
    section.insert(
        "terms".into(),
        Value::Array(terms.into_iter().map(Value::String).collect()),
    );
    if !outcome.corrections.is_empty() {
        let mut corrections = Table::new();
        for a in &outcome.corrections {
            let mut one = Table::new();
            one.insert("gain".into(), Value::Float(a.gain));
            one.insert("delay_s".into(), Value::Float(a.delay_s));
            corrections.insert(a.channel.clone(), Value::Table(one));
        }
        section.insert("corrections".into(), Value::Table(corrections));
    }
}
