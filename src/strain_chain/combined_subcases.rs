//! SUBCOM, SYMCOM and REPCASE of a deck: linear combinations of the subcases above them.

use crate::fe::{
    LoadCase, Relief, Solution, SolveReport, combine_balances, combine_reactions, combine_results,
};
use crate::host::fault::{Fault, Faults};
use crate::strain_chain::built_in_solver::label_of;
use crate::strain_chain::deck::DeckModel;
use nastran::bdf::{Subcase, SubcaseKind};

/// A combination of solved subcases.
pub(crate) struct CombinedSubcase {
    subcase: Subcase,
    /// Index among all results.
    at: usize,
    /// Factors and indices of solved cases.
    terms: Vec<(f64, usize)>,
}

impl CombinedSubcase {
    /// Returns the factors and the indices of the solved cases that they multiply.
    pub(crate) fn terms(&self) -> &[(f64, usize)] {
        &self.terms
    }
}

/// Reads the combination of the subcases `above` that the subcase `s` states. `solved` contains the index of the solved case of each subcase, and
/// `at` is the index of the combination among all results.
///
/// SUBSEQ gives its last factor to the SUBCASE directly above, and so on upwards. SYMSEQ gives its factors to SYM subcases in the same way;
/// without SYMSEQ every factor is 1. REPCASE repeats the subcase above.
///
/// # Errors
/// Missing factors, or more factors than subcases; a combination with its own LOAD; subcases that have no static solution.
pub(crate) fn read_combination(
    read: &DeckModel,
    s: &Subcase,
    (above, solved): (&[Subcase], &[Option<usize>]),
    at: usize,
) -> Result<CombinedSubcase, Faults> {
    let (word, of) = match s.kind {
        SubcaseKind::Symcom => ("SYMCOM", SubcaseKind::Sym),
        SubcaseKind::Repcase => ("REPCASE", SubcaseKind::Subcase),
        _ => ("SUBCOM", SubcaseKind::Subcase),
    };
    let fault = |wrong: String, remedy: &str| {
        let field = format!("{word} {}", s.id);
        let path = read.deck.path(s.at);
        Faults::from(Fault::with_line(path, s.at.line, field, wrong, remedy))
    };
    let candidates: Vec<usize> = (0..above.len()).filter(|i| above[*i].kind == of).collect();
    let factors = match (s.kind, s.sequence.as_slice()) {
        (SubcaseKind::Repcase, _) => vec![1.0],
        (SubcaseKind::Symcom, []) => vec![1.0; candidates.len()],
        (_, sequence) => sequence.to_vec(),
    };
    if factors.is_empty() || factors.len() > candidates.len() {
        let wrong = format!(
            "{} factors are given for {} subcases above",
            factors.len(),
            candidates.len()
        );
        return Err(fault(
            wrong,
            "give one factor for each subcase, in SUBSEQ or SYMSEQ",
        ));
    }
    let named = &candidates[candidates.len() - factors.len()..];
    let mut terms = Vec::new();
    for (factor, i) in factors.into_iter().zip(named) {
        match solved.get(*i).copied().flatten() {
            Some(case) => terms.push((factor, case)),
            None if factor == 0.0 => {}
            None => {
                let wrong = format!("subcase {} has no static solution", above[*i].id);
                return Err(fault(wrong, "give this subcase a LOAD, or the factor 0"));
            }
        }
    }
    if terms.is_empty() {
        return Err(fault("every factor is 0".to_owned(), "correct the factors"));
    }
    let own = read.deck.case_control.subcases.get(above.len());
    if own.is_some_and(|s| s.load.is_some()) {
        return Err(fault(
            "a combination of subcases can't have a LOAD".to_owned(),
            "write a SUBCASE",
        ));
    }
    Ok(CombinedSubcase {
        subcase: s.clone(),
        at,
        terms,
    })
}

/// Adds the combinations to the results, in the order of the deck.
///
/// # Errors
/// Results of bars at different stations, which can't be added.
pub(crate) fn add_combinations(
    read: &DeckModel,
    combined: &[CombinedSubcase],
    cases: &mut Vec<LoadCase>,
    (solution, report): (&mut Solution, &mut SolveReport),
) -> Result<(), Faults> {
    let mut made = Vec::new();
    for c in combined {
        let (id, label) = (c.subcase.id, label_of(&c.subcase));
        let results = c
            .terms
            .iter()
            .filter_map(|(f, i)| Some((*f, solution.cases.get(*i)?)));
        let results: Vec<_> = results.collect();
        let Some(result) = combine_results(id, label.clone(), &results) else {
            return Err(other_stations(read, &c.subcase).into());
        };
        let ids = c
            .terms
            .iter()
            .filter_map(|(f, i)| Some((*f, cases.get(*i)?.subcase)));
        let ids: Vec<(f64, u32)> = ids.collect();
        let balances = ids.iter().filter_map(|(f, id)| {
            let b = report.balance.iter().find(|b| b.subcase == *id)?;
            Some((*f, b))
        });
        let balance = combine_balances(id, &balances.collect::<Vec<_>>());
        let reactions = ids.iter().filter_map(|(f, id)| {
            let r = report.reactions.iter().find(|r| r.subcase == *id)?;
            Some((*f, r))
        });
        let reactions = combine_reactions(id, &reactions.collect::<Vec<_>>());
        let case = LoadCase {
            subcase: id,
            label,
            loads: Vec::new(),
            spc: None,
            mpc: None,
            relief: Relief::None,
        };
        made.push((c.at, case, result, balance, reactions));
    }
    for (at, case, result, balance, reactions) in made {
        cases.insert(at.min(cases.len()), case);
        solution.cases.insert(at.min(solution.cases.len()), result);
        report.balance.extend(balance);
        report.reactions.extend(reactions);
    }
    Ok(())
}

/// Returns the fault of a combination whose subcases have results of bars at different stations.
pub(crate) fn other_stations(read: &DeckModel, combination: &Subcase) -> Fault {
    Fault::with_line(
        read.deck.path(combination.at),
        combination.at.line,
        format!("subcase {}", combination.id),
        "its subcases have bar strain at different stations, which cannot be combined",
        "solve the sum of the loads as a SUBCASE with a LOAD card",
    )
}
