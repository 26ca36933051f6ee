//! Subcase numbers that a deck states more than once.

use super::deck::DeckModel;
use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, FaultList, Faults};
use nastran::place::Place;
use std::collections::BTreeMap;

/// Remedy for a deck with two subcases of one number.
const NUMBER_ONCE: &str = "give each subcase a separate number, in increasing order";

/// Returns the subcase numbers that a deck states more than once, with the places of each.
fn repeated_subcases(read: &DeckModel) -> BTreeMap<u32, Vec<Place>> {
    let mut places: BTreeMap<u32, Vec<Place>> = BTreeMap::new();
    for s in &read.deck.case_control.subcases {
        places.entry(s.id).or_default().push(s.at);
    }
    places.retain(|_, at| at.len() > 1);
    places
}

/// Returns a warning for each subcase number that a deck states more than once.
pub fn find_repeated_subcases(read: &DeckModel) -> Vec<Finding> {
    let repeated = repeated_subcases(read).into_iter();
    let warn = |(id, places): (u32, Vec<Place>)| {
        let place = |at: &Place| format!("`{}`:{}", read.deck.path(*at), at.line);
        let all: Vec<String> = places.iter().map(place).collect();
        Finding::new(
            Severity::Warning,
            "subcase-ambiguous",
            read.given.as_str(),
            format!("SUBCASE {id} begins at {}", all.join(" and ")),
            NUMBER_ONCE,
        )
        .with_numbers(places.len() as f64, 1.0)
    };
    repeated.map(warn).collect()
}

/// Refuses a deck with two subcases of the same number, since loads, references and results select a subcase by its number.
///
/// # Errors
/// One fault for each line that repeats a number.
pub fn refuse_repeated_subcases(read: &DeckModel) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    for (id, places) in repeated_subcases(read) {
        let Some((first, later)) = places.split_first() else {
            continue;
        };
        let first = format!("`{}`:{}", read.deck.path(*first), first.line);
        faults.extend(later.iter().map(|at| {
            Fault::with_line(
                read.deck.path(*at),
                at.line,
                format!("SUBCASE {id}"),
                format!("a subcase of this number begins at {first}"),
                NUMBER_ONCE,
            )
        }));
    }
    Faults::check(faults)
}
