//! Support that a job states compared with the SPC sets of the subcases whose results it reads.

use crate::fe::{CaseResult, SupportChoice};
use crate::finding::{Finding, Severity, list_few};
use crate::job::Job;
use crate::model::Model;
use crate::strain_chain::built_in_solver::is_combination;
use crate::strain_chain::deck::DeckModel;
use crate::strain_chain::deck_loads::subcase_of;
use std::collections::{BTreeMap, BTreeSet};

/// Returns a warning if the subcases of the loads have different supports, or another support than the job states.
///
/// The comparison uses the degrees of freedom that the SPC sets hold. A subcase whose label differs in the results is not compared.
pub(super) fn check_deck_supports<'a>(
    job: &Job,
    deck: &DeckModel,
    cases: impl Iterator<Item = &'a CaseResult>,
) -> Option<Finding> {
    let subcases = deck.deck.case_control.effective_subcases();
    let model = &deck.model;
    let mut by_set: BTreeMap<Option<u32>, u32> = BTreeMap::new();
    for case in cases {
        let Some(s) = subcase_of(&subcases, case).and_then(|i| subcases.get(i)) else {
            continue;
        };
        // A subcase without loads is not the source of these results.
        let is_run = s.load.is_some() || s.temperature_load.is_some();
        if is_run && !is_combination(s) {
            // `SPC = NONE` is read as set 0.
            let set = s.spc.filter(|sid| *sid != 0);
            by_set.entry(set).or_insert(s.id);
        }
    }
    let stated = job
        .model
        .as_ref()
        .map_or(SupportChoice::Deck, |m| m.support);
    let differs = match stated {
        SupportChoice::Deck => {
            let mut held = by_set.keys().map(|sid| held_dofs(model, *sid));
            let first = held.next()?;
            held.any(|h| h != first)
        }
        // PARAM,INREL balances the loads along the degrees of freedom that an SPC set leaves free.
        SupportChoice::Free if model.params.inrel < 0 => false,
        SupportChoice::Free => by_set.keys().any(|sid| !held_dofs(model, *sid).is_empty()),
        SupportChoice::Set(set) => {
            let wanted = held_dofs(model, Some(set));
            by_set.keys().any(|sid| held_dofs(model, *sid) != wanted)
        }
    };
    let words = by_set.iter().map(|(sid, subcase)| match sid {
        Some(sid) => format!("subcase {subcase} has SPC = {sid}"),
        None => format!("subcase {subcase} has no SPC"),
    });
    let words = list_few(&words.collect::<Vec<_>>());
    let wrong = match stated {
        SupportChoice::Deck => {
            format!("the loads of the job were solved on different supports: {words}")
        }
        SupportChoice::Free => format!("the job states support = \"free\", and {words}"),
        SupportChoice::Set(set) => format!("the job states support = {set}, and {words}"),
    };
    differs.then(|| {
        Finding::new(
            Severity::Warning,
            "support",
            deck.given.as_str(),
            format!("{wrong}: the strain of the results is valid for the support of the deck"),
            "solve all unit loads on the support of the structure during the measurement",
        )
    })
}

/// Returns the grids and degrees of freedom that an SPC set holds.
fn held_dofs(model: &Model, sid: Option<u32>) -> BTreeSet<(u32, usize)> {
    let sets = model.spcs.iter().filter(|s| Some(s.sid) == sid);
    let terms = sets.flat_map(|s| &s.terms);
    terms
        .flat_map(|(grid, dofs, _)| dofs.iter0().map(move |dof| (grid.0, dof)))
        .collect()
}
