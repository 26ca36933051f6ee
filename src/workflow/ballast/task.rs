//! Inputs of `ballast`, and the completed deck.

use crate::fe::floor::FloorSolution;
use crate::job::{Ballast, Job};
use crate::measured::wheels::Wheels;
use crate::strain_chain::deck::DeckModel;
use crate::units::factor;
use crate::workflow::cases::relocate_deck;
use nastran::bdf::Deck;
use std::path::Path;

/// The completed deck.
pub(super) const DECK: &str = "completed";

/// The deck with the masses.
pub struct CompletedDeck {
    pub(super) deck: Deck,
    pub(super) edited: Vec<(String, Vec<u8>)>,
}

impl CompletedDeck {
    /// Returns name and bytes of every file of the completed deck. Paths of INCLUDEs are relative to `folder`. The first file is `completed.bdf`.
    pub fn files(&self, folder: &Path) -> Vec<(String, Vec<u8>)> {
        relocate_deck(&self.deck, self.edited.clone(), folder, DECK)
    }
}

/// Inputs of `ballast` with the model.
pub(super) struct Task<'a> {
    pub job: &'a Job,
    pub ballast: &'a Ballast,
    pub read: &'a DeckModel,
    pub wheels: Wheels,
    pub standing: FloorSolution,
    pub gravity: f64,
}

/// Returns the report force per job unit.
pub(super) fn force(job: &Job) -> f64 {
    factor(job.units, job.report_units.force)
}

/// Returns the report length per job unit.
pub(super) fn length(job: &Job) -> f64 {
    factor(job.units, job.report_units.length)
}

/// Returns the report mass per job unit.
pub(super) fn mass(job: &Job) -> f64 {
    factor(job.units, job.report_units.mass)
}
