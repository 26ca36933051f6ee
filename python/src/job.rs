//! A job that has been read and checked.

use crate::fault::raise;
use crate::files::Desk;
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::path::PathBuf;
use strainbridge::{Fault, Job};

/// Checked job with its source.
#[pyclass(frozen, name = "_Job", module = "strainbridge._strainbridge")]
pub(crate) struct CheckedJob {
    pub job: Job,
    pub desk: Desk,
}

#[pymethods]
impl CheckedJob {
    /// Reads the job at `path`. `files` are in memory, by path, and have priority over files on the disk.
    #[new]
    #[pyo3(signature = (path, files=BTreeMap::new()))]
    fn new(py: Python, path: PathBuf, files: BTreeMap<PathBuf, Vec<u8>>) -> PyResult<Self> {
        let desk = Desk(files);
        let job = py.detach(|| Job::read(&path, &desk));
        let job = job.map_err(|f| raise(py, f))?;
        Ok(Self { job, desk })
    }
}

/// Returns the keys of a job's text, as JSON.
#[pyfunction]
pub(crate) fn job_to_json(py: Python, path: &str, text: &str) -> PyResult<String> {
    let fault = |e: &dyn std::fmt::Display| {
        let said = e.to_string();
        raise(
            py,
            Fault::new(path, "text", said.trim_end(), "write it as TOML").into(),
        )
    };
    let table: toml::Table = toml::from_str(text).map_err(|e| fault(&e))?;
    serde_json::to_string(&table).map_err(|e| fault(&e))
}
