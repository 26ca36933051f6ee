//! Reading files into solutions.

use super::beams::BeamCollector;
use super::blocks::{is_bar, is_shell_or_bar};
use super::displacement::to_basic;
use super::merge::merge;
use super::repeated_subcases::find_repeated_results;
use super::shells::ShellCollector;
use super::tally::{Irregularity, Tally};
use crate::fe::deck_result_consistency::{Supports, check_consistency, check_coordinates};
use crate::fe::{CaseResult, Solution};
use crate::finding::{Finding, Severity};
use crate::model::Model;
use nastran::cards::Cards;
use nastran::results::{Analysis, Block, Quantity, ResultsFile, Rows};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// Whether displacements are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Displacements {
    /// Into [`CaseResult::displacement`].
    #[default]
    Read,
    /// Left in the file: less memory where only strain matters.
    Leave,
}

/// Selection of the results to read.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct ReadOptions {
    /// Whether displacements are read.
    pub displacements: Displacements,
    /// Subcases to read; `None` for all.
    pub subcases: Option<BTreeSet<u32>>,
    /// Supports of the run that produced the results, as the caller states them.
    pub supports: Supports,
}

/// Combines the static subcases of several files to one solution, subcases ascending.
///
/// A subcase in two files is one case if the files complement each other (strain in one, displacements in the other, other elements).
/// It is also one case if both have equal values. If values differ there are two cases and a finding.
pub fn solution_from_results(
    model: &Model,
    files: &[(&str, &ResultsFile)],
    options: &ReadOptions,
) -> Solution {
    let solutions = files.iter();
    let solutions = solutions.map(|(name, file)| solution_from_file(model, name, file, options));
    let solutions: Vec<Solution> = solutions.collect();
    let (names, files): (Vec<&str>, Vec<&ResultsFile>) = files.iter().copied().unzip();
    let mut found = find_repeated_results(&files, options.subcases.as_ref());
    found.retain(|r| r.is_of_strain());
    let mut all = merge(solutions, &found);
    all.findings.extend(found.iter().map(|r| r.finding(&names)));
    all
}

/// Reads the static subcases of one result file, sorted by subcase. A finding names other analyses in the file.
///
/// Shell strain is at Z1 and Z2 in the output frame of [`crate::fe::shell_frame`]. If a subcase has no shell strain, strain is computed from shell
/// stress and the isotropic material. Bars are treated in the same way. Blocks that can't be decoded and the results of [`check_consistency`] become
/// findings.
pub fn solution_from_file(
    model: &Model,
    name: &str,
    file: &ResultsFile,
    options: &ReadOptions,
) -> Solution {
    let mut by_subcase: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    let mut passed_over: BTreeSet<&'static str> = BTreeSet::new();
    for (ix, block) in file.blocks().iter().enumerate() {
        if block.analysis != Analysis::Statics {
            passed_over.insert(block.analysis.word());
        } else if block.complex {
            passed_over.insert("complex statics");
        } else if block.sort2 {
            passed_over.insert("statics in SORT2");
        } else if options
            .subcases
            .as_ref()
            .is_none_or(|s| s.contains(&block.subcase))
        {
            by_subcase.entry(block.subcase).or_default().push(ix);
        }
    }
    let read: Vec<(CaseResult, Tally, Vec<Finding>)> = by_subcase
        .par_iter()
        .map(|(&subcase, blocks)| read_case(model, name, file, options, subcase, blocks))
        .collect();
    let mut solution = Solution {
        source: format!("{}: {name}", file.solver()),
        ..Solution::default()
    };
    let mut tally = Tally::default();
    for (case, case_tally, findings) in read {
        tally.merge(case_tally);
        solution.findings.extend(findings);
        solution.cases.push(case);
    }
    share_element_lists(&mut solution.cases);
    solution.findings.extend(tally.findings(name));
    solution
        .findings
        .extend(check_consistency(model, name, file, options.supports));
    if let Some((cards, _)) = file.cards() {
        // Grids and their frames are enough to compare coordinates.
        let cards = Cards {
            grids: cards.grids,
            grdset: cards.grdset,
            coords: cards.coords,
            ..Cards::default()
        };
        let (geometry, _) = Model::from_cards(&cards);
        solution
            .findings
            .extend(check_coordinates(model, name, &geometry));
    }
    if solution.cases.is_empty() {
        let what = if passed_over.is_empty() {
            "no results".to_string()
        } else {
            list(&passed_over)
        };
        let message = format!("the file has no static subcase; it contains: {what}");
        let remedy = "give the results of a static run (SOL 101)";
        solution.findings.push(Finding::new(
            Severity::Error,
            "no-static-results",
            name,
            message,
            remedy,
        ));
    } else if !passed_over.is_empty() {
        let message = format!(
            "only real static subcases in SORT1 are read; passed over: {}",
            list(&passed_over)
        );
        solution.findings.push(Finding::new(
            Severity::Info,
            "not-static",
            name,
            message,
            "nothing, if only the static subcases are needed",
        ));
    }
    solution
}

fn list(words: &BTreeSet<&str>) -> String {
    words.iter().copied().collect::<Vec<_>>().join(", ")
}

