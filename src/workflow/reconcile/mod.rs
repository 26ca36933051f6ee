//! `reconcile`: where simulation and measurement disagree, which effect is missing, and the model with the effect.

mod added_motion;
mod answer;
mod background;
mod causes;
mod channel_corrections;
mod deck_frame;
mod deck_loads;
mod deck_thermal;
mod described_effects;
mod extend;
pub mod extended_columns;
mod extended_deck;
mod extended_job;
mod extended_loads;
pub mod extended_model;
pub(super) mod folder_paths;
mod frame_columns;
mod influence;
mod local_ground;
mod local_stiffness;
mod marked_stiffness;
mod matrix_frame;
mod model_changes;
mod model_part;
mod motion_findings;
mod motion_job;
mod motion_path;
mod one_file;
mod readings;
pub(super) mod redirect;
mod refined_model;
mod region;
mod run_frame;
mod signature_table;
mod stiffness;
mod stiffness_changes;
mod strain_findings;
mod strain_job;
mod strain_path;
mod words;
mod zones;

pub use answer::*;
pub use extended_job::extended_job;
pub use marked_stiffness::MarkedStiffness;
pub use model_changes::ModelChange;
pub use words::effect_in_words;

use crate::host::context::Context;
use crate::host::fault::Faults;
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::Work;
use crate::job::{GivenSensitivity, Job, ReconcilePath};
use crate::strain_chain::named_results::check_tables;

/// Compares the model of a job with its measurement and identifies missing effects. The answer contains the difference before and after, and
/// the job with the identified effects.
///
/// # Errors
/// Returns every fault of the job and of the files that it names.
///
/// # Example
/// Gauge P05 of `examples/frame` was wired with the wrong sign:
/// ```
/// use strainbridge::{Context, Disk, Job, reconcile};
///
/// let job = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/reconcile_matrix.toml");
/// let found = reconcile(&Job::read(job, &Disk)?, &Context::new(&Disk))?;
/// assert_eq!(found.named, ["sign_flip:P05"]);
/// assert!(found.gap.after < 0.1 * found.gap.before);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn reconcile(job: &Job, cx: &Context) -> Result<Outcome<Reconciliation>, Faults> {
    let mut work = Work::of_job(cx, job);
    let job = &job.without_validation_gauges()?;
    check_tables(&work, job)?;
    let path = job.reconcile.as_ref().map(|r| r.path);
    let answer = match path.unwrap_or(ReconcilePath::Static) {
        ReconcilePath::Static => strain_path::answer(job, &mut work)?,
        ReconcilePath::Dynamic => motion_path::answer(job, &mut work)?,
    };
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Reads the data of a `[reconcile]` without solving a model, and discards them.
///
/// # Errors
/// Faults of the job and of the files it names.
pub(super) fn check_inputs(work: &mut Work, job: &Job) -> Result<(), Faults> {
    match job.reconcile.as_ref().map(|r| r.path) {
        Some(ReconcilePath::Static) => strain_path::check_inputs(job, work),
        Some(ReconcilePath::Dynamic) | None => Ok(()),
    }
}

/// Reads the signatures that accompany a given S for these gauges, as every search for a missing effect does, and discards them.
///
/// # Errors
/// Tables that can't be read, gauges that a table lacks.
pub(super) fn check_signature_inputs(
    work: &mut Work,
    job: &Job,
    given: &GivenSensitivity,
    gauges: &[String],
) -> Result<(), Faults> {
    matrix_frame::read(work, job, given, gauges).map(|_| ())
}
