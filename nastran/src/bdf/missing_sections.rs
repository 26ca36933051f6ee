//! Statements between the sections of a deck that are missing or misspelt.

use super::bulk_scan::first_word;
use super::fault::{DeckFaultKind, Fault};
use super::line::text_of;
use super::vocabulary::{case_word, effect_of_card};
use crate::place::Place;

/// Sections that a BEGIN statement names.
///
/// # Reference
/// MSC Nastran 2022.4 and Simcenter Nastran quick reference guides, BEGIN BULK.
pub(super) const PARTS: [&str; 10] = [
    "BULK", "SUPER", "AUXMODEL", "AUXMODAL", "MASSID", "MODULE", "ARBMODEL", "TRMC", "UDS",
    "FLXBDY",
];

/// Returns the fault of a statement that is missing above `found`, or misspelt there.
pub(super) fn missing_statement(card: &str, at: Place, found: &str, why: &'static str) -> Fault {
    Fault {
        at,
        card: card.to_owned(),
        field: None,
        what: DeckFaultKind::Statement {
            found: found.trim().to_owned(),
            why,
        },
    }
}

/// Returns whether a line of case control is an entry of bulk data, so that BEGIN BULK is missing above it.
pub(super) fn is_bulk_entry(text: &str) -> bool {
    let name = text_of(&first_word(text.as_bytes()));
    case_word(&name).is_none() && effect_of_card(&name).is_some()
}
