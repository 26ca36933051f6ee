//! Columns of a table that nothing reads.

use super::suggest;
use super::table::Table;
use crate::finding::{Finding, Severity, list_few};
use crate::host::files::Inputs;

/// Adds a warning that names the columns of a table which `is_read` does not accept. `lacking` are names of columns that the table could have.
pub fn note_unread(
    inputs: &mut Inputs,
    table: &Table,
    is_read: impl Fn(usize) -> bool,
    lacking: &[&str],
) {
    if let Some(finding) = unread_columns(table, is_read, lacking) {
        inputs.note(&table.file, finding);
    }
}

/// Returns the warning that [`note_unread`] adds; `None` for a table without unread columns.
pub fn unread_columns(
    table: &Table,
    is_read: impl Fn(usize) -> bool,
    lacking: &[&str],
) -> Option<Finding> {
    let columns = table.header.iter().enumerate();
    let unread = columns.filter(|(c, name)| !name.is_empty() && !is_read(*c));
    let unread: Vec<&str> = unread.map(|(_, name)| name.as_str()).collect();
    let renamed = unread.iter().filter_map(|column| {
        let near = suggest::misspelt(column, lacking.iter().copied())?;
        Some(format!("`{column}` to `{near}`"))
    });
    let renamed: Vec<String> = renamed.collect();
    let remedy = match renamed.is_empty() {
        true => "delete these columns, or name them as in the job".to_owned(),
        false => format!("rename {}, or delete the columns", list_few(&renamed)),
    };
    let named: Vec<String> = unread.iter().map(|c| format!("`{c}`")).collect();
    (!named.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "column-not-read",
            &*table.file,
            format!(
                "no command reads these columns of the table, and they change no result: {}",
                list_few(&named)
            ),
            remedy,
        )
        .with_numbers(named.len() as f64, 0.0)
    })
}
