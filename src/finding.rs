//! What a stage has to say about its own result.

mod bounded;
pub mod explain;

pub use bounded::bounded;
use serde::Serialize;

/// How much a finding matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing.
    Info,
    /// Look before you trust.
    Warning,
    /// The answer can't be relied on: exit code 1.
    Error,
}

/// A measured fact about a result, its limit, and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// How much it matters.
    pub severity: Severity,
    /// Stable code, such as `loads-not-separable`; [`explain`] has an entry for each.
    pub code: &'static str,
    /// What it is about: a gauge, a load, a file, an element.
    pub subject: String,
    /// A plain sentence with the consequence.
    pub message: String,
    /// The measured number, where there is one.
    pub measured: Option<f64>,
    /// The limit it is held against.
    pub limit: Option<f64>,
    /// Chance that right data make as much of it, where that decided.
    #[serde(skip)]
    pub chance: Option<f64>,
    /// What the reader can do.
    pub remedy: String,
}

impl Severity {
    /// Its name in files and in the reference.
    pub fn name(self) -> &'static str {
        match self {
            Self::Info => "info",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }

    /// That of a name in files; `None` where none is called so.
    pub fn named(name: &str) -> Option<Self> {
        let all = [Self::Info, Self::Warning, Self::Error];
        all.into_iter().find(|s| s.name() == name)
    }

    /// The word of it in messages.
    pub fn word(self) -> &'static str {
        match self {
            Self::Info => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

impl Finding {
    /// A finding without numbers, its words [`bounded`].
    pub fn new(
        severity: Severity,
        code: &'static str,
        subject: impl Into<String>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            severity,
            code,
            subject: bounded(subject),
            message: bounded(message),
            measured: None,
            limit: None,
            chance: None,
            remedy: bounded(remedy),
        }
    }

    /// The same with the chance that right data make as much of it.
    pub fn with_chance(mut self, chance: f64) -> Self {
        self.chance = Some(chance);
        self
    }

    /// The same with the measured number and its limit.
    pub fn with_numbers(mut self, measured: f64, limit: f64) -> Self {
        self.measured = Some(measured);
        self.limit = Some(limit);
        self
    }
}

/// Names that a finding lists: a reader looks up a few of them, and a record has thousands of times.
const LISTED: usize = 8;

/// The names, the first few of many and how many more there are.
pub fn few(names: &[impl AsRef<str>]) -> String {
    let shown: Vec<&str> = names.iter().take(LISTED).map(AsRef::as_ref).collect();
    match names.len().saturating_sub(LISTED) {
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// The worst severity of a list.
pub fn worst(findings: &[Finding]) -> Option<Severity> {
    findings.iter().map(|f| f.severity).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_of_many_names_a_few_and_how_many_more() {
        assert_eq!(few(&["A", "B"]), "A, B");
        let times: Vec<String> = (0..1600).map(|i| format!("t = {i}")).collect();
        let text = few(&times);
        assert!(text.starts_with("t = 0, t = 1, "), "{text}");
        assert!(text.ends_with(" and 1592 more"), "{text}");
    }
}
