//! Names of loads.

/// Returns a name without characters that need quotation in a job or a table.
pub(super) fn plain_name(name: &str) -> String {
    name.trim()
        .chars()
        .map(|c| match c {
            '"' | '\\' | ',' => '_',
            c if c.is_control() => '_',
            c => c,
        })
        .collect()
}
