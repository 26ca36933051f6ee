//! `[[section]]`.

use super::named_file::NamedFile;

/// `[[section]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordSection {
    /// Name.
    pub name: String,
    /// Samples of the section.
    pub extent: SectionExtent,
    /// How often the section occurs in the duty cycle.
    pub repeats: f64,
    /// Line of the job.
    pub line: u32,
}

/// Samples of a section.
#[derive(Clone, Debug, PartialEq)]
pub enum SectionExtent {
    /// Samples of the strain record from one time until before another, s.
    Times([f64; 2]),
    /// A separate strain record.
    File(NamedFile),
}
