//! Names of users in tables.

use crate::series::cell::guard_formula;
use std::borrow::Cow;

/// Returns the text as a cell of a CSV table. Text with a comma, a quote or a line break is quoted (RFC 4180).
///
/// Text that a spreadsheet would read as a formula begins with an apostrophe.
///
/// # Example
/// ```
/// use strainbridge::report::csv_cell;
///
/// assert_eq!(csv_cell("left wheel"), "left wheel");
/// assert_eq!(csv_cell("left, rear"), "\"left, rear\"");
/// assert_eq!(csv_cell("the \"old\" rail"), "\"the \"\"old\"\" rail\"");
/// assert_eq!(csv_cell("=1+1"), "'=1+1");
/// ```
pub fn csv_cell(text: &str) -> Cow<'_, str> {
    let text = guard_formula(text);
    if text.contains([',', ';', '"', '\n', '\r', '\t']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::series::cell::remove_guard;

    #[test]
    fn what_would_break_a_row_is_quoted_and_reads_back() {
        for name in [
            "Run 1",
            "Run 1, loaded",
            "a \"b\"",
            "one\ntwo",
            "x;y",
            "=1+1",
            "@x, y",
        ] {
            let text = format!("run,value\n{},1\n", csv_cell(name));
            let mut reader = csv::Reader::from_reader(text.as_bytes());
            let row = reader.records().next().unwrap().unwrap();
            assert_eq!((remove_guard(&row[0]), &row[1]), (name, "1"));
        }
    }

    #[test]
    fn no_cell_begins_as_a_formula_does() {
        for name in ["=cmd|' /C calc'!A0", "+x", "-x", "@x", "=a,\"b\""] {
            let cell = csv_cell(name);
            assert!(cell.trim_start_matches('"').starts_with('\''), "{cell}");
        }
    }
}
