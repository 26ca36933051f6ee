//! `init`: a commented job from the analyst's own files, tried before it is recommended.
//!
//! `propose` loads (of the results' subcases, of the deck's, at `points`), lengths by the `mesh`, `text` of the job, and
//! `trial`: `place` on it. The first proposal that `place` answers is written.

mod mesh;
mod plain_name;
mod points;
mod propose;
mod purpose;
mod round;
mod text;
mod trial;

use crate::fe::from_results::{
    Displacements, HOLD_ONCE, ReadOptions, find_repeated_results, solution_from_file,
    subcase_labels,
};
use crate::finding::{Finding, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::Job;
use crate::model::{Model, Shell};
use crate::strain_chain::deck::{DeckModel, moduli_and_densities, read_model};
use crate::strain_chain::job_deck::against_suggested_units;
use crate::strain_chain::named_results::RESULTS_REMEDY;
use crate::units::likely_system;
use nastran::results::ResultsFile;
use propose::{LeftOutLoad, StrainFrom, StrainResultFile, proposals};
pub use purpose::{Purpose, init_for};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
pub use text::JOB;
use text::{JobPlan, usual_spacing};
use trial::{Verdict, WithJob, first_that_places};

/// A commented job made from an analyst's files.
#[derive(Serialize)]
pub struct Proposal {
    /// Name of the job's file.
    pub job: &'static str,
    /// Names of the loads proposed.
    pub loads: Vec<String>,
    /// Loads and subcases of the files that are not proposed.
    pub left_out: Vec<NotProposed>,
    /// Whether `place` finds a layout for the job.
    pub placeable: bool,
    /// Names of shell properties in the deck.
    #[serde(skip)]
    pub zones: BTreeMap<String, BTreeSet<u32>>,
    /// The job itself.
    #[serde(skip)]
    pub text: String,
    /// The job, read from its text, and the model of the deck. `None` without a deck, or if `text` needs a correction before it can be read.
    #[serde(skip)]
    pub read: Option<(Job, Model)>,
    /// Path of the proposed job.
    #[serde(skip)]
    pub path: PathBuf,
    /// Command for which the job is written, if it is not `place`.
    #[serde(skip)]
    pub purpose: Option<&'static str>,
}

/// Load or subcase that `init` leaves out of the proposed job, with the reason.
#[derive(Serialize)]
pub struct NotProposed {
    /// Name of the load or subcase.
    pub name: String,
    /// Reason why the subcase is left out.
    pub reason: String,
}

impl Answer for Proposal {
    const COMMAND: &'static str = "init";
    const RESULT: &'static str = "The proposed job";

    fn verdict(&self) -> String {
        let left_out = match self.left_out.len() {
            0 => String::new(),
            n => format!(", leaves out {n}"),
        };
        let places = match (self.placeable, self.purpose) {
            (false, None) => ", and cannot place gauges yet: the findings state why",
            _ => "",
        };
        format!(
            "{} proposes {}{left_out}{places}.",
            self.job,
            count_of(self.loads.len(), "load")
        )
    }
}

/// Proposes a commented job in `folder` from a deck and its results. It tries whether `place` finds gauges for the proposed loads.
///
/// The job is a text in the answer; the caller writes it.
///
/// # Errors
/// Returns files that can't be read, an existing job, or a deck without grids.
///
/// # Example
/// ```
/// use std::path::Path;
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, init};
///
/// # const DECK: &str = "SOL 101\nCEND\nSPC = 1\nSUBCASE 1\n LABEL = left\n LOAD = 2\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,100.,0.,0.
/// # GRID,3,,100.,20.,0.\nGRID,4,,0.,20.,0.\nGRID,5,,200.,0.,0.\nGRID,6,,200.,20.,0.\nCQUAD4,1,1,1,2,3,4\nCQUAD4,2,1,2,5,6,3
/// # PSHELL,1,1,2.,1,,1\nMAT1,1,210000.,,.3,7.85-9\nSPC1,1,123456,1,4\nFORCE,2,5,,10.,0.,0.,1.\nENDDATA\n";
/// let files = InMemory::default().with_file("strip.bdf", DECK);
/// let proposed = init(Path::new("strip.bdf"), &[], Path::new(""), &Context::new(&files))?;
/// assert_eq!(proposed.loads.len(), 1);
///
/// // The text is a job that reads without faults.
/// let files = files.with_file(&proposed.path, proposed.text.as_str());
/// let job = Job::read(&proposed.path, &files)?;
/// assert_eq!(job.loads[0].name, proposed.loads[0]);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn init(
    deck_path: &Path,
    results: &[PathBuf],
    folder: &Path,
    cx: &Context,
) -> Result<Outcome<Proposal>, Faults> {
    let mut work = Work::new(cx);
    let target = free_target(folder, cx)?;
    let given = deck_path.display().to_string();
    let deck = work.stage("read deck", |s| {
        read_model(&mut s.inputs, Path::new(""), &given)
    })?;
    Faults::check(deck.unread_part_faults())?;
    if deck.model.grids.is_empty() {
        let none = Fault::new(
            &*given,
            "GRID",
            "the deck contains no grid",
            "give a deck, or an OP2 that contains the mesh",
        );
        return Err(Faults::or(deck.faults, none));
    }
    work.findings.extend(deck.findings.iter().cloned());
    let (moduli, densities) = moduli_and_densities(&deck.model);
    let system = likely_system(deck.model.params.unitsys.as_deref(), &moduli, &densities);
    let of_units = system.map(|s| against_suggested_units(s, &deck.model));
    work.findings.extend(of_units.into_iter().flatten());
    let strained = read_strained(results, &deck, &mut work)?;
    let found = proposals(&deck, &strained, system);
    let plan = JobPlan {
        deck: &deck,
        deck_path,
        results,
        folder,
        system,
        from: found.first().map_or(StrainFrom::Solver, |p| p.from),
        without_results: match strained.iter().all(|s| s.1.is_empty()) {
            true => "no static subcase in them has strain of shells",
            false => "`place` finds no gauges with them",
        },
        loads: found.first().map_or(&[], |p| &p.loads),
        left_out: found.first().map_or(Vec::new(), |p| p.left_out.clone()),
        spacing: usual_spacing(&deck),
        angle_step_deg: 15,
    };
    let verdict = match obstacle(&deck, &given, system.is_none()) {
        Some(finding) => {
            work.findings.push(finding);
            Verdict::from_plan(&plan)
        }
        None => work.stage("try", |w| first_that_places(&w.cx, &plan, &found)),
    };
    work.findings.extend(verdict.finding);
    let files = WithJob::new(cx.files, &target, &verdict.text);
    let job = Job::read(&target, &files).ok();
    let answer = Proposal {
        job: JOB,
        loads: verdict.loads,
        left_out: verdict.left_out.into_iter().map(not_proposed).collect(),
        placeable: verdict.places,
        zones: named_zones(&deck.model),
        text: verdict.text,
        read: job.map(|job| (job, deck.model)),
        path: target,
        purpose: None,
    };
    Ok(work.finish(StatedUnits::default(), answer))
}

