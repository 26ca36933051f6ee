//! Findings of a page, grouped by code. The first finding of a group is open, further findings are folded.

use crate::finding::explain::{Code, codes};
use crate::finding::{Finding, Severity};
use crate::host::words::{capitalize, numbers_in_words};
use maud::{Markup, html};

/// Findings by severity.
pub(super) struct FindingsBySeverity<'a> {
    /// Errors.
    pub errors: Vec<&'a Finding>,
    /// Warnings.
    pub warnings: Vec<&'a Finding>,
    /// Notes.
    pub notes: Vec<&'a Finding>,
}

impl<'a> FindingsBySeverity<'a> {
    /// Sorts findings by severity. Findings of one severity keep their order.
    pub(super) fn from_findings(findings: &'a [Finding]) -> Self {
        let of = |severity| findings.iter().filter(|f| f.severity == severity).collect();
        Self {
            errors: of(Severity::Error),
            warnings: of(Severity::Warning),
            notes: of(Severity::Info),
        }
    }
}

/// Whether the answer can be relied on, and why: for a notebook.
pub(in crate::report) fn reliability(findings: &[&Finding]) -> Markup {
    let is_note = |g: &Vec<&Finding>| g.iter().all(|f| f.severity == Severity::Info);
    let (notes, serious): (Vec<_>, Vec<_>) = groups_of(findings).into_iter().partition(is_note);
    html! {
        @if findings.is_empty() { p { "No findings." } }
        @for g in &serious { (group(g)) }
        @if !notes.is_empty() {
            details { summary { "Notes" } @for g in &notes { (group(g)) } }
        }
    }
}

/// Returns the findings by severity and code.
pub(super) fn groups_of<'a>(findings: &[&'a Finding]) -> Vec<Vec<&'a Finding>> {
    let mut groups: Vec<Vec<&Finding>> = Vec::new();
    for &f in findings {
        let alike = |g: &&mut Vec<&Finding>| {
            g.iter()
                .any(|o| (o.severity, o.code) == (f.severity, f.code))
        };
        match groups.iter_mut().find(alike) {
            Some(group) => group.push(f),
            None => groups.push(vec![f]),
        }
    }
    groups
}

/// Returns the findings of one code.
pub(super) fn group(findings: &[&Finding]) -> Markup {
    let more = findings.len().saturating_sub(1);
    html! {
        @for f in findings.iter().take(1) { (finding(f)) }
        @if more > 0 {
            details { summary { (more) " more like it" } @for f in findings.iter().skip(1) { (finding(f)) } }
        }
    }
}

fn finding(f: &Finding) -> Markup {
    let class = match f.severity {
        Severity::Error => "f error",
        Severity::Warning => "f warning",
        Severity::Info => "f info",
    };
    html! {
        div class=(class) {
            b { (f.severity.word()) } " · " (subjects(&f.subject)) ": " (f.message)
            @if let Some(words) = numbers_in_words(f) { small { " " (capitalize(&words)) "." } }
            @if !f.remedy.is_empty() { div { small { "What to do: " (f.remedy) } } }
        }
    }
}

/// Names in the subject of a finding. `start.js` highlights the gauge names in the pictures of the page.
fn subjects(subject: &str) -> Markup {
    html! {
        @for (i, name) in subject.split(", ").enumerate() {
            @if i > 0 { ", " }
            span data-subject { (name) }
        }
    }
}

/// Returns the conditions that a command tests and that are not among the findings.
pub(super) fn passed_conditions(command: &str, findings: &[Finding]) -> Vec<&'static Code> {
    let tests = |c: &&Code| {
        let serious = c.severity.iter().any(|s| *s != Severity::Info);
        serious && c.said_by.split(", ").any(|by| by == command)
    };
    let found = |c: &&Code| findings.iter().any(|f| f.code == c.code);
    let all = codes().iter().filter(tests);
    all.filter(|c| !found(c)).collect()
}
