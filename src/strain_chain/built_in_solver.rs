//! Access of all commands to the built-in solver. Solutions are kept in the store of the context, and are reused while their inputs are unchanged.

use crate::fe::{
    Corners, DisplacementSolution, FeError, LoadCase, Relief, Solution, SolveOptions, SolveReport,
    Support, SupportChoice, UnitLoad, relief_finding, solution_of, solve_displacements,
    solve_modes, support_of,
};
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::store::{Key, read_solution, write_solution};
use crate::host::work::{Work, cancelled_fault};
use crate::job::Job;
use crate::model::Model;
use crate::strain_chain::deck::DeckModel;
use crate::strain_chain::repeated_subcases::refuse_repeated_subcases;
use nastran::bdf::{Subcase, SubcaseKind};
use std::collections::BTreeSet;
use std::fmt::Write;

/// Number of elastic modes computed together with the strain by default.
pub const MODES: usize = 10;

/// Number of grids of the largest deck that is solved a second time without a request. Such a solution takes less than a second on two processors. On
/// a mesh of half the width it takes about 5 s and 1 GB.
pub(super) const MOST_GRIDS_TWICE: usize = 13_000;

/// Returns the support of the structure of a job under its unit loads.
///
/// # Errors
/// An SPC set that the deck lacks; subcases that select several SPC sets; an SPC set that moves grids.
pub fn support_of_job(job: &Job, model: &Model) -> Result<Support, Faults> {
    let (wanted, line) = job
        .model
        .as_ref()
        .map_or((SupportChoice::Deck, 0), |m| (m.support, m.support_line));
    let fault = |wrong: String, remedy: &str| {
        Fault::with_line(&*job.file, line, "model.support", wrong, remedy)
    };
    let support = support_of(model, wanted).map_err(|e| {
        let remedy = "write support = \"free\", or the id of the SPC set that supports the structure during the measurement";
        Faults::from(fault(e.to_string(), remedy))
    })?;
    match moved_by(model, support) {
        None => Ok(support),
        Some((sid, grid, by)) => Err(Faults::from(fault(
            format!(
                "SPC set {sid} moves grid {grid} by {by}: the strain of this displacement belongs to no load, and would be in every column of S"
            ),
            "set the displacement to 0, or name another set; `solve` on the deck uses displacements that its subcases enforce",
        ))),
    }
}

/// Returns the first displacement other than zero that a support enforces: SPC set, grid, size.
fn moved_by(model: &Model, support: Support) -> Option<(u32, u32, f64)> {
    let set = model.spcs.iter().find(|s| Some(s.sid) == support.spc)?;
    let (grid, _, by) = set.terms.iter().find(|t| t.2 != 0.0)?;
    Some((set.sid, model.grids.get(grid.us())?.id, *by))
}

/// Returns a finding on the inertia relief of a job: assumed, or limited by springs to ground.
///
/// # Errors
/// The faults of [`support_of_job`].
pub fn relief_of_job(job: &Job, model: &Model) -> Result<Option<Finding>, Faults> {
    let wanted = job
        .model
        .as_ref()
        .map_or(SupportChoice::Deck, |m| m.support);
    let support = support_of_job(job, model)?;
    // Without PARAM,INREL in the deck, the structure of a job is free. The reference of the key `support` documents this.
    let limited = |f: &Finding| f.code == "tied-to-ground" || support.by_springs > 0;
    Ok(relief_finding(model, support, wanted).filter(limited))
}

/// Returns a finding on the support, for `check` and `init`.
pub fn support_finding(deck: &str, support: Support) -> Finding {
    Finding::new(
        Severity::Info,
        "support",
        deck,
        format!("under unit loads the structure is {}", support.words()),
        "state `support` in [model] if the support during the measurement differs",
    )
}

/// Refuses a command that needs a structure on its wheels, if supports hold the structure.
///
/// # Errors
/// A structure that is held by an SPC set or by springs to ground.
pub fn stands_on_wheels(job: &Job, model: &Model, what: &str) -> Result<(), Faults> {
    let support = support_of_job(job, model)?;
    if !support.is_held() {
        return Ok(());
    }
    let line = job.model.as_ref().map_or(0, |m| m.support_line);
    Err(Faults::from(Fault::with_line(
        &*job.file,
        line,
        "model.support",
        format!(
            "{what} needs a structure on its wheels, and this one is {}",
            support.words()
        ),
        match support.spc {
            Some(_) => "write support = \"free\" if wheels carry it",
            None => "remove the springs and supports to ground, so that wheels carry it",
        },
    )))
}

