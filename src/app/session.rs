//! What commands that are not yet questions with an outcome carry: a [`Work`] with output folder, words and the body of `result.json`.

use super::context::Context;
use super::fault::{Fault, FaultList, Faults};
use super::outcome::{Findings, Outcome, StatedUnits, Tables};
use super::output::Output;
use super::store::SolutionStore;
use super::strain::Conditioning;
use super::work::Work;
use crate::sensitivity::{Sensitivity, check_separability};
use crate::units::{ReportUnits, UnitSystem};
use serde::Serialize;
use serde_json::{Map, Value};
use std::path::{Path, PathBuf};

/// What a command was asked.
#[derive(Clone, Debug, Default)]
pub struct CommonArguments {
    /// Output folder.
    pub out: Option<PathBuf>,
}

/// A command on a job.
#[derive(Clone, Debug, Default)]
pub struct JobArguments {
    /// The job.
    pub job: PathBuf,
    /// What every command is asked.
    pub common: CommonArguments,
}

/// A command on files.
#[derive(Clone, Debug, Default)]
pub struct FilesArguments {
    /// Decks, results, jobs.
    pub files: Vec<PathBuf>,
    /// What every command is asked.
    pub common: CommonArguments,
}

/// A command on a deck and its results.
#[derive(Clone, Debug, Default)]
pub struct DeckArguments {
    /// The deck.
    pub deck: PathBuf,
    /// Result files.
    pub results: Vec<PathBuf>,
    /// What every command is asked.
    pub common: CommonArguments,
}

/// One run of a command.
pub struct Session<'a> {
    pub(super) command: &'static str,
    common: CommonArguments,
    work: Work<'a>,
    faults: FaultList,
    pub(super) units: StatedUnits,
    body: Map<String, Value>,
    pub(super) output: Option<Output>,
    /// The page to be drawn on paper.
    #[cfg(feature = "pdf")]
    pub(super) paper: Option<crate::report::page::Page>,
    text: String,
}

impl<'a> std::ops::Deref for Session<'a> {
    type Target = Work<'a>;
    fn deref(&self) -> &Work<'a> {
        &self.work
    }
}

impl std::ops::DerefMut for Session<'_> {
    fn deref_mut(&mut self) -> &mut Self::Target {
        &mut self.work
    }
}

/// What a closed session leaves.
pub struct Closed {
    /// `result.json`.
    pub json: String,
    /// Words for standard output.
    pub text: String,
    /// What the stages had to say.
    pub findings: Findings,
    /// Lines for standard error that are no part of the answer.
    pub notes: Vec<String>,
    /// Where the files went.
    pub folder: Option<PathBuf>,
    /// Faults of the input that left an answer all the same.
    pub faults: FaultList,
    /// The body of `result.json`.
    pub result: Value,
    /// How long it took.
    pub seconds: f64,
}

impl<'a> Session<'a> {
    /// Runs a command in a context; its files are complete afterwards.
    ///
    /// # Errors
    /// Bad input; nothing was written.
    pub fn run(
        command: &'static str,
        common: &CommonArguments,
        cx: &Context<'a>,
        work: impl FnOnce(&mut Session<'a>) -> Result<(), Faults>,
    ) -> Result<Closed, Faults> {
        let mut session = Session {
            command,
            common: common.clone(),
            work: Work::new(cx),
            faults: Vec::new(),
            units: StatedUnits::default(),
            body: Map::new(),
            output: None,
            #[cfg(feature = "pdf")]
            paper: None,
            text: String::new(),
        };
        work(&mut session)?;
        #[cfg(feature = "pdf")]
        session.write_paper()?;
        session.close()
    }

    /// Runs a stage: timed under its name, told to whoever hears of progress.
    pub fn stage<T>(&mut self, name: &str, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = std::time::Instant::now();
        self.cx.progress.begin(name);
        let out = work(self);
        self.cx.progress.end();
        self.note_seconds(name, start.elapsed().as_secs_f64());
        out
    }

    /// Where solutions of the built-in solver are kept.
    pub fn store(&self) -> Option<&'a dyn SolutionStore> {
        self.cx.store
    }

    /// Rank, condition numbers and findings on separability, put into the result.
    ///
    /// # Errors
    /// Mistakes of the program only.
    pub fn put_conditioning(&mut self, s: &Sensitivity) -> Result<(), Faults> {
        let c = Conditioning::of(s);
        self.put("rank", c.rank)?;
        self.put("condition_number", c.condition_number)?;
        self.put("condition_number_scaled", c.condition_number_scaled)?;
        self.findings.extend(check_separability(s));
        Ok(())
    }

    /// Puts a key into `result.json`.
    ///
    /// # Errors
    /// A fault where the value has no JSON form, which is a mistake of the program.
    pub fn put(&mut self, key: &str, value: impl Serialize) -> Result<(), Faults> {
        let value = serde_json::to_value(value).map_err(|e| {
            Faults::from(Fault::of(
                "result.json",
                key,
                e.to_string(),
                "report this as an error of the program",
            ))
        })?;
        self.body.insert(key.to_owned(), value);
        Ok(())
    }

    /// Notes faults of the input that leave an answer all the same (`check`): they are listed, and the exit code is 2.
    pub fn put_faults(&mut self, faults: FaultList) {
        self.faults.extend(faults);
    }

    /// States the units of the answer.
    pub fn put_units(&mut self, system: UnitSystem, report: &ReportUnits) {
        self.units = StatedUnits::of(system, report);
    }

    /// Adds lines to the text that the user reads on standard output (nothing of it with `--json`).
    pub fn say(&mut self, line: impl AsRef<str>) {
        self.text.push_str(line.as_ref());
        self.text.push('\n');
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
        let output = match self.output.take() {
            Some(output) => output,
            None => Output::begin(folder)?,
        };
        Ok(self.output.insert(output))
    }

    /// Writes and commits the files.
    fn close(self) -> Result<Closed, Faults> {
        let body = Body(self.command, Value::Object(self.body));
        let outcome = self.work.finish(self.units, body);
        let none = Tables::new();
        let tables = self.output.as_ref().map_or(&none, Output::tables);
        let json = outcome.to_json_of(outcome.answer.0, tables);
        let json = json.map_err(|e| {
            Fault::of(
                "result.json",
                "result",
                e.to_string(),
                "report this as an error of the program",
            )
        })?;
        let mut folder = None;
        if let Some(mut output) = self.output {
            output.write_bytes("result.json", json.as_bytes())?;
            folder = Some(output.folder().to_owned());
            output.commit(self.command)?;
        }
        let Outcome {
            findings,
            notes,
            answer,
            seconds,
            ..
        } = outcome;
        Ok(Closed {
            json,
            text: self.text,
            findings,
            notes,
            folder,
            faults: self.faults,
            result: answer.1,
            seconds: seconds.total(),
        })
    }
}

/// The body of `result.json` by key.
struct Body(&'static str, Value);

impl Serialize for Body {
    fn serialize<S: serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        self.1.serialize(s)
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
