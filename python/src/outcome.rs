//! Outcome of any command: `result.json` as text, console output, and the files on request.

use crate::fault::raise;
use crate::work::{Asked, run};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use strainbridge::host::outcome::Answer;
use strainbridge::report::command::{Report, result_text, save, words};
use strainbridge::report::gauge_table::gauges_text;
use strainbridge::report::notebook::piece;
use strainbridge::sensitivity::Sensitivity;
use strainbridge::workflow::calibrate::CalibratedSensitivity;
use strainbridge::workflow::place::CertifiedLayout;
use strainbridge::workflow::recover::RecoveredLoads;
use strainbridge::workflow::sensitivity::ComputedSensitivity;
use strainbridge::{Faults, Outcome};

/// Methods of an outcome of any type.
pub(crate) trait Kept: Send {
    /// Writes the files of the command, and returns the text of `result.json`.
    fn save(&self, folder: &Path) -> Result<String, Faults>;

    /// Returns the blocks of the report for a notebook.
    fn piece(&self) -> String;

    /// Returns names and values of the columns of a record's samples, if it has any.
    fn history(&self) -> Option<Vec<(String, Vec<f64>)>> {
        None
    }

    /// Returns the layout, if the command chooses gauges.
    fn layout(&self) -> Option<&CertifiedLayout> {
        None
    }

    /// Returns S, strain per job unit of each load, if the command computes it.
    fn sensitivity(&self) -> Option<&Sensitivity> {
        None
    }
}

/// Calibrated S.
struct OfCalibration(Outcome<CalibratedSensitivity>);

/// S of gauges or candidates.
struct OfModel(Outcome<ComputedSensitivity>);

impl Kept for OfModel {
    fn save(&self, folder: &Path) -> Result<String, Faults> {
        save(&self.0, folder)
    }

    fn piece(&self) -> String {
        piece(&self.0)
    }

    fn sensitivity(&self) -> Option<&Sensitivity> {
        Some(&self.0.prepared.sensitivity)
    }
}

impl Kept for OfCalibration {
    fn save(&self, folder: &Path) -> Result<String, Faults> {
        save(&self.0, folder)
    }

    fn piece(&self) -> String {
        piece(&self.0)
    }

    fn sensitivity(&self) -> Option<&Sensitivity> {
        Some(&self.0.sensitivity)
    }
}

/// Layout of gauges.
struct OfPlacement(Outcome<CertifiedLayout>);

impl Kept for OfPlacement {
    fn save(&self, folder: &Path) -> Result<String, Faults> {
        save(&self.0, folder)
    }

    fn piece(&self) -> String {
        piece(&self.0)
    }

    fn layout(&self) -> Option<&CertifiedLayout> {
        Some(&self.0)
    }
}

/// Loads of the measured strain, including samples.
struct Measured(Outcome<RecoveredLoads>);

impl Kept for Measured {
    fn save(&self, folder: &Path) -> Result<String, Faults> {
        save(&self.0, folder)
    }

    fn piece(&self) -> String {
        piece(&self.0)
    }

    fn history(&self) -> Option<Vec<(String, Vec<f64>)>> {
        let record = self.0.record()?;
        let history = record.history.as_ref()?;
        let mut columns = vec![("time".to_owned(), Vec::new())];
        for name in &record.head.names {
            for end in ["", ".low", ".high"] {
                columns.push((format!("{name}{end}"), Vec::new()));
            }
        }
        for row in history.rows() {
            let loads = row.loads.iter().flat_map(|l| l.unwrap_or([f64::NAN; 3]));
            let numbers = std::iter::once(row.time).chain(loads);
            for ((_, column), number) in columns.iter_mut().zip(numbers) {
                column.push(number);
            }
        }
        Some(columns)
    }
}

impl<A> Kept for Outcome<A>
where
    A: Answer + Send,
    Outcome<A>: Report,
{
    fn save(&self, folder: &Path) -> Result<String, Faults> {
        save(self, folder)
    }

    fn piece(&self) -> String {
        piece(self)
    }
}

/// Outcome without the type of its answer.
#[pyclass(frozen, name = "_Outcome", module = "strainbridge._strainbridge")]
pub(crate) struct AnyOutcome {
    /// Text of `result.json`, without the list of tables, which exist only as files.
    #[pyo3(get)]
    json: String,
    /// Table and summary as on a terminal.
    #[pyo3(get)]
    words: String,
    /// Notes about the computation.
    #[pyo3(get)]
    notes: Vec<String>,
    kept: Mutex<Box<dyn Kept>>,
}

