//! Sections that are strain records of their own.

use super::damage::CycleCountInput;
use super::history::History;
use super::record::record;
use super::sections::{SectionLoad, count};
use super::sink::RecordSink;
use super::task::Task;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{Measured, SectionExtent};
use crate::measured::{self, MeasuredStrain};

/// Recovers and counts the loads of every section with a separate file. Only the loads of one file at a time are in memory.
///
/// # Errors
/// Files that can't be read, or that contain runs.
pub(super) fn count_files(work: &mut Work, task: &Task) -> Result<Vec<SectionLoad>, Faults> {
    let mut out = Vec::new();
    for section in &task.job.sections {
        let SectionExtent::File(file) = &section.extent else {
            continue;
        };
        let measured = Measured {
            strain: file.clone(),
            ..task.measured.clone()
        };
        let mut job = task.job.clone();
        job.measured = Some(measured.clone());
        job.sections = Vec::new();
        (job.compare, job.runs) = (None, None);
        job.recover.files = Some(Vec::new());
        let of_file = Task {
            job: &job,
            measured: &measured,
            prepared: task.prepared,
            errors: task.errors,
            zero: task.zero.clone(),
            estimating: task.estimating.clone(),
            validation: task.validation.clone(),
            noise_factor: task.noise_factor,
        };
        let opened = measured::open(&mut work.inputs, &job, &measured, file)?;
        let MeasuredStrain::Record(opened) = opened else {
            let wrong = format!(
                "`{}` has runs, and a section is part of a record",
                file.given
            );
            let remedy = "name a record: a column `time`, or a format of records";
            let at = Fault::with_line(&*job.file, section.line, "section.file", wrong, remedy);
            return Err(at.into());
        };
        let mut history = History::default();
        let (found, _) = record(work, &of_file, &opened, &mut history)?;
        let samples = history.samples()?;
        let counting = CycleCountInput {
            head: &found.head,
            samples: &*samples,
            slope: job.recover.slope,
        };
        out.extend(count(
            counting,
            section,
            std::slice::from_ref(&(0..samples.n_samples())),
        ));
    }
    Ok(out)
}
