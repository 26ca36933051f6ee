//! Every command that takes a job or files, by its name.

use crate::fault::{argument_fault, raise};
use crate::files::Desk;
use crate::job::CheckedJob;
use crate::outcome::{
    AnyOutcome, keep, keep_calibrated, keep_layout, keep_loads, keep_sensitivity,
};
use crate::work::{Asked, run};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use strainbridge::fe::{HeatedStrain, SolveOptions};
use strainbridge::host::store::Folder;
use strainbridge::workflow::fleet::{FleetSpec, name::Shard};
use strainbridge::workflow::verify;
use strainbridge::{Context, Faults, Job};

/// Command that takes only a job.
type OnJob = fn(&Job, &Context) -> Result<AnyOutcome, Faults>;

/// Commands that take only a job, with the function of the library.
const ON_JOB: [(&str, OnJob); 12] = [
    ("ballast", |j, cx| keep(strainbridge::ballast(j, cx)?)),
    ("calibrate", |j, cx| {
        keep_calibrated(strainbridge::calibrate(j, cx)?)
    }),
    ("cases", |j, cx| keep(strainbridge::cases(j, cx)?)),
    ("identify", |j, cx| keep(strainbridge::identify(j, cx)?)),
    ("payload", |j, cx| keep(strainbridge::payload(j, cx)?)),
    ("place", |j, cx| keep_layout(strainbridge::place(j, cx)?)),
    ("reconcile", |j, cx| keep(strainbridge::reconcile(j, cx)?)),
    ("recover", |j, cx| keep_loads(strainbridge::recover(j, cx)?)),
    ("respond", |j, cx| keep(strainbridge::respond(j, cx)?)),
    ("sensitivity", |j, cx| {
        keep_sensitivity(strainbridge::sensitivity(j, cx)?)
    }),
    ("simulate", |j, cx| keep(strainbridge::simulate(j, cx)?)),
    ("study", |j, cx| keep(strainbridge::study(j, cx)?)),
];

/// Commands with arguments in addition to a job, or with files instead.
const WITH_MORE: [&str; 7] = [
    "check", "fleet", "init", "modes", "solve", "strains", "verify",
];

/// Arguments of a command in addition to its job.
struct More {
    files: Vec<PathBuf>,
    folder: PathBuf,
    modes: usize,
    heated: HeatedStrain,
    shard: Option<Shard>,
    digests: BTreeMap<String, String>,
}

/// Returns the names of the commands that [`ask`] accepts.
#[pyfunction]
pub(crate) fn commands() -> Vec<&'static str> {
    let on_job = ON_JOB.iter().map(|c| c.0);
    let mut names: Vec<&str> = on_job.chain(WITH_MORE).collect();
    names.sort_unstable();
    names
}

/// Returns the JSON schema of a job.
#[pyfunction]
pub(crate) fn schema() -> String {
    strainbridge::job::schema::job_schema()
}

