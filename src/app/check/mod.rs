//! `check`: what is in the files, every fault, and whether deck and results belong together.
//!
//! [`kind`] tells files apart by content; [`decks`] and [`results`] describe them; [`jobs`] follows a job to the files it names;
//! [`together`] compares.

mod decks;
mod jobs;
mod kind;
mod results;
mod together;

use super::context::Context;
use super::fault::{FaultList, Faults};
use super::outcome::{Answer, Outcome, StatedUnits};
use super::work::Work;
pub use decks::DeckEntry;
use kind::{Kind, kind_of};
pub use results::ResultEntry;
use serde::{Serialize, Serializer};
use std::path::{Path, PathBuf};

/// What was found in all files.
#[derive(Default, Serialize)]
pub struct Checked {
    /// Decks.
    pub decks: Vec<DeckEntry>,
    /// Result files.
    pub results: Vec<ResultEntry>,
    /// Every fault; where there is one, the files are bad input.
    #[serde(serialize_with = "as_lines")]
    pub faults: FaultList,
    /// Jobs in words.
    #[serde(skip)]
    pub jobs: Vec<String>,
    #[serde(skip)]
    units: StatedUnits,
}

fn as_lines<S: Serializer>(faults: &FaultList, s: S) -> Result<S::Ok, S::Error> {
    s.collect_seq(faults.iter().map(ToString::to_string))
}

impl Answer for Checked {
    const COMMAND: &'static str = "check";
}

/// What is in decks, results and jobs, every fault, and whether they belong together. Faults of the files are part of the answer.
///
/// # Errors
/// None of the files' own.
pub fn check(files: &[PathBuf], cx: &Context) -> Result<Outcome<Checked>, Faults> {
    let mut work = Work::new(cx);
    let mut found = Checked::default();
    for file in files {
        let given = file.display().to_string();
        work.stage("read", |w| look(w, Path::new(""), &given, &mut found));
    }
    work.stage("compare", |w| together::compare(w, &mut found));
    let units = found.units.clone();
    Ok(work.finish(units, found))
}

/// Looks into one file.
fn look(work: &mut Work, base: &Path, given: &str, found: &mut Checked) {
    let bytes = match work.inputs.read(base, given) {
        Ok(b) => b,
        Err(f) => return found.faults.push(f),
    };
    match kind_of(given, &bytes) {
        Kind::Job => jobs::look(work, base, given, found),
        Kind::Deck => decks::look(work, base, given, &bytes, found),
        Kind::Results => results::look(work, given, bytes, found),
    }
}
