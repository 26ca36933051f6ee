//! Decks and results given instead of a job: one fault for the file instead of a fault for every line.

use crate::host::fault::Fault;
use std::path::Path;

/// Lines in which a deck shows itself.
const LINES_LOOKED_AT: usize = 5000;

/// Refuses result files by the end of their name.
///
/// # Errors
/// A fault that names `init`.
pub(super) fn check_name(given: &str) -> Result<(), Fault> {
    let end = Path::new(given).extension().map(|e| e.to_ascii_lowercase());
    let results = ["op2", "h5", "pch"];
    match end.as_ref().and_then(|e| e.to_str()) {
        Some(e) if results.contains(&e) => {
            Err(not_a_job_fault(given, "these are results", "DECK "))
        }
        _ => Ok(()),
    }
}

/// Refuses decks by their contents.
///
/// # Errors
/// A fault that names `init`.
pub(super) fn check_text(given: &str, text: &str) -> Result<(), Fault> {
    let is_card = |line: &str| {
        let line = line.trim_start().to_ascii_uppercase();
        let name: String = line
            .chars()
            .take_while(char::is_ascii_alphanumeric)
            .collect();
        let after = line.get(name.len()..).unwrap_or_default();
        let field =
            after.starts_with([',', '*']) || after.starts_with("  ") && !after.contains('=');
        line.starts_with("BEGIN BULK")
            || field && ["GRID", "CQUAD4", "CTRIA3", "CHEXA", "CBAR"].contains(&name.as_str())
    };
    if text.lines().take(LINES_LOOKED_AT).any(is_card) {
        return Err(not_a_job_fault(given, "this is a deck", ""));
    }
    Ok(())
}

fn not_a_job_fault(given: &str, what: &str, before: &str) -> Fault {
    Fault::new(
        given,
        "job",
        format!("{what}, not a job"),
        format!("`strainbridge init {before}{given}` writes a job from it"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decks_are_distinguished_from_jobs() {
        for deck in [
            "SOL 101\nCEND\nbegin bulk\n",
            "GRID,1,,0.,0.,0.\n",
            "$ a\nGRID    1               0.      0.      0.\n",
        ] {
            let fault = check_text("a.bdf", deck).unwrap_err();
            assert!(fault.wrong.contains("deck") && fault.remedy.contains("init a.bdf"));
        }
        assert!(check_text("a.toml", "units = \"m-kg-s\"\ngrid = 1\nGRID  = 3\n").is_ok());
        assert!(check_name("a.op2").is_err() && check_name("a.toml").is_ok());
    }
}