/// Returns the unit loads of a job as load cases. Subcases are numbered in job order.
///
/// # Errors
/// Grids and coordinate systems that the deck lacks.
pub fn cases_of_job(job: &Job, read: &DeckModel) -> Result<Vec<LoadCase>, Faults> {
    refuse_repeated_subcases(read)?;
    check_mpc_sets(read)?;
    let support = support_of_job(job, &read.model)?;
    let loads = crate::strain_chain::unit_loads(job, &read.model)?;
    crate::strain_chain::unit_loads::refuse_missing_sets(job, &read.model, &loads)?;
    Ok(job
        .loads
        .iter()
        .zip(loads)
        .map(|(l, load)| LoadCase {
            subcase: l.number,
            label: l.name.clone(),
            loads: vec![load],
            spc: support.spc,
            mpc: read.model.mpc,
            relief: support.relief,
        })
        .collect())
}

/// Refuses a deck whose subcases select different MPC sets, since the structure under unit loads has one MPC set.
///
/// # Errors
/// One fault with the sets.
fn check_mpc_sets(read: &DeckModel) -> Result<(), Faults> {
    let subcases = read.deck.case_control.effective_subcases();
    let sets: BTreeSet<u32> = subcases.iter().map(|s| s.mpc.unwrap_or(0)).collect();
    if sets.len() < 2 {
        return Ok(());
    }
    let word = |sid: &u32| match sid {
        0 => "none".to_owned(),
        n => n.to_string(),
    };
    let words: Vec<String> = sets.iter().map(word).collect();
    let wrong = format!(
        "the deck's subcases select different MPC sets ({}): unit loads need one",
        list_few(&words)
    );
    let remedy = "select the MPC set of the structure above the subcases only";
    Err(Faults::from(Fault::new(&read.given, "MPC", wrong, remedy)))
}

/// Returns the label of a subcase, or its subtitle.
pub fn label_of(s: &Subcase) -> String {
    s.label.clone().or(s.subtitle.clone()).unwrap_or_default()
}

/// Returns whether a subcase is a combination of other subcases.
pub fn is_combination(s: &Subcase) -> bool {
    matches!(
        s.kind,
        SubcaseKind::Subcom | SubcaseKind::Symcom | SubcaseKind::Repcase
    )
}

/// Returns a static subcase of a deck as a load case.
///
/// # Errors
/// The reason why the subcase is not a load case. It is a combination of other subcases, has an ANALYSIS that is not statics, or has no load.
pub fn static_case(model: &Model, subcase: &Subcase) -> Result<LoadCase, String> {
    if is_combination(subcase) {
        return Err("it combines other subcases".to_owned());
    }
    let analysis = subcase.analysis.as_ref();
    if let Some(analysis) = analysis.filter(|a| !a.starts_with("STAT")) {
        return Err(format!("ANALYSIS = {analysis} is not statics"));
    }
    if subcase.deform.is_some() {
        return Err("DEFORM is not supported".to_owned());
    }
    let case = LoadCase::of_subcase(model, subcase, label_of(subcase));
    if case.loads.is_empty() && !has_enforced(model, subcase.spc) {
        return Err("no LOAD".to_owned());
    }
    Ok(case)
}

/// Returns whether an SPC set moves a grid.
fn has_enforced(model: &Model, spc: Option<u32>) -> bool {
    model
        .spcs
        .iter()
        .any(|s| Some(s.sid) == spc && s.terms.iter().any(|t| t.2 != 0.0))
}

/// Solves load cases on the model of a deck, with its elastic modes, or reads the kept solution.
///
/// # Errors
/// Faults of the solver, with file and line.
pub fn solve_kept(
    work: &mut Work,
    read: &DeckModel,
    cases: &[LoadCase],
    options: SolveOptions,
) -> Result<(Solution, SolveReport), Faults> {
    let identity = identity(work, read, cases, &format!("modes {}", options.modes));
    let solved = displacements_kept(work, &identity, &read.model, cases, &options)
        .map_err(|e| faults_of(&e, read))?;
    for (step, seconds) in &solved.report.seconds {
        work.note_seconds(&format!("solve: {step}"), *seconds);
    }
    work.stage("strain", |_| {
        solution_of(&read.model, cases, solved, &options)
    })
    .map_err(|e| faults_of(&e, read))
}

