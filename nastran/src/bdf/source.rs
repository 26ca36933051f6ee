//! The files of a deck, and the places of its sections in them.

use crate::place::Place;

/// A file of a deck.
#[derive(Clone, Debug, PartialEq)]
pub struct Source {
    /// Path by which the loader identifies the file.
    pub path: String,
    /// Bytes of the file, unchanged.
    pub bytes: Vec<u8>,
}

/// A remark that is not a fault.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Note {
    pub at: Place,
    pub text: String,
}

/// A position between bytes of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Position {
    pub source: usize,
    pub offset: usize,
}

/// Boundaries between the sections of the deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub(super) struct SectionBounds {
    /// Start of the line after CEND, or of the deck.
    pub case_start: Option<Position>,
    /// Start of the line `BEGIN BULK`.
    pub bulk_line: Option<Position>,
    /// Start of the line ENDDATA.
    pub enddata: Option<Position>,
    /// Start of the line SOL, and its end.
    pub(super) sol: Option<(Position, usize)>,
}

/// Lines of bulk data that begin with a card and contain no INCLUDE, BEGIN or ENDDATA.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    pub source: u32,
    pub start: usize,
    pub end: usize,
    /// Number of the first line.
    pub line: u32,
}
