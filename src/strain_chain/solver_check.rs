//! Strain of result files compared with the strain that the built-in solver computes on the deck of the job.

use crate::fe::deck_result_consistency::StrainDifference;
use crate::fe::{CaseResult, Corners, SolveOptions};
use crate::finding::{Finding, Severity, list_few};
use crate::host::work::Work;
use crate::job::Job;
use crate::strain_chain::built_in_solver::{MOST_GRIDS_TWICE, cases_of_job, solve_kept};
use crate::strain_chain::deck::DeckModel;
use std::collections::BTreeMap;

/// When results are compared with the built-in solver, and from which difference on they contradict the deck.
struct Rules {
    /// Share of the strain ([`StrainDifference::share`]) by which two programs differ at most on one deck. From twice this share on, the difference
    /// is an error. On public decks with results of MSC, NX and MYSTRAN the share is 0 to 0.1. On a deck with one element of each kind it is 0.26.
    share: f64,
    /// Share of the strain of one shell above which its surfaces or axes differ from the deck. On the public decks the largest share is 0.84.
    of_shell: f64,
    /// Mean strain of a load, as a share of the largest of all loads, below which a field is rounding, since results have single precision.
    strained: f64,
    /// Cosine above which both fields differ by a factor alone.
    cosine: f64,
}

const RULES: Rules = Rules {
    share: 0.27,
    of_shell: 1.0,
    strained: 1e-6,
    cosine: 0.98,
};

/// Solves the loads of a job on its deck and compares the strain with the `results`, in the order of the loads.
///
/// Returns `None` if they agree. It also returns `None` if the deck is too large, or contains cards that the solver does not support. A note then
/// states the reason.
pub(super) fn check_against_solver(
    work: &mut Work,
    job: &Job,
    deck: &DeckModel,
    results: &[&CaseResult],
) -> Option<Finding> {
    let grids = deck.model.grids.len();
    if grids > MOST_GRIDS_TWICE {
        let why = format!("the deck has {grids} grids, limit {MOST_GRIDS_TWICE}");
        return skip(work, &why);
    }
    let cases = match cases_of_job(job, deck) {
        Ok(cases) => cases,
        Err(faults) => return skip(work, &faults.first_reason()),
    };
    let options = SolveOptions {
        corners: Corners::Leave,
        modes: 0,
        ..SolveOptions::default()
    };
    let solved = match solve_kept(work, deck, &cases, options) {
        Ok((solved, _)) => solved,
        Err(faults) => return skip(work, &faults.first_reason()),
    };
    let pairs = results.iter().zip(&solved.cases);
    let differences = pairs.map(|(result, solved)| StrainDifference::compare(result, solved));
    let differences: Vec<(&str, StrainDifference)> = job
        .loads
        .iter()
        .zip(differences)
        .filter_map(|(load, difference)| Some((load.name.as_str(), difference?)))
        .collect();
    let differences = keep_straining_loads(differences);
    of_loads(deck, &differences).or_else(|| of_single_shells(deck, &differences))
}

/// Returns the loads that strain the structure. For other loads, the fields are rounding errors, and their difference is as large as the fields.
fn keep_straining_loads(mut loads: Vec<(&str, StrainDifference)>) -> Vec<(&str, StrainDifference)> {
    let largest = loads.iter().map(|l| l.1.mean).fold(0.0, f64::max);
    loads.retain(|l| l.1.mean > RULES.strained * largest);
    loads
}

const CODE: &str = "strain-contradicts-deck";

/// Returns a finding on the loads under which the whole strain differs.
fn of_loads(deck: &DeckModel, differences: &[(&str, StrainDifference)]) -> Option<Finding> {
    let found = differences.iter().filter(|(_, d)| d.share > RULES.share);
    let mut found: Vec<&(&str, StrainDifference)> = found.collect();
    found.sort_by(|a, b| b.1.share.total_cmp(&a.1.share));
    let largest = found.first()?.1.share;
    let named: Vec<String> = found
        .iter()
        .map(|(load, d)| format!("`{load}` {}", words_of(d)))
        .collect();
    let message = format!(
        "the strain in the results differs from the strain that the built-in solver computes on this deck: {}",
        list_few(&named)
    );
    let remedy = "give the deck of this run, or run the deck again: material, thickness, coordinates, normals, supports or the place of a load differ";
    let severity = match largest > 2.0 * RULES.share {
        true => Severity::Error,
        false => Severity::Warning,
    };
    let finding = Finding::new(severity, CODE, &*deck.given, message, remedy);
    Some(finding.with_numbers(largest, RULES.share))
}

/// Returns a finding on single shells whose strain differs in sign or direction.
fn of_single_shells(deck: &DeckModel, differences: &[(&str, StrainDifference)]) -> Option<Finding> {
    let mut largest: BTreeMap<u32, f64> = BTreeMap::new();
    for (shell, share) in differences.iter().flat_map(|d| &d.1.of_shells) {
        if let Some(shell) = deck.model.shells.get(shell.us())
            && *share > RULES.of_shell
        {
            let of_shell = largest.entry(shell.id).or_default();
            *of_shell = of_shell.max(*share);
        }
    }
    let worst = largest.values().copied().reduce(f64::max)?;
    let ids: Vec<&u32> = largest.keys().collect();
    let message = format!(
        "the strain in the results has another sign or direction than the built-in solver computes on this deck, in elements {}",
        list_few(&ids)
    );
    let remedy = "give the deck of this run, or run the deck again: the order of the grids of these elements differs, and with it the upper surface or the element axes";
    let finding = Finding::new(Severity::Error, CODE, &*deck.given, message, remedy);
    Some(finding.with_numbers(worst, RULES.of_shell))
}

/// Returns the difference as a message: a factor if the fields differ only by a factor, otherwise the share.
fn words_of(difference: &StrainDifference) -> String {
    let StrainDifference {
        share,
        factor,
        cosine,
        ..
    } = difference;
    match cosine.abs() > RULES.cosine {
        true => format!("is {factor:.3} times as large"),
        false => format!("by {:.0} %", 100.0 * share),
    }
}

/// Notes that the results were not compared, and why.
fn skip(work: &mut Work, why: &str) -> Option<Finding> {
    work.notes.push(format!(
        "the results were not compared with the built-in solver: {why}"
    ));
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_that_strains_nothing_but_for_rounding_is_not_compared() {
        let of = |mean: f64| StrainDifference {
            share: 1.0,
            mean,
            factor: 0.0,
            cosine: 0.0,
            of_shells: Vec::new(),
        };
        let left = keep_straining_loads(vec![("bends", of(1e-9)), ("rounding", of(1e-16))]);
        assert_eq!(left, [("bends", of(1e-9))]);
        assert_eq!(keep_straining_loads(vec![("alone", of(1e-16))]).len(), 1);
    }
}
