//! Errors of an OP2 file.

use crate::results::{Damage, ElementType};

/// Why an OP2, or a block of it, could not be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)] // the messages describe the values
pub enum Op2Error {
    /// The first record is not a key of one word.
    #[error(
        "not an OP2: the file begins with the bytes {first:02x?}, expected a record of 4 or 8 bytes; give the binary file that PARAM,POST writes"
    )]
    NotOp2 { first: Vec<u8> },

    /// No table could be read.
    #[error(
        "damaged OP2: no table could be read, {what} at byte {offset}; export the results again"
    )]
    NoTable { offset: usize, what: String },

    /// The file is cut short or contradicts itself.
    #[error("damaged OP2, cut short perhaps: {0}; write or copy the file again")]
    Damaged(Damage),

    /// The caller asked for a block that does not exist.
    #[error("block {block} does not exist: the file has {count}")]
    NoBlock { block: usize, count: usize },

    /// The block is listed, but its rows are not decoded.
    #[error("table {table}, record {record} at byte {offset}: {why}")]
    Unsupported {
        table: String,
        record: usize,
        offset: usize,
        why: UnsupportedRows,
    },

    /// A row holds an id that no entity can have.
    #[error(
        "table {table}, record {record} at byte {offset}: row {row} has the id word {found}; the record is damaged, export the results again"
    )]
    BadId {
        table: String,
        record: usize,
        offset: usize,
        row: usize,
        found: i64,
    },
}

impl Op2Error {
    /// Returns whether the file contradicts itself, and is not only of a kind that is not read.
    pub(crate) fn is_damage(&self) -> bool {
        matches!(
            self,
            Self::NoTable { .. } | Self::Damaged(_) | Self::BadId { .. }
        )
    }
}

/// Why the rows of a block are not decoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[allow(missing_docs)]
pub enum UnsupportedRows {
    #[error("complex results are not decoded; ask for a static or modal run")]
    Complex,
    #[error("SORT2 results are not decoded; ask the solver for SORT1")]
    Sort2,
    #[error("random results are not decoded")]
    Random,
    #[error("the quantity (table code {table_code}) is not decoded")]
    Quantity { table_code: i32 },
    #[error("rows of element type {} ({}) with {num_wide} words are not decoded", .element.0, .element.name().unwrap_or("unknown"))]
    Layout { element: ElementType, num_wide: u32 },
    #[error("nodal rows with {num_wide} words are not decoded, expected 8")]
    Nodal { num_wide: u32 },
}
