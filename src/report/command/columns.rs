//! Units of the columns of a table, stated by its header.

use crate::host::fault::Fault;
use crate::host::output::Output;

/// States the units of a written table, column by column. An empty unit stands for a name or a plain number.
///
/// # Errors
/// A fault if the written table cannot be read back.
pub(super) fn declare_written(
    out: &mut Output,
    table: &str,
    unit: impl Fn(&str) -> String,
) -> Result<(), Fault> {
    let bytes = out.read_back(table)?;
    let header = bytes.split(|b| *b == b'\n').next().unwrap_or_default();
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_reader(header);
    let record = reader
        .records()
        .next()
        .and_then(Result::ok)
        .unwrap_or_default();
    let columns: Vec<(String, String)> = record.iter().map(|c| (c.to_owned(), unit(c))).collect();
    drop(bytes);
    out.declare(table, columns);
    Ok(())
}
