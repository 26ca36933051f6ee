//! Errors of a universal file.

use crate::series::error::SeriesError;

/// Returns the error of a file that can't be read.
pub(super) fn read_error(what: impl std::fmt::Display) -> SeriesError {
    SeriesError::Broken {
        wrong: format!("it cannot be read as a universal file ({what})"),
        remedy: "export time histories as data sets 58 or 58b on even steps",
    }
}
