//! Elements and grids that one has and the other lacks.

use crate::finding::{Finding, Severity, list_few};
use crate::model::Model;
use nastran::results::{Analysis, Block, Quantity, ResultsFile};
use std::collections::{BTreeMap, BTreeSet};

/// Returns findings on ids of the file that the model lacks, and on grids and strained shells of the model that the file lacks.
///
/// One block of each quantity and element type is looked at, of the subcase with most rows.
pub fn check_ids(model: &Model, name: &str, file: &ResultsFile) -> Vec<Finding> {
    let mut elements: BTreeSet<u32> = BTreeSet::new();
    let mut grids: BTreeSet<u32> = BTreeSet::new();
    for ix in largest_blocks(file.blocks()) {
        let (Some(block), Ok(rows)) = (file.blocks().get(ix), file.rows(ix)) else {
            continue;
        };
        if block.element.is_some() {
            elements.extend(rows.ids.iter().map(|id| id.entity))
        } else {
            // Scalar points (grid type 2) are not grids of the model.
            let grid_rows = rows.ids.iter().filter(|id| id.at == 1);
            grids.extend(grid_rows.map(|id| id.entity))
        }
    }
    let ours_e = element_ids(model);
    let ours_g: BTreeSet<u32> = model.grids.iter().map(|g| g.id).collect();
    let mut findings = Vec::new();
    report_missing_ids(&mut findings, name, "element", &elements, &ours_e);
    report_missing_ids(&mut findings, name, "grid", &grids, &ours_g);
    if !grids.is_empty() && !grids.is_disjoint(&ours_g) {
        let absent: Vec<u32> = ours_g.difference(&grids).copied().collect();
        if !absent.is_empty() {
            let message = format!(
                "{} of {} grids of the deck have no displacements in the file: {}",
                absent.len(),
                ours_g.len(),
                list_few(&absent)
            );
            let remedy =
                "request DISPLACEMENT = ALL if the deck is the run's deck; else give that deck";
            findings.push(
                Finding::new(Severity::Info, "grid-not-in-results", name, message, remedy)
                    .with_numbers(absent.len() as f64, 0.0),
            );
        }
    }
    let shells: Vec<u32> = model
        .shells
        .iter()
        .map(|s| s.id)
        .filter(|id| !elements.contains(id))
        .collect();
    if !shells.is_empty() && elements.iter().any(|id| ours_e.contains(id)) {
        let message = format!(
            "{} of {} shells of the deck have no results in the file: {}",
            shells.len(),
            model.shells.len(),
            list_few(&shells)
        );
        let remedy =
            "request STRAIN(FIBER) = ALL, or a SET with the elements that may carry gauges";
        findings.push(
            Finding::new(
                Severity::Info,
                "shell-not-in-results",
                name,
                message,
                remedy,
            )
            .with_numbers(shells.len() as f64, 0.0),
        );
    }
    findings
}

/// Returns the block with most entries for every element type (strain before stress) and for displacements.
fn largest_blocks(blocks: &[Block]) -> Vec<usize> {
    let mut best: BTreeMap<(Option<u32>, Quantity), (usize, usize)> = BTreeMap::new();
    for (ix, b) in blocks.iter().enumerate() {
        let wanted = matches!(
            b.quantity,
            Quantity::Strain
                | Quantity::Stress
                | Quantity::PlyStrain
                | Quantity::PlyStress
                | Quantity::Displacement
        );
        let modelled = b.element.is_none_or(|e| is_modelled(e.0));
        if !wanted || !modelled || b.analysis != Analysis::Statics || b.complex || b.sort2 {
            continue;
        }
        let entry = best
            .entry((b.element.map(|e| e.0), b.quantity))
            .or_insert((b.entries, ix));
        if b.entries > entry.0 {
            *entry = (b.entries, ix);
        }
    }
    let with_strain: BTreeSet<Option<u32>> = best
        .keys()
        .filter(|k| k.1 == Quantity::Strain)
        .map(|k| k.0)
        .collect();
    best.into_iter()
        .filter(|(k, _)| k.1 != Quantity::Stress || !with_strain.contains(&k.0))
        .map(|(_, (_, ix))| ix)
        .collect()
}

/// Element types whose cards the model holds; fasteners, scalar springs on points and the like are no sign of a foreign deck.
fn is_modelled(element: u32) -> bool {
    matches!(
        element,
        1..=4 | 10 | 33 | 34 | 39 | 64 | 67 | 68 | 70 | 74 | 75 | 82 | 95..=98 | 100 | 102 | 144 | 227 | 228 | 232 | 233
    )
}

fn element_ids(model: &Model) -> BTreeSet<u32> {
    model.elements().map(|e| model.element_id(e)).collect()
}

/// Adds a finding for ids that the file contains and the deck lacks. It is an error if they have no id in common.
fn report_missing_ids(
    findings: &mut Vec<Finding>,
    name: &str,
    what: &str,
    theirs: &BTreeSet<u32>,
    ours: &BTreeSet<u32>,
) {
    let absent: Vec<u32> = theirs.difference(ours).copied().collect();
    if absent.is_empty() {
        return;
    }
    let severity = match absent.len() == theirs.len() {
        true => Severity::Error,
        false => Severity::Warning,
    };
    let code = match what {
        "element" => "element-not-in-deck",
        _ => "grid-not-in-deck",
    };
    let message = format!(
        "{} of {} {what}s with results are not in the deck: {}",
        absent.len(),
        theirs.len(),
        list_few(&absent)
    );
    let finding = Finding::new(severity, code, name, message, "give the deck of this run");
    findings.push(finding.with_numbers(absent.len() as f64, 0.0));
}
