//! A plan of gauges: model, strain of the loads and S of the candidates in memory, for one layout after another.

use crate::fault::{argument_fault, raise};
use crate::job::CheckedJob;
use crate::outcome::{AnyOutcome, keep_layout};
use crate::work::{Asked, run};
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};
use strainbridge::host::store::Folder;
use strainbridge::job::JobGauge;
use strainbridge::workflow::place::Plan;
use strainbridge::{Context, Faults, Job};

/// Plan of a job.
#[pyclass(frozen, name = "_Plan", module = "strainbridge._strainbridge")]
pub(crate) struct KeptPlan(Mutex<Plan>);

/// Runs work with the files of a job.
fn with_job<T: Send>(
    py: Python,
    job: &CheckedJob,
    asked: &Asked,
    cache: bool,
    work: impl FnOnce(&Job, &Context) -> Result<T, Faults> + Send,
) -> PyResult<T> {
    let store = cache.then(Folder::of_user);
    let done = run(py, asked, |heard| {
        let mut cx = Context::new(&job.desk).progress(heard);
        if let Some(folder) = &store {
            cx = cx.store(folder);
        }
        work(&job.job, &cx)
    })?;
    done.map_err(|f| raise(py, f))
}

#[pymethods]
impl KeptPlan {
    /// Reads the model of a job and the strain of its loads.
    #[new]
    #[pyo3(signature = (job, threads=None, cache=true, progress=None))]
    fn new(
        py: Python,
        job: &Bound<CheckedJob>,
        threads: Option<usize>,
        cache: bool,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Self> {
        let asked = Asked { threads, progress };
        let plan = with_job(py, job.get(), &asked, cache, Plan::read)?;
        Ok(Self(Mutex::new(plan)))
    }

    /// Chooses gauges for a job with the model and the loads of the plan.
    #[pyo3(signature = (job, threads=None, progress=None))]
    fn place(
        &self,
        py: Python,
        job: &Bound<CheckedJob>,
        threads: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<AnyOutcome> {
        let asked = Asked { threads, progress };
        with_job(py, job.get(), &asked, false, |job, cx| {
            let mut plan = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            keep_layout(plan.place(job, cx)?)
        })
    }

    /// Evaluates the gauges of a table, a text like `gauges.csv`, with the bound of a layout of [`KeptPlan::place`].
    #[pyo3(signature = (job, table, best, threads=None, progress=None))]
    fn evaluate(
        &self,
        py: Python,
        job: &Bound<CheckedJob>,
        table: &str,
        best: &Bound<AnyOutcome>,
        threads: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<AnyOutcome> {
        let asked = Asked { threads, progress };
        let best = best.get();
        with_job(py, job.get(), &asked, false, |job, cx| {
            let job = job.with_plan_files("", Some(table))?;
            let file = job.gauges_file();
            let of_table = job.gauges.iter().filter(|g| g.file == file);
            let gauges: Vec<JobGauge> = of_table.cloned().collect();
            let plan = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            best.with_layout(|best| match best {
                Some(best) => keep_layout(plan.evaluate(&job, &gauges, best, cx)?),
                None => {
                    let wrong = "it is not a layout of `Plan.place`";
                    let remedy = "give the outcome that `Plan.place` returned";
                    Err(argument_fault("Plan.evaluate", "best", wrong, remedy).into())
                }
            })
        })
    }
}
