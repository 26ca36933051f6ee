//! `solve`: the built-in solver on a job's unit loads or on a deck's own static subcases.

use crate::fe::{
    Balance, Corners, LoadCase, Reactions, Relief, Solution, SolveOptions, SolveReport, Support,
    SupportChoice, refuse, relief_finding, suport_without_inrel,
};
use crate::finding::{Finding, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::Job;
use crate::linalg::sparse::OrderingMethod;
use crate::model::{Model, Shell};
pub use crate::strain_chain::built_in_solver::MODES;
use crate::strain_chain::built_in_solver::{
    cases_of_job, faults_of, is_combination, relief_of_job, solve_kept, static_case, support_of_job,
};
use crate::strain_chain::combined_subcases::{CombinedSubcase, add_combinations, read_combination};
use crate::strain_chain::deck::{DeckModel, read_model};
use crate::strain_chain::job_deck::read_deck;
use crate::strain_chain::named_results::{MissingResults, check_named};
use crate::strain_chain::repeated_subcases::refuse_repeated_subcases;
use crate::units::{UnitSystem, number};
use nastran::bdf::Request;
use nastran::cards::ShellShape;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Load cases solved by the built-in solver.
#[derive(Serialize)]
pub struct SolvedCases {
    /// Grids of the model.
    pub grids: usize,
    /// Number of unknowns.
    pub dofs: usize,
    /// Number of entries of the factor.
    pub factor_nonzeros: usize,
    /// Ordering of the unknowns.
    pub ordering: Option<OrderingMethod>,
    /// Smallest pivot divided by the largest entry of its row.
    pub smallest_pivot: f64,
    /// Nastran's epsilon of the worst case before and after refinement: |u'(f - K u)| / |u'f|.
    pub epsilon: [f64; 2],
    /// Units of mass, balance and reactions, from the job's system; null for a deck, which states no units.
    pub model_units: StatedUnits,
    /// Applied loads, inertia loads and remaining imbalance of each load case.
    pub balance: Vec<Balance>,
    /// Mass and centre of gravity.
    pub mass: Option<MassAndCentre>,
    /// Description of the support of the structure under the unit loads of a job; `None` for a deck, whose subcases state their support.
    pub support: Option<String>,
    /// For each load case: resultants of the applied loads and of the reactions, and the reactions by grid, basic frame. Empty without a support.
    pub reactions: Vec<Reactions>,
    /// First elastic frequencies, per unit of time.
    pub elastic_modes_hz: Vec<f64>,
    /// Largest resident memory of the process so far, bytes; `None` if the system does not report it.
    pub peak_memory_bytes: Option<u64>,
    /// Title of the report.
    #[serde(skip)]
    pub title: String,
    /// The job's system of units.
    #[serde(skip)]
    pub system: Option<UnitSystem>,
    /// The deck's model.
    #[serde(skip)]
    pub deck: DeckModel,
    /// Load cases.
    #[serde(skip)]
    pub cases: Vec<LoadCase>,
    /// Displacements and strain.
    #[serde(skip)]
    pub solution: Solution,
    /// Report of the solver.
    #[serde(skip)]
    pub report: SolveReport,
}

/// Mass and its centre, basic frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MassAndCentre {
    /// Mass, the deck's units.
    pub mass: f64,
    /// Centre of gravity.
    pub cg: [f64; 3],
}

impl Answer for SolvedCases {
    const COMMAND: &'static str = "solve";
    const RESULT: &'static str = "The solution";

    fn verdict(&self) -> String {
        let first = self.elastic_modes_hz.first();
        let first = first.map_or_else(String::new, |hz| {
            format!(", first elastic mode {} Hz", number(*hz))
        });
        let support = self.support.as_ref();
        let support = support.map_or_else(String::new, |s| format!("; the structure is {s}"));
        format!(
            "{} solved on {}{first}{support}.",
            count_of(self.solution.cases.len(), "load case"),
            count_of(self.grids, "grid")
        )
    }
}

/// Inputs of the solver.
struct Task {
    read: DeckModel,
    cases: Vec<LoadCase>,
    /// Places at which strain is computed.
    corners: Corners,
    /// Combinations of the load cases.
    combined: Vec<CombinedSubcase>,
    /// Reason why a subcase of the deck is left out.
    left_out: Vec<String>,
    /// Description of the support of a job's structure.
    support: Option<String>,
}

