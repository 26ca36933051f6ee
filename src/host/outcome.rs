//! Outcome of a command: the answer of its type, with units, inputs, findings and seconds. `result.json` is its serialised form.

use super::words::count_of;
use crate::finding::{Finding, Severity, list_few, worst_severity};
use crate::host::fault::Fault;
use crate::host::files::Input;
use crate::units::{ReportUnits, UnitSystem};
use serde::{Serialize, Serializer};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Version of `result.json`. It increases when a key changes its meaning.
pub const SCHEMA: u32 = 1;

/// Answer of a command. Each command has its own type of answer.
pub trait Answer: Serialize {
    /// Name of the command.
    const COMMAND: &'static str;
    /// Name of the result, as the subject of a sentence: `The recovered loads`.
    const RESULT: &'static str;

    /// Returns the result and its uncertainty in one sentence, in numbers with units. `±` is the half width of a 95 % interval. The sentence is right
    /// for an answer without findings; [`Outcome::summary`] adds the meaning of the findings.
    fn verdict(&self) -> String;

    /// Returns the faults of the input that are part of the answer: only `check` has them.
    fn faults(&self) -> &[Fault] {
        &[]
    }
}

/// Answer of a command with inputs, findings and units. It dereferences to the answer, so `plan.gauges` is a field of the answer.
///
/// # Example
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, recover};
///
/// # const JOB: &str = r#"
/// # units = "m-kg-s"
/// # load = [{ name = "left" }, { name = "right" }]
/// # sensitivity = { file = "s.csv" }
/// # measured = { strain = "strain.csv", noise_microstrain = 1.0 }
/// # "#;
/// # let files = InMemory::default()
/// #     .with_file("job.toml", JOB)
/// #     .with_file("s.csv", "gauge,left,right\nG1,0.10,0.02\nG2,0.02,0.10\nG3,0.05,0.05\n")
/// #     .with_file("strain.csv", "run,G1,G2,G3\nR1,221,139,151\n");
/// let job = Job::read("job.toml", &files)?;
/// let outcome = recover(&job, &Context::new(&files))?;
/// assert!(outcome.is_reliable());
/// assert!(outcome.inputs.iter().any(|i| i.path == "strain.csv" && i.sha256.len() == 64));
/// assert!(outcome.units.list().contains(&("force", "N".to_owned())));
///
/// // The sentence for people is the first text of the file for machines.
/// let json: serde_json::Value = serde_json::from_str(&outcome.to_json(&Default::default())?)?;
/// assert_eq!(json["command"], "recover");
/// assert_eq!(json["summary"], outcome.summary());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Outcome<A> {
    /// Units of the answer.
    pub units: StatedUnits,
    /// Every file that was read.
    pub inputs: Vec<Input>,
    /// Paths of the inputs and of other files that the answer depends on. No output replaces any of these files.
    pub sources: Vec<PathBuf>,
    /// Findings on the answer, the worst first.
    pub findings: Findings,
    /// Seconds by stage.
    pub seconds: Seconds,
    /// Notes about the computation that are not part of the answer.
    pub notes: Vec<String>,
    /// The answer.
    pub answer: A,
}

impl<A> std::ops::Deref for Outcome<A> {
    type Target = A;
    fn deref(&self) -> &A {
        &self.answer
    }
}

impl<A> Outcome<A> {
    /// Returns whether no finding has the severity error.
    pub fn is_reliable(&self) -> bool {
        self.findings.worst_severity() < Some(Severity::Error)
    }
}

impl<A: Answer> Outcome<A> {
    /// Returns the sentence that states the result and whether the result can be used. Console, page and `result.json` begin with this sentence.
    pub fn summary(&self) -> String {
        let count = |severity| {
            let of_severity = self.findings.iter().filter(|f| f.severity == severity);
            of_severity.count()
        };
        let faults = self.answer.faults().len();
        match (count(Severity::Error), count(Severity::Warning)) {
            _ if faults > 0 => format!(
                "The input has {}: nothing can be computed from it before {} corrected.",
                count_of(faults, "fault"),
                if faults == 1 { "it is" } else { "they are" }
            ),
            (0, 0) => self.answer.verdict(),
            (0, n) => format!(
                "{} The result is usable, with {}.",
                self.answer.verdict(),
                count_of(n, "warning")
            ),
            _ => format!(
                "{} cannot be relied on: {}.",
                A::RESULT,
                reasons(&self.findings)
            ),
        }
    }
}

/// Returns the errors as the short texts of their codes, each with its subject: `gauge silent (P03)`.
fn reasons(findings: &[Finding]) -> String {
    /// Codes that a sentence names; the findings below it name all.
    const MOST: usize = 2;
    /// Characters of the subjects that a sentence has room for.
    const ROOM: usize = 32;
    let errors = findings.iter().filter(|f| f.severity == Severity::Error);
    let mut by_code: Vec<(&str, Vec<&str>)> = Vec::new();
    for f in errors {
        match by_code.iter_mut().find(|c| c.0 == f.code) {
            Some((_, subjects)) if subjects.contains(&f.subject.as_str()) => {}
            Some((_, subjects)) => subjects.push(&f.subject),
            None => by_code.push((f.code, vec![&f.subject])),
        }
    }
    let reason = |(code, subjects): &(&str, Vec<&str>)| {
        let words = code.replace('-', " ");
        let subjects = list_few(subjects);
        match subjects.chars().count() <= ROOM {
            true => format!("{words} ({subjects})"),
            false => words,
        }
    };
    let mut list: Vec<String> = by_code.iter().take(MOST).map(reason).collect();
    if by_code.len() > MOST {
        list.push(format!("and {} more", by_code.len() - MOST));
    }
    list.join("; ")
}

/// Findings of an outcome.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Findings(pub Vec<Finding>);

