//! `place` tried on proposed jobs, so that `init` recommends only what works.

use super::propose::{LeftOutLoad, Proposal, ProposedLoad};
use super::round::round;
use super::text::{JOB, JobPlan};
use crate::finding::{Finding, Severity};
use crate::host::context::{Context, Files};
use crate::host::files::FileBytes;
use crate::host::store::Memory;
use crate::job::Job;
use crate::strain_chain::deck::without_dots;
use crate::workflow::place::place;
use std::path::{Path, PathBuf};

/// Grids of a model up to which `place` is tried: some seconds with the built-in solver.
const MOST_GRIDS: usize = 100_000;
/// Trials at most.
const MOST_TRIALS: usize = 24;

/// Result of the trials.
pub(super) struct Verdict {
    /// Text of job.toml.
    pub text: String,
    /// Names of the loads in `text`.
    pub loads: Vec<String>,
    /// Loads and subcases that are left out.
    pub left_out: Vec<LeftOutLoad>,
    /// Whether `place` can be recommended.
    pub places: bool,
    /// Warning if `place` finds no gauges for any proposal.
    pub finding: Option<Finding>,
}

impl Verdict {
    /// Returns the job as planned, which is not recommended.
    pub(super) fn from_plan(plan: &JobPlan) -> Self {
        Self {
            text: plan.text(),
            loads: names(plan.loads),
            left_out: plan.left_out.clone(),
            places: false,
            finding: None,
        }
    }
}

/// Returns the verdict on the first proposal that `place` answers without error, with or without warnings. Without such a proposal it returns the
/// first one.
pub(super) fn first_that_places(cx: &Context, plan: &JobPlan, proposals: &[Proposal]) -> Verdict {
    if plan.deck.model.grids.len() > MOST_GRIDS {
        return Verdict {
            places: !plan.loads.is_empty(),
            ..Verdict::from_plan(plan)
        };
    }
    // Solutions are stored for the time of the trials. If the caller has a store, `place` uses them afterwards.
    let cx = match cx.store {
        Some(_) => cx.clone(),
        None => cx.clone().store(&Memory::default()),
    };
    let mut first_why = None;
    for trial in trials(plan, proposals).take(MOST_TRIALS) {
        match try_place(&cx, &trial) {
            Ok(()) => return answer(&trial),
            Err(why) => first_why = first_why.or(Some(why)),
        }
    }
    let why = first_why.unwrap_or_else(|| {
        "neither subcases with loads nor points where loads could act were found".to_owned()
    });
    Verdict {
        finding: Some(Finding::new(
            Severity::Warning,
            "no-placement-found",
            plan.deck.given.clone(),
            format!("`place` finds no gauges for the proposed loads: {why}"),
            "correct the [[load]]s and [candidates], or give results with strain of shells",
        )),
        ..Verdict::from_plan(plan)
    }
}

fn names(loads: &[ProposedLoad]) -> Vec<String> {
    loads.iter().map(|l| l.name.clone()).collect()
}

fn answer(trial: &JobPlan) -> Verdict {
    Verdict {
        places: true,
        ..Verdict::from_plan(trial)
    }
}

/// The proposals in turn, each with less spacing; then those that the files do not state with fewer loads.
fn trials<'a>(
    plan: &'a JobPlan<'a>,
    proposals: &'a [Proposal],
) -> impl Iterator<Item = JobPlan<'a>> {
    let with = move |p: &'a Proposal, n: usize, spacing: f64| {
        let (loads, fewer) = p.loads.split_at(n.min(p.loads.len()));
        let fewer = fewer.iter().map(|l| LeftOutLoad {
            name: l.name.clone(),
            load: Some(l.clone()),
            why: "gauges on these shells do not separate them from the loads above".to_owned(),
        });
        JobPlan {
            from: p.from,
            loads,
            left_out: fewer.chain(p.left_out.iter().cloned()).collect(),
            spacing,
            ..plan.clone()
        }
    };
    let usual = plan.spacing;
    let whole = proposals.iter().flat_map(move |p| {
        [usual, round(usual / 4.0), 0.0]
            .into_iter()
            .map(move |spacing| with(p, p.loads.len(), spacing))
    });
    let invented = proposals.iter().filter(|p| !p.stated);
    let fewer = invented.flat_map(move |p| {
        let halves = std::iter::successors(Some(p.loads.len() / 2), |n| Some(n / 2));
        halves.take_while(|n| *n > 0).map(move |n| with(p, n, 0.0))
    });
    whole.chain(fewer)
}

/// Returns an error with the reason if `place` gives no layout.
fn try_place(cx: &Context, trial: &JobPlan) -> Result<(), String> {
    let path = trial.folder.join(JOB);
    // Four angles a place show whether the gauges separate the loads. `place` proves the layout with more angles.
    let trial = JobPlan {
        angle_step_deg: 45,
        ..trial.clone()
    };
    let files = WithJob::new(cx.files, &path, &trial.text());
    let cx = Context {
        files: &files,
        store: cx.store.clone(),
        progress: cx.progress,
    };
    let placed = Job::read(&path, &files).and_then(|mut job| {
        job.placement.proof = false;
        place(&job, &cx)
    });
    match placed {
        Err(faults) => Err(faults
            .iter()
            .next()
            .map_or_else(String::new, |f| format!("{}: {}", f.wrong, f.remedy))),
        Ok(placed) => {
            let mut findings = placed.findings.iter();
            match findings.find(|f| f.severity == Severity::Error) {
                Some(f) => Err(format!("{} {}", f.message, f.remedy)),
                None => Ok(()),
            }
        }
    }
}

/// The files of a context and a job that isn't written yet.
pub(super) struct WithJob<'a> {
    inner: &'a dyn Files,
    path: PathBuf,
    text: String,
}

impl<'a> WithJob<'a> {
    /// Returns the files of `inner` and `text` at `path`.
    pub(super) fn new(inner: &'a dyn Files, path: &Path, text: &str) -> Self {
        Self {
            inner,
            path: path.to_owned(),
            text: text.to_owned(),
        }
    }
}

impl Files for WithJob<'_> {
    fn load(&self, path: &Path) -> std::io::Result<FileBytes> {
        if path == self.path {
            Ok(FileBytes::from(self.text.clone().into_bytes()))
        } else {
            // A folder that does not exist yet has no `..`.
            self.inner.load(&without_dots(path))
        }
    }
}
