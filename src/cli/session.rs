//! What one run of a command carries: options, inputs, stages with their times, findings, and what goes into `result.json`.

use super::CommonArguments;
use super::fault::{Fault, Faults};
use super::files::{Input, Inputs};
use super::output::Output;
use super::progress::{Meter, Progress};
use super::words::finding_text;
use crate::finding::{Finding, Severity, worst};
use crate::units::{ReportUnits, UnitSystem};
use serde::Serialize;
use serde_json::{Map, Value};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::time::Instant;

/// Bytes of stack of a working thread, what a main thread has on most systems.
const STACK: usize = 8 << 20;

/// One run of a command.
pub struct Session {
    pub(super) command: &'static str,
    common: CommonArguments,
    /// Files read so far.
    pub inputs: Inputs,
    /// What the stages had to say.
    pub findings: Vec<Finding>,
    faults: Faults,
    pub(super) units: Value,
    body: Map<String, Value>,
    seconds: Map<String, Value>,
    pub(super) output: Option<Output>,
    /// The page to be drawn on paper.
    #[cfg(feature = "pdf")]
    pub(super) paper: Option<crate::report::page::Page>,
    text: String,
    notes: Vec<String>,
    meter: Arc<Meter>,
}

/// `result.json`.
#[derive(Serialize)]
struct ResultFile<'a> {
    command: &'a str,
    version: &'a str,
    units: &'a Value,
    inputs: &'a [Input],
    findings: &'a [Finding],
    #[serde(flatten)]
    body: &'a Map<String, Value>,
    seconds: &'a Map<String, Value>,
}

/// What a closed session leaves.
struct Closed {
    json: String,
    text: String,
    findings: Vec<Finding>,
    folder: Option<PathBuf>,
    faults: Faults,
}

/// A command that ran as a step of another.
pub struct Step {
    /// Its name.
    pub command: &'static str,
    /// Its part of `result.json`.
    pub result: Value,
    /// What it had to say.
    pub findings: Vec<Finding>,
    /// Its words for standard output.
    pub text: String,
    /// How long it took.
    pub seconds: f64,
}

impl Session {
    /// Runs a command and reports: text or `result.json` on standard output, findings and faults on standard error.
    pub fn run(
        command: &'static str,
        common: &CommonArguments,
        work: impl FnOnce(&mut Session) -> Result<(), Faults> + Send,
    ) -> ExitCode {
        let mut session = Session::new(command, common);
        let start = Instant::now();
        // Work begins on a thread of the pool: from outside, each of a factorisation's many small parallel steps would wake two threads
        // and put one to sleep. 0 threads: as many as the machine has.
        let done = match rayon::ThreadPoolBuilder::new()
            .num_threads(common.threads.map_or(0, |n| n.max(1)))
            .stack_size(STACK)
            .build()
        {
            Ok(pool) => pool.install(|| work(&mut session)),
            Err(e) => Err(vec![Fault::of(
                "--threads",
                "threads",
                e.to_string(),
                "ask for fewer threads",
            )]),
        };
        #[cfg(feature = "pdf")]
        let done = done.and_then(|()| session.write_paper());
        session.note_seconds("total", start);
        match done.and_then(|()| session.finish()) {
            Ok(code) => code,
            Err(faults) => {
                print_faults(&faults);
                let _ = std::io::stderr().write_all(b"nothing was written\n");
                ExitCode::from(2)
            }
        }
    }

    fn new(command: &'static str, common: &CommonArguments) -> Self {
        Session {
            command,
            common: common.clone(),
            inputs: Inputs::default(),
            findings: Vec::new(),
            faults: Vec::new(),
            units: Value::Null,
            body: Map::new(),
            seconds: Map::new(),
            output: None,
            #[cfg(feature = "pdf")]
            paper: None,
            text: String::new(),
            notes: Vec::new(),
            meter: Arc::default(),
        }
    }

