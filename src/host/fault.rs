//! Faults of inputs: the problem, its place and the remedy.

use crate::finding::{Finding, list_few, shorten_names};
use serde::Serialize;
use std::collections::{HashMap, HashSet};
use std::fmt;

/// Fault of an input, printed as `file:line: field: what is wrong: what to do`.
///
/// [`shorten_names`] shortens long names in its text.
///
/// # Example
/// ```
/// use strainbridge::Fault;
///
/// let fault = Fault::with_line("job.toml", 7, "load.grid", "grid 12 is not in the deck", "name a grid of the deck");
/// assert_eq!(fault.line, Some(7));
/// assert_eq!(
///     fault.to_string(),
///     "job.toml:7: load.grid: grid 12 is not in the deck: name a grid of the deck"
/// );
/// // A fault of a whole file has no line, and editors jump to the first one.
/// let fault = Fault::new("job.toml", "model", "the job has no [model]", "name the deck");
/// assert!(fault.line.is_none() && fault.to_string().starts_with("job.toml:1: model: "));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// File, as the job or the command line states it.
    pub file: String,
    /// Line, counted from 1; `None` if the fault concerns the whole file.
    pub line: Option<u32>,
    /// Key, card field or column.
    pub field: String,
    /// Text with the observed and the expected content.
    pub wrong: String,
    /// Remedy, as an imperative.
    pub remedy: String,
}

impl Fault {
    /// Creates a fault at a line of a file.
    pub fn with_line(
        file: impl Into<String>,
        line: u32,
        field: impl Into<String>,
        wrong: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        let line = (line > 0).then_some(line);
        Self {
            file: file.into(),
            line,
            field: shorten_names(field),
            wrong: shorten_names(wrong),
            remedy: shorten_names(remedy),
        }
    }

    /// Creates a fault of a whole file.
    pub fn new(
        file: impl Into<String>,
        field: impl Into<String>,
        wrong: impl Into<String>,
        remedy: impl Into<String>,
    ) -> Self {
        Self {
            file: file.into(),
            line: None,
            field: shorten_names(field),
            wrong: shorten_names(wrong),
            remedy: shorten_names(remedy),
        }
    }

    /// Creates a fault of a whole file from a finding that stops the command.
    pub fn from_finding(
        file: impl Into<String>,
        field: impl Into<String>,
        finding: &Finding,
    ) -> Self {
        let remedy = finding.remedy.trim_end_matches('.');
        Self::new(file, field, finding.clause(), remedy)
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}: {}: {}",
            self.file,
            self.line.unwrap_or(1),
            self.field,
            self.wrong,
            self.remedy
        )
    }
}

/// Faults during collection; the list may be empty.
pub type FaultList = Vec<Fault>;

/// All faults of the inputs, at least one. It is the error type of every command.
///
/// A slice of [`Fault`]s, so `iter`, `len` and indices work on it.
///
/// # Example
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Faults, Job};
///
/// const JOB: &str = "units = \"m-kg-s\"\ncolour = \"red\"\nmeasured = { noise_microstrain = \"1\" }\n";
/// let files = InMemory::default().with_file("job.toml", JOB);
/// let faults: Faults = Job::read("job.toml", &files).unwrap_err();
/// assert!(faults.len() >= 2, "both lines are reported at once");
/// assert!(faults.iter().any(|f| f.line == Some(2) && f.field == "colour"));
/// assert!(faults.iter().any(|f| f.line == Some(3)));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Faults(Vec<Fault>);

impl Faults {
    /// Succeeds if the list is empty.
    ///
    /// # Errors
    /// Returns the faults of a list that is not empty.
    pub fn check(list: FaultList) -> Result<(), Self> {
        if list.is_empty() {
            Ok(())
        } else {
            Err(Self(fold_similar_faults(list)))
        }
    }

    /// Returns the faults of a list, or `otherwise` if the list is empty.
    pub fn or(list: FaultList, otherwise: Fault) -> Self {
        if list.is_empty() {
            otherwise.into()
        } else {
            Self(fold_similar_faults(list))
        }
    }

    /// Returns field and sentence of the first fault, for a message that gives it as a reason.
    pub fn first_reason(&self) -> String {
        let reason = |f: &Fault| format!("{}: {}", f.field, f.wrong);
        self.0.first().map_or_else(String::new, reason)
    }

    /// Returns the faults as a list.
    pub fn into_list(self) -> FaultList {
        self.0
    }
}

/// Returns the faults, with similar faults folded. If many faults of a file and field differ in quoted values only, one fault replaces them.
fn fold_similar_faults(list: FaultList) -> FaultList {
    /// Faults up to which each is listed.
    const FEW: usize = 3;
    let key = |f: &Fault| {
        let unquoted: Vec<&str> = f.wrong.split('`').step_by(2).collect();
        let place = (f.file.clone(), f.field.clone());
        (place, unquoted.join("``"), f.remedy.clone())
    };
    let mut lines: HashMap<_, Vec<u32>> = HashMap::new();
    for fault in list.iter().filter(|f| f.line.is_some()) {
        lines.entry(key(fault)).or_default().extend(fault.line);
    }
    lines.retain(|_, l| l.len() > FEW);
    let mut out = FaultList::new();
    let mut folded = HashSet::new();
    for mut fault in list {
        let key = key(&fault);
        if let Some(lines) = lines.get(&key).filter(|_| fault.line.is_some()) {
            if !folded.insert(key) {
                continue;
            }
            let others: Vec<String> = lines.iter().skip(1).map(u32::to_string).collect();
            fault.wrong = shorten_names(format!(
                "{}; {} more faults of this kind, in lines {}",
                fault.wrong,
                others.len(),
                list_few(&others)
            ));
        }
        out.push(fault);
    }
    out
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self(vec![fault])
    }
}

impl std::ops::Deref for Faults {
    type Target = [Fault];
    fn deref(&self) -> &[Fault] {
        &self.0
    }
}

impl IntoIterator for Faults {
    type Item = Fault;
    type IntoIter = std::vec::IntoIter<Fault>;
    fn into_iter(self) -> Self::IntoIter {
        self.0.into_iter()
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for fault in &self.0 {
            writeln!(f, "{fault}")?;
        }
        let n = self.0.len();
        write!(f, "{n} fault{} found", if n == 1 { "" } else { "s" })
    }
}

impl std::error::Error for Faults {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_that_differ_in_quoted_values_alone_are_one_and_others_are_kept() {
        let cell = |line, text: &str| {
            Fault::with_line(
                "runs.csv",
                line,
                "G1",
                format!("`{text}` is not a number"),
                "write a number",
            )
        };
        let grid = |line| {
            Fault::with_line(
                "a.bdf",
                line,
                "GRID",
                format!("grid {line} is missing"),
                "add it",
            )
        };
        let cells = (2..92).map(|line| cell(line, &line.to_string()));
        let folded = Faults::check(cells.collect()).unwrap_err().into_list();
        assert_eq!(folded.len(), 1);
        assert!(folded[0].wrong.contains("89 more"), "{}", folded[0].wrong);
        let kept = Faults::check((2..92).map(grid).collect()).unwrap_err();
        assert_eq!(kept.into_list().len(), 90);
    }
}
