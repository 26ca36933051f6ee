//! What was found in all files.

use super::decks::DeckEntry;
use super::records::RecordEntry;
use super::results::ResultEntry;
use crate::host::fault::FaultList;
use crate::host::outcome::{Answer, StatedUnits};
use crate::job::Candidates;
use serde::{Serialize, Serializer};

/// What was found in all files.
#[derive(Default, Serialize)]
pub struct Checked {
    /// Decks.
    pub decks: Vec<DeckEntry>,
    /// Result files.
    pub results: Vec<ResultEntry>,
    /// Records and tables.
    pub records: Vec<RecordEntry>,
    /// Every fault; where there is one, the files are bad input.
    #[serde(serialize_with = "as_lines")]
    pub faults: FaultList,
    /// Jobs in words.
    #[serde(skip)]
    pub jobs: Vec<String>,
    /// What the last job says of where gauges may go.
    #[serde(skip)]
    pub candidates: Option<Candidates>,
    #[serde(skip)]
    pub(super) units: StatedUnits,
}

fn as_lines<S: Serializer>(faults: &FaultList, s: S) -> Result<S::Ok, S::Error> {
    s.collect_seq(faults.iter().map(ToString::to_string))
}

impl Answer for Checked {
    const COMMAND: &'static str = "check";
}
