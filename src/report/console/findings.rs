//! Findings of a terminal: of those with one code the first, the worst last, in the lines that are left for them.

use super::content::Texts;
use super::wrap::{cut_to_width, wrap_lines};
use crate::finding::{Finding, Severity};
use crate::host::words::count_of;
use crate::host::words::finding_text;

/// Lines of one finding.
#[derive(Clone, Debug, PartialEq)]
pub struct FindingLines {
    /// Severity of the finding; `None` for a remark.
    pub severity: Option<Severity>,
    /// Lines of the finding. All lines after the first are indented.
    pub lines: Vec<String>,
}

/// Spaces before the later lines of a finding.
const INDENT: usize = 4;

/// Cuts tried in this order until the findings fit: the mildest severity shown, lines for each finding.
const ATTEMPTS: [(Severity, usize); 10] = [
    (Severity::Info, 8),
    (Severity::Info, 4),
    (Severity::Warning, 8),
    (Severity::Warning, 4),
    (Severity::Warning, 3),
    (Severity::Warning, 2),
    (Severity::Warning, 1),
    (Severity::Error, 4),
    (Severity::Error, 2),
    (Severity::Error, 1),
];

/// Returns the lines of all findings and remarks. With a limit, it returns only the findings and remarks that fit.
pub(super) fn lines(
    texts: &Texts,
    width: usize,
    plain: fn(&str) -> String,
    limit: Option<usize>,
) -> Vec<FindingLines> {
    let fold = limit.is_some();
    let mut all: Vec<FindingLines> = texts
        .notes
        .iter()
        .map(|note| FindingLines {
            severity: None,
            lines: wrap_lines(&plain(&format!("note: {note}")), width, INDENT),
        })
        .collect();
    let mut sorted: Vec<&Finding> = texts.findings.iter().collect();
    sorted.sort_by_key(|f| f.severity);
    all.extend(sorted.iter().enumerate().filter_map(|(i, f)| {
        let alike = |g: &&&Finding| (g.severity, g.code) == (f.severity, f.code);
        let is_first = !sorted.iter().take(i).any(|g| alike(&g));
        let more = sorted.iter().skip(i + 1).filter(alike).count();
        let mut text = finding_text(f);
        if fold && more > 0 {
            text.push_str(&format!(" (and {more} more `{}`: -v lists them)", f.code));
        }
        (is_first || !fold).then(|| FindingLines {
            severity: Some(f.severity),
            lines: wrap_lines(&plain(&text), width, INDENT),
        })
    }));
    match limit {
        Some(limit) => limit_lines(all, limit, width),
        None => all,
    }
}

/// Severity by which a remark is left out.
fn severity(f: &FindingLines) -> Severity {
    f.severity.unwrap_or(Severity::Info)
}

/// Leaves out what does not fit, and states how many findings that are.
fn limit_lines(all: Vec<FindingLines>, limit: usize, width: usize) -> Vec<FindingLines> {
    let n_lines = |mildest: Severity, most: usize| -> usize {
        let shown = all.iter().filter(|f| severity(f) >= mildest);
        let left_out = all.iter().any(|f| severity(f) < mildest);
        shown.map(|f| f.lines.len().min(most)).sum::<usize>() + usize::from(left_out)
    };
    let fits = ATTEMPTS.iter().find(|a| n_lines(a.0, a.1) <= limit);
    let (mildest, most) = fits.copied().unwrap_or((Severity::Error, 1));
    let (mut shown, mut left_out): (Vec<_>, Vec<_>) =
        all.into_iter().partition(|f| severity(f) >= mildest);
    if fits.is_none() {
        // Even the errors do not fit: show the last ones, and a line with the number of errors left out.
        let kept = limit.saturating_sub(1).max(1);
        let over = shown.len().saturating_sub(kept);
        left_out.extend(shown.drain(..over));
    }
    for f in &mut shown {
        if f.lines.len() > most {
            f.lines.truncate(most);
            if let Some(last) = f.lines.last_mut() {
                *last = cut_to_width(&format!("{last} ..."), width);
            }
        }
    }
    if !left_out.is_empty() {
        shown.insert(0, left_out_line(&left_out, width));
    }
    shown
}

/// The line that counts the omitted findings.
fn left_out_line(left_out: &[FindingLines], width: usize) -> FindingLines {
    let kinds = [
        (Severity::Info, "note"),
        (Severity::Warning, "warning"),
        (Severity::Error, "error"),
    ];
    let count = |(of, word): (Severity, &str)| {
        let n = left_out.iter().filter(|f| severity(f) == of).count();
        (n > 0).then(|| count_of(n, word))
    };
    let counts: Vec<String> = kinds.into_iter().filter_map(count).collect();
    let text = format!("{} more: -v prints them", counts.join(", "));
    FindingLines {
        severity: None,
        lines: vec![cut_to_width(&text, width)],
    }
}
