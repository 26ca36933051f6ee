//! Content of a terminal, before it is laid out.

use crate::finding::Finding;

/// Content of a terminal before its layout.
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
    /// Names of the columns. Empty for a list of fields and values.
    pub head: Vec<String>,
    /// Cells by row.
    pub rows: Vec<Vec<String>>,
}

impl ConsoleTable {
    /// Creates a table with these columns.
    pub fn new(title: impl Into<String>, head: &[&str], rows: Vec<Vec<String>>) -> Self {
        Self {
            title: title.into(),
            head: head.iter().map(|h| (*h).to_owned()).collect(),
            rows,
        }
    }

    /// Creates a list of fields, each with its value.
    pub fn of_fields(title: impl Into<String>, fields: &[(&str, String)]) -> Self {
        let row = |(name, value): &(&str, String)| vec![(*name).to_owned(), value.clone()];
        Self::new(title, &[], fields.iter().map(row).collect())
    }
}

impl Console {
    /// Creates a terminal with one table. `file` contains all rows of the table.
    pub fn new(table: ConsoleTable, file: Option<&'static str>) -> Self {
        Self {
            tables: vec![table],
            next: None,
            file,
        }
    }

    /// Adds the next step of the user.
    pub fn next(self, step: impl Into<String>) -> Self {
        Self {
            next: Some(step.into()),
            ..self
        }
    }

    /// Adds a shorter table of the same result, which is used if there is not enough room.
    pub fn or(mut self, table: ConsoleTable) -> Self {
        self.tables.push(table);
        self
    }

    /// Changes every text by `change`.
    pub(super) fn map(&self, change: fn(&str) -> String) -> Self {
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
