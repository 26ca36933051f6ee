//! One run of a command: context, threads, printed texts, exit code.

use super::progress::Terminal;
use super::reporter::Reporter;
use super::{CommonArguments, InitArguments};
use crate::finding::Severity;
use crate::host::context::{Context, Disk};
use crate::host::fault::{Fault, Faults};
use crate::host::other_results::INDEX;
use crate::host::outcome::{Answer, Outcome};
use crate::host::output::{Output, left_by_others};
use crate::host::store::Folder;
use crate::job::Job;
use crate::report::command::{
    RecordFolder, Report, check_folder, console_of, finish, result_text, save,
};
use crate::report::console::Texts;
use crate::workflow::check::{CheckedFiles, check};
use crate::workflow::init::{init, init_for};
use crate::workflow::recover::{RecoveredLoads, recover_into};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Bytes of stack of a working thread, the size for a main thread on most systems.
const STACK: usize = 8 << 20;

/// A command's surroundings.
pub(super) struct Run {
    common: CommonArguments,
    store: Option<Folder>,
}

impl Run {
    /// A command on this file.
    pub fn from_arguments(common: &CommonArguments, _main_input: &Path) -> Self {
        Self {
            common: common.clone(),
            store: (!common.no_cache).then(Folder::of_user),
        }
    }

    /// Returns the folder stated by `--out`. Without `--out` it is `<job name>.out` next to the job.
    pub fn folder(&self, path: &Path) -> PathBuf {
        let asked = self.common.out.clone();
        asked.unwrap_or_else(|| default_folder(path))
    }

    /// Runs `ask` on a job and writes the outcome to `--out`, or to `<job name>.out` next to the job.
    pub fn job<A>(
        &self,
        path: &Path,
        ask: impl FnOnce(&Job, &Context) -> Result<Outcome<A>, Faults> + Send,
    ) -> ExitCode
    where
        A: Answer + Send,
        Outcome<A>: Report,
    {
        self.job_into(path, &self.folder(path), ask)
    }

    /// Runs a computation on a job and writes the outcome into `folder`.
    pub fn job_into<A>(
        &self,
        path: &Path,
        folder: &Path,
        ask: impl FnOnce(&Job, &Context) -> Result<Outcome<A>, Faults> + Send,
    ) -> ExitCode
    where
        A: Answer + Send,
        Outcome<A>: Report,
    {
        self.ask_into(folder, |cx| ask(&Job::read(path, cx.files)?, cx))
    }

    /// Runs `ask` on files and writes the outcome to `--out`, or to `<name>.out` next to the first file.
    pub fn files<A>(
        &self,
        first: &Path,
        ask: impl FnOnce(&Context) -> Result<Outcome<A>, Faults> + Send,
    ) -> ExitCode
    where
        A: Answer + Send,
        Outcome<A>: Report,
    {
        self.ask_into(&self.folder(first), ask)
    }

    /// Runs a computation and writes the outcome into `folder`.
    pub fn ask_into<A>(
        &self,
        folder: &Path,
        ask: impl FnOnce(&Context) -> Result<Outcome<A>, Faults> + Send,
    ) -> ExitCode
    where
        A: Answer + Send,
        Outcome<A>: Report,
    {
        let done = self.run_in_pool(|cx| {
            check_folder::<A>(folder)?;
            let outcome = ask(cx)?;
            let json = save(&outcome, folder)?;
            Ok((outcome, json))
        });
        self.print(done, Some(folder))
    }

    /// Recovers the loads of a job and writes them to `--out`, or to `<job name>.out` next to the job. Loads of a record are written during the
    /// computation.
    pub fn recover(&self, path: &Path) -> ExitCode {
        let folder = self.folder(path);
        let done = self.run_in_pool(|cx| {
            check_folder::<RecoveredLoads>(&folder)?;
            recover_and_save(&Job::read(path, cx.files)?, cx, &folder)
        });
        self.print(done, Some(&folder))
    }

    /// Checks files. The answer contains the faults of the files. Files are written only with `--out`.
    pub fn check(&self, files: &[PathBuf]) -> ExitCode {
        let folder = self.common.out.as_deref();
        let done = self.run_in_pool(|cx| {
            folder.map_or(Ok(()), check_folder::<CheckedFiles>)?;
            let outcome = check(files, cx)?;
            let json = match folder {
                Some(folder) => save(&outcome, folder)?,
                None => result_text(&outcome)?,
            };
            Ok((outcome, json))
        });
        self.print(done, folder)
    }

    /// Writes a job from files: alone into the current folder, with `result.json` into `--out`.
    pub fn init(&self, a: &InitArguments) -> ExitCode {
        let folder = self.common.out.clone();
        let into = folder.clone().unwrap_or_else(|| PathBuf::from("."));
        let done = self.run_in_pool(|cx| {
            let (deck, results) = (a.deck.as_deref(), &a.results);
            let outcome = match a.purpose {
                Some(purpose) => init_for(purpose, deck, results, &into, cx)?,
                None => init(a.main(), results, &into, cx)?,
            };
            let json = match folder {
                Some(_) => save(&outcome, &into)?,
                None => {
                    let mut out = Output::begin(&into)?;
                    out.write_bytes(outcome.job, outcome.text.as_bytes())?;
                    out.check_spared(&outcome.sources)?;
                    out.rename_all()?;
                    result_text(&outcome)?
                }
            };
            Ok((outcome, json))
        });
        self.print(done, self.common.out.as_deref())
    }

