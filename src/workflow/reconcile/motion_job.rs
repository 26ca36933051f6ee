//! The named effects of motion in a job: terms, couplings, a change of mass, corrections of channels.

use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::{MotionFrame, MotionOutcome};
use crate::vehicle::adjustment::Adjustment;
use toml::{Table, Value};

/// File name of the job.
pub(super) const JOB: &str = "extended_job.toml";

/// Returns whether a job can state the corrections. A channel may have one slip, one low-pass filter and one line.
pub(super) fn can_state(outcome: &MotionOutcome) -> bool {
    let one = |a: &Adjustment| a.slips.len() <= 1 && a.lags.len() <= 1 && a.lines_hz.len() <= 1;
    outcome.corrections.iter().all(one)
}

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
        // A job without terms has stiffness and damping of every link.
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
            Change::Gain { .. }
            | Change::Delay { .. }
            | Change::Clock { .. }
            | Change::Slip { .. }
            | Change::Lag { .. }
            | Change::Line { .. }
            | Change::Flip { .. } => {}
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
            for l in &a.lags {
                one.insert("low_pass_s".into(), Value::Float(l.time_s));
                one.insert("low_pass_order".into(), Value::Integer(l.order.into()));
            }
            let mut state = |key: &str, value: f64| one.insert(key.into(), Value::Float(value));
            state("gain", a.gain);
            state("delay_s", a.delay_s);
            if a.clock != 0.0 {
                state("clock_ppm", 1e6 * a.clock);
            }
            for s in &a.slips {
                state("slip_at_s", s.at_s);
                state("slip_s", s.by_s);
            }
            for hz in &a.lines_hz {
                state("line_hz", *hz);
            }
            corrections.insert(a.channel.clone(), Value::Table(one));
        }
        section.insert("corrections".into(), Value::Table(corrections));
    }
}
