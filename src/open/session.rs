//! A session: the job, its plan in memory, and the calls of the page on them.

use super::seen_files::{SeenFiles, changed_files_fault};
use crate::fe::strain_tensor::Surface;
use crate::host::context::{Context, Disk, Progress};
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::Outcome;
use crate::host::store::Folder;
use crate::job::{Job, JobGauge, Keep, StatedPlace};
use crate::report::command::{check_folder, save};
use crate::stop::Stop;
use crate::workflow::place::{CertifiedLayout, Plan};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Threads and kept solutions of a session.
pub struct Surroundings {
    /// Threads that compute.
    pub pool: rayon::ThreadPool,
    /// Store of solutions of the built-in solver.
    pub store: Option<Folder>,
    /// Folder for the report.
    pub out: PathBuf,
}

/// The two texts of a plan.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanTexts {
    /// Text of the picked lists; blank: as the job states them.
    pub picks: String,
    /// Text of the table of gauges; needed where gauges stay, and for saving.
    #[serde(default)]
    pub gauges: Option<String>,
}

/// A gauge at another place.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MovedGauge {
    name: String,
    /// Basic frame, job units.
    at: [f64; 3],
    /// `top` or `bottom`.
    side: String,
    /// Axis, basic frame.
    along: [f64; 3],
}

/// A layout that the page shows.
pub struct ShownLayout {
    /// All gauges of the plan.
    pub layout: Arc<Outcome<CertifiedLayout>>,
    /// Names of the gauges that stay.
    pub kept: Vec<String>,
}

/// A session of one job.
pub struct Session {
    pub(super) path: PathBuf,
    around: Surroundings,
    data: Mutex<SessionData>,
    pub(super) seen: SeenFiles,
    stop: Mutex<Stop>,
    working: AtomicUsize,
}

struct SessionData {
    /// The job without its picked lists.
    job: Job,
    plan: Plan,
    /// The last layout that was chosen, and the texts that it was chosen for.
    best: Option<(PlanTexts, Arc<Outcome<CertifiedLayout>>)>,
}

impl SessionData {
    /// Chooses gauges for a job with these texts, and keeps the layout.
    fn choose(
        &mut self,
        texts: &PlanTexts,
        job: &Job,
        cx: &Context,
    ) -> Result<Arc<Outcome<CertifiedLayout>>, Faults> {
        let best = Arc::new(self.plan.place(job, cx)?);
        self.best = Some((texts.clone(), Arc::clone(&best)));
        Ok(best)
    }
}

struct LiveProgress(Stop);

impl Progress for LiveProgress {
    fn stop(&self) -> Stop {
        self.0.clone()
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Counts work in progress.
struct Busy<'a>(&'a AtomicUsize);

impl Drop for Busy<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

impl Session {
    /// Reads a job and its model.
    ///
    /// # Errors
    /// Every fault of the job and of the files that it names.
    pub fn begin(
        path: &Path,
        around: Surroundings,
        progress: &dyn Progress,
    ) -> Result<Self, Faults> {
        let data = read_data(path, &around, progress)?;
        let seen = SeenFiles::default();
        seen.note_all(&data.job, &data.plan);
        Ok(Self {
            path: path.to_owned(),
            around,
            data: Mutex::new(data),
            seen,
            stop: Mutex::default(),
            working: AtomicUsize::new(0),
        })
    }

    /// Returns the job as last read, without its picked lists.
    pub fn job(&self) -> Job {
        lock(&self.data).job.clone()
    }

    /// Returns whether a call computes.
    pub fn is_working(&self) -> bool {
        self.working.load(Ordering::SeqCst) > 0
    }

    /// Stops the computation in progress.
    pub fn cancel(&self) {
        lock(&self.stop).ask();
    }

    /// Computes on the threads of the session, after work that another call began.
    fn compute<T: Send>(
        &self,
        work: impl FnOnce(&mut SessionData, &Context) -> Result<T, Faults> + Send,
    ) -> Result<T, Faults> {
        self.working.fetch_add(1, Ordering::SeqCst);
        let _busy = Busy(&self.working);
        let mut data = lock(&self.data);
        let stop = Stop::new();
        lock(&self.stop).clone_from(&stop);
        let (data, progress) = (&mut *data, LiveProgress(stop));
        let cx = context(&self.around, &progress);
        self.around.pool.install(|| work(data, &cx))
    }

    /// Chooses gauges: all, or those in addition to the gauges that stay.
    ///
    /// # Errors
    /// Faults of the texts, candidates that allow no layout, a stop request.
    pub fn place(&self, texts: &PlanTexts) -> Result<ShownLayout, Faults> {
        self.compute(|data, cx| {
            let job = data
                .job
                .with_plan_files(&texts.picks, texts.gauges.as_deref())?;
            let best = data.choose(texts, &job, cx)?;
            let staying = gauges_that_stay(&job);
            let kept = staying.iter().map(|g| g.name.clone()).collect();
            if staying.is_empty() {
                return Ok(ShownLayout { layout: best, kept });
            }
            let chosen = best.gauges.iter();
            let chosen = chosen.map(|g| g.to_job_gauge(job.candidates.grid_length));
            let all: Vec<JobGauge> = staying.into_iter().chain(chosen).collect();
            let layout = Arc::new(data.plan.evaluate(&job, &all, &best, cx)?);
            Ok(ShownLayout { layout, kept })
        })
    }

