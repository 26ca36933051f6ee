//! Files, page and terminal of each outcome: one file a command.

mod ballast;
mod calibrate;
mod cases;
mod check;
mod columns;
mod fleet;
mod fleet_damage;
mod fleet_page;
#[cfg(feature = "parquet")]
mod fleet_parquet;
mod identify;
mod init;
mod modes;
mod outcome_text;
mod pages;
mod payload;
mod place;
mod reconcile;
mod reconcile_extended;
mod reconcile_motion;
mod reconcile_strain;
mod recover;
mod respond;
mod respond_files;
mod sensitivity;
mod simulate;
mod solve;
mod strains;
mod study;
mod verify;

pub use outcome_text::{console_of, words};
#[cfg(feature = "open")]
pub use pages::live_page;
pub use pages::{write_book, write_page};
pub use recover::RecordFolder;

use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome, Tables};
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page};
use std::path::Path;

/// An outcome that has report files and console output.
pub trait Report {
    /// Files that every outcome of its kind has. Before computation, the command checks whether they would overwrite files of the user.
    const FILES: &'static [&'static str] = &["result.json", "report.html"];

    /// Writes its tables and report, each table with the units of its columns.
    ///
    /// # Errors
    /// The first file that can't be written.
    fn write(&self, out: &mut Output) -> Result<(), Faults>;

    /// Report of the outcome; `None` for an outcome without a report.
    fn page(&self) -> Option<Page>;

    /// Numbers that answer the question of the command, for the first screen of its page.
    fn key_numbers(&self) -> Vec<KeyNumber>;

    /// Table of the result for the first screen of its page: the most detailed one of the terminal that is narrow enough.
    fn result_table(&self) -> ConsoleTable {
        /// Columns that have room next to a picture.
        const COLUMNS: usize = 6;
        let tables = self.console().tables;
        let is_narrow = |t: &&ConsoleTable| t.rows.first().is_none_or(|r| r.len() <= COLUMNS);
        let narrow = tables.iter().find(is_narrow);
        narrow.or(tables.last()).cloned().unwrap_or_default()
    }

    /// Content of a terminal: tables of the result, next step, main table of the folder.
    fn console(&self) -> Console;
}

/// Refuses a folder in which files of the outcome would overwrite files that no command wrote.
///
/// # Errors A fault for each such file.
pub fn check_folder<A>(folder: &Path) -> Result<(), Faults>
where
    Outcome<A>: Report,
{
    Output::check_free(folder, <Outcome<A> as Report>::FILES)
}

/// Writes an outcome into a folder and returns the text of `result.json`. This file is written last. It gets its name after all other files are
/// complete.
///
/// # Errors
/// The first file that can't be written.
pub fn save<A>(outcome: &Outcome<A>, folder: &Path) -> Result<String, Faults>
where
    A: Answer,
    Outcome<A>: Report,
{
    let mut out = Output::begin(folder)?;
    outcome.write(&mut out)?;
    finish(outcome, out)
}

/// Adds `result.json` to the files of an outcome, moves all files to their place, and returns the text of `result.json`.
///
/// # Errors
/// The first file that can't be written.
pub fn finish<A: Answer>(outcome: &Outcome<A>, mut out: Output) -> Result<String, Faults> {
    let json = outcome
        .to_json(out.tables())
        .map_err(|e| mistake("result.json", &e))?;
    out.write_bytes("result.json", json.as_bytes())?;
    out.commit(A::COMMAND, &outcome.sources)?;
    Ok(json)
}

/// Returns the text of `result.json` of an outcome that is not written.
///
/// # Errors
/// An answer without a JSON form, which is a mistake of the program.
pub fn result_text<A: Answer>(outcome: &Outcome<A>) -> Result<String, Faults> {
    let json = outcome.to_json(&Tables::new());
    Ok(json.map_err(|e| mistake("result.json", &e))?)
}

/// A file that a library refuses to make.
fn mistake(file: &str, e: &impl ToString) -> Fault {
    Fault::new(
        file,
        "file",
        e.to_string(),
        "report this as an error of the program",
    )
}
