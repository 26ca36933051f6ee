//! Contents and faults of all checked files.

use super::decks::DeckEntry;
use super::records::RecordEntry;
use super::results::ResultEntry;
use crate::host::fault::{Fault, FaultList};
use crate::host::outcome::{Answer, StatedUnits};
use crate::host::words::count_of;
use crate::job::Candidates;
use serde::{Serialize, Serializer};

/// Contents and faults of all files that were checked.
#[derive(Default, Serialize)]
pub struct CheckedFiles {
    /// Decks.
    pub decks: Vec<DeckEntry>,
    /// Result files.
    pub results: Vec<ResultEntry>,
    /// Records and tables.
    pub records: Vec<RecordEntry>,
    /// All faults. With a fault, the exit code is the code of bad input.
    #[serde(serialize_with = "as_lines")]
    pub faults: FaultList,
    /// Next command for the user, with the last job.
    #[serde(skip)]
    pub(super) next: Option<String>,
    /// Descriptions of the jobs.
    #[serde(skip)]
    pub jobs: Vec<String>,
    /// Candidates that the last job allows.
    #[serde(skip)]
    pub candidates: Option<Candidates>,
    #[serde(skip)]
    pub(super) units: StatedUnits,
}

fn as_lines<S: Serializer>(faults: &FaultList, s: S) -> Result<S::Ok, S::Error> {
    s.collect_seq(faults.iter().map(ToString::to_string))
}

impl Answer for CheckedFiles {
    const COMMAND: &'static str = "check";
    const RESULT: &'static str = "The result of these files";

    fn verdict(&self) -> String {
        let files = self.decks.len() + self.results.len() + self.records.len() + self.jobs.len();
        format!("{} read, no faults found.", count_of(files, "file"))
    }

    fn faults(&self) -> &[Fault] {
        &self.faults
    }
}

impl CheckedFiles {
    /// Returns the next step of a user: the command of the job, or a job for a deck. `None` if the files have faults.
    pub fn next_step(&self) -> Option<String> {
        let deck = self.decks.first().map(|d| {
            let deck = d.path();
            format!("run `strainbridge init {deck}` for a job")
        });
        let next = self.next.clone().or(deck);
        next.filter(|_| self.faults.is_empty())
    }
}
