//! `reconcile`: where simulation and measurement disagree, which effect is missing, and the model with the effect in it.

mod background;
mod causes;
mod deck_frame;
mod deck_thermal;
mod described;
mod dynamic;
mod dynamic_extend;
mod extend;
mod extended_deck;
pub(super) mod extended_job;
mod extended_loads;
mod finer;
mod matrix_frame;
mod one_file;
pub(super) mod relative;
mod signature_table;
mod static_path;
mod stiffness;
mod tables;
mod words;

use super::fault::Faults;
use super::job::{ReconcilePath, read_job};
use super::{JobArguments, Session};

/// Runs the workflow of the job's path.
///
/// # Errors
/// Faults of the job and of the files it names.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = read_job(&mut session.inputs, &arguments.job)?;
    session.put_units(job.units, &job.report_units);
    match job
        .reconcile
        .as_ref()
        .map_or(ReconcilePath::Static, |r| r.path)
    {
        ReconcilePath::Static => static_path::run(&job, &arguments.job, session),
        ReconcilePath::Dynamic => dynamic::run(&job, &arguments.job, session),
    }
}
