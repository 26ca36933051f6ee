//! A chapter of the story, and the deck that it is told of.

use crate::app::Closed;

/// The model, as in models/truck-shell.
pub(super) const DECK: &str = include_str!("../../../models/truck-shell/truck.bdf");
/// Its name in the story's folder.
pub(in crate::cli) const DECK_NAME: &str = "truck.bdf";

/// One chapter: its folder and what happened.
pub(super) struct Chapter {
    pub folder: &'static str,
    pub words: String,
    pub command: &'static str,
    pub step: Closed,
}
