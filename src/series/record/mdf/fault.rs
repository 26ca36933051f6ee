//! Errors of an MDF4 file.

use crate::series::error::SeriesError;

/// Returns the error of a file that can't be read.
pub(super) fn read_error(what: impl std::fmt::Display) -> SeriesError {
    SeriesError::Broken {
        wrong: format!("it cannot be read as MDF4 ({what})"),
        remedy: "save it as MDF 4.1 with its measuring program or asammdf",
    }
}
