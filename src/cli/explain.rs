//! `explain`: the meaning of findings.

use super::arguments::ExplainArguments;
use super::reporter::{Reporter, print};
use super::run::refuse;
use crate::finding::explain::Code;
use crate::host::output::Output;
use crate::report::console::wrap_lines;
use crate::report::reference;
use crate::workflow;
use std::path::Path;
use std::process::ExitCode;

/// Prints the entry of a code, or all codes.
pub(super) fn explain(a: &ExplainArguments) -> ExitCode {
    if let Some(folder) = &a.reference {
        return write_reference(a, folder);
    }
    let all = workflow::explain::explain_all();
    match (&a.code, a.common.json) {
        (Some(code), json) => match workflow::explain::explain(code) {
            Ok(entry) if json => print_json(entry),
            Ok(entry) => {
                let reporter = Reporter::from_arguments(&a.common);
                reporter.print_lines(&entry_lines(entry, reporter.width()))
            }
            Err(faults) => refuse(&faults, &a.common),
        },
        (None, true) => print_json(&all),
        (None, false) => print(list(all).as_bytes()),
    }
}

fn print_json(value: &impl serde::Serialize) -> ExitCode {
    // Plain text always has a JSON form.
    let text = serde_json::to_string_pretty(value).unwrap_or_default() + "\n";
    print(text.as_bytes())
}

/// An entry as a page for a terminal.
fn entry_lines(c: &Code, width: usize) -> Vec<String> {
    let head = format!("{}: {}, from {}", c.code, c.severities(), c.said_by);
    let fields = [
        ("cause", c.cause),
        ("limit", c.limit),
        ("remedy", c.remedy),
        ("example", c.example),
    ];
    let field = |(name, text): (&str, &str)| {
        // Names and texts are in two columns.
        let lines = wrap_lines(text, width.saturating_sub(11), 0);
        let at = |(i, line): (usize, String)| match i {
            0 => format!("  {name:<7}  {line}"),
            _ => format!("{}{line}", " ".repeat(11)),
        };
        lines.into_iter().enumerate().map(at).collect::<Vec<_>>()
    };
    let mut lines = wrap_lines(&head, width, 2);
    lines.push(String::new());
    lines.extend(fields.into_iter().flat_map(field));
    lines
}

/// A line a code.
fn list(all: &[Code]) -> String {
    let width = all.iter().map(|c| c.code.len()).max().unwrap_or(0);
    let line = |c: &Code| format!("{:<width$}  {}\n", c.code, c.cause);
    all.iter().map(line).collect()
}

fn write_reference(a: &ExplainArguments, folder: &Path) -> ExitCode {
    let written = Output::begin(folder).and_then(|mut out| {
        for (name, text) in reference::pages() {
            out.write_bytes(name, text.as_bytes())?;
        }
        out.rename_all()
    });
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => refuse(&fault.into(), &a.common),
    }
}
