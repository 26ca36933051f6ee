//! An outcome, whatever the command: `result.json` as text, words, and the files on demand.

use crate::fault::raise;
use crate::work::{Asked, run};
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use strainbridge::app::outcome::{Answer, Tables};
use strainbridge::report::command::{Report, save, unsaved};
use strainbridge::{Fault, Faults, Outcome};

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

/// An outcome whose command writes its files as it goes: it has none of its own.
struct Unwritten;

impl Kept for Unwritten {
    fn save(&self, folder: &Path) -> Result<String, Faults> {
        let shown = folder.display().to_string();
        let (said, remedy) = ("this outcome has no files", "call the command for them");
        Err(Fault::of(shown, "save", said, remedy).into())
    }
}

/// An outcome for Python, without files.
pub(crate) fn tell_unwritten<A: Answer>(outcome: Outcome<A>) -> Result<Told, Faults> {
    let json = outcome.to_json(&Tables::new()).map_err(|e| {
        let remedy = "report this as an error of the program";
        Fault::of("result.json", "file", e.to_string(), remedy)
    })?;
    Ok(Told {
        json,
        words: String::new(),
        notes: outcome.notes.clone(),
        kept: Mutex::new(Box::new(Unwritten)),
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