/// Returns the strain of unit loads on a model made from a deck (a finer mesh, further temperature sets), stored like any other solution. `made`
/// describes how the model was made, which the bytes of the deck do not show.
///
/// # Errors
/// Faults of the solver, with file and line.
pub fn unit_loads_kept(
    work: &mut Work,
    (read, made): (&DeckModel, &str),
    (model, support): (&Model, Support),
    loads: &[UnitLoad],
) -> Result<Solution, Faults> {
    cases_kept(work, (read, made), model, &support.unit_cases(model, loads))
}

/// Returns the strain of load cases like [`unit_loads_kept`].
///
/// # Errors
/// Faults of the solver, with file and line.
pub(super) fn cases_kept(
    work: &mut Work,
    (read, made): (&DeckModel, &str),
    model: &Model,
    cases: &[LoadCase],
) -> Result<Solution, Faults> {
    let options = SolveOptions::default();
    let identity = identity(work, read, cases, made);
    displacements_kept(work, &identity, model, cases, &options)
        .and_then(|solved| solution_of(model, cases, solved, &options))
        .map(|(solution, _)| solution)
        .map_err(|e| faults_of(&e, read))
}

/// Elastic modes of the structure of a deck.
pub struct ElasticModes {
    /// Frequencies, ascending, cycles per unit of time.
    pub hz: Vec<f64>,
    /// Shapes of unit generalised mass, basic frame: translation and rotation by grid index.
    pub shapes: Vec<Vec<[f64; 6]>>,
    /// Strain of the shapes.
    pub strain: Solution,
}

/// Returns the lowest `count` elastic modes on an SPC set with their strain, solved or from the store; fewer if the structure has fewer.
///
/// # Errors
/// Faults of the solver, with file and line.
pub fn modes_kept(
    work: &mut Work,
    read: &DeckModel,
    spc: Option<u32>,
    count: usize,
) -> Result<ElasticModes, Faults> {
    let model = &read.model;
    let case = |subcase: u32| LoadCase {
        subcase,
        label: format!("mode {subcase}"),
        loads: Vec::new(),
        spc,
        mpc: model.mpc,
        relief: Relief::None,
    };
    let identity = identity(work, read, &[case(0)], &format!("shapes of {count} modes"));
    let options = SolveOptions {
        stop: work.cx.progress.stop(),
        ..SolveOptions::default()
    };
    let solve = || {
        let solved = solve_modes(model, spc, model.mpc, count, &options)?;
        let mut displacements: Vec<Vec<[f64; 6]>> =
            solved.modes.iter().map(|m| m.shape.clone()).collect();
        // The result has as many fields as requested. Fields beyond the number of modes are zero.
        displacements.resize(count, vec![[0.0; 6]; model.grids.len()]);
        Ok(DisplacementSolution {
            displacements,
            report: SolveReport {
                grids: model.grids.len(),
                dofs: solved.dofs,
                modes: solved.modes.iter().map(|m| m.frequency).collect(),
                ..SolveReport::default()
            },
            findings: solved.findings,
        })
    };
    let of = (model.grids.len(), count);
    let mut solved =
        load_or_solve(work, &identity, of, "modes", solve).map_err(|e| faults_of(&e, read))?;
    let unsettled = |f: &Finding| f.code == "modes-not-converged";
    work.findings
        .extend(solved.findings.drain(..).filter(unsettled));
    let hz = std::mem::take(&mut solved.report.modes);
    solved.displacements.truncate(hz.len());
    let shapes = solved.displacements.clone();
    let cases: Vec<LoadCase> = (1..).take(hz.len()).map(case).collect();
    let (strain, _) = work
        .stage("strain", |_| solution_of(model, &cases, solved, &options))
        .map_err(|e| faults_of(&e, read))?;
    Ok(ElasticModes { hz, shapes, strain })
}

/// Displacements of load cases from the cache, or solved and put there.
fn displacements_kept(
    work: &mut Work,
    identity: &str,
    model: &Model,
    cases: &[LoadCase],
    options: &SolveOptions,
) -> Result<DisplacementSolution, FeError> {
    let options = SolveOptions {
        stop: work.cx.progress.stop(),
        ..options.clone()
    };
    let of = (model.grids.len(), cases.len());
    load_or_solve(work, identity, of, "solve", || {
        solve_displacements(model, cases, &options)
    })
}

