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
    /// All stretches of the strain record in which channels are within ranges.
    Within(SectionRule),
}

/// Rule of a section: every channel is within its range.
#[derive(Clone, Debug, PartialEq)]
pub struct SectionRule {
    /// Channel of the strain record with its range, both ends included, unit of the record; an infinite end is no limit.
    pub ranges: Vec<(String, [f64; 2])>,
    /// Shortest stretch that counts, s.
    pub at_least_s: f64,
}
