//! An outcome, whatever the command: `result.json` as text, words, and the files on demand.

use crate::fault::raise;
use crate::work::{Asked, run};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use strainbridge::app::outcome::Answer;
use strainbridge::report::command::{Report, save, unsaved};
use strainbridge::{Faults, Outcome};

/// What can be asked of an outcome of any type.
pub(crate) trait Kept: Send {
    /// Writes the files of the command; the text of `result.json`.
    fn save(&self, folder: &Path) -> Result<String, Faults>;
}

impl<A> Kept for Outcome<A>
where
    A: Answer + Send,
    Outcome<A>: Report,
{
    fn save(&self, folder: &Path) -> Result<String, Faults> {
        save(self, folder)
    }
}

/// An outcome with the type of its answer left behind.
#[pyclass(frozen, name = "_Outcome", module = "strainbridge._strainbridge")]
pub(crate) struct Told {
    /// The text of `result.json`, without the tables that only files have.
    #[pyo3(get)]
    json: String,
    /// What a person reads of it on a terminal.
    #[pyo3(get)]
    words: String,
    /// What is worth knowing of the way.
    #[pyo3(get)]
    notes: Vec<String>,
    kept: Mutex<Box<dyn Kept>>,
}

/// An outcome for Python.
pub(crate) fn tell<A>(outcome: Outcome<A>) -> Result<Told, Faults>
where
    A: Answer + Send + 'static,
    Outcome<A>: Report,
{
    Ok(Told {
        json: unsaved(&outcome)?,
        words: outcome.words(),
        notes: outcome.notes.clone(),
        kept: Mutex::new(Box::new(outcome)),
    })
}

#[pymethods]
impl Told {
    /// Writes the files of the command into a folder; the text of `result.json`.
    fn save(&self, py: Python, folder: PathBuf) -> PyResult<String> {
        let done = run(py, &Asked::default(), |_| {
            let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            kept.save(&folder)
        })?;
        done.map_err(|f| raise(py, f))
    }
}
