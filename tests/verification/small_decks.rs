//! Decks of a few lines, solved as their case control requests.

use nastran::bdf::{Deck, MemoryLoader, read_deck};
use strainbridge::fe::*;
use strainbridge::model::{FaultWeight, Model, ModelFault};

/// Returns a deck with this case control and bulk data.
pub fn deck(case_control: &str, bulk: &str) -> Deck {
    let text = format!("SOL 101\nCEND\n{case_control}\nBEGIN BULK\n{bulk}\nENDDATA\n");
    let deck = read_deck("test.bdf", text.into_bytes(), &mut MemoryLoader::default());
    assert!(deck.faults.is_empty(), "{:?}", deck.faults);
    deck
}

/// Returns the model of a deck, and the faults that prevent a solution.
pub fn model(case_control: &str, bulk: &str) -> (Model, Vec<ModelFault>) {
    let (model, mut faults) = Model::from_deck(&deck(case_control, bulk));
    faults.retain(|f| f.weight() == FaultWeight::Error);
    (model, faults)
}

/// Solves the first subcase of a deck.
pub fn try_solve(case_control: &str, bulk: &str) -> Result<(Model, DisplacementSolution), FeError> {
    let deck = deck(case_control, bulk);
    let (model, faults) = Model::from_deck(&deck);
    let wrong: Vec<&ModelFault> = faults
        .iter()
        .filter(|f| f.weight() == FaultWeight::Error)
        .collect();
    assert!(wrong.is_empty(), "{wrong:?}");
    let first = deck.case_control.effective_subcases().remove(0);
    let case = LoadCase::of_subcase(&model, &first, String::new());
    let solved = solve_displacements(&model, &[case], &SolveOptions::default())?;
    Ok((model, solved))
}

/// Solves the first subcase of a deck. An error fails the test.
pub fn solve(case_control: &str, bulk: &str) -> (Model, DisplacementSolution) {
    try_solve(case_control, bulk).unwrap_or_else(|e| panic!("{e}"))
}

/// Returns the displacement of a grid.
pub fn displacement_at((model, solved): &(Model, DisplacementSolution), grid: u32) -> [f64; 6] {
    solved.displacements[0][model.grid_ix(grid).unwrap().us()]
}

/// Returns the cards that the solver refuses.
pub fn list_refused_cards(case_control: &str, bulk: &str) -> Vec<String> {
    match try_solve(case_control, bulk) {
        Err(FeError::Refused(list)) => list.into_iter().map(|r| r.card).collect(),
        Err(other) => panic!("{other}"),
        Ok(_) => Vec::new(),
    }
}

/// Fails if `got` differs from `expected` by more than the given share of it.
#[track_caller]
pub fn assert_close(what: &str, got: f64, expected: f64, share: f64) {
    let limit = share * expected.abs().max(f64::MIN_POSITIVE);
    assert!(
        (got - expected).abs() <= limit,
        "{what}: {got:e} for {expected:e}"
    );
}
