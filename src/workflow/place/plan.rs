//! A plan: model, strain fields and S of the candidates in memory, for one layout after another.

use super::kept_candidates::KeptCandidates;
use super::lay_out_gauges;
use super::outcome::CertifiedLayout;
use super::stated_layout::{describe_stated, job_with_layout};
use crate::fe::SupportChoice;
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Outcome, StatedUnits};
use crate::host::work::{Beginning, Work};
use crate::job::{Job, JobGauge, JobLoad};
use crate::strain_chain::named_results::check_tables;
use crate::strain_chain::{Fields, WantedAt, read_fields};
use crate::units::UnitSystem;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Plan of gauges for a job. It keeps the model, the strain of the loads and S of the candidates. If candidates, the number of gauges or the gauges
/// to keep change, only the search runs again.
///
/// # Example
/// ```
/// use strainbridge::workflow::place::Plan;
/// use strainbridge::{Context, Disk, Job};
///
/// let job = Job::read(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/frame/place.toml"), &Disk)?;
/// let cx = Context::new(&Disk);
/// let mut plan = Plan::read(&job, &cx)?;
/// let twelve = plan.place(&job, &cx)?;
///
/// // The lists of a picked file, and the number of gauges.
/// let changed = job.with_plan_files("[candidates]\nproperties = [1]\n[placement]\ngauges = 10\n", None)?;
/// let ten = plan.place(&changed, &cx)?;
/// assert_eq!((twelve.gauges.len(), ten.gauges.len()), (12, 10));
/// assert!(ten.log_det < twelve.log_det);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub struct Plan {
    fields: Arc<Fields>,
    candidates: KeptCandidates,
    beginning: Option<Beginning>,
    source: PlanSource,
}

/// Keys of a job on which the strain fields of a plan depend.
#[derive(Debug, PartialEq)]
struct PlanSource {
    units: UnitSystem,
    files: Vec<PathBuf>,
    support: Option<SupportChoice>,
    mesh_error: Option<bool>,
    /// The loads, with line 0.
    loads: Vec<JobLoad>,
}

impl PlanSource {
    fn new(job: &Job) -> Self {
        let model = job.model.as_ref();
        let files = model.map(|m| std::iter::once(&m.deck).chain(&m.results));
        let load = |load: &JobLoad| {
            let mut load = load.clone();
            load.line = 0;
            if let Some(result) = &mut load.result {
                result.line = 0;
            }
            load
        };
        Self {
            units: job.units,
            files: files
                .into_iter()
                .flatten()
                .map(|f| job.folder.join(&f.given))
                .collect(),
            support: model.map(|m| m.support),
            mesh_error: model.and_then(|m| m.mesh_error),
            loads: job.loads.iter().map(load).collect(),
        }
    }
}

impl Plan {
    /// Reads the model of a job and the strain of its loads.
    ///
    /// # Errors
    /// Returns every fault of the job's files, and a job without a model or loads.
    pub fn read(job: &Job, cx: &Context) -> Result<Self, Faults> {
        let mut work = Work::of_job(cx, job);
        let plan = Self::read_into(&mut work, job)?;
        let mut beginning = work.into_beginning();
        let of_job = |path: &PathBuf| job.read.iter().any(|r| r.path == *path);
        beginning.read.retain(|r| !of_job(&r.path));
        Ok(Self {
            beginning: Some(beginning),
            ..plan
        })
    }

    /// Returns the paths of the files that were read for the model.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let read = self.beginning.iter().flat_map(|b| &b.read);
        read.map(|f| f.path.as_path())
    }

    /// Reads the model as a part of a command.
    pub(super) fn read_into(work: &mut Work, job: &Job) -> Result<Self, Faults> {
        check_tables(work, job)?;
        let fields = read_fields(work, job, WantedAt::Anywhere)?;
        Ok(Self {
            fields: Arc::new(fields),
            candidates: KeptCandidates::default(),
            beginning: None,
            source: PlanSource::new(job),
        })
    }

    /// Chooses gauges for a job like [`super::place`]. The job must have the model and the loads of the plan; its candidates, gauges and placement
    /// may differ.
    ///
    /// # Errors
    /// Returns a job with another model or other loads, candidates that allow no layout, gauges that cannot be kept, and a stop request.
    pub fn place(&mut self, job: &Job, cx: &Context) -> Result<Outcome<CertifiedLayout>, Faults> {
        self.check_source(job)?;
        let work = self.resume(job, cx);
        self.lay_out(work, job)
    }

    /// Evaluates the layout of these gauges like a chosen layout. `best` is a layout of [`Plan::place`] for the same job: its bound gives the
    /// efficiency of the gauges.
    ///
    /// # Errors
    /// Returns a job with another model or other loads, gauges that cannot be laid, and gauges that do not separate the loads.
    pub fn evaluate(
        &self,
        job: &Job,
        gauges: &[JobGauge],
        best: &CertifiedLayout,
        cx: &Context,
    ) -> Result<Outcome<CertifiedLayout>, Faults> {
        self.check_source(job)?;
        let mut work = self.resume(job, cx);
        let job = job.with_property_ids(&self.fields.model().property_names)?;
        let stated = job_with_layout(&job, gauges);
        let layout = describe_stated(&mut work, &stated, &self.fields, best)?;
        // The page shows the candidates of the job.
        let answer = layout.into_placed(Arc::clone(&self.fields), &job);
        Ok(work.finish(units_of(&job), answer))
    }

    /// Chooses gauges as the last part of a command.
    pub(super) fn lay_out(
        &mut self,
        mut work: Work,
        job: &Job,
    ) -> Result<Outcome<CertifiedLayout>, Faults> {
        let job = &job.with_property_ids(&self.fields.model().property_names)?;
        let answer = lay_out_gauges(&mut work, job, &self.fields, &mut self.candidates)?;
        let answer = answer.into_placed(Arc::clone(&self.fields), job);
        Ok(work.finish(units_of(job), answer))
    }

    /// Refuses a job whose units, model or loads are not those of the plan.
    fn check_source(&self, job: &Job) -> Result<(), Fault> {
        let found = PlanSource::new(job);
        if found == self.source {
            return Ok(());
        }
        let (field, what) = match found.loads == self.source.loads {
            true => ("model", "the units or the model"),
            false => ("load", "the loads"),
        };
        let wrong = format!("{what} of the job differ from the plan");
        Err(Fault::new(
            &*job.file,
            field,
            wrong,
            "read a plan of this job",
        ))
    }

    fn resume<'a>(&self, job: &Job, cx: &Context<'a>) -> Work<'a> {
        match &self.beginning {
            Some(beginning) => Work::resume(cx, &job.read, beginning),
            None => Work::of_job(cx, job),
        }
    }
}

fn units_of(job: &Job) -> StatedUnits {
    StatedUnits::from_units(job.units, &job.report_units)
}
