//! Names of users in cells of tables that a spreadsheet may open.

use std::borrow::Cow;

/// Apostrophe before a text that a spreadsheet would read as a formula. With it, the cell remains a text.
const GUARD: char = '\'';

/// Returns the text with a guard if a spreadsheet would read it as a formula. [`remove_guard`] removes the guard.
///
/// # Reference
/// OWASP, CSV injection: cells that begin with `=`, `+`, `-`, `@`, tab or carriage return.
pub fn guard_formula(text: &str) -> Cow<'_, str> {
    if is_formula(text) {
        Cow::Owned(format!("{GUARD}{text}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// Returns the text without the guard of [`guard_formula`].
pub fn remove_guard(text: &str) -> &str {
    text.strip_prefix(GUARD)
        .filter(|rest| is_formula(rest))
        .unwrap_or(text)
}

fn is_formula(text: &str) -> bool {
    text.starts_with(['=', '+', '-', '@', '\t', '\r'])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_guarded_and_read_back_and_other_names_are_left_alone() {
        for name in ["=cmd|' /C calc'!A0", "+1", "-LF.FZ", "@SUM(A1)", "\tx"] {
            let cell = guard_formula(name);
            assert!(!is_formula(&cell), "{name}");
            assert_eq!(remove_guard(&cell), name);
        }
        for name in ["LF.FZ", "'quoted'", "5", ""] {
            assert_eq!(guard_formula(name), name);
            assert_eq!(remove_guard(name), name);
        }
    }
}
