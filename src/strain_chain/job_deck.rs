//! Reads the deck of a job for all commands, and compares it with the units that the job states.

use crate::fe::suport_without_inrel;
use crate::finding::Finding;
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::{Job, ModelFiles};
use crate::model::Model;
use crate::strain_chain::deck::{DeckModel, moduli_and_densities, read_model};
use crate::strain_chain::not_solved::NOT_SOLVED;
use crate::units::{UnitSystem, check_units};

/// Reads the deck of a job. Findings on the deck, and contradictions to the units of the job, are added to the findings of `work`.
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
    // The solver refuses unsupported cards that affect its answer, so the finding is needed only for given results.
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
    // There is no job whose units PARAM,UNITSYS could contradict.
    findings.retain(|f| f.code != "units-contradict-unitsys");
    findings
}

/// Returns the contradictions between a system of units, stated by a job or suggested by the materials, and a deck.
pub(crate) fn against_units(system: UnitSystem, model: &Model) -> Vec<Finding> {
    let (moduli, densities) = moduli_and_densities(model);
    let unitsys = model.params.unitsys.as_deref();
    check_units(system, unitsys, &moduli, &densities)
}
