//! Kind of a file: by its content, and by its name only if the content does not determine it.

use crate::host::sheet::is_sheet;
use crate::host::what_is::{binary_kind, is_deck};
use crate::series::record::csv::Layout;
use crate::series::record::is_format;
use crate::strain_chain::deck::looks_like_op2;

/// A kind of file that `check` reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Job,
    Deck,
    Results,
    /// A record, or a table of text.
    Table,
    /// Anything else that is no text.
    Other(&'static str),
}

pub(super) fn kind_of(name: &str, bytes: &[u8]) -> Kind {
    let name = name.to_ascii_lowercase();
    let ends = |list: &[&str]| list.iter().any(|e| name.ends_with(e));
    if is_format(bytes) {
        return Kind::Table;
    }
    let head = bytes.trim_ascii_start();
    let punch = head
        .get(..6)
        .is_some_and(|h| h.eq_ignore_ascii_case(b"$TITLE"));
    if looks_like_op2(bytes) || nastran::h5::is_h5(bytes) || punch || ends(&[".op2", ".h5", ".pch"])
    {
        return Kind::Results;
    }
    if is_sheet(bytes) && ends(&[".xlsx", ".xlsm"]) {
        return Kind::Table;
    }
    if let Some(kind) = binary_kind(bytes) {
        // A text table with two bytes for each character (UTF-16) looks like a binary file.
        return match ends(TABLES) {
            true => Kind::Table,
            false => Kind::Other(kind),
        };
    }
    if ends(&[".toml"]) {
        return Kind::Job;
    }
    let is_record = || Layout::detect(bytes).is_ok_and(|layout| layout.is_record());
    let is_table = ends(TABLES) || ends(&[".txt", ".asc"]) && is_record();
    match is_table && !is_deck(bytes) {
        true => Kind::Table,
        false => Kind::Deck,
    }
}

/// Ends of the names of tables of text.
const TABLES: &[&str] = &[".csv", ".tsv"];
