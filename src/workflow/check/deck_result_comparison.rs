//! Deck against results.

use super::checked_files::CheckedFiles;
use super::decks::DeckEntry;
use crate::fe::deck_result_consistency::{Supports, check_consistency, check_coordinates};
use crate::fe::from_results::find_repeated_results;
use crate::finding::Finding;
use crate::host::work::Work;
use crate::strain_chain::deck::model_of_op2;
use nastran::op2::Op2;
use nastran::results::ResultsFile;

/// Returns warnings on subcases that results contain more than once. If a job has several files, it may state which one it uses.
fn find_ambiguous_subcases(found: &CheckedFiles) -> Vec<Finding> {
    let all = found.results.iter();
    let (of_jobs, others): (Vec<_>, Vec<_>) = all.partition(|r| r.is_of_job);
    let groups = of_jobs.into_iter().map(|r| vec![r]);
    let mut findings = Vec::new();
    for group in groups.chain([others]) {
        let read = group.iter();
        let read =
            read.filter_map(|r| Some((r.path(), ResultsFile::read(&r.bytes, r.path()).ok()?)));
        let (names, files): (Vec<&str>, Vec<ResultsFile>) = read.unzip();
        let twice = find_repeated_results(&files.iter().collect::<Vec<_>>(), None);
        findings.extend(twice.iter().map(|r| r.finding(&names)));
    }
    findings
}

/// Compares every result file with the deck and adds the findings. If no deck has a mesh, the first OP2 with geometry replaces it.
pub(super) fn compare(work: &mut Work, found: &mut CheckedFiles) {
    work.findings.extend(find_ambiguous_subcases(found));
    let has_mesh = |d: &DeckEntry| d.model.as_ref().is_some_and(|m| !m.grids.is_empty());
    if !found.decks.iter().any(has_mesh) {
        let with_mesh = found
            .results
            .iter()
            .find_map(|r| model_of_op2(r.path(), &r.bytes).ok());
        if let Some(read) = with_mesh {
            work.findings.extend(read.findings.iter().cloned());
            found.faults.extend(read.faults.iter().cloned());
            found.decks.push(DeckEntry::from_deck(read));
        }
    }
    let Some(model) = found
        .decks
        .iter()
        .find(|d| has_mesh(d))
        .and_then(|d| d.model.as_ref())
    else {
        return;
    };
    for r in &found.results {
        let Ok(file) = ResultsFile::read(&r.bytes, r.path()) else {
            continue;
        };
        work.findings
            .extend(check_consistency(model, r.path(), &file, Supports::AsDeck));
        if let Ok(op2) = Op2::read(&r.bytes) {
            let (cards, _) = op2.cards();
            if !cards.grids.is_empty() {
                let (geometry, _) = crate::model::Model::from_cards(&cards);
                work.findings
                    .extend(check_coordinates(model, r.path(), &geometry));
            }
        }
    }
}
