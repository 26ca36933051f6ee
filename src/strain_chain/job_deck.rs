//! The deck of a job, held against the units that the job states: one place for every command that reads one.

use crate::fe::suport_without_inrel;
use crate::finding::Finding;
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{Job, ModelFiles};
use crate::model::Model;
use crate::strain_chain::deck::{DeckModel, moduli_and_densities, read_model};
use crate::strain_chain::not_solved::NOT_SOLVED;
use crate::units::check_units;

/// The deck of a job; what is worth knowing of it, and what contradicts the job's units, goes to the work.
///
/// # Errors
/// Every fault of the deck.
pub(crate) fn read_deck(
    work: &mut Work,
    job: &Job,
    files: &ModelFiles,
) -> Result<DeckModel, Faults> {
    let read = read_model(&mut work.inputs, &job.folder, &files.deck.given)?;
    let solves = files.results.is_empty();
    // The solver itself refuses what acts on its answer.
    let of_results = |f: &&Finding| f.code != NOT_SOLVED || !solves;
    let findings = read.findings.iter().filter(of_results);
    work.findings.extend(findings.cloned());
    if solves {
        work.findings
            .extend(suport_without_inrel(&read.model, read.deck.sol));
    }
    Faults::check(read.faults.clone())?;
    work.findings.extend(against_units(job, &read.model));
    Ok(read)
}

/// Contradictions between the job's units and its deck.
pub(crate) fn against_units(job: &Job, model: &Model) -> Vec<Finding> {
    let (moduli, densities) = moduli_and_densities(model);
    let unitsys = model.params.unitsys.as_deref();
    check_units(job.units, unitsys, &moduli, &densities)
}
