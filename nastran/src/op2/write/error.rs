//! Errors of writing an OP2.

use crate::results::{ElementType, Quantity};

/// Reason why an OP2 could not be written.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)] // the messages describe the values
pub enum WriteError {
    #[error(transparent)]
    Io(#[from] std::io::Error),

    #[error("{} rows of {} can't be written to an OP2; leave this block out", .quantity.word(), .element.map_or_else(|| "grids".to_owned(), |e| e.name().map_or_else(|| format!("element type {}", e.0), str::to_owned)))]
    Unsupported {
        quantity: Quantity,
        element: Option<ElementType>,
    },

    #[error("{} rows of entity {entity}: {found} rows, expected {expected}", .quantity.word())]
    Rows {
        quantity: Quantity,
        entity: u32,
        found: usize,
        expected: usize,
    },

    #[error("id {0} is too large for an OP2: ten times the id must fit 31 bits")]
    Id(u32),

    #[error("the rows have {found} columns, the layout {expected}")]
    Columns { found: usize, expected: usize },
}
