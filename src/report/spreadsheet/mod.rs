//! Spreadsheets (XLSX): the tables of a command, and units and findings on sheets of their own.

mod book;
mod gauges;
mod loads;

pub use book::{Cell, Sheet, UnitOf, WorkbookDescription, spreadsheet};
pub use gauges::gauge_sheets;
pub use loads::{HistoryLoad, history_sheet, residual_sheet, runs_sheet};

#[cfg(test)]
mod tests;