fn not_proposed(left_out: LeftOutLoad) -> NotProposed {
    NotProposed {
        name: left_out.name,
        reason: left_out.why,
    }
}

/// Returns the shell properties that elements use, by their names in comments of the deck.
fn named_zones(model: &Model) -> BTreeMap<String, BTreeSet<u32>> {
    let property = |s: &Shell| Some(model.shell_properties.get(s.property.us())?.id);
    let used: BTreeSet<u32> = model.shells.iter().filter_map(property).collect();
    let mut zones: BTreeMap<String, BTreeSet<u32>> = BTreeMap::new();
    for (id, name) in model.property_names.iter().filter(|n| used.contains(&n.0)) {
        zones.entry(name.clone()).or_default().insert(*id);
    }
    zones
}

/// Path of the proposed job.
///
/// # Errors
/// A fault if this file already exists.
fn free_target(folder: &Path, cx: &Context) -> Result<PathBuf, Fault> {
    let target = folder.join(JOB);
    if cx.files.load(&target).is_ok() {
        return Err(Fault::new(
            target.display().to_string(),
            JOB,
            "a file of this name exists, and it is not overwritten",
            "move it away, or name another folder with `--out`",
        ));
    }
    Ok(target)
}

/// Returns the finding on an obstacle that stops placing before a trial: faults of the deck, no shells, unknown units.
fn obstacle(deck: &DeckModel, given: &str, units_open: bool) -> Option<Finding> {
    let m = &deck.model;
    let stop = |code, message: String, remedy: &str| {
        Some(Finding::new(
            Severity::Warning,
            code,
            given,
            message,
            remedy,
        ))
    };
    if let Some(first) = deck.faults.first() {
        let n = deck.faults.len();
        let message = format!("{n} faults in the deck, the first: {first}");
        return stop("deck-has-faults", message, "run `check` on it");
    }
    if m.shells.is_empty() {
        let message = format!(
            "there is no surface for gauges: no shell among {} solids and {} bars and beams",
            m.solids.len(),
            m.beams.len()
        );
        let remedy = "cover the faces of the solids with thin shells (membranes of a thousandth of the thickness) and solve again";
        return stop("nothing-to-glue-on", message, remedy);
    }
    if units_open {
        let message = "Young's moduli and densities fit no system of units".to_owned();
        return stop("units-unknown", message, "fill in `units` of the job");
    }
    None
}

/// Returns the result files, each with the static subcases that contain strain of shells.
fn read_strained(
    results: &[PathBuf],
    deck: &DeckModel,
    work: &mut Work,
) -> Result<Vec<StrainResultFile>, Faults> {
    let options = ReadOptions {
        displacements: Displacements::Leave,
        ..ReadOptions::default()
    };
    let mut strained = Vec::new();
    for path in results {
        let name = path.display().to_string();
        let bytes = work.inputs.read(Path::new(""), &name)?;
        let read = work.stage("read results", |_| {
            ResultsFile::read(&bytes, &name).map(|f| {
                let solution = solution_from_file(&deck.model, &name, &f, &options);
                (
                    solution,
                    find_repeated_results(&[&f], None),
                    subcase_labels(&f),
                )
            })
        });
        let (solution, repeated, labels) =
            read.map_err(|e| Fault::new(&*name, "results", e.to_string(), RESULTS_REMEDY))?;
        if let Some(twice) = repeated.iter().find(|r| r.is_of_strain()) {
            return Err(Fault::new(&*name, "results", twice.words(&[&name]), HOLD_ONCE).into());
        }
        if let Some(cut) = deck.find_truncation(&solution.findings) {
            return Err(cut.into());
        }
        // The job reports results that a file lacks, and leaves them out.
        let findings = solution.findings.iter();
        let said =
            findings.filter(|f| f.code != "no-static-results" && f.code != "no-strain-output");
        work.findings.extend(said.cloned());
        let with_strain = solution
            .cases
            .iter()
            .filter(|c| !c.shells.elements.is_empty());
        let named = with_strain.map(|c| {
            let label = labels.get(&c.subcase).cloned().unwrap_or_default();
            (c.subcase, label)
        });
        strained.push((name, named.collect()));
    }
    Ok(strained)
}
