//! The deck of a job, held against the units that the job states: one place for every command that reads one.

use crate::fe::suport_without_inrel;
use crate::finding::Finding;
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{Job, ModelFiles};
use crate::model::Model;
use crate::strain_chain::deck::{DeckModel, moduli_and_densities, read_model};
use crate::strain_chain::not_solved::NOT_SOLVED;
use crate::units::{UnitSystem, check_units};

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
    work.findings.extend(against_units(job.units, &read.model));
    Ok(read)
}

/// Returns the materials that contradict the system of units that they suggest as a whole.
pub(crate) fn against_suggested_units(system: UnitSystem, model: &Model) -> Vec<Finding> {
    let mut findings = against_units(system, model);
    // No job states units that PARAM,UNITSYS could contradict.
    findings.retain(|f| f.code != "units-contradict-unitsys");
    findings
}

/// Returns the contradictions between a system of units, stated by a job or suggested by the materials, and a deck.
pub(crate) fn against_units(system: UnitSystem, model: &Model) -> Vec<Finding> {
    let (moduli, densities) = moduli_and_densities(model);
    let unitsys = model.params.unitsys.as_deref();
    check_units(system, unitsys, &moduli, &densities)
}
