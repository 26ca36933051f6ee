//! Lines of a terminal for an outcome: one table of the result, the summary, findings with the worst last, the next command, paths of files.
//!
//! The lines fit a terminal: no line is wider, and there are at most [`LINES`] of them unless all are asked for. `cli` prints them.

mod findings;
mod table;
mod wrap;

pub use findings::FindingLines;
pub use wrap::wrapped;

use crate::finding::Finding;

/// Lines of a command, the table and the findings included: a terminal shows them without scrolling.
pub const LINES: usize = 25;
/// Columns where standard output is not a terminal.
pub const WIDTH: usize = 100;

/// Content of a terminal, before it is laid out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Console {
    /// Tables of the same result, the most detailed first. The first one that fits is shown.
    pub tables: Vec<ConsoleTable>,
    /// Next step of the user.
    pub next: Option<String>,
    /// File of the output folder with all rows.
    pub file: Option<&'static str>,
}

/// Table of a terminal.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ConsoleTable {
    /// Line over the table: quantity, units, meaning of `±`.
    pub title: String,
    /// Names of the columns; empty for a list of fields and values.
    pub head: Vec<String>,
    /// Cells by row.
    pub rows: Vec<Vec<String>>,
}

impl ConsoleTable {
    /// A table with these columns.
    pub fn new(title: impl Into<String>, head: &[&str], rows: Vec<Vec<String>>) -> Self {
        Self {
            title: title.into(),
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows,
        }
    }

    /// A list of fields, each with its value.
    pub fn of_fields(title: impl Into<String>, fields: &[(&str, String)]) -> Self {
        let row = |(name, value): &(&str, String)| vec![(*name).to_owned(), value.clone()];
        Self::new(title, &[], fields.iter().map(row).collect())
    }
}

impl Console {
    /// A terminal with one table, whose rows are all in `file`.
    pub fn new(table: ConsoleTable, file: Option<&'static str>) -> Self {
        Self {
            tables: vec![table],
            next: None,
            file,
        }
    }

    /// The same with the next step of the user.
    pub fn next(self, step: impl Into<String>) -> Self {
        Self {
            next: Some(step.into()),
            ..self
        }
    }

    /// The same with a shorter table of the same result.
    pub fn or(mut self, table: ConsoleTable) -> Self {
        self.tables.push(table);
        self
    }

    /// The same with every text changed by `change`.
    fn map(&self, change: fn(&str) -> String) -> Self {
        let all = |list: &[String]| list.iter().map(|t| change(t)).collect();
        let table = |t: &ConsoleTable| ConsoleTable {
            title: change(&t.title),
            head: all(&t.head),
            rows: t.rows.iter().map(|r| all(r)).collect(),
        };
        Self {
            tables: self.tables.iter().map(table).collect(),
            next: self.next.as_deref().map(change),
            file: self.file,
        }
    }
}

/// Texts of a run in addition to its table.
#[derive(Clone, Copy, Debug, Default)]
pub struct Texts<'a> {
    /// Sentence that states the result.
    pub summary: &'a str,
    /// Findings in any order.
    pub findings: &'a [Finding],
    /// Remarks on the run.
    pub notes: &'a [String],
    /// Paths of the report and of the main table.
    pub paths: &'a [String],
}

/// Room for the lines of a command.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// Columns.
    pub width: usize,
    /// Lines; `None`: as many as there are.
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
    let summary = wrapped(&plain(texts.summary), width, 0);
    let next = console.next.as_ref();
    let next = next.map_or_else(Vec::new, |n| wrapped(&format!("Next: {n}"), width, 6));
    let paths = path_lines(texts.paths, width);
    // The blank line between table and summary counts.
    let fixed = summary.len() + next.len() + paths.len() + 1;
    let least = table::least_lines(&console.tables, width);
    let for_findings = room.lines.map(|l| l.saturating_sub(fixed + least));
    let findings = findings::lines(texts, width, plain, for_findings);
    let used: usize = findings.iter().map(|f| f.lines.len()).sum();
    let for_table = room.lines.map(|l| l.saturating_sub(fixed + used));
    let mut answer = table::lines(&console, width, for_table);
    if !answer.is_empty() {
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
    /// Signs and what stands for them.
    const SIGNS: [(&str, &str); 9] = [
        ("±", "+-"),
        ("µ", "u"),
        ("μ", "u"),
        ("∞", "inf"),
        ("°", " deg"),
        ("²", "^2"),
        ("³", "^3"),
        ("×", "x"),
        ("·", "*"),
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
        false => paths.iter().flat_map(|p| wrapped(p, width, 2)).collect(),
    }
}

#[cfg(test)]
mod tests;
