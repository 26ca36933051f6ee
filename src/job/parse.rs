//! Parses text into a raw job and reports every fault, not only the first. An entry with a fault is removed and the remaining text is parsed again.

use super::raw_job::RawJob;
use super::suggest;
use crate::host::fault::{Fault, FaultList};
use serde::Deserialize;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error};

/// The most faults listed for one job; more would hide the first.
const MOST_FAULTS: usize = 100;

/// Returns the raw job, and the faults found during parsing.
pub(super) fn parse_job(file: &str, text: &str) -> (RawJob, FaultList) {
    let (mut table, errors) = DeTable::parse_recoverable(text);
    let mut faults: FaultList = errors.iter().map(|e| syntax_fault(file, text, e)).collect();
    if !faults.is_empty() {
        return (RawJob::default(), faults);
    }
    while faults.len() < MOST_FAULTS {
        match RawJob::deserialize(Deserializer::from(table.clone())) {
            Ok(raw) => return (raw, faults),
            Err(e) => {
                let span = e.span().unwrap_or(0..0);
                let mut key = Vec::new();
                let removed = remove_entry(table.get_mut(), &span, &mut key);
                faults.push(value_fault(file, text, &e, &span, &key));
                if !removed {
                    break;
                }
            }
        }
    }
    (RawJob::default(), faults)
}

fn syntax_fault(file: &str, text: &str, e: &Error) -> Fault {
    let (line, column) = line_column(text, e.span().unwrap_or(0..0).start);
    let message = e.message().lines().collect::<Vec<_>>().join("; ");
    Fault::with_line(
        file,
        line,
        "syntax",
        format!("{message} (column {column})"),
        "write TOML: `key = value`, text in quotes, sections in brackets",
    )
}

fn value_fault(file: &str, text: &str, e: &Error, span: &Range<usize>, key: &[String]) -> Fault {
    let (line, column) = line_column(text, span.start);
    let field = if key.is_empty() {
        "job".to_owned()
    } else {
        format_key_path(key)
    };
    let message = e.message();
    if let Some((word, names)) = unknown_key(message) {
        let wrong = format!("unknown key `{word}` (column {column})");
        return Fault::with_line(
            file,
            line,
            field,
            wrong,
            suggest::remedy(&word, names.iter().map(String::as_str)),
        );
    }
    let (wrong, expected) = match message.split_once(", expected ") {
        Some((wrong, expected)) => (wrong.to_owned(), plain_type(expected)),
        None => (message.to_owned(), String::new()),
    };
    let remedy = if expected.is_empty() {
        "correct the value".to_owned()
    } else {
        format!("give {expected}")
    };
    let expected = if expected.is_empty() {
        expected
    } else {
        format!(", expected {expected}")
    };
    Fault::with_line(
        file,
        line,
        field,
        format!("{wrong}{expected} (column {column})"),
        remedy,
    )
}

/// `load[2].grid` of `load`, `2`, `grid`.
fn format_key_path(key: &[String]) -> String {
    key.iter()
        .fold(String::new(), |path, part| match part.parse::<usize>() {
            Ok(n) => format!("{path}[{n}]"),
            Err(_) if path.is_empty() => part.clone(),
            Err(_) => format!("{path}.{part}"),
        })
}

/// Returns the unknown key and the known names in serde's message about an unknown field.
fn unknown_key(message: &str) -> Option<(String, Vec<String>)> {
    let rest = message.strip_prefix("unknown field `")?;
    let mut quoted = rest.split('`').step_by(2).map(str::to_owned);
    let word = quoted.next()?;
    let names = rest
        .split('`')
        .skip(2)
        .step_by(2)
        .map(str::to_owned)
        .collect();
    Some((word, names))
}

/// Returns a plain description of a Rust type name.
fn plain_type(expected: &str) -> String {
    match expected.trim() {
        "f64" => "a number".into(),
        "u32" | "u64" => "a whole number, 0 or more".into(),
        "a string" => "text in quotes".into(),
        "a boolean" => "true or false".into(),
        "an array of length 3" => "three numbers, [x, y, z]".into(),
        "an array of length 2" => "two numbers, [low, high]".into(),
        "a sequence" => "a list in brackets".into(),
        "a map" => "a table, { key = value }".into(),
        s if s.starts_with("struct ") => "a section of keys".into(),
        s => s.into(),
    }
}

/// Returns the line and column, counted from 1, of a byte of the text.
pub(super) fn line_column(text: &str, at: usize) -> (u32, u32) {
    let before = text.get(..at.min(text.len())).unwrap_or(text);
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
    (line as u32, column as u32)
}

/// Removes the innermost entry that contains the span from the table and appends its path to `key`; returns false without such an entry.
fn remove_entry(table: &mut DeTable, span: &Range<usize>, key: &mut Vec<String>) -> bool {
    let holds = |k: &Range<usize>, v: &Range<usize>| {
        (k.start <= span.start && span.end <= k.end) || (v.start <= span.start && span.end <= v.end)
    };
    let found = table
        .iter()
        .filter(|(k, v)| holds(&k.span(), &v.span()) || has_covering_entry(v, span))
        .map(|(k, _)| k.clone())
        .next();
    let Some(name) = found else { return false };
    key.push(name.get_ref().to_string());
    if let Some(value) = table.get_mut(&name)
        && remove_inside(value, span, key)
    {
        return true;
    }
    table.remove(&name);
    true
}

/// Returns whether an entry below contains the span. The span of a dotted or array table need not cover its entries.
fn has_covering_entry(value: &Spanned<DeValue>, span: &Range<usize>) -> bool {
    let covers = |r: &Range<usize>| r.start <= span.start && span.end <= r.end && r.end > r.start;
    match value.get_ref() {
        DeValue::Table(t) => t
            .iter()
            .any(|(k, v)| covers(&k.span()) || covers(&v.span()) || has_covering_entry(v, span)),
        DeValue::Array(a) => a
            .iter()
            .any(|v| covers(&v.span()) || has_covering_entry(v, span)),
        _ => false,
    }
}

fn remove_inside(value: &mut Spanned<DeValue>, span: &Range<usize>, key: &mut Vec<String>) -> bool {
    match value.get_mut() {
        DeValue::Table(t) => remove_entry(t, span, key),
        DeValue::Array(a) => {
            let n = a.len();
            for (i, item) in a.iter_mut().enumerate() {
                if has_covering_entry(item, span) {
                    let mark = key.len();
                    if n > 1 || matches!(item.get_ref(), DeValue::Table(_)) {
                        key.push(format!("{}", i + 1));
                    }
                    if remove_inside(item, span, key) {
                        return true;
                    }
                    key.truncate(mark);
                }
            }
            false
        }
        _ => false,
    }
}
