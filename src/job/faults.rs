//! Collecting faults at places of the job's text.

use super::parse::line_column;
use super::raw_job::S;
use super::spanned_value::SpannedValue;
use super::suggest;
use super::types::NamedFile;
use crate::host::fault::{Fault, FaultList};
use crate::host::words::format_number;

/// No quantity of a job is larger in any system of units; the square of one that is smaller stays a number.
const LARGEST: f64 = 1e30;

/// Text of the job, and the faults found so far.
pub(super) struct Collector<'a> {
    pub file: &'a str,
    pub text: &'a str,
    pub faults: &'a mut FaultList,
    /// Bytes at which lines end, ascending.
    ends: Vec<usize>,
}

impl<'a> Collector<'a> {
    /// Returns a collector for the text of a file.
    pub(super) fn new(file: &'a str, text: &'a str, faults: &'a mut FaultList) -> Self {
        Self {
            ends: text.match_indices('\n').map(|(at, _)| at).collect(),
            file,
            text,
            faults,
        }
    }

    /// Returns the line of a value.
    pub(super) fn line<T>(&self, at: &SpannedValue<T>) -> u32 {
        let start = at.span().start;
        self.ends.partition_point(|end| *end < start) as u32 + 1
    }

    /// Adds a fault at a value.
    pub(super) fn fault<T>(
        &mut self,
        at: &SpannedValue<T>,
        field: &str,
        wrong: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        let (line, column) = line_column(self.text, at.span().start);
        let wrong = format!("{} (column {column})", wrong.into());
        self.faults
            .push(Fault::with_line(self.file, line, field, wrong, remedy));
    }

    /// Returns the value of a required key. Otherwise it adds a fault; `section` is the section that lacks the key.
    pub(super) fn require<T: Clone, U>(
        &mut self,
        value: &S<T>,
        section: &SpannedValue<U>,
        key: &str,
        example: &str,
    ) -> Option<T> {
        if value.is_none() {
            self.fault(
                section,
                key,
                "this key is missing",
                format!("add `{example}`"),
            );
        }
        value.as_ref().map(|v| v.value().clone())
    }

    /// Returns a named file.
    pub(super) fn named_file(&self, value: &S<String>, key: &str) -> Option<NamedFile> {
        value.as_ref().map(|v| self.named_at(v, key))
    }

    /// Returns a named file.
    pub(super) fn named_at(&self, v: &SpannedValue<String>, key: &str) -> NamedFile {
        NamedFile {
            given: v.value().clone(),
            key: key.to_owned(),
            line: self.line(v),
        }
    }

    /// Returns the choice with the name `word`. Returns `default` if the key is absent or the name is unknown; an unknown name is a fault.
    pub(super) fn choose<T: Copy>(
        &mut self,
        word: &S<String>,
        key: &str,
        choices: &[(&str, T)],
        default: T,
    ) -> T {
        let Some(word) = word else { return default };
        self.choose_at(word, key, choices).unwrap_or(default)
    }

    /// Returns the choice with the name `word`; adds a fault if the name is unknown.
    pub(super) fn choose_at<T: Copy>(
        &mut self,
        word: &SpannedValue<String>,
        key: &str,
        choices: &[(&str, T)],
    ) -> Option<T> {
        let found = choices.iter().find(|c| c.0 == word.value()).map(|c| c.1);
        if found.is_none() {
            let names: Vec<&str> = choices.iter().map(|c| c.0).collect();
            let expected = names
                .iter()
                .map(|n| format!("`{n}`"))
                .collect::<Vec<_>>()
                .join(", ");
            let wrong = format!("`{}`, expected one of {expected}", word.value());
            let remedy = match suggest::find_closest_name(word.value(), names) {
                Some(n) => format!("did you mean `{n}`?"),
                None => "use one of these words".to_owned(),
            };
            self.fault(word, key, wrong, remedy);
        }
        found
    }

    /// Returns a number that is finite, at most [`LARGEST`], and passes `ok`. Otherwise it adds a fault. `expected` describes `ok`.
    pub(super) fn number(
        &mut self,
        value: &S<f64>,
        key: &str,
        expected: &str,
        ok: impl Fn(f64) -> bool,
    ) -> Option<f64> {
        let v = value.as_ref()?;
        let x = *v.value();
        let wrong = match x {
            x if x.is_finite() && x.abs() > LARGEST => {
                format!("`{x:e}` is beyond {LARGEST:e}, which no quantity reaches in any unit")
            }
            x if x.is_finite() && ok(x) => return Some(x),
            x => format!("`{x}`, expected {expected}"),
        };
        self.fault(v, key, wrong, "correct the number");
        None
    }

    /// Returns a number of 0 or more.
    pub(super) fn at_least_zero(&mut self, value: &S<f64>, key: &str) -> Option<f64> {
        self.number(value, key, "0 or more", |x| x >= 0.0)
    }

    /// Returns a relative error, a fraction from 0 to 1. Otherwise it adds a fault, which asks whether a larger number is in percent.
    pub(super) fn fraction(&mut self, value: &S<f64>, key: &str) -> Option<f64> {
        const EXPECTED: &str = "a fraction from 0 to 1";
        let percent = |x: f64| x > 1.0 && x <= 100.0;
        match value.as_ref().map(|v| (v, *v.value())) {
            Some((v, x)) if percent(x) => {
                let wrong = format!(
                    "`{x}` is {} %, expected {EXPECTED}",
                    format_number(100.0 * x)
                );
                let remedy = format!(
                    "if percent was meant, write {} for {x} %",
                    format_number(x / 100.0)
                );
                self.fault(v, key, wrong, remedy);
                None
            }
            _ => self.number(value, key, EXPECTED, |x| (0.0..=1.0).contains(&x)),
        }
    }

    /// Returns a number above 0.
    pub(super) fn positive_number(&mut self, value: &S<f64>, key: &str) -> Option<f64> {
        self.number(value, key, "a number above 0", |x| x > 0.0)
    }

    /// Returns a count of at least 1.
    pub(super) fn count(&mut self, value: &S<u32>, key: &str) -> Option<usize> {
        let v = value.as_ref()?;
        if *v.value() == 0 {
            self.fault(v, key, "`0`, expected 1 or more", "correct the number");
        }
        Some(*v.value() as usize)
    }
}