/// Runs a command and returns its outcome.
#[pyfunction]
#[pyo3(signature = (command, job=None, *, files=Vec::new(), folder=PathBuf::new(), modes=0, total_strain=false, shard=None, digests=BTreeMap::new(), threads=None, cache=true, progress=None))]
pub(crate) fn ask(
    py: Python,
    command: &str,
    job: Option<&Bound<CheckedJob>>,
    files: Vec<PathBuf>,
    folder: PathBuf,
    modes: usize,
    total_strain: bool,
    shard: Option<&str>,
    digests: BTreeMap<String, String>,
    threads: Option<usize>,
    cache: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<AnyOutcome> {
    let shard = shard.map(|text| shard_of(py, text)).transpose()?;
    let more = More {
        files,
        folder,
        modes,
        heated: match total_strain {
            true => HeatedStrain::Total,
            false => HeatedStrain::Mechanical,
        },
        shard,
        digests,
    };
    let (none, job) = (Desk::default(), job.map(Bound::get));
    let store = cache.then(Folder::of_user);
    let asked = Asked { threads, progress };
    let done = run(py, &asked, |heard| {
        let mut cx = Context::new(job.map_or(&none, |j| &j.desk)).progress(heard);
        if let Some(folder) = &store {
            cx = cx.store(folder);
        }
        answer(command, job.map(|j| &j.job), &more, &cx)
    })?;
    done.map_err(|f| raise(py, f))
}

fn shard_of(py: Python, text: &str) -> PyResult<Shard> {
    Shard::parse(text).ok_or_else(|| {
        let said = format!("`{text}` is not a part such as 3/64");
        raise(
            py,
            argument_fault("fleet", "shard", &said, "write it as 3/64").into(),
        )
    })
}

fn answer(
    command: &str,
    job: Option<&Job>,
    more: &More,
    cx: &Context,
) -> Result<AnyOutcome, Faults> {
    let none = PathBuf::new();
    let first: &Path = more.files.first().unwrap_or(&none);
    let rest = more.files.get(1..).unwrap_or_default();
    let options = SolveOptions {
        modes: more.modes,
        heated: more.heated,
        ..SolveOptions::default()
    };
    match (command, job) {
        ("check", _) => keep(strainbridge::check(&more.files, cx)?),
        ("init", _) => keep(strainbridge::init(first, rest, &more.folder, cx)?),
        ("verify", _) => keep(strainbridge::verify(
            first,
            |_, _| Ok(more.folder.clone()),
            cx,
        )?),
        ("strains", _) => keep(strainbridge::strains(first, rest, cx)?),
        ("modes", Some(job)) => keep(strainbridge::modes(job, more.modes, cx)?),
        ("modes", None) => keep(strainbridge::modes_of_deck(first, more.modes, cx)?),
        ("solve", Some(job)) => keep(strainbridge::solve(job, options, cx)?),
        ("solve", None) => keep(strainbridge::solve_deck(first, options, cx)?),
        ("fleet", Some(job)) => {
            let spec = FleetSpec {
                files: more.files.clone(),
                shard: more.shard,
                folder: more.folder.clone(),
                digests: more.digests.clone(),
            };
            keep(strainbridge::fleet(job, &spec, cx)?)
        }
        (name, Some(job)) => match ON_JOB.iter().find(|c| c.0 == name) {
            Some((_, question)) => question(job, cx),
            None => Err(argument_fault("ask", "command", name, "see `commands()`").into()),
        },
        (name, None) => Err(argument_fault(name, "job", "no job is given", "give a job").into()),
    }
}

/// Returns the command that wrote a folder, its job or deck, and the results that it names.
#[pyfunction]
pub(crate) fn made(py: Python, folder: PathBuf) -> PyResult<(String, PathBuf, Vec<String>)> {
    let made = verify::read_made(&folder).map_err(|f| raise(py, f.into()))?;
    let main = verify::main_input(&folder, &made).map_err(|f| raise(py, f.into()))?;
    let results = made.results().iter().map(|r| (*r).to_owned()).collect();
    Ok((made.command, main, results))
}

/// Removes stored solutions from a folder, by default from that of the user. Returns its path, the number of solutions, and their bytes.
#[pyfunction]
#[pyo3(signature = (folder=None))]
pub(crate) fn clean(py: Python, folder: Option<PathBuf>) -> PyResult<(PathBuf, usize, u64)> {
    let folder = folder.map_or_else(Folder::of_user, Folder::new);
    let (removed, bytes) = folder.clean().map_err(|e| {
        let (name, said) = (folder.path().display().to_string(), e.to_string());
        raise(
            py,
            argument_fault(&name, "clean", &said, "check the permissions").into(),
        )
    })?;
    Ok((folder.path().to_owned(), removed, bytes))
}

/// Returns the explanation of a finding as JSON: of one code, or of every code if `None`.
#[pyfunction]
#[pyo3(signature = (code=None))]
pub(crate) fn explain(py: Python, code: Option<&str>) -> PyResult<String> {
    let said = match code {
        Some(code) => {
            let found = strainbridge::explain(code).map_err(|f| raise(py, f))?;
            serde_json::to_string(found)
        }
        None => serde_json::to_string(strainbridge::explain_all()),
    };
    said.map_err(|e| {
        raise(
            py,
            argument_fault(
                "explain",
                "code",
                &e.to_string(),
                "report this as an error of the program",
            )
            .into(),
        )
    })
}
