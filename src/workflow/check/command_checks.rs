//! Tests of a readable job with the code of the commands. The deck is solved or its results are opened, gauges or places for them are found on the
//! model, and readings are tested.

use crate::finding::{Finding, Severity};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::job::Job;
use crate::strain_chain::{WantedAt, has_covariance, prepare, read_fields};
use crate::workflow::{recover, sensitivity};

/// Grids of a deck up to which `check` solves it, with a mesh of half the width: a few seconds of work on two cores.
const MOST_GRIDS: usize = 10_000;

/// Runs the parts of `sensitivity` and `recover` that give findings. `grids` is the number of grids of the job's deck. The caller has read all other
/// files.
///
/// # Errors
/// Faults of these commands.
pub(super) fn ask(work: &mut Work, job: &Job, grids: usize) -> Result<(), Faults> {
    let measured = job.measured.as_ref().filter(|_| recovers(job));
    let placed = job.sensitivity.is_none() && job.gauges.is_empty();
    // With a given S, only responses need a model. The model of a `ballast` job still lacks masses, so it is not solved.
    let of_model = match placed {
        true => job.ballast.is_none(),
        false => job.sensitivity.is_none() || has_covariance(job),
    };
    let solves = of_model && job.model.is_some() && !job.loads.is_empty();
    if solves && grids > MOST_GRIDS {
        work.findings.push(not_asked(job, grids));
        return Ok(());
    }
    match measured {
        Some(measured) if !placed && (solves || job.sensitivity.is_some()) => {
            let prepared = prepare(work, job)?;
            recover::recover_for_findings(work, job, measured, &prepared)
        }
        _ if !solves => Ok(()),
        // A job without places may be meant for `solve` alone.
        _ if placed && job.candidates.line == 0 && job.placement.line == 0 => {
            read_fields(work, job, WantedAt::Anywhere).map(|_| ())
        }
        _ if placed || recovers(job) => sensitivity::prepare_sensitivity(work, job).map(|_| ()),
        _ => prepare(work, job).map(|_| ()),
    }
}

/// Returns whether a job is meant for `recover`. Jobs for weighing, reconciliation or calibration have strain that the loads alone don't explain. A
/// study may test gauges that don't determine the loads.
pub(super) fn recovers(job: &Job) -> bool {
    let taught = job.calibration.line == 0 || has_covariance(job);
    let others = job.reconcile.is_some() || job.payload.is_some() || job.vehicle.is_some();
    taught && !others && job.study.is_none() && job.ballast.is_none()
}

/// Returns the finding that the deck is not solved, with the checks that only the commands make.
fn not_asked(job: &Job, grids: usize) -> Finding {
    let readings = match job.measured {
        Some(_) => ", and the loads from the readings",
        None => "",
    };
    Finding::new(
        Severity::Info,
        "solution-not-checked",
        job.model.as_ref().map_or("model", |m| &m.deck.given),
        format!(
            "the deck is not solved here. Not checked: the solution, the places of gauges{readings}"
        ),
        "run `sensitivity` or `place` on the job: later commands use the stored solution",
    )
    .with_numbers(grids as f64, MOST_GRIDS as f64)
}
