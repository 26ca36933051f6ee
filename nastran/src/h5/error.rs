//! Errors of an HDF5 result file.

use crate::results::Damage;

/// Why an HDF5 file, or a block of one, could not be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum H5Error {
    /// The container is damaged or uses a feature that is not read.
    #[error("`{path}`: {reason}: the file is cut or damaged, write it again (MDLPRM,HDF5)")]
    Container {
        /// Path in the file.
        path: String,
        /// Message of the HDF5 layer.
        reason: String,
    },
    /// The file is cut short, or a table of it is damaged.
    #[error("damaged HDF5 file, cut short perhaps: {0}; write or copy the file again")]
    Damaged(Damage),
    /// The file is HDF5, but without `/NASTRAN/RESULT`.
    #[error(
        "no group `/NASTRAN/RESULT`: this is not a Nastran result file, or it contains input only"
    )]
    NoResults,
    /// A table without a required field.
    #[error("`{path}`: field `{field}` is missing or not a number: schema not supported")]
    MissingField {
        /// The table.
        path: String,
        /// The field.
        field: &'static str,
    },
    /// A table states more data than the file can contain.
    #[error("`{path}`: {claimed} bytes claimed, at most {possible} possible: the file is damaged")]
    TooLarge {
        /// The table.
        path: String,
        /// Number of records times record size.
        claimed: u64,
        /// Largest size that fits the size of the file.
        possible: u64,
    },
    /// The block index is out of range.
    #[error("block {index} does not exist: the file has {blocks}")]
    NoSuchBlock {
        /// Requested index.
        index: usize,
        /// Number of blocks in the file.
        blocks: usize,
    },
    /// A table of a kind that is not decoded.
    #[error("`{path}` is not decoded: no layout is known for it")]
    NotDecoded {
        /// The table.
        path: String,
    },
}

impl H5Error {
    /// Returns whether the file contradicts itself, and is not only of a kind that is not read.
    pub(crate) fn is_damage(&self) -> bool {
        matches!(
            self,
            Self::Container { .. } | Self::TooLarge { .. } | Self::Damaged(_)
        )
    }
}