/// Solves the unit loads of a job with the built-in solver. Each load is a case, in the order of the job.
///
/// # Errors
/// Returns every fault of the job and its deck, or the fault that stops the solver.
///
/// # Example
/// The tip of a cantilever moves by `F L^3 / (3 E I)`, and its support takes the load:
/// ```
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, solve};
///
/// # const DECK: &str = "SOL 101\nCEND\nSPC = 1\nBEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.\nCBAR,1,1,1,2,0.,0.,1.
/// # PBAR,1,1,600.,2.+4,8.+4,1.+4\nMAT1,1,210000.,,.3,7.85-9\nSPC1,1,123456,1\nENDDATA\n";
/// const JOB: &str = r#"
/// units = "mm-t-s"
/// model = { deck = "cantilever.bdf" }
/// load = [{ name = "tip", grid = 2, component = "FZ" }]
/// "#;
/// let files = InMemory::default().with_file("cantilever.bdf", DECK).with_file("job.toml", JOB);
/// let solved = solve(&Job::read("job.toml", &files)?, Default::default(), &Context::new(&files))?;
/// let tip = solved.solution.cases[0].displacement[1][2];
/// let exact = 1000.0_f64.powi(3) / (3.0 * 210_000.0 * 20_000.0);
/// assert!((tip / exact - 1.0).abs() < 1e-9);
/// assert!((solved.reactions[0].total[2] + 1.0).abs() < 1e-9); // N
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn solve(
    job: &Job,
    options: SolveOptions,
    cx: &Context,
) -> Result<Outcome<SolvedCases>, Faults> {
    let mut work = Work::of_job(cx, job);
    let task = work.stage("read", |w| of_job(w, job))?;
    let title = title_of(Path::new(&job.file));
    let answer = solve_cases(&mut work, task, options, title, Some(job.units))?;
    Ok(work.finish(
        StatedUnits::from_units(job.units, &job.report_units),
        answer,
    ))
}

/// Solves the static subcases of a deck with the built-in solver. Support and loads are the ones that each subcase selects.
///
/// # Errors
/// Returns every fault of the deck, or the fault that stops the solver.
///
/// # Example
/// A rod of length L and area A under the tension F becomes longer by `F L / (E A)`:
/// ```
/// use std::path::Path;
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, solve_deck};
///
/// const ROD: &str = "SOL 101\nCEND\nSPC = 1\nLOAD = 2\nBEGIN BULK
/// GRID,1,,0.,0.,0.\nGRID,2,,1000.,0.,0.,,23456\nCROD,1,1,1,2\nPROD,1,1,100.\nMAT1,1,210000.,,.3
/// SPC1,1,123456,1\nFORCE,2,2,,2100.,1.,0.,0.\nENDDATA\n";
/// let files = InMemory::default().with_file("rod.bdf", ROD);
/// let solved = solve_deck(Path::new("rod.bdf"), Default::default(), &Context::new(&files))?;
/// let end = solved.solution.cases[0].displacement[1][0];
/// assert!((end - 2100.0 * 1000.0 / (210_000.0 * 100.0)).abs() < 1e-12);
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn solve_deck(
    path: &Path,
    options: SolveOptions,
    cx: &Context,
) -> Result<Outcome<SolvedCases>, Faults> {
    let mut work = Work::new(cx);
    let task = work.stage("read", |w| of_deck(w, path))?;
    let answer = solve_cases(&mut work, task, options, title_of(path), None)?;
    Ok(work.finish(StatedUnits::default(), answer))
}

