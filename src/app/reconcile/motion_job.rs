//! The named effects of motion in a job: terms, couplings, a change of mass, corrections of channels.

use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::{MotionFrame, MotionOutcome};
use toml::{Table, Value};

/// File name of the job.
pub(super) const JOB: &str = "extended_job.toml";

/// Puts the changes into `[vehicle]`.
pub(super) fn edit(section: &mut Table, frame: &MotionFrame, outcome: &MotionOutcome) {
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
