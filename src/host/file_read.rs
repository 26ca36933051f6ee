//! A file that was read.

use crate::finding::{Finding, Severity};
use std::path::PathBuf;

/// A file that the command read, with its location.
#[derive(Clone, Debug, PartialEq)]
pub struct FileRead {
    /// Path as given, by the user or by the job.
    pub given: String,
    /// Path from which the file was read.
    pub path: PathBuf,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Severity of a last line that may be cut off in a table. `None` if the end of the table is complete.
    pub unsure: Option<Severity>,
    /// Other findings on the table.
    pub noted: Vec<Finding>,
}