/// The blocks of one subcase.
fn read_case(
    model: &Model,
    name: &str,
    file: &ResultsFile,
    options: &ReadOptions,
    subcase: u32,
    blocks: &[usize],
) -> (CaseResult, Tally, Vec<Finding>) {
    let block = |ix: usize| file.blocks().get(ix);
    let of = |q: Quantity| {
        blocks
            .iter()
            .copied()
            .filter(move |&ix| block(ix).is_some_and(|b| b.quantity == q))
    };
    let label = blocks
        .iter()
        .filter_map(|&ix| block(ix))
        .map(label)
        .find(|l| !l.is_empty())
        .unwrap_or_default();
    let (mut tally, mut findings) = (Tally::default(), Vec::new());
    let mut case = CaseResult {
        subcase,
        label,
        ..CaseResult::default()
    };
    let mut decode = |ix: usize| match file.rows(ix) {
        Ok(rows) => Some(rows),
        Err(e) => {
            // A block of a kind that is not decoded is left out. A block that contradicts itself is damaged, so the whole file is in question.
            let (severity, code, remedy) = if e.is_damage() {
                (
                    Severity::Error,
                    "results-damaged",
                    "write or copy the file again",
                )
            } else {
                (
                    Severity::Warning,
                    "block-not-read",
                    "export the results again if this block is needed",
                )
            };
            findings.push(Finding::new(severity, code, name, e.to_string(), remedy));
            None
        }
    };
    // Strain is read if the file has any, else stress; shells and bars are handled separately.
    let mut shells = ShellCollector::new(model);
    let mut beams = BeamCollector::new(model);
    let (mut shell_strain, mut beam_strain) = (false, false);
    for ix in of(Quantity::Strain).filter(|&ix| block(ix).is_some_and(is_shell_or_bar)) {
        let (Some(b), Some(rows)) = (block(ix), decode(ix)) else {
            continue;
        };
        if ShellCollector::takes(&rows) {
            shell_strain = true;
            shells.add(b, &rows, &mut tally);
        } else if BeamCollector::takes(&rows) {
            beam_strain = true;
            beams.add(b, &rows, &mut tally);
        }
    }
    for ix in of(Quantity::Stress).filter(|&ix| block(ix).is_some_and(is_shell_or_bar)) {
        let Some(b) = block(ix) else { continue };
        if if is_bar(b) { beam_strain } else { shell_strain } {
            continue;
        }
        let Some(rows) = decode(ix) else { continue };
        if ShellCollector::takes(&rows) {
            shells.add(b, &rows, &mut tally);
        } else if BeamCollector::takes(&rows) {
            beams.add(b, &rows, &mut tally);
        }
    }
    case.shells = shells.finish();
    case.beams = beams.finish();
    if let Some(ix) = of(Quantity::PlyStrain)
        .next()
        .or_else(|| of(Quantity::PlyStress).next())
        && let Some(rows) = decode(ix)
    {
        note_plies(model, &rows, &case, &mut tally);
    }
    if options.displacements == Displacements::Read
        && let Some(ix) = of(Quantity::Displacement).next()
        && let (Some(b), Some(rows)) = (block(ix), decode(ix))
    {
        case.displacement = to_basic(model, b, &rows);
    }
    (case, tally, findings)
}

/// Returns LABEL, or else SUBTITLE, of every subcase of a file that has one of them.
pub fn subcase_labels(file: &ResultsFile) -> BTreeMap<u32, String> {
    let named = file.blocks().iter().filter_map(|b| {
        let [_, subtitle, label] = &b.titles;
        let name = [label, subtitle].into_iter().find(|t| !t.is_empty())?;
        Some((b.subcase, name.clone()))
    });
    named.collect()
}

/// LABEL, else SUBTITLE, else TITLE.
fn label(block: &Block) -> String {
    block
        .titles
        .iter()
        .rev()
        .find(|t| !t.is_empty())
        .cloned()
        .unwrap_or_default()
}

/// Laminates with ply rows only.
fn note_plies(model: &Model, rows: &Rows, case: &CaseResult, tally: &mut Tally) {
    let mut last = None;
    for id in &rows.ids {
        if last.replace(id.entity) == Some(id.entity) {
            continue;
        }
        let known = model
            .shells
            .binary_search_by_key(&id.entity, |s| s.id)
            .ok()
            .and_then(|i| u32::try_from(i).ok());
        if let Some(ix) = known
            && case
                .shells
                .elements
                .binary_search(&crate::model::ShellIx(ix))
                .is_err()
        {
            tally.add(Irregularity::PliesOnly, id.entity);
        }
    }
}

/// Load cases with the same elements share one list.
fn share_element_lists(cases: &mut [CaseResult]) {
    for i in 1..cases.len() {
        let (before, after) = cases.split_at_mut(i);
        let Some(case) = after.first_mut() else {
            continue;
        };
        if let Some(same) = before
            .iter()
            .rev()
            .find(|b| b.shells.elements == case.shells.elements)
        {
            case.shells.elements = Arc::clone(&same.shells.elements);
        }
        if let Some(same) = before
            .iter()
            .rev()
            .find(|b| b.beams.elements == case.beams.elements)
        {
            case.beams.elements = Arc::clone(&same.beams.elements);
        }
    }
}
