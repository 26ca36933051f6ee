//! A chapter of the story, and the deck that it is told of.

use crate::host::outcome::Findings;
use serde_json::Value;

/// The model, as in models/truck-shell.
pub(super) const DECK: &str = include_str!("../../../models/truck-shell/truck.bdf");
/// Its name in the story's folder.
pub(in crate::cli) const DECK_NAME: &str = "truck.bdf";

/// One chapter: its folder and what happened.
pub(super) struct Chapter {
    pub folder: &'static str,
    pub words: String,
    pub command: &'static str,
    pub step: Step,
}

/// A command of the story, done and written.
pub(super) struct Step {
    /// The answer as `result.json` has it.
    pub result: Value,
    /// Sentence that states the result of the command.
    pub summary: String,
    pub findings: Findings,
    pub seconds: f64,
}