    /// Runs a command as a step of this one, on the same threads: its files go to `out`, its words and findings come back unprinted.
    ///
    /// # Errors
    /// The faults that the command alone would have listed.
    pub fn step(
        &mut self,
        command: &'static str,
        out: &Path,
        work: impl FnOnce(&mut Session) -> Result<(), Faults>,
    ) -> Result<Step, Faults> {
        let common = CommonArguments {
            out: Some(out.to_owned()),
            ..CommonArguments::default()
        };
        let mut session = Session::new(command, &common);
        let start = Instant::now();
        let progress = Progress::start(command, &self.meter);
        work(&mut session)?;
        #[cfg(feature = "pdf")]
        session.write_paper()?;
        drop(progress);
        session.note_seconds("total", start);
        self.note_seconds(command, start);
        let result = Value::Object(session.body.clone());
        let findings = session.findings.clone();
        session.close().map(|closed| Step {
            command,
            result,
            findings,
            text: closed.text,
            seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// Runs a stage: timed under its name, with a progress line on a terminal where it takes over a second.
    pub fn stage<T>(&mut self, name: &str, work: impl FnOnce(&mut Session) -> T) -> T {
        let start = Instant::now();
        self.meter.begin(0);
        let progress = Progress::start(name, &self.meter);
        let out = work(self);
        drop(progress);
        self.note_seconds(name, start);
        out
    }

    /// What the progress line of the present stage shows; to be told how many parts it has.
    pub fn meter(&self) -> Arc<Meter> {
        Arc::clone(&self.meter)
    }

    fn note_seconds(&mut self, name: &str, start: Instant) {
        self.note_step(name, start.elapsed().as_secs_f64());
    }

    /// Adds seconds under a name of its own, for the steps of a stage.
    pub fn note_step(&mut self, name: &str, seconds: f64) {
        let before = self
            .seconds
            .get(name)
            .and_then(Value::as_f64)
            .unwrap_or(0.0);
        let s = before + seconds;
        self.seconds
            .insert(name.to_owned(), Value::from((s * 1e6).round() / 1e6));
    }

    /// Puts a key into `result.json`.
    ///
    /// # Errors
    /// A fault where the value has no JSON form, which is a mistake of the program.
    pub fn put(&mut self, key: &str, value: impl Serialize) -> Result<(), Faults> {
        let value = serde_json::to_value(value).map_err(|e| {
            vec![Fault::of(
                "result.json",
                key,
                e.to_string(),
                "report this as an error of the program",
            )]
        })?;
        self.body.insert(key.to_owned(), value);
        Ok(())
    }

    /// Notes faults of the input that leave an answer all the same (`check`): they are listed, and the exit code is 2.
    pub fn put_faults(&mut self, faults: Faults) {
        self.faults.extend(faults);
    }

    /// States the units of the answer.
    pub fn put_units(&mut self, system: UnitSystem, report: &ReportUnits) {
        self.units = serde_json::json!({
            "system": system.name(),
            "force": report.force.name,
            "moment": report.moment.name,
            "length": report.length.name,
            "mass": report.mass.name,
            "stress": report.stress.name,
            "strain": "microstrain",
        });
    }

    /// Adds lines to the text that the user reads on standard output (nothing of it with `--json`).
    pub fn say(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
    }

    /// Adds a line for standard error that is no part of the answer.
    pub fn note(&mut self, line: impl Into<String>) {
        self.notes.push(line.into());
    }

    /// Whether solutions of the built-in solver are kept beside their inputs.
    pub fn keeps_solutions(&self) -> bool {
        !self.common.no_cache
    }

    /// The output folder: `--out`, else `<name of the file>.out` in the current folder's reach beside the file.
    ///
    /// # Errors
    /// A fault where it can't be created.
    pub fn output_for(&mut self, main_input: &Path) -> Result<&mut Output, Faults> {
        let folder = self
            .common
            .out
            .clone()
            .unwrap_or_else(|| default_folder(main_input));
        self.open(&folder)
    }

    /// The output folder where `--out` names one, `None` otherwise (`check`).
    ///
    /// # Errors
    /// A fault where it can't be created.
    pub fn output_if_asked(&mut self) -> Result<Option<&mut Output>, Faults> {
        match self.common.out.clone() {
            Some(folder) => self.open(&folder).map(Some),
            None => Ok(None),
        }
    }

    /// The output folder, named by the command itself.
    ///
    /// # Errors
    /// A fault where it can't be created.
    pub fn output_at(&mut self, folder: &Path) -> Result<&mut Output, Faults> {
        self.open(folder)
    }

    fn open(&mut self, folder: &Path) -> Result<&mut Output, Faults> {
        if self.output.is_none() {
            self.output = Some(Output::begin(folder).map_err(|f| vec![f])?);
        }
        self.output.as_mut().ok_or_else(Vec::new)
    }

    /// Writes and commits the files.
    fn close(mut self) -> Result<Closed, Faults> {
        if self.command == "check" {
            let lines: Vec<String> = self.faults.iter().map(Fault::to_string).collect();
            self.put("faults", lines)?;
        }
        let inputs = self.inputs.list();
        let mut findings = self.findings;
        // The worst first; the order of stages within a severity.
        findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
        let result = ResultFile {
            command: self.command,
            version: env!("CARGO_PKG_VERSION"),
            units: &self.units,
            inputs: &inputs,
            findings: &findings,
            body: &self.body,
            seconds: &self.seconds,
        };
        let mut json = serde_json::to_string_pretty(&result).map_err(|e| {
            vec![Fault::of(
                "result.json",
                "result",
                e.to_string(),
                "report this as an error of the program",
            )]
        })?;
        json.push('\n');
        let mut folder = None;
        if let Some(mut output) = self.output {
            output
                .write_bytes("result.json", json.as_bytes())
                .map_err(|f| vec![f])?;
            folder = Some(output.folder().to_owned());
            output.commit().map_err(|f| vec![f])?;
        }
        Ok(Closed {
            json,
            text: self.text,
            findings,
            folder,
            faults: self.faults,
        })
    }

    /// Closes and prints.
    fn finish(self) -> Result<ExitCode, Faults> {
        let as_json = self.common.json;
        let own = self.notes.clone();
        let Closed {
            json,
            text,
            findings,
            folder,
            faults,
        } = self.close()?;
        let text = if as_json { json } else { text };
        // A closed pipe (`| head`) is no fault of ours.
        let _ = std::io::stdout().write_all(text.as_bytes());
        let mut notes = String::new();
        findings
            .iter()
            .for_each(|f| notes.push_str(&(finding_text(f) + "\n")));
        for note in &own {
            notes.push_str(&format!("note: {note}\n"));
        }
        if let Some(folder) = folder {
            notes.push_str(&format!("written to `{}`\n", folder.display()));
        }
        let _ = std::io::stderr().write_all(notes.as_bytes());
        if !faults.is_empty() {
            print_faults(&faults);
            return Ok(ExitCode::from(2));
        }
        Ok(if worst(&findings) == Some(Severity::Error) {
            ExitCode::from(1)
        } else {
            ExitCode::SUCCESS
        })
    }
}

/// `<stem>.out` beside the file.
fn default_folder(main_input: &Path) -> PathBuf {
    let mut name = main_input
        .file_stem()
        .map(|s| s.to_owned())
        .unwrap_or_else(|| "strainbridge".into());
    name.push(".out");
    main_input.with_file_name(name)
}

fn print_faults(faults: &Faults) {
    let mut text: String = faults.iter().map(|f| format!("{f}\n")).collect();
    let n = faults.len();
    text.push_str(&format!(
        "{n} fault{} found\n",
        if n == 1 { "" } else { "s" }
    ));
    let _ = std::io::stderr().write_all(text.as_bytes());
}
