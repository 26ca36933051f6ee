//! A chapter of the demo story, and the deck of the story.

use crate::host::outcome::Findings;
use crate::report::page::Card;
use crate::units::number;
use serde_json::Value;

/// The model, as in models/truck-shell.
pub(super) const DECK: &str = include_str!("../../../models/truck-shell/truck.bdf");
/// Name in the story's folder.
pub(in crate::cli) const DECK_NAME: &str = "truck.bdf";

/// One chapter: its folder and what happened.
pub(super) struct Chapter {
    pub folder: &'static str,
    pub words: String,
    /// Heading of the card of the chapter.
    pub title: &'static str,
    /// Two numbers, each with its description.
    pub numbers: Vec<(String, String)>,
    pub command: &'static str,
    pub step: Step,
}

/// A command of the story, done and written.
pub(super) struct Step {
    /// Answer in the form of `result.json`.
    pub result: Value,
    pub findings: Findings,
    /// The result in short, with a picture of its report.
    pub card: Card,
    pub seconds: f64,
}

/// Returns a lower bound in percent, never rounded up.
pub(super) fn percent_at_least(bound: f64) -> String {
    percent((1000.0 * bound).floor() / 1000.0)
}

/// Returns a share in percent.
pub(super) fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// Returns a number of a result with its description.
pub(super) fn number_of(value: &serde_json::Value, what: &str) -> (String, String) {
    let shown = match value.as_f64() {
        Some(v) if value.is_f64() => number(v),
        _ => value.to_string(),
    };
    (shown, what.to_owned())
}
