//! A file that was read.

use std::path::PathBuf;

/// A file that was read, with where it was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRead {
    /// Path as given, by the user or by the job.
    pub given: String,
    /// Path it was read from.
    pub path: PathBuf,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Whether it is a table whose last line may be cut.
    pub unsure: bool,
}