/// Keeps an outcome for Python.
pub(crate) fn keep<A>(outcome: Outcome<A>) -> Result<AnyOutcome, Faults>
where
    A: Answer + Send + 'static,
    Outcome<A>: Report,
{
    keep_as(outcome, |o| Box::new(o))
}

/// Keeps recovered loads for Python.
pub(crate) fn keep_loads(outcome: Outcome<RecoveredLoads>) -> Result<AnyOutcome, Faults> {
    keep_as(outcome, |o| Box::new(Measured(o)))
}

/// Keeps the outcome of a calibration for Python.
pub(crate) fn keep_calibrated(
    outcome: Outcome<CalibratedSensitivity>,
) -> Result<AnyOutcome, Faults> {
    keep_as(outcome, |o| Box::new(OfCalibration(o)))
}

/// Keeps S of gauges or candidates for Python.
pub(crate) fn keep_sensitivity(
    outcome: Outcome<ComputedSensitivity>,
) -> Result<AnyOutcome, Faults> {
    keep_as(outcome, |o| Box::new(OfModel(o)))
}

/// Keeps a layout of gauges for Python.
pub(crate) fn keep_layout(outcome: Outcome<CertifiedLayout>) -> Result<AnyOutcome, Faults> {
    keep_as(outcome, |o| Box::new(OfPlacement(o)))
}

fn keep_as<A: Answer>(
    outcome: Outcome<A>,
    keep: impl FnOnce(Outcome<A>) -> Box<dyn Kept>,
) -> Result<AnyOutcome, Faults>
where
    Outcome<A>: Report,
{
    Ok(AnyOutcome {
        json: result_text(&outcome)?,
        words: words(&outcome),
        notes: outcome.notes.clone(),
        kept: Mutex::new(keep(outcome)),
    })
}

impl AnyOutcome {
    /// Uses the layout of the outcome, `None` if its command chooses no gauges.
    pub(crate) fn with_layout<T>(&self, work: impl FnOnce(Option<&CertifiedLayout>) -> T) -> T {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        work(kept.layout())
    }

    /// Returns the text of `gauges.csv` of the layout, `None` if the command chooses no gauges.
    fn gauges_text(&self) -> Result<Option<String>, Faults> {
        self.with_layout(|layout| layout.map(gauges_text).transpose())
    }
}

/// Matrix with the names of its rows and columns.
type NamedMatrix<'py> = (Bound<'py, PyArray2<f64>>, Vec<String>, Vec<String>);

#[pymethods]
impl AnyOutcome {
    /// Writes the files of the command into a folder, and returns the text of `result.json`.
    fn save(&self, py: Python, folder: PathBuf) -> PyResult<String> {
        let done = run(py, &Asked::default(), |_| {
            let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            kept.save(&folder)
        })?;
        done.map_err(|f| raise(py, f))
    }

    /// Returns the blocks of its report as HTML for a notebook.
    fn html(&self, py: Python) -> PyResult<String> {
        run(py, &Asked::default(), |_| {
            let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            kept.piece()
        })
    }

    /// Returns the text of `gauges.csv`, `None` if the command chooses no gauges.
    fn gauge_table(&self, py: Python) -> PyResult<Option<String>> {
        self.gauges_text().map_err(|f| raise(py, f))
    }

    /// Returns S, gauges x loads, microstrain per job unit of each load, with the names of gauges and loads. `None` if the command computes no S.
    fn sensitivity<'py>(&self, py: Python<'py>) -> PyResult<Option<NamedMatrix<'py>>> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let Some(s) = kept.sensitivity() else {
            return Ok(None);
        };
        let (n, k) = (s.gauges.len(), s.loads.len());
        let entries = (0..n * k).map(|i| s.values[(i / k, i % k)] * 1e6);
        let matrix = PyArray1::from_vec(py, entries.collect()).reshape([n, k])?;
        let loads = s.loads.iter().map(|l| l.name.clone()).collect();
        Ok(Some((matrix, s.gauges.clone(), loads)))
    }

    /// Returns the samples of a record by column, `time` first. `None` if no record was measured.
    fn history<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let found = run(py, &Asked::default(), |_| {
            let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
            kept.history()
        })?;
        let Some(columns) = found else {
            return Ok(None);
        };
        let out = PyDict::new(py);
        for (name, values) in columns {
            out.set_item(name, PyArray1::from_vec(py, values))?;
        }
        Ok(Some(out))
    }
}
