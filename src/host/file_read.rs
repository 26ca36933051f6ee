//! A file that was read.

use crate::finding::{Finding, Severity};
use std::path::PathBuf;

/// A file that was read, with its location.
#[derive(Clone, Debug, PartialEq)]
pub struct FileRead {
    /// Path as given, by the user or by the job.
    pub given: String,
    /// Path it was read from.
    pub path: PathBuf,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// How much a table whose last line may be cut matters; `None`: its end is sound.
    pub unsure: Option<Severity>,
    /// Findings on a table, other than on its end.
    pub noted: Vec<Finding>,
}
