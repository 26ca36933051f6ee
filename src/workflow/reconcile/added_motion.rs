//! Changes of the job by the named effects of motion.

use super::extended_model::ExtendedModel;
use super::model_changes::{ModelChange, Place, list_changes};
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::{MotionEffect, MotionFrame, MotionOutcome};
use crate::units::number;
use crate::vehicle::adjustment::Adjustment;

/// Returns the changes by the effects; empty without an extended model.
pub(super) fn added_to_motion(
    frame: &MotionFrame,
    outcome: &MotionOutcome,
    extended: Option<&ExtendedModel>,
) -> Vec<ModelChange> {
    let Some(extended) = extended else {
        return Vec::new();
    };
    let of = |e: &MotionEffect| list_changes(&e.id, places(frame, outcome, extended.name, e));
    outcome.effects.iter().flat_map(of).collect()
}

fn places(frame: &MotionFrame, outcome: &MotionOutcome, job: &str, e: &MotionEffect) -> Vec<Place> {
    let found = |k: usize| e.size.get(k).map_or_else(String::new, |s| number(*s));
    let term = |k: usize, words: String| {
        let unit = if k == 0 { e.unit.as_str() } else { "" };
        let new = format!("`{words}`, found {} {unit}", found(k));
        [
            format!("{job}: [vehicle] terms"),
            "none".to_owned(),
            new.trim_end().to_owned(),
        ]
    };
    match &e.change {
        Change::Terms { link, terms } => {
            let Some(l) = frame.vehicle.links.get(*link) else {
                return Vec::new();
            };
            let named = terms.iter().map(|t| format!("{}:{}", t.text(), l.name));
            named.enumerate().map(|(k, words)| term(k, words)).collect()
        }
        Change::Links(links) => {
            let named = links.iter().flat_map(|l| {
                let terms = l.terms.iter();
                terms.map(|t| format!("{}_{}", t.symbol(), l.name))
            });
            named.enumerate().map(|(k, words)| term(k, words)).collect()
        }
        Change::Step(step) => vec![[
            format!("{job}: [vehicle] mass_change"),
            "none".to_owned(),
            format!(
                "{} {} at {} s over {} s",
                found(0),
                e.unit,
                number(step.at_s),
                number(step.over_s)
            ),
        ]],
        Change::Swap { a, b } => vec![[
            format!("{job}: [vehicle] columns"),
            format!("{a}, {b}"),
            format!("{b}, {a}"),
        ]],
        Change::Gain { channel } | Change::Flip { channel } => {
            vec![correction_change(
                frame,
                outcome,
                job,
                channel,
                "gain",
                |a| number(a.gain),
            )]
        }
        Change::Delay { channel } => {
            vec![correction_change(
                frame,
                outcome,
                job,
                channel,
                "delay_s",
                |a| number(a.delay_s),
            )]
        }
        Change::Clock { channel } => {
            vec![correction_change(
                frame,
                outcome,
                job,
                channel,
                "clock_ppm",
                |a| number(1e6 * a.clock),
            )]
        }
        Change::Slip { channel, .. } => {
            vec![correction_change(
                frame,
                outcome,
                job,
                channel,
                "slip_s",
                |a| {
                    let list = a.slips.iter();
                    or_none(list.map(|s| format!("{} at {} s", number(s.by_s), number(s.at_s))))
                },
            )]
        }
        Change::Lag { channel, .. } => {
            vec![correction_change(
                frame,
                outcome,
                job,
                channel,
                "low_pass_s",
                |a| or_none(a.lags.iter().map(|l| number(l.time_s))),
            )]
        }
        Change::Line { channel, .. } => {
            vec![correction_change(
                frame,
                outcome,
                job,
                channel,
                "line_hz",
                |a| or_none(a.lines_hz.iter().map(|hz| number(*hz))),
            )]
        }
    }
}

fn or_none(list: impl Iterator<Item = String>) -> String {
    let list: Vec<String> = list.collect();
    match list.is_empty() {
        true => "none".to_owned(),
        false => list.join(", "),
    }
}

/// Returns the change of a key of a channel's corrections: value before and after.
fn correction_change(
    frame: &MotionFrame,
    outcome: &MotionOutcome,
    job: &str,
    channel: &str,
    key: &str,
    value: impl Fn(&Adjustment) -> String,
) -> Place {
    let sound = Adjustment {
        channel: channel.to_owned(),
        gain: 1.0,
        delay_s: 0.0,
        clock: 0.0,
        slips: Vec::new(),
        lags: Vec::new(),
        lines_hz: Vec::new(),
    };
    let of = |list: &[Adjustment]| {
        let own = list.iter().find(|a| a.channel == channel);
        value(own.unwrap_or(&sound))
    };
    [
        format!("{job}: [vehicle.corrections.{channel}] {key}"),
        of(&frame.corrections),
        of(&outcome.corrections),
    ]
}
