//! Severity of a finding and its name.

use serde::{Deserialize, Serialize};

/// Severity of a finding. The worst severity of an answer decides its exit code.
///
/// Severities are ordered: `Info < Warning < Error`.
///
/// # Example
/// ```
/// use strainbridge::Severity;
///
/// let of_findings = [Severity::Info, Severity::Warning, Severity::Info];
/// assert_eq!(of_findings.iter().max(), Some(&Severity::Warning));
/// assert!(Severity::Warning < Severity::Error);
/// assert_eq!(Severity::parse_name("error"), Some(Severity::Error));
/// assert_eq!(Severity::parse_name("fatal"), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Information: the answer is not affected.
    Info,
    /// The answer is usable, but check the cause first.
    Warning,
    /// The answer is unreliable: exit code 1.
    Error,
}

impl Severity {
    /// Returns the name in files and in the reference.
    pub fn name(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }

    /// Parses a name (`info`, `warning`, `error`); `None` for any other text.
    pub fn parse_name(name: &str) -> Option<Self> {
        let all = [Self::Info, Self::Warning, Self::Error];
        all.into_iter().find(|s| s.name() == name)
    }

    /// Returns the name in messages; `Info` is a `note` there.
    pub fn word(self) -> &'static str {
        match self {
            Self::Info => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}
