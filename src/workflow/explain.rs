//! Explanation of a finding by its code.

use crate::finding::explain::{self, Code};
use crate::host::fault::{Fault, Faults};
use crate::job::suggest::remedy;

/// Returns cause, limit, remedy and example of every finding, sorted by code. Editors and web pages show them next to a finding.
///
/// # Example
/// ```
/// use strainbridge::{explain, explain_all};
///
/// let all = explain_all();
/// assert!(all.is_sorted_by_key(|entry| entry.code));
/// for entry in all {
///     assert_eq!(explain(entry.code).unwrap().code, entry.code);
///     assert!(!entry.cause.is_empty() && !entry.remedy.is_empty());
/// }
/// ```
pub fn explain_all() -> &'static [Code] {
    explain::codes()
}

/// Returns cause, limit, remedy and example of a finding. Former codes lead to the code that replaced them.
///
/// # Errors
/// Returns a fault with the closest code if no finding has `code`.
///
/// # Example
/// ```
/// use strainbridge::{Severity, explain};
///
/// let entry = explain("loads-not-separable").unwrap();
/// assert!(entry.severity.contains(&Severity::Error));
/// assert_eq!(explain("gauges-exchanged").unwrap().code, "inputs-exchanged");
///
/// let faults = explain("loads-not-seperable").unwrap_err();
/// assert!(faults[0].remedy.contains("loads-not-separable"));
/// ```
pub fn explain(code: &str) -> Result<&'static Code, Faults> {
    explain::code(code).ok_or_else(|| {
        let wrong = format!("no finding has the code `{code}`");
        let closest = suggest_code(code);
        Fault::new("explain", "code", wrong, closest).into()
    })
}

/// Suggests the closest code, else the codes that share a word with it, else the option that lists all codes.
fn suggest_code(code: &str) -> String {
    let names = explain::codes().iter().map(|c| c.code);
    let meant = remedy(code, names.clone());
    if meant.starts_with("did you mean") {
        return meant;
    }
    let alike = |name: &&str| {
        let mut words = code.split(['-', '_', ' ']).filter(|w| w.len() > 3);
        words.any(|w| name.contains(&w.to_lowercase()))
    };
    let some: Vec<String> = names.filter(alike).map(|n| format!("`{n}`")).collect();
    match some.as_slice() {
        [] => "`strainbridge explain --list` lists all codes".to_owned(),
        some => format!("did you mean one of {}?", some.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_code_is_answered_by_the_one_that_was_meant() {
        assert!(explain("loads-not-separable").is_ok());
        let faults = explain("loads-not-seperable").unwrap_err();
        assert_eq!(faults[0].remedy, "did you mean `loads-not-separable`?");
        let faults = explain("separable").unwrap_err();
        assert!(faults[0].remedy.contains("`loads-weakly-separable`"));
        let faults = explain("zzz").unwrap_err();
        assert!(faults[0].remedy.contains("--list"));
    }
}