/// Returns a solution of so many grids and fields from the cache, or solves and stores it.
fn load_or_solve(
    work: &mut Work,
    identity: &str,
    (grids, fields): (usize, usize),
    stage: &str,
    solve: impl FnOnce() -> Result<DisplacementSolution, FeError>,
) -> Result<DisplacementSolution, FeError> {
    let key = Key::from_identity(identity);
    let mut store = work.cx.store.clone();
    let read = store
        .as_deref()
        .map(|s| read_solution(s, &key, grids, fields));
    let kept = match read {
        Some(Ok(Some(solved))) => {
            let note = "a stored solution is used (`--no-cache` solves again)";
            if !work.notes.iter().any(|n| n == note) {
                work.notes.push(note.to_owned());
            }
            store = None;
            Some(solved)
        }
        Some(Err(why)) => {
            work.notes.push(format!("solved again: {why}"));
            None
        }
        Some(Ok(None)) | None => None,
    };
    let solved = match kept {
        Some(solved) => solved,
        None => work.stage(stage, |_| solve())?,
    };
    let written = store.as_deref().map(|s| write_solution(s, &key, &solved));
    if let Some(Err(why)) = written {
        work.notes.push(format!(
            "the solution is not stored for the next command: {why}"
        ));
    }
    Ok(solved)
}

/// Returns the first elastic frequency of the structure of a deck, with the supports of the job, whose strain another program solved. If the built-in
/// solver can't compute it, a finding states why.
pub fn first_mode_of(work: &mut Work, job: &Job, read: &DeckModel) -> Option<f64> {
    let solved = cases_of_job(job, read).and_then(|cases| {
        let options = SolveOptions {
            corners: Corners::Leave,
            modes: MODES,
            ..SolveOptions::default()
        };
        solve_kept(work, read, &cases, options)
    });
    let why = match solved {
        Ok((_, report)) => match report.modes.first() {
            Some(f) => return Some(*f),
            None => "it has no elastic mode".to_owned(),
        },
        Err(faults) => faults.first_reason(),
    };
    work.findings.push(Finding::new(
        Severity::Info,
        "first-mode-unknown",
        &read.given,
        format!("the first elastic mode of the structure is not known ({why}): whether the record is slow enough for quasi-static recovery was not checked"),
        "compare the content of the loads with a third of the first elastic frequency of the structure as it is held",
    ));
    None
}

/// Returns the text that identifies displacements by their inputs. These are the program's version, sources, dependencies and features (`build.rs`),
/// the bytes of the deck and its includes, and the load cases.
fn identity(work: &mut Work, read: &DeckModel, cases: &[LoadCase], made: &str) -> String {
    let mut text = format!(
        "strainbridge {} {} {made}\n",
        env!("CARGO_PKG_VERSION"),
        env!("STRAINBRIDGE_SOURCES"),
    );
    for path in &read.files {
        let digest = work.inputs.digest_of(path);
        let _ = writeln!(text, "file {}", digest.unwrap_or_default());
    }
    for case in cases {
        let _ = writeln!(
            text,
            "case {} {:?} {:?} {:?} {:?}",
            case.subcase, case.loads, case.spc, case.mpc, case.relief
        );
    }
    text
}

/// Returns the solver's faults with file and line. A stopped computation is not a fault of the deck.
pub fn faults_of(error: &FeError, read: &DeckModel) -> Faults {
    if *error == FeError::Stopped {
        return cancelled_fault().into();
    }
    let list: FaultList = error
        .faults()
        .into_iter()
        .map(|f| {
            let at = match error {
                FeError::MissingSet { kind, subcase, .. } => {
                    let stated = read.deck.case_control.place_of(kind, Some(*subcase));
                    stated.unwrap_or(f.at)
                }
                _ => f.at,
            };
            let file = match at.line {
                0 => read.given.clone(),
                _ => read.deck.path(at).to_owned(),
            };
            Fault::with_line(file, at.line, f.card, f.reason, f.remedy)
        })
        .collect();
    let unknown = Fault::new(&*read.given, "solve", error.to_string(), "correct the deck");
    Faults::or(list, unknown)
}
