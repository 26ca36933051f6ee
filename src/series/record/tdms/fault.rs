//! Errors of a TDMS file.

use crate::series::error::SeriesError;

/// Returns the error of a file that can't be read.
pub(super) fn read_error(what: impl std::fmt::Display) -> SeriesError {
    SeriesError::Broken {
        wrong: format!("it cannot be read as TDMS ({what})"),
        remedy: "save it again with its measuring program or export it as CSV",
    }
}
