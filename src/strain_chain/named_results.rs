//! Result files that a job names.

use crate::finding::Finding;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::host::unreadable_at;
use crate::job::{EffectSource, HoldOut, Job, NamedFile};
use nastran::results::{ResultsError, ResultsFile};

/// Treatment of missing results.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingResults {
    /// The job is wrong.
    Refused,
    /// The run that writes the results is not done yet.
    ToCome,
}

/// Refuses results that the job names and that are cut or damaged, even if the command does not use them. The list of files that were read does not
/// contain them.
///
/// # Errors
/// A fault for each such file, and for each missing file if `absent` requires it.
pub fn check_named(work: &Work, job: &Job, absent: MissingResults) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    for named in job.model.iter().flat_map(|m| &m.results) {
        let path = job.folder.join(&named.given);
        let is_there = match work.inputs.load(&path) {
            Ok(bytes) => ResultsFile::read(&bytes, &named.given)
                .map(drop)
                .map_err(|e| results_fault(job, named, &e)),
            Err(e)
                if absent == MissingResults::ToCome && e.kind() == std::io::ErrorKind::NotFound =>
            {
                Ok(())
            }
            Err(e) => Err(unreadable_at(job, named, &e)),
        };
        faults.extend(is_there.err());
    }
    Faults::check(faults)
}

/// Remedy for results that can't be read.
pub const RESULTS_REMEDY: &str = "give an OP2, punch or HDF5 file of a static run";

/// Returns the fault of results that can't be read.
pub fn results_fault(job: &Job, named: &NamedFile, e: &ResultsError) -> Fault {
    Fault::with_line(
        &*job.file,
        named.line,
        &*named.key,
        format!("`{}`: {e}", named.given),
        RESULTS_REMEDY,
    )
}

/// Returns the fault of results whose elements have another type than in the deck.
pub fn other_deck(job: &Job, named: &NamedFile, finding: &Finding) -> Fault {
    Fault::with_line(
        &*job.file,
        named.line,
        &*named.key,
        format!("`{}`: {}", named.given, finding.clause()),
        finding.remedy.trim_end_matches('.'),
    )
}

/// Refuses missing tables that the job names, whether or not the command reads them. These are runs, zero, held-out runs, covariance, signatures and
/// described effects. The list of files that were read does not contain them.
///
/// # Errors
/// A fault for each such table.
pub fn check_tables(work: &Work, job: &Job) -> Result<(), Faults> {
    let mut named: Vec<&NamedFile> = job.runs.iter().map(|r| &r.file).collect();
    if let Some(measured) = &job.measured {
        named.extend(&measured.zero);
        if let HoldOut::File(file) = &measured.hold_out {
            named.push(file);
        }
    }
    if let Some(given) = &job.sensitivity {
        named.extend(&given.covariance);
        named.extend(given.signatures.files());
    }
    for effect in job.reconcile.iter().flat_map(|r| &r.described) {
        if let EffectSource::Signature(file) = &effect.source {
            named.push(file);
        }
    }
    let missing = |n: &&NamedFile| match work.inputs.load(&job.folder.join(&n.given)) {
        Err(e) => Some(unreadable_at(job, n, &e)),
        Ok(_) => None,
    };
    Faults::check(named.iter().filter_map(missing).collect())
}
