//! Findings of a stage about its own result.

pub mod explain;
mod name_shortening;
mod sentence;
mod severity;

pub use name_shortening::shorten_names;
pub use sentence::capitalize;
use serde::{Deserialize, Deserializer, Serialize};
pub use severity::Severity;
use std::fmt::Display;

/// Name of a finding's code.
pub type CodeName = &'static str;

/// A measured fact about a result, its limit, and the remedy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    /// Severity of the finding.
    pub severity: Severity,
    /// Stable code, such as `loads-not-separable`; [`explain`] has an entry for each.
    #[serde(deserialize_with = "read_code")]
    pub code: CodeName,
    /// Subject: a gauge, a load, a file, an element.
    pub subject: String,
    /// Sentences with the consequence.
    pub message: String,
    /// Measured number, if the finding has one.
    pub measured: Option<f64>,
    /// Limit that the measured number is compared with.
    pub limit: Option<f64>,
    /// Chance that correct data give a number of this size, if this chance decided the finding.
    #[serde(skip)]
    pub chance: Option<f64>,
    /// Remedy, as an imperative.
    pub remedy: String,
}

/// Reads a code that [`explain`] has an entry for.
fn read_code<'de, D: Deserializer<'de>>(from: D) -> Result<CodeName, D::Error> {
    let name = String::deserialize(from)?;
    let known = explain::code(&name).map(|c| c.code);
    known.ok_or_else(|| serde::de::Error::custom(format!("`{name}` is not a code of a finding")))
}

impl Finding {
    /// Creates a finding without numbers. Message and remedy become sentences with a capital letter and a full stop, and long names in them are
    /// shortened ([`shorten_names`]).
    pub fn new(
        severity: Severity,
        code: &'static str,
        subject: impl Into<String>,
        message: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let subject = shorten_names(subject);
        Self {
            severity,
            code,
            message: sentence::sentence(&shorten_names(message), &subject),
            measured: None,
            limit: None,
            chance: None,
            remedy: sentence::sentence(&shorten_names(remedy), ""),
            subject,
        }
    }

    /// Returns the message without its full stop, for a text that continues it.
    pub fn clause(&self) -> &str {
        self.message.trim_end_matches('.')
    }

    /// Adds the probability that correct data produce a finding as large as this one.
    pub fn with_chance(mut self, chance: f64) -> Self {
        self.chance = Some(chance);
        self
    }

    /// Adds the measured number and its limit.
    pub fn with_numbers(mut self, measured: f64, limit: f64) -> Self {
        self.measured = Some(measured);
        self.limit = Some(limit);
        self
    }
}

impl Finding {
    /// Returns the measured number and its limit as shown to people. `None` for a limit of 0, because the number then counts the items that the
    /// message names.
    pub fn shown_numbers(&self) -> Option<(f64, Option<f64>)> {
        let measured = self.measured.filter(|_| self.limit != Some(0.0))?;
        Some((measured, self.limit))
    }
}

/// Number of names that a finding lists. A reader looks up only a few, and a record may have thousands.
pub const LISTED: usize = 8;

/// Returns the first names or ids of a list and the number of the others: `P01, P02 and 5 more`, or `none`.
pub fn list_few(names: &[impl Display]) -> String {
    few_of(names, names.len())
}

/// Returns the first names of a list with `count` entries in total. `names` contains at least these first entries.
pub fn few_of(names: &[impl Display], count: usize) -> String {
    let shown: Vec<String> = names.iter().take(LISTED).map(|n| n.to_string()).collect();
    match count.saturating_sub(shown.len()) {
        0 if shown.is_empty() => "none".to_owned(),
        0 => shown.join(", "),
        more => format!("{} and {more} more", shown.join(", ")),
    }
}

/// Returns the worst severity of a list.
pub fn worst_severity(findings: &[Finding]) -> Option<Severity> {
    findings.iter().map(|f| f.severity).max()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_of_many_names_a_few_and_how_many_more() {
        assert_eq!(list_few(&["A", "B"]), "A, B");
        let times: Vec<String> = (0..1600).map(|i| format!("t = {i}")).collect();
        let text = list_few(&times);
        assert!(text.starts_with("t = 0, t = 1, "), "{text}");
        assert!(text.ends_with(" and 1592 more"), "{text}");
        assert_eq!(list_few(&[11, 12]), "11, 12");
        assert_eq!(few_of(&["A", "B"], 5), "A, B and 3 more");
    }

    #[test]
    fn a_finding_is_read_as_it_was_written_and_an_unknown_code_is_refused() {
        let written = Finding::new(Severity::Warning, "gauge-silent", "G1", "message", "remedy")
            .with_numbers(0.1, f64::INFINITY)
            .with_chance(1e-7);
        let text = serde_json::to_string(&written).unwrap();
        let expected = Finding {
            // JSON has no infinite numbers, and results do not contain the chance.
            limit: None,
            chance: None,
            ..written
        };
        assert_eq!(serde_json::from_str::<Finding>(&text).unwrap(), expected);
        let other = text.replace("gauge-silent", "gauge-of-no-entry");
        assert!(serde_json::from_str::<Finding>(&other).is_err());
    }
}
