//! Texts of a command on standard output and standard error. They fit the width of the terminal, are as quiet or loud as requested, and have colour
//! on a terminal.

use super::CommonArguments;
use crate::finding::{Finding, Severity};
use crate::host::fault::Fault;
use crate::host::outcome::Seconds;
use crate::report::console::{
    Console, FindingLines, LINES, Room, Texts, WIDTH, ascii, lay_out, wrap_lines,
};
use serde_json::{Value, json};
use std::io::{ErrorKind, IsTerminal, Write};
use std::process::ExitCode;

/// Amount of printed text.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Level {
    /// Faults, and findings of severity error.
    Quiet,
    /// Lines that fit a terminal, and of findings with one code the first.
    Plain,
    /// Every row, every finding, and seconds by stage.
    Verbose,
}

/// Settings of the text that a command prints.
#[derive(Clone, Copy)]
pub(super) struct Reporter {
    level: Level,
    colour: bool,
    json: bool,
    room: Room,
}

impl Reporter {
    /// Returns the settings of printed text that the arguments request. Text has colours if stderr is a terminal and `NO_COLOR` is not set.
    pub fn from_arguments(common: &CommonArguments) -> Self {
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
            room: Room {
                width: width(),
                lines: (level != Level::Verbose).then_some(LINES),
                is_utf8: shows_utf8(
                    locale().as_deref(),
                    !cfg!(windows) || std::io::stdout().is_terminal(),
                ),
            },
        }
    }

    /// Returns whether only messages that decide the exit code are printed.
    pub fn is_quiet(self) -> bool {
        self.level == Level::Quiet
    }

    /// Prints an outcome: table, summary and next step on standard output, findings in between on standard error. If `result.json` is requested, only
    /// this text goes to standard output. Returns whether standard output could be written.
    pub fn outcome(self, console: &Console, texts: &Texts, json: &str) -> bool {
        let layout = match self.level {
            Level::Quiet => {
                let errors = texts
                    .findings
                    .iter()
                    .filter(|f| f.severity == Severity::Error);
                let errors: Vec<Finding> = errors.cloned().collect();
                let texts = Texts {
                    findings: &errors,
                    ..Texts::default()
                };
                lay_out(&Console::default(), &texts, &self.room)
            }
            _ => lay_out(console, texts, &self.room),
        };
        let [answer, next, paths] =
            [&layout.answer, &layout.next, &layout.paths].map(|lines| text_of(lines));
        let findings: String = layout
            .findings
            .iter()
            .map(|f| self.colour_finding(f))
            .collect();
        match (self.json, self.level) {
            (true, _) => {
                let printed = is_printed(json.as_bytes());
                write_to_stderr(&(findings + &paths));
                printed
            }
            (false, Level::Quiet) => {
                write_to_stderr(&findings);
                true
            }
            (false, _) => {
                let printed = is_printed(answer.as_bytes());
                write_to_stderr(&findings);
                printed && is_printed((next + &paths).as_bytes())
            }
        }
    }

    /// Lines of a finding, its severity in colour.
    fn colour_finding(self, f: &FindingLines) -> String {
        let text = text_of(&f.lines);
        match f.severity {
            Some(severity) if self.colour => {
                let word = severity.word();
                text.replacen(word, &format!("{}{word}\x1b[0m", colour(severity)), 1)
            }
            _ => text,
        }
    }

    /// Returns the columns of the terminal.
    pub fn width(self) -> usize {
        self.room.width
    }

    /// Prints lines on standard output.
    pub fn print_lines(self, lines: &[String]) -> ExitCode {
        print(self.printable_text(text_of(lines)).as_bytes())
    }

    /// Returns a text with the signs that standard output and standard error show.
    fn printable_text(self, text: String) -> String {
        match self.room.is_utf8 {
            true => text,
            false => ascii(&text),
        }
    }

    /// Prints a remark on standard error.
    pub fn note(self, text: &str) {
        if self.level != Level::Quiet {
            let text = text_of(&wrap_lines(text, self.room.width, 4));
            write_to_stderr(&self.printable_text(text));
        }
    }

    /// Prints the seconds of each stage, at the verbose level only.
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
        let time = format!("time: {}", list.join(", "));
        write_to_stderr(&text_of(&wrap_lines(&time, self.room.width, 4)));
    }

    /// Prints faults on standard error, and as JSON on standard output if JSON is requested.
    pub fn faults(self, faults: &[Fault]) {
        if self.json {
            let json = json!({ "faults": faults });
            print(format!("{json:#}\n").as_bytes());
        }
        self.fault_lines(faults);
    }

    /// Prints faults on standard error only.
    pub fn fault_lines(self, faults: &[Fault]) {
        let n = faults.len();
        let mut text = self.printable_text(faults.iter().map(|f| format!("{f}\n")).collect());
        let plural = if n == 1 { "" } else { "s" };
        let total = format!("{n} fault{plural} found");
        text.push_str(&match self.colour {
            true => format!("{}{total}\x1b[0m\n", colour(Severity::Error)),
            false => total + "\n",
        });
        write_to_stderr(&text);
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

/// Returns the columns of the terminal; [`WIDTH`] if standard output is not a terminal.
fn width() -> usize {
    /// Least width; a narrower terminal wraps lines automatically.
    const LEAST: usize = 40;
    let size = terminal_size::terminal_size_of(std::io::stdout());
    size.map_or(WIDTH, |(w, _)| usize::from(w.0).max(LEAST))
}

/// Returns the first of `LC_ALL`, `LC_CTYPE` and `LANG` that is set.
fn locale() -> Option<String> {
    let value = |name: &str| std::env::var(name).ok().filter(|v| !v.is_empty());
    ["LC_ALL", "LC_CTYPE", "LANG"].into_iter().find_map(value)
}

/// Returns whether printed text may contain UTF-8. A stated locale decides. Without one, `is_read_as_utf8` decides. It is false for a pipe or a file
/// on Windows, which other programs read in the code page of the console. The standard library writes Unicode to a Windows console.
fn shows_utf8(locale: Option<&str>, is_read_as_utf8: bool) -> bool {
    locale.map_or(is_read_as_utf8, |l| {
        let l = l.to_ascii_lowercase();
        l.contains("utf-8") || l.contains("utf8")
    })
}

/// Lines as text.
fn text_of(lines: &[String]) -> String {
    lines.iter().map(|l| format!("{l}\n")).collect()
}

fn write_to_stderr(text: &str) {
    // A closed pipe is not a fault of this program.
    let _ = std::io::stderr().write_all(text.as_bytes());
}

/// Prints to standard output.
pub(super) fn print(text: &[u8]) -> ExitCode {
    match is_printed(text) {
        true => ExitCode::SUCCESS,
        false => ExitCode::from(2),
    }
}

/// Prints a text on standard output and returns whether this succeeded; an error other than a closed pipe is reported.
fn is_printed(text: &[u8]) -> bool {
    let mut out = std::io::stdout().lock();
    match out.write_all(text).and_then(|()| out.flush()) {
        // A closed pipe (`| head`) is not a fault of this program.
        Err(e) if e.kind() != ErrorKind::BrokenPipe => {
            write_to_stderr(&format!(
                "standard output cannot be written ({e}): the printed text is incomplete\n"
            ));
            false
        }
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_locale_decides_whether_utf_8_is_printed_and_without_one_the_pipe_of_windows_does_not_have_it()
     {
        let (terminal, pipe_of_windows) = (true, false);
        for locale in ["C", "POSIX", "de_DE.ISO-8859-1", "German_Germany.1252"] {
            assert!(!shows_utf8(Some(locale), terminal), "{locale}");
        }
        for locale in ["de_DE.UTF-8", "C.utf8", "en_US.UTF8"] {
            assert!(shows_utf8(Some(locale), pipe_of_windows), "{locale}");
        }
        assert!(shows_utf8(None, terminal));
        assert!(!shows_utf8(None, pipe_of_windows));
    }
}
