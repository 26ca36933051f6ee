//! A file that a job names.

/// A file that the job names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NamedFile {
    /// Path as written, relative to the job's folder.
    pub given: String,
    /// Key that names the file, such as `model.deck`.
    pub key: String,
    /// Line of the job.
    pub line: u32,
}

impl NamedFile {
    /// Returns whether the name ends with `.toml`.
    pub fn is_toml(&self) -> bool {
        let ending = self.given.rsplit_once('.');
        ending.is_some_and(|(_, e)| e.eq_ignore_ascii_case("toml"))
    }
}