    /// Runs a question that writes only into `--out`, if that names a folder.
    pub fn question<A>(
        &self,
        out: Option<&Path>,
        ask: impl FnOnce(&Context) -> Result<Outcome<A>, Faults> + Send,
    ) -> ExitCode
    where
        A: Answer + Send,
        Outcome<A>: Report,
    {
        let done = self.run_in_pool(|cx| {
            out.map_or(Ok(()), check_folder::<A>)?;
            let outcome = ask(cx)?;
            let json = match out {
                Some(folder) => save(&outcome, folder)?,
                None => result_text(&outcome)?,
            };
            Ok((outcome, json))
        });
        self.print(done, out)
    }

    /// Runs work on the requested number of threads. It begins on a thread of the pool. From outside, each of a factorisation's many small parallel
    /// steps would wake two threads and put one to sleep.
    fn run_in_pool<T: Send>(
        &self,
        work: impl FnOnce(&Context) -> Result<T, Faults> + Send,
    ) -> Result<T, Faults> {
        let terminal = Terminal::default();
        let pool = thread_pool(&self.common)?;
        let mut cx = Context::new(&Disk);
        if !Reporter::from_arguments(&self.common).is_quiet() {
            cx = cx.progress(&terminal);
        }
        if let Some(folder) = &self.store {
            cx = cx.store(folder);
        }
        pool.install(|| work(&cx))
    }

    /// Prints an outcome whose files are in `folder`, or its faults.
    fn print<A: Answer>(
        &self,
        done: Result<(Outcome<A>, String), Faults>,
        folder: Option<&Path>,
    ) -> ExitCode
    where
        Outcome<A>: Report,
    {
        let (outcome, json) = match done {
            Ok(done) => done,
            Err(faults) => return refuse(&faults, &self.common),
        };
        let console = console_of(&outcome);
        let others = folder.and_then(|f| left_by_others(f, A::COMMAND));
        let notes = outcome.notes.iter().cloned().chain(others.clone());
        let notes: Vec<String> = notes.collect();
        let index = others.is_some().then_some(INDEX);
        let files = ["report.html"].into_iter().chain(console.file).chain(index);
        let paths = files.filter_map(|file| {
            let path = folder?.join(file);
            path.is_file().then(|| path.display().to_string())
        });
        let paths: Vec<String> = paths.collect();
        let faults = outcome.answer.faults();
        let summary = outcome.summary();
        let texts = Texts {
            // Faults and their summary go to standard error.
            summary: if faults.is_empty() {
                summary.as_str()
            } else {
                ""
            },
            findings: &outcome.findings,
            notes: &notes,
            paths: &paths,
        };
        let reporter = Reporter::from_arguments(&self.common);
        let is_printed = reporter.outcome(&console, &texts, &json);
        reporter.seconds(&outcome.seconds);
        if !faults.is_empty() {
            reporter.fault_lines(faults);
            reporter.note(&summary);
            return ExitCode::from(2);
        }
        match outcome.findings.worst_severity() {
            _ if !is_printed => ExitCode::from(2),
            Some(Severity::Error) => ExitCode::from(1),
            _ => ExitCode::SUCCESS,
        }
    }
}

/// Returns the requested number of threads.
///
/// # Errors
/// Threads that the system refuses.
pub(super) fn thread_pool(common: &CommonArguments) -> Result<rayon::ThreadPool, Fault> {
    // 0 threads: as many as the machine has.
    rayon::ThreadPoolBuilder::new()
        .num_threads(common.threads.map_or(0, |n| n.max(1)))
        .stack_size(STACK)
        .build()
        .map_err(|e| {
            let remedy = "ask for fewer threads";
            Fault::new("--threads", "threads", e.to_string(), remedy)
        })
}

/// Recovers the loads of a job into a folder. Returns the outcome and the text of `result.json`.
///
/// # Errors
/// Every fault of the job, a file that cannot be written.
pub(super) fn recover_and_save(
    job: &Job,
    cx: &Context,
    folder: &Path,
) -> Result<(Outcome<RecoveredLoads>, String), Faults> {
    let mut sink = RecordFolder::new(folder);
    let outcome = recover_into(job, cx, &mut sink)?;
    let mut out = sink.into_output()?;
    outcome.write(&mut out)?;
    let json = finish(&outcome, out)?;
    Ok((outcome, json))
}

/// Returns `<stem>.out` next to the file.
fn default_folder(main_input: &Path) -> PathBuf {
    let stem = main_input.file_stem();
    let mut name = stem.map_or_else(|| "strainbridge".into(), |s| s.to_owned());
    name.push(".out");
    main_input.with_file_name(name)
}

/// Prints faults and the note that nothing was written; returns exit code 2.
pub(super) fn refuse(faults: &Faults, common: &CommonArguments) -> ExitCode {
    let reporter = Reporter::from_arguments(common);
    reporter.faults(faults);
    reporter.note("nothing was written");
    ExitCode::from(2)
}
