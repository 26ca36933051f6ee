//! Columns of a table that nothing reads.

use super::suggest;
use crate::finding::{Finding, Severity};

/// Columns that a message names at most: a table of runs has fewer, and a record has thousands.
const NAMED: usize = 20;

/// Columns of a table that nothing reads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unread {
    columns: Vec<String>,
    remedy: String,
}

impl Unread {
    /// Returns the columns `headers`, which nothing reads; `known` are names that the table could hold and does not. `None` without any.
    pub fn of(headers: &[&str], known: &[&str]) -> Option<Self> {
        let headers = headers.iter().filter(|h| !h.is_empty());
        let columns: Vec<String> = headers.map(|h| (*h).to_owned()).collect();
        let meant = |column: &String| {
            let near = suggest::closest(column, known.iter().copied());
            near.map(|name| format!("`{column}` to `{name}`"))
        };
        let renamed: Vec<String> = columns.iter().filter_map(meant).take(NAMED).collect();
        let remedy = match renamed.is_empty() {
            true => "drop these columns, or name them as the job does".to_owned(),
            false => format!("rename {}, or drop the columns", renamed.join(", ")),
        };
        (!columns.is_empty()).then_some(Self { columns, remedy })
    }

    /// Returns the warning that names the columns of `file`.
    pub fn finding(&self, file: &str) -> Finding {
        let named: Vec<String> = self.columns.iter().map(|c| format!("`{c}`")).collect();
        let more = match named.len().saturating_sub(NAMED) {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let list = named.iter().take(NAMED).cloned().collect::<Vec<_>>();
        Finding::new(
            Severity::Warning,
            "column-not-read",
            file,
            format!(
                "no command reads these columns of the table, and they change no result: {}{more}",
                list.join(", ")
            ),
            &self.remedy,
        )
        .with_numbers(named.len() as f64, 0.0)
    }
}
