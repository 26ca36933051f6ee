//! Names of users in tables.

use std::borrow::Cow;

/// The text as a cell of a CSV table: in quotes where it holds a comma, a quote or a line break (RFC 4180).
pub fn csv_cell(text: &str) -> Cow<'_, str> {
    if text.contains([',', ';', '"', '\n', '\r', '\t']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_would_break_a_row_is_quoted_and_reads_back() {
        for name in ["Run 1", "Run 1, loaded", "a \"b\"", "one\ntwo", "x;y"] {
            let text = format!("run,value\n{},1\n", csv_cell(name));
            let mut reader = csv::Reader::from_reader(text.as_bytes());
            let row = reader.records().next().unwrap().unwrap();
            assert_eq!((&row[0], &row[1]), (name, "1"));
        }
    }
}
