//! What a command says on standard error: faults and findings one line each, quieter or louder as asked, in colour on a terminal.

use super::CommonArguments;
use crate::finding::{Finding, Severity};
use crate::host::fault::Fault;
use crate::host::outcome::Seconds;
use crate::host::words::finding_text;
use serde_json::{Value, json};
use std::io::{ErrorKind, IsTerminal, Write};
use std::process::ExitCode;

/// How much is said.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Level {
    /// Faults, and findings of severity error.
    Quiet,
    /// Findings, of those with one code the first.
    Plain,
    /// Every finding, and seconds by stage.
    Verbose,
}

/// How a command speaks.
#[derive(Clone, Copy)]
pub(super) struct Voice {
    level: Level,
    colour: bool,
    json: bool,
}

impl Voice {
    /// As the arguments ask; in colour on a terminal where `NO_COLOR` isn't set.
    pub fn of(common: &CommonArguments) -> Self {
        let level = match (common.quiet, common.verbose) {
            (true, _) => Level::Quiet,
            (false, true) => Level::Verbose,
            (false, false) => Level::Plain,
        };
        let set = |name: &str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
        let dumb = std::env::var_os("TERM").is_some_and(|t| t == "dumb");
        Self {
            level,
            colour: std::io::stderr().is_terminal() && !set("NO_COLOR") && !dumb,
            json: common.json,
        }
    }

    /// Whether only what makes the exit code is said.
    pub fn is_quiet(self) -> bool {
        self.level == Level::Quiet
    }

    /// Prints the answer to standard output: `result.json` where asked for, else words; whether it got there.
    pub fn answer(self, words: &str, json: &str) -> bool {
        match (self.json, self.level) {
            (true, _) => is_printed(json.as_bytes()),
            (false, Level::Quiet) => true,
            (false, _) => is_printed(words.as_bytes()),
        }
    }

    /// Says findings, the worst first.
    pub fn findings(self, findings: &[Finding]) {
        let mut text = String::new();
        for (i, f) in findings.iter().enumerate() {
            if self.level == Level::Quiet && f.severity < Severity::Error {
                continue;
            }
            let alike = |g: &&Finding| (g.severity, g.code) == (f.severity, f.code);
            let mut more = 0;
            if self.level != Level::Verbose {
                if findings.iter().take(i).any(|g| alike(&g)) {
                    continue;
                }
                more = findings.iter().skip(i + 1).filter(alike).count();
            }
            text.push_str(&self.painted(f));
            if more > 0 {
                text.push_str(&format!(" (and {more} more `{}`: -v lists them)", f.code));
            }
            text.push('\n');
        }
        say(&text);
    }

    /// One finding, its severity in colour.
    fn painted(self, f: &Finding) -> String {
        let line = finding_text(f);
        let word = f.severity.word();
        match self.colour {
            true => line.replacen(word, &format!("{}{word}\x1b[0m", colour(f.severity)), 1),
            false => line,
        }
    }

    /// Says what is worth knowing of the way.
    pub fn notes<'a>(self, notes: impl IntoIterator<Item = &'a str>) {
        if self.level != Level::Quiet {
            let lines: String = notes.into_iter().map(|n| format!("{n}\n")).collect();
            say(&lines);
        }
    }

    /// Says seconds by stage, where everything is asked for.
    pub fn seconds(self, seconds: &Seconds) {
        if self.level != Level::Verbose {
            return;
        }
        let stages = match serde_json::to_value(seconds) {
            Ok(Value::Object(stages)) => stages,
            _ => return,
        };
        let of =
            |(stage, s): (&String, &Value)| format!("{stage} {:.2} s", s.as_f64().unwrap_or(0.0));
        let list: Vec<String> = stages.iter().map(of).collect();
        say(&format!("time: {}\n", list.join(", ")));
    }

    /// Says faults; as JSON on standard output too where that is asked for.
    pub fn faults(self, faults: &[Fault]) {
        if self.json {
            let json = json!({ "faults": faults });
            print(format!("{json:#}\n").as_bytes());
        }
        self.fault_lines(faults);
    }

    /// Says faults on standard error alone.
    pub fn fault_lines(self, faults: &[Fault]) {
        let n = faults.len();
        let mut text: String = faults.iter().map(|f| format!("{f}\n")).collect();
        let plural = if n == 1 { "" } else { "s" };
        let total = format!("{n} fault{plural} found");
        text.push_str(&match self.colour {
            true => format!("{}{total}\x1b[0m\n", colour(Severity::Error)),
            false => total + "\n",
        });
        say(&text);
    }
}

/// The escape sequence of a severity: red, yellow, cyan.
fn colour(severity: Severity) -> &'static str {
    match severity {
        Severity::Error => "\x1b[1;31m",
        Severity::Warning => "\x1b[33m",
        Severity::Info => "\x1b[36m",
    }
}

fn say(text: &str) {
    // A closed pipe is no fault of ours.
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Prints to standard output.
pub(super) fn print(text: &[u8]) -> ExitCode {
    match is_printed(text) {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(2),
    }
}

/// Whether a text got to standard output; said where it did not.
fn is_printed(text: &[u8]) -> bool {
    let mut out = std::io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        // A closed pipe (`| head`) is no fault of ours.
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            say(&format!(
                "standard output can't be written ({e}): what was printed is not whole\n"
            ));
            false
        }
        _ => true,
    }
}