fn title_of(path: &Path) -> String {
    let stem = path.file_stem();
    stem.map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

fn solve_cases(
    work: &mut Work,
    task: Task,
    options: SolveOptions,
    title: String,
    system: Option<UnitSystem>,
) -> Result<SolvedCases, Faults> {
    let Task {
        read,
        mut cases,
        combined,
        corners,
        left_out,
        support,
    } = task;
    let options = SolveOptions { corners, ..options };
    for why in left_out {
        work.findings.push(Finding::new(
            Severity::Warning,
            "subcase-left-out",
            read.given.clone(),
            why,
            "solve it with Nastran",
        ));
    }
    let (mut solution, mut report) = solve_kept(work, &read, &cases, options)?;
    add_combinations(&read, &combined, &mut cases, (&mut solution, &mut report))?;
    work.findings.extend(solution.findings.iter().cloned());
    Ok(SolvedCases {
        grids: report.grids,
        dofs: report.dofs,
        factor_nonzeros: report.factor_nonzeros,
        ordering: report.ordering,
        smallest_pivot: report.smallest_pivot,
        epsilon: report.epsilon,
        model_units: system.map_or_else(StatedUnits::default, StatedUnits::of_model),
        balance: report.balance.clone(),
        mass: report.mass.map(|m| MassAndCentre {
            mass: m.mass,
            cg: [m.cg.x, m.cg.y, m.cg.z],
        }),
        support,
        reactions: report.reactions.clone(),
        elastic_modes_hz: report.modes.clone(),
        peak_memory_bytes: peak_memory(),
        title,
        system,
        deck: read,
        cases,
        solution,
        report,
    })
}

fn of_job(work: &mut Work, job: &Job) -> Result<Task, Faults> {
    let Some(files) = &job.model else {
        return Err(Fault::new(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )
        .into());
    };
    check_named(work, job, MissingResults::Refused)?;
    let read = read_deck(work, job, files)?;
    let support = support_of_job(job, &read.model)?;
    let cases = cases_of_job(job, &read)?;
    work.findings.extend(relief_of_job(job, &read.model)?);
    Ok(Task {
        read,
        cases,
        combined: Vec::new(),
        corners: Corners::Compute,
        left_out: Vec::new(),
        support: Some(support.words()),
    })
}

fn of_deck(work: &mut Work, path: &Path) -> Result<Task, Faults> {
    let given = path.display().to_string();
    let base = PathBuf::new();
    let read = read_model(&mut work.inputs, &base, &given)?;
    work.findings.extend(read.findings.iter().cloned());
    Faults::check(read.faults.clone())?;
    refuse_repeated_subcases(&read)?;
    refuse(&read.model, &[]).map_err(|e| faults_of(&e, &read))?;
    let suport = suport_without_inrel(&read.model, read.deck.sol);
    let explained = suport.is_some();
    work.findings.extend(suport);
    work.findings.extend(other_sequence(&read));
    let mut left_out = Vec::new();
    let mut cases = Vec::new();
    let mut combined = Vec::new();
    let mut corners = corners_always_written(&read.model);
    let subcases = read.deck.case_control.effective_subcases();
    let mut solved = Vec::new();
    for (i, s) in subcases.iter().enumerate() {
        if is_combination(s) {
            let at = cases.len() + combined.len();
            let above = (&subcases[..i], solved.as_slice());
            combined.push(read_combination(&read, s, above, at)?);
            solved.push(None);
            continue;
        }
        match static_case(&read.model, s) {
            Ok(case) => {
                if s.request("STRAIN").is_none_or(asks_for_corners) {
                    corners = Corners::Compute;
                }
                solved.push(Some(cases.len()));
                cases.push(case);
            }
            Err(why) => {
                left_out.push(format!("subcase {}: {why}", s.id));
                solved.push(None);
            }
        }
    }
    let relieved = cases.iter().find(|c| c.spc.is_none());
    work.findings.extend(relieved.and_then(|c| {
        let support = match c.relief {
            Relief::None => return None,
            _ => Support::without_spc(&read.model),
        };
        // SUPORT without PARAM,INREL is already reported, together with the assumption.
        let new = |f: &Finding| !explained || f.code != "inertia-relief-assumed";
        relief_finding(&read.model, support, SupportChoice::Deck).filter(new)
    }));
    if cases.is_empty() {
        return Err(Faults::from(Fault::new(
            given,
            "case control",
            "no static subcase with a LOAD",
            "add `LOAD = n` to a subcase, or give a job with [[load]] entries",
        )));
    }
    Ok(Task {
        read,
        cases,
        combined,
        corners,
        left_out,
        support: None,
    })
}

/// Returns a note that loads of a deck for another linear analysis are solved as statics.
fn other_sequence(read: &DeckModel) -> Option<Finding> {
    /// Sequences with static subcases: statics, inertia relief, buckling, optimisation.
    const STATICS: [u32; 9] = [1, 2, 5, 24, 61, 65, 101, 105, 200];
    let sequence = read.deck.sol.filter(|s| !STATICS.contains(s))?;
    Some(Finding::new(
        Severity::Info,
        "solution-sequence",
        &read.given,
        format!(
            "SOL {sequence} has no static subcases: the loads of its subcases are solved as linear statics"
        ),
        "write SOL 101 if statics is meant",
    ))
}

/// Returns whether a request for strain names a method for corners; Nastran's default is the centre. A deck that asks for no strain at all gets
/// both.
fn asks_for_corners(r: &Request) -> bool {
    ["CORNER", "BILIN", "CUBIC", "SGAGE"]
        .iter()
        .any(|o| r.has(o))
}

/// Result files have no element type for the centre of CQUAD8 and CTRIA6 alone.
fn corners_always_written(model: &Model) -> Corners {
    let curved = |s: &Shell| matches!(s.shape, ShellShape::Quad8 | ShellShape::Tria6);
    if model.shells.iter().any(curved) {
        Corners::Compute
    } else {
        Corners::Leave
    }
}

/// Returns the largest resident memory of this process so far, bytes; `None` if the system does not report it.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}
