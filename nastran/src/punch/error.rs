//! Errors of a punch file.

use crate::results::Damage;

/// Why a punch file, or a block of one, could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PunchError {
    /// The text has no `$` header that names a result.
    #[error(
        "no result block found: a punch file has headers such as `$DISPLACEMENTS` or `$ELEMENT STRAINS`; request output with (PUNCH)"
    )]
    NoBlocks,
    /// The text ends within an entry.
    #[error("damaged punch file, cut short perhaps: {0}; write or copy the file again")]
    Damaged(Damage),
    /// The block index is out of range.
    #[error("block {index} does not exist: the file has {blocks}")]
    NoSuchBlock {
        /// Requested index.
        index: usize,
        /// Number of blocks in the file.
        blocks: usize,
    },
    /// The block is complex, SORT2 or of a type that is not decoded.
    #[error("block `{block}` is not decoded: {why}")]
    NotDecoded {
        /// Table and element type.
        block: String,
        /// The reason.
        why: String,
    },
    /// A field contradicts its layout.
    #[error(
        "line {line}: `{text}`: expected {expected}: write the file again, it is damaged or edited"
    )]
    BadField {
        /// Line, from 1.
        line: u32,
        /// Text of the field.
        text: String,
        /// Description of a valid field.
        expected: &'static str,
    },
    /// The number of values of an entry differs from the number that its element type has.
    #[error(
        "line {line}: {found} words in the entry, expected {expected}: the file is cut or damaged"
    )]
    WordCount {
        /// First line of the entry, from 1.
        line: u32,
        /// Number of values found.
        found: usize,
        /// Number of values of the element type.
        expected: usize,
    },
}

impl PunchError {
    /// Returns whether the text contradicts its layout, and is not only of a kind that is not decoded.
    pub(crate) fn is_damage(&self) -> bool {
        matches!(
            self,
            Self::BadField { .. } | Self::WordCount { .. } | Self::Damaged(_)
        )
    }
}
