//! A file that a job names.

/// A file that the job names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Path as written, relative to the job's folder.
    pub given: String,
    /// The key that names it, such as `model.deck`.
    pub key: String,
    /// Line of the job.
    pub line: u32,
}
