//! `check`: content of files, every fault, and whether deck and results belong together.
//!
//! `kind` finds the kind of a file. `checked_files` is the answer. `decks`, `results` and `records` describe files. `jobs` follows a job to its
//! files, and `command_checks` runs the checks of the commands. `deck_result_comparison` compares a deck with results.

mod checked_files;
mod command_checks;
mod deck_result_comparison;
mod decks;
mod jobs;
mod kind;
mod records;
mod results;

use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::Outcome;
use crate::host::work::Work;
pub use checked_files::CheckedFiles;
pub use decks::DeckEntry;
use kind::{Kind, kind_of};
pub use records::RecordEntry;
pub use results::ResultEntry;
use std::path::{Path, PathBuf};

/// Reads decks, results and jobs, lists their contents and faults, and compares them with each other. Faults of the files are part of the answer.
///
/// # Errors
/// Returns an error only if the command itself fails, never for a fault of a file.
///
/// # Example
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, check};
///
/// let deck = "SOL 101\nCEND\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nCROD,1,7,1,2\nCONM2,2,3,,1.\nENDDATA\n";
/// let files = InMemory::default().with_file("rod.bdf", deck);
/// let found = check(&["rod.bdf".into()], &Context::new(&files))?;
/// // Line 6 names property 7 and line 7 names grid 3, which the deck does not contain.
/// let faults: Vec<String> = found.faults.iter().map(ToString::to_string).collect();
/// assert!(faults.iter().any(|f| f.starts_with("rod.bdf:6: ") && f.contains("PROD 7")), "{faults:?}");
/// assert!(faults.iter().any(|f| f.starts_with("rod.bdf:7: ") && f.contains("grid 3")), "{faults:?}");
/// assert!(found.next_step().is_none());
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn check(files: &[PathBuf], cx: &Context) -> Result<Outcome<CheckedFiles>, Faults> {
    let mut work = Work::new(cx);
    let mut found = CheckedFiles::default();
    for file in files {
        let given = file.display().to_string();
        work.stage("read", |w| check_file(w, Path::new(""), &given, &mut found));
    }
    work.stage("compare", |w| {
        deck_result_comparison::compare(w, &mut found)
    });
    for deck in &found.decks {
        work.findings
            .extend(deck.contradictions_of_suggested_units());
    }
    let units = found.units.clone();
    Ok(work.finish(units, found))
}

/// Checks one file.
fn check_file(work: &mut Work, base: &Path, given: &str, found: &mut CheckedFiles) {
    let bytes = match work.inputs.read(base, given) {
        Ok(b) => b,
        Err(f) => return found.faults.push(f),
    };
    match kind_of(given, &bytes) {
        Kind::Job => jobs::check_job(work, base, given, found, check_file),
        Kind::Deck => {
            let (entry, faults) = decks::check_deck(work, base, given, &bytes);
            found.faults.extend(faults);
            found.decks.push(entry);
        }
        Kind::Results => {
            let (entry, faults) = results::check_results(work, given, bytes);
            found.faults.extend(faults);
            found.results.extend(entry);
        }
        Kind::Table => match records::check_record(work, base, given) {
            Ok(entry) => found.records.push(entry),
            Err(faults) => found.faults.extend(faults),
        },
        Kind::Other(kind) => found.faults.push(Fault::new(
            given,
            "file",
            format!("it is {kind}"),
            "name a deck, results, a job, a record or a table",
        )),
    }
}
