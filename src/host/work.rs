//! State of a command in progress: files read, findings, seconds of its stages, notes.

use crate::finding::Finding;
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::file_read::FileRead;
use crate::host::files::Inputs;
use crate::host::outcome::{Findings, Outcome, Seconds, StatedUnits};
use std::path::PathBuf;
use std::time::Instant;

/// A command in progress, with the data of its outcome.
pub struct Work<'a> {
    /// Context of the command.
    pub cx: Context<'a>,
    /// Files read so far.
    pub inputs: Inputs<'a>,
    /// Findings of the stages.
    pub findings: Vec<Finding>,
    /// Notes about the computation that are not part of the answer.
    pub notes: Vec<String>,
    /// Files that were read and are not listed among the inputs.
    pub sources: Vec<PathBuf>,
    seconds: Seconds,
    began: Instant,
}

impl<'a> Work<'a> {
    /// Begins a command on the files of a context.
    pub fn new(cx: &Context<'a>) -> Self {
        Self {
            cx: cx.clone(),
            inputs: Inputs::new(cx.files),
            findings: Vec::new(),
            notes: Vec::new(),
            sources: Vec::new(),
            seconds: Seconds::default(),
            began: Instant::now(),
        }
    }

    /// Runs a stage, records its time under its name, and reports its begin and end as progress.
    pub fn stage<T>(&mut self, name: &str, work: impl FnOnce(&mut Self) -> T) -> T {
        let start = Instant::now();
        self.cx.progress.begin(name);
        let out = work(self);
        self.cx.progress.end();
        self.note_seconds(name, start.elapsed().as_secs_f64());
        out
    }

    /// Adds seconds under a separate name, for the steps of a stage.
    pub fn note_seconds(&mut self, name: &str, seconds: f64) {
        self.seconds.add(name, seconds);
    }

    /// Checks that the command was not cancelled.
    ///
    /// # Errors
    /// One fault if the receiver of the progress cancelled the command.
    pub fn go_on(&self) -> Result<(), Faults> {
        if self.cx.progress.is_cancelled() {
            return Err(cancelled_fault().into());
        }
        Ok(())
    }

    /// Returns the files, findings and notes so far, from which later commands on the same data resume.
    pub fn into_beginning(mut self) -> Beginning {
        Beginning {
            read: self.inputs.files_read(),
            findings: self.findings,
            notes: self.notes,
            sources: self.sources,
        }
    }

    /// Resumes a command on a job after a beginning that was made for it or for a job with the same data.
    pub fn resume(cx: &Context<'a>, read: &[FileRead], beginning: &Beginning) -> Self {
        let is_new = |f: &&FileRead| !read.iter().any(|r| r.path == f.path);
        let others = beginning.read.iter().filter(is_new);
        let all: Vec<FileRead> = read.iter().chain(others).cloned().collect();
        let mut work = Self::new(cx);
        work.inputs = Inputs::resume(cx.files, &all);
        work.findings.clone_from(&beginning.findings);
        work.notes.clone_from(&beginning.notes);
        work.sources.clone_from(&beginning.sources);
        work
    }

    /// Returns the outcome: the answer with everything that was collected.
    pub fn finish<A>(mut self, units: StatedUnits, answer: A) -> Outcome<A> {
        self.note_seconds("total", self.began.elapsed().as_secs_f64());
        self.findings.extend(self.inputs.findings());
        // The worst findings are first. Within a severity they keep the order of the stages.
        self.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
        Outcome {
            units,
            sources: self
                .inputs
                .paths()
                .into_iter()
                .chain(self.sources)
                .collect(),
            inputs: self.inputs.list(),
            findings: Findings(self.findings),
            seconds: self.seconds,
            notes: self.notes,
            answer,
        }
    }
}

/// Files, findings and notes of the first part of a command.
pub struct Beginning {
    /// Files that were read.
    pub read: Vec<FileRead>,
    findings: Vec<Finding>,
    notes: Vec<String>,
    sources: Vec<PathBuf>,
}

/// Returns the fault of a command that the receiver of progress stopped.
pub fn cancelled_fault() -> Fault {
    Fault::new("work", "progress", "stopped", "ask again")
}
