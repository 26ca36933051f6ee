//! Content in lines that fit a terminal.

use super::content::{Console, Texts};
use super::findings::{self, FindingLines};
use super::table;
use super::wrap::wrap_lines;

/// Room for the lines of a command.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Number of columns.
    pub width: usize,
    /// Number of lines. `None` means no limit.
    pub lines: Option<usize>,
    /// Whether the terminal shows characters beyond ASCII.
    pub is_utf8: bool,
}

/// Lines of a command in the order in which they are printed.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layout {
    /// Table and summary.
    pub answer: Vec<String>,
    /// Findings, the worst last.
    pub findings: Vec<FindingLines>,
    /// Next step.
    pub next: Vec<String>,
    /// Paths.
    pub paths: Vec<String>,
}

/// Lays out the texts of a command.
pub fn lay_out(console: &Console, texts: &Texts, room: &Room) -> Layout {
    let plain: fn(&str) -> String = match room.is_utf8 {
        true => str::to_owned,
        false => ascii,
    };
    let console = console.map(plain);
    let width = room.width;
    let summary = wrap_lines(&plain(texts.summary), width, 0);
    let next = console.next.as_ref();
    let next = next.map_or_else(Vec::new, |n| wrap_lines(&format!("Next: {n}"), width, 6));
    let paths = path_lines(texts.paths, width);
    // The blank line between table and summary counts.
    let fixed = summary.len() + next.len() + paths.len() + 1;
    let least = table::least_lines(&console.tables, width);
    let for_findings = room.lines.map(|l| l.saturating_sub(fixed + least));
    let findings = findings::lines(texts, width, plain, for_findings);
    let used: usize = findings.iter().map(|f| f.lines.len()).sum();
    let for_table = room.lines.map(|l| l.saturating_sub(fixed + used));
    let mut answer = table::lines(&console, width, for_table);
    if !answer.is_empty() && !summary.is_empty() {
        answer.push(String::new());
    }
    answer.extend(summary);
    Layout {
        answer,
        findings,
        next,
        paths,
    }
}

/// Returns a text in ASCII as far as signs of numbers and units go.
pub fn ascii(text: &str) -> String {
    /// Signs and their ASCII replacements.
    const SIGNS: [(&str, &str); 13] = [
        ("±", "+-"),
        ("µ", "u"),
        ("μ", "u"),
        ("ε", "e"),
        ("∞", "inf"),
        ("°", " deg"),
        ("²", "^2"),
        ("³", "^3"),
        ("×", "x"),
        ("·", "*"),
        ("≥", ">="),
        ("−", "-"),
        ("…", "..."),
    ];
    let change = |text: String, sign: &(&str, &str)| text.replace(sign.0, sign.1);
    SIGNS.iter().fold(text.to_owned(), change)
}

/// Paths on one line where they fit, else each on its own.
fn path_lines(paths: &[String], width: usize) -> Vec<String> {
    let together = paths.join("   ");
    match together.chars().count() <= width {
        true if paths.is_empty() => Vec::new(),
        true => vec![together],
        false => paths.iter().flat_map(|p| wrap_lines(p, width, 2)).collect(),
    }
}