    /// Evaluates a layout whose gauges were moved. `placed` is the table that was sent when the layout was chosen: the bound that gives the
    /// efficiency is the bound of that choice, chosen again if another plan was placed since.
    ///
    /// # Errors
    /// Faults of the texts, gauges that cannot be laid, a call before the first layout.
    pub fn move_gauges(
        &self,
        texts: &PlanTexts,
        placed: Option<String>,
        moved: &[MovedGauge],
    ) -> Result<ShownLayout, Faults> {
        self.compute(|data, cx| {
            let job = data
                .job
                .with_plan_files(&texts.picks, texts.gauges.as_deref())?;
            let chosen_for = PlanTexts {
                picks: texts.picks.clone(),
                gauges: placed,
            };
            let best = match &data.best {
                Some((of, best)) if *of == chosen_for => Arc::clone(best),
                Some(_) => {
                    let job = data
                        .job
                        .with_plan_files(&chosen_for.picks, chosen_for.gauges.as_deref())?;
                    data.choose(&chosen_for, &job, cx)?
                }
                None => {
                    let remedy = "place gauges first";
                    let fault = Fault::new("plan", "gauges", "there is no layout yet", remedy);
                    return Err(fault.into());
                }
            };
            let table = job.gauges_file();
            let of_table = job.gauges.iter().filter(|g| g.file == table);
            let mut all: Vec<JobGauge> = of_table.cloned().collect();
            for m in moved {
                move_gauge(&mut all, m)?;
            }
            let layout = Arc::new(data.plan.evaluate(&job, &all, &best, cx)?);
            let kept = gauges_that_stay(&job).into_iter().map(|g| g.name);
            Ok(ShownLayout {
                layout,
                kept: kept.collect(),
            })
        })
    }

    /// Writes the files of `place` for the job and its files as they are saved. Returns the folder and the summary.
    ///
    /// # Errors
    /// Faults of the command, files that changed since they were read.
    pub fn report(&self) -> Result<(PathBuf, String), Faults> {
        let changed = self.seen.list_changed();
        if !changed.is_empty() {
            return Err(changed_files_fault(&changed).into());
        }
        let out = &self.around.out;
        check_folder::<CertifiedLayout>(out)?;
        self.compute(|data, cx| {
            let outcome = data.plan.place(&Job::read(&self.path, &Disk)?, cx)?;
            save(&outcome, out)?;
            Ok((out.clone(), outcome.summary()))
        })
    }

    /// Reads the job and its model again.
    ///
    /// # Errors
    /// Faults of [`Session::begin`]; the session then keeps what it has.
    pub fn reload(&self) -> Result<(), Faults> {
        self.compute(|data, cx| {
            *data = read_data(&self.path, &self.around, cx.progress)?;
            self.seen.note_all(&data.job, &data.plan);
            Ok(())
        })
    }

    /// Reads the job again after its table of gauges was saved. The model stays.
    pub(super) fn reread_job(&self) {
        if let Ok(job) = Job::read_without_picks(&self.path, &Disk) {
            lock(&self.data).job = job;
        }
    }
}

fn read_data(
    path: &Path,
    around: &Surroundings,
    progress: &dyn Progress,
) -> Result<SessionData, Faults> {
    let job = Job::read_without_picks(path, &Disk)?;
    let cx = context(around, progress);
    let plan = around.pool.install(|| Plan::read(&job, &cx))?;
    Ok(SessionData {
        job,
        plan,
        best: None,
    })
}

fn context<'a>(around: &'a Surroundings, progress: &'a dyn Progress) -> Context<'a> {
    let cx = Context::new(&Disk).progress(progress);
    match &around.store {
        Some(folder) => cx.store(folder),
        None => cx,
    }
}

/// Gauges of a job that its placement keeps.
fn gauges_that_stay(job: &Job) -> Vec<JobGauge> {
    let stays = |g: &&JobGauge| match &job.placement.keep {
        Keep::None => false,
        Keep::All => true,
        Keep::Named(names) => names.contains(&g.name),
    };
    job.gauges.iter().filter(stays).cloned().collect()
}

/// Puts a gauge of a list at another place.
fn move_gauge(all: &mut [JobGauge], moved: &MovedGauge) -> Result<(), Fault> {
    let wrong =
        |field: &str, wrong: String| Err(Fault::new("plan", field, wrong, "read the page again"));
    let Some(gauge) = all.iter_mut().find(|g| g.name == moved.name) else {
        return wrong("moved", format!("the table has no gauge `{}`", moved.name));
    };
    let numbers = moved.at.iter().chain(&moved.along);
    if !numbers.clone().all(|v| v.is_finite()) || moved.along == [0.0; 3] {
        return wrong(
            "moved",
            format!("gauge `{}` has no place or axis", moved.name),
        );
    }
    gauge.surface = match moved.side.as_str() {
        "top" => Surface::Top,
        "bottom" => Surface::Bottom,
        other => return wrong("side", format!("`{other}` is not `top` or `bottom`")),
    };
    gauge.surface_stated = true;
    gauge.place = StatedPlace::Position(moved.at, 0);
    gauge.position = Some(moved.at);
    gauge.direction = Some(moved.along);
    gauge.cid = 0;
    gauge.angle_deg = 0.0;
    Ok(())
}
