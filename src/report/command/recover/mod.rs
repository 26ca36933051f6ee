//! Report files and console output of `recover`.
//!
//! A [`RecordFolder`] writes the loads of a record while they are recovered. All other files are written from the outcome.

mod columns;
mod comparison_curves;
mod console;
mod folder;
mod load_comparison;
mod load_tables;
mod nastran;
#[cfg(feature = "parquet")]
mod parquet;
mod record;
mod rpc;
mod runs;
mod tables;
mod turning_points;
mod vtu;

pub use folder::RecordFolder;

use super::Report;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::report::console::{Console, ConsoleTable};
use crate::report::page::{KeyNumber, Page};
use crate::workflow::recover::{RecoveredLoads, States};

impl Report for Outcome<RecoveredLoads> {
    const FILES: &'static [&'static str] = &["result.json", "report.html", "loads.csv"];

    fn write(&self, out: &mut Output) -> Result<(), Faults> {
        load_comparison::write(out, self)?;
        match &self.states {
            States::Runs(runs) => runs::write(out, self, runs),
            States::Record(record) => record::write(out, self, record),
        }
    }

    fn page(&self) -> Option<Page> {
        let mut page = match &self.states {
            States::Runs(runs) => runs::page(self, runs),
            States::Record(record) => record::page(self, record),
        };
        load_comparison::add_sections(&mut page, self);
        Some(page)
    }

    fn key_numbers(&self) -> Vec<KeyNumber> {
        load_tables::key_numbers(self)
    }

    fn result_table(&self) -> ConsoleTable {
        load_tables::result_table(self)
    }

    fn console(&self) -> Console {
        console::console(self)
    }
}
