//! Finding about cards and statements of a deck that the built-in solver does not support.

use crate::fe::{LoadCase, UnitLoad, unsupported_cards};
use crate::finding::{Finding, Severity, list_few};
use crate::model::Model;
use nastran::bdf::{Deck, Subcase};
use nastran::place::Place;
use std::collections::BTreeMap;

/// Code of the finding.
pub const NOT_SOLVED: &str = "card-not-solved";

/// Returns the finding on everything that acts in the deck as its case control selects it and that the solver would refuse.
pub fn not_solved(deck: &Deck, model: &Model, given: &str) -> Option<Finding> {
    let subcases = deck.case_control.effective_subcases();
    let acting = |s| LoadCase::of_subcase(model, s, String::new());
    let cases: Vec<LoadCase> = subcases.iter().map(acting).collect();
    let place = |at: Place| format!("`{}` line {}", deck.path(at), at.line);
    refused_in(model, &cases, given, place)
}

/// Returns the finding on everything that acts in the geometry blocks of an OP2, every load set included, and that the solver would refuse.
pub fn not_solved_of_op2(model: &Model, given: &str) -> Option<Finding> {
    let sets = model.load_sets.iter().map(|s| UnitLoad::Set(s.sid));
    let heated = model.temperatures.iter().map(|t| UnitLoad::Temperature {
        set: t.sid,
        initial: None,
    });
    let case = LoadCase {
        loads: sets.chain(heated).collect(),
        ..LoadCase::of_subcase(model, &Subcase::default(), String::new())
    };
    refused_in(model, &[case], given, |_| format!("`{given}`"))
}

fn refused_in(
    model: &Model,
    cases: &[LoadCase],
    given: &str,
    place: impl Fn(Place) -> String,
) -> Option<Finding> {
    let mut refused = unsupported_cards(model, cases);
    refused.sort_by(|a, b| (a.at, &a.card).cmp(&(b.at, &b.card)));
    refused.dedup();
    let first = refused.first()?;
    let mut names: BTreeMap<&str, usize> = BTreeMap::new();
    for r in &refused {
        let name = match r.card.rsplit_once(' ') {
            Some((name, id)) if id.bytes().all(|b| b.is_ascii_digit()) => name,
            _ => r.card.as_str(),
        };
        *names.entry(name).or_default() += 1;
    }
    let counted: Vec<String> = names.iter().map(|(n, c)| format!("{n}: {c}")).collect();
    let message = format!(
        "{}: `{}` affects the solution, and the built-in solver does not support it. Such entries: {} ({})",
        place(first.at),
        first.card,
        refused.len(),
        list_few(&counted)
    );
    let remedy =
        "give results of Nastran in the job; the built-in solver does not solve this model";
    let mut finding = Finding::new(Severity::Warning, NOT_SOLVED, given, message, remedy);
    finding.measured = Some(refused.len() as f64);
    Some(finding)
}