impl Findings {
    /// Returns the worst severity; `None` without findings.
    pub fn worst_severity(&self) -> Option<Severity> {
        worst_severity(&self.0)
    }
}

impl std::ops::Deref for Findings {
    type Target = [Finding];
    fn deref(&self) -> &[Finding] {
        &self.0
    }
}

/// Seconds by stage.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Seconds(Map<String, Value>);

impl Seconds {
    /// Adds seconds to the stage `name`.
    pub fn add(&mut self, name: &str, seconds: f64) {
        let before = self.0.get(name).and_then(Value::as_f64).unwrap_or(0.0);
        let s = before + seconds;
        self.0
            .insert(name.to_owned(), Value::from((s * 1e6).round() / 1e6));
    }

    /// Returns the sum over all stages, s.
    pub fn total(&self) -> f64 {
        self.0.get("total").and_then(Value::as_f64).unwrap_or(0.0)
    }
}

/// Units of an answer, by quantity. The list is empty if the answer has no numbers with units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StatedUnits(Vec<(&'static str, String)>);

impl StatedUnits {
    /// Creates the units of a job from its unit system and its report units.
    pub fn from_units(system: UnitSystem, report: &ReportUnits) -> Self {
        let unit = |name: &str| name.to_owned();
        Self(vec![
            ("system", unit(system.name())),
            ("force", unit(report.force.name)),
            ("moment", unit(report.moment.name)),
            ("length", unit(report.length.name)),
            ("mass", unit(report.mass.name)),
            ("stress", unit(report.stress.name)),
            ("strain", unit("microstrain")),
        ])
    }

    /// Creates the units of an answer whose numbers are in the unit system of the model.
    pub fn of_model(system: UnitSystem) -> Self {
        Self::from_units(system, &ReportUnits::from_system(system))
    }

    /// Returns pairs of quantity and unit.
    pub fn list(&self) -> &[(&'static str, String)] {
        &self.0
    }
}

impl Serialize for StatedUnits {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match self.0.is_empty() {
            true => s.serialize_none(),
            false => s.collect_map(self.0.iter().map(|(k, v)| (k, v))),
        }
    }
}

/// Units of the columns of every table that was written: file, column, unit (empty: a number, a name).
pub type Tables = BTreeMap<String, BTreeMap<String, String>>;

/// `result.json`.
#[derive(Serialize)]
struct ResultFile<'a, A> {
    command: &'a str,
    version: &'a str,
    schema: u32,
    summary: &'a str,
    units: &'a StatedUnits,
    inputs: &'a [Input],
    findings: &'a Findings,
    #[serde(flatten)]
    answer: &'a A,
    tables: &'a Tables,
    seconds: &'a Seconds,
}

impl<A: Answer> Outcome<A> {
    /// Returns `result.json`, ending in a line feed; `tables` are the tables written next to it.
    ///
    /// # Errors
    /// Returns an error if the answer has no JSON form, which is a mistake of the program.
    pub fn to_json(&self, tables: &Tables) -> Result<String, serde_json::Error> {
        let file = ResultFile {
            command: A::COMMAND,
            version: env!("CARGO_PKG_VERSION"),
            schema: SCHEMA,
            summary: &self.summary(),
            units: &self.units,
            inputs: &self.inputs,
            findings: &self.findings,
            answer: &self.answer,
            tables,
            seconds: &self.seconds,
        };
        serde_json::to_string_pretty(&file).map(|text| text + "\n")
    }
}

/// Returns a finite number, or `None`: JSON has no form for infinite numbers and NaN.
#[must_use]
pub fn finite_or_none(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize)]
    struct TestAnswer(#[serde(skip)] Vec<Fault>);

    impl Answer for TestAnswer {
        const COMMAND: &'static str = "asked";
        const RESULT: &'static str = "The answer";

        fn verdict(&self) -> String {
            "The answer is 42 ± 1 kN.".into()
        }

        fn faults(&self) -> &[Fault] {
            &self.0
        }
    }

    fn summary(faults: usize, findings: &[(Severity, &'static str, &str)]) -> String {
        let finding = |(severity, code, subject): &(Severity, &'static str, &str)| {
            Finding::new(*severity, code, *subject, "message", "remedy")
        };
        let fault = || Fault::new("job.toml", "units", "unknown", "correct it");
        Outcome {
            units: StatedUnits::default(),
            inputs: Vec::new(),
            sources: Vec::new(),
            findings: Findings(findings.iter().map(finding).collect()),
            seconds: Seconds::default(),
            notes: Vec::new(),
            answer: TestAnswer((0..faults).map(|_| fault()).collect()),
        }
        .summary()
    }

    #[test]
    fn an_answer_with_errors_never_sounds_fine() {
        let (info, warning, error) = (Severity::Info, Severity::Warning, Severity::Error);
        let fine = "The answer is 42 ± 1 kN.";
        assert_eq!(summary(0, &[(info, "strain-source", "model")]), fine);
        let warned = summary(0, &[(warning, "gauge-suspect", "P1")]);
        assert_eq!(
            warned,
            format!("{fine} The result is usable, with 1 warning.")
        );
        let summary_text = summary(
            0,
            &[
                (error, "gauge-silent", "P1"),
                (error, "gauge-silent", "P2"),
                (warning, "gauge-suspect", "P3"),
                (
                    error,
                    "loads-not-separable",
                    "a subject with more words than a sentence has room for",
                ),
            ],
        );
        assert_eq!(
            summary_text,
            "The answer cannot be relied on: gauge silent (P1, P2); loads not separable."
        );
        let refused = summary(2, &[(error, "gauge-silent", "P1")]);
        assert!(refused.starts_with("The input has 2 faults"), "{refused}");
    }
}
