//! The job's model and the strain of its unit loads, from result files or from the built-in solver.

use super::combined_subcases::{other_stations, read_combination};
use super::deck_loads::check_deck_loads;
use super::deck_supports::check_deck_supports;
use super::load_cases::{check_labels, find_cases};
use super::mesh::{MeshError, WantedAt, not_checked, take_out};
use super::unit_loads::unit_loads;
use crate::fe::from_results::{
    Displacements, ReadOptions, find_repeated_results, other_element_types, solution_from_file,
    subcase_labels,
};
use crate::fe::{CaseResult, LoadCase, Solution, SolveOptions, UnitLoad, combine_results};
use crate::gauge::CornerRows;
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::{Job, JobLoad, LoadRole, ModelFiles, Reference};
use crate::model::{BeamIx, Load as ModelLoad, Model};
use crate::sensitivity::{Load, LoadCaseOf};
use crate::strain_chain::built_in_solver::{
    MODES, cases_of_job, is_combination, label_of, relief_of_job, solve_kept, static_case,
    support_of_job,
};
use crate::strain_chain::deck::DeckModel;
use crate::strain_chain::job_deck::read_deck;
use crate::strain_chain::named_results::{other_deck, results_fault};
use crate::strain_chain::solver_check::check_against_solver;
use nastran::bdf::Subcase;
use nastran::results::ResultsFile;
use std::collections::BTreeSet;

/// Model and strain fields.
pub struct Fields {
    /// Deck and model.
    pub deck: DeckModel,
    /// Solutions from result files, or the solution of the built-in solver.
    pub solutions: Vec<Solution>,
    solved_here: bool,
    /// Solution and case of each load.
    of_load: Vec<(usize, usize)>,
    /// Mesh error that was subtracted from `solutions`, by load of the job. `None` if it was not computed.
    pub mesh_error: Option<MeshError>,
    /// First elastic frequency of the structure with the supports of the job, cycles per unit of time. `None` if another program solved it, or if
    /// additional loads were solved with it.
    pub first_mode: Option<f64>,
    /// Subcase of the deck that is the reference state of the readings, solved by the built-in solver. `None` if another program solved it, or if the
    /// job has no such state.
    reference: Option<CaseResult>,
    /// Solution of the additional loads; `None` if another program solved the loads of the job.
    pub additional: Option<Solution>,
}

/// Function that returns the loads to solve on a model in addition to the loads of a job.
pub type AdditionalUnitLoads<'a> = &'a dyn Fn(&Model) -> Result<Vec<UnitLoad>, Faults>;

impl Fields {
    /// Returns the model.
    pub fn model(&self) -> &Model {
        &self.deck.model
    }

    /// Returns every load with the case in which it acts, in job order.
    pub fn load_cases<'a>(&'a self, job: &Job) -> Vec<LoadCaseOf<'a>> {
        let cases = self.of_load.iter();
        of_loads(job, cases.map(|&(s, c)| &self.solutions[s].cases[c]))
    }

    /// Returns every load with the mesh error in its case, in job order; empty if the mesh error was not computed.
    pub fn mesh_cases<'a>(&'a self, job: &Job) -> Vec<LoadCaseOf<'a>> {
        of_loads(job, self.mesh_error.iter().flat_map(|e| &e.cases))
    }

    /// Returns the share of the mesh error that may remain; 0 if the mesh error was not computed.
    pub fn mesh_left(&self) -> f64 {
        self.mesh_error.as_ref().map_or(0.0, |e| e.left)
    }

    /// Returns the reference state, a subcase of the deck, from its results or from the built-in solver. Cases that were solved for the job's loads
    /// have numbers of the job, which are not subcase numbers.
    pub fn subcase(&self, id: u32) -> Option<&CaseResult> {
        if self.is_solved_here() {
            return self.reference.as_ref().filter(|c| c.subcase == id);
        }
        let mut cases = self.solutions.iter().flat_map(|s| &s.cases);
        cases.find(|c| c.subcase == id)
    }

    /// Returns whether the built-in solver solved the loads.
    pub fn is_solved_here(&self) -> bool {
        self.solved_here
    }

    /// Returns whether every load's case has strain at corners.
    pub fn corner_rows(&self, job: &Job) -> CornerRows {
        let all = self
            .load_cases(job)
            .iter()
            .all(|l| !l.case.shells.corners.is_empty());
        if all {
            CornerRows::Present
        } else {
            CornerRows::Absent
        }
    }
}

/// Pairs the loads of a job with their cases.
fn of_loads<'a>(job: &Job, cases: impl Iterator<Item = &'a CaseResult>) -> Vec<LoadCaseOf<'a>> {
    job.loads
        .iter()
        .zip(cases)
        .map(|(l, case)| LoadCaseOf {
            load: Load {
                name: l.name.clone(),
                expected: l.expected,
                wanted: l.role == LoadRole::Wanted,
                quantity: l.quantity(),
            },
            applied: l.applied,
            case,
        })
        .collect()
}

/// Reads the model and finds the case of every load. If the job requests strain without mesh error, it is computed `at` these places.
///
/// # Errors
/// Faults of the deck, unreadable results, loads without a case.
pub fn read_fields(work: &mut Work, job: &Job, at: WantedAt) -> Result<Fields, Faults> {
    read_fields_with_additional_loads(work, job, at, None)
}

/// Reads the model like [`read_fields`], and solves for the loads `additional` with the same matrix factor. Elastic modes are then omitted, since no
/// caller needs them.
///
/// # Errors
/// Every error of [`read_fields`] and of `additional`.
pub fn read_fields_with_additional_loads(
    work: &mut Work,
    job: &Job,
    at: WantedAt,
    additional: Option<AdditionalUnitLoads<'_>>,
) -> Result<Fields, Faults> {
    let Some(files) = &job.model else {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )));
    };
    if job.loads.is_empty() {
        return Err(Faults::from(Fault::new(
            &*job.file,
            "load",
            "the job has no [[load]]",
            "name the loads to be recovered, one [[load]] each",
        )));
    }
    let deck = work.stage("read model", |s| read_deck(s, job, files))?;
    match files.results.is_empty() {
        true => solve_fields(work, job, deck, at, additional),
        false => read_results(work, job, files, deck),
    }
}

/// Solves the unit loads of the job, its reference subcase and further cases together with the built-in solver.
///
/// # Errors
/// Faults that stop the solver, with file and line.
fn solve_fields(
    work: &mut Work,
    job: &Job,
    deck: DeckModel,
    at: WantedAt,
    additional: Option<AdditionalUnitLoads<'_>>,
) -> Result<Fields, Faults> {
    let mut cases = cases_of_job(job, &deck)?;
    work.findings.extend(relief_of_job(job, &deck.model)?);
    let of_job = cases.len();
    let number = |cases: &[LoadCase]| cases.iter().map(|c| c.subcase + 1).max().unwrap_or(1);
    let reference = reference_state(job, &deck)?;
    for (_, case) in reference.iter().flat_map(|r| &r.terms) {
        let subcase = number(&cases);
        cases.push(LoadCase {
            subcase,
            ..case.clone()
        });
    }
    let of_reference = cases.len();
    if let Some(additional) = additional {
        let support = support_of_job(job, &deck.model)?;
        let more = support.unit_cases(&deck.model, &additional(&deck.model)?);
        let first = number(&cases);
        let numbered = |(subcase, case)| LoadCase { subcase, ..case };
        cases.extend((first..).zip(more).map(numbered));
    }
    let options = SolveOptions {
        modes: if additional.is_some() { 0 } else { MODES },
        ..SolveOptions::default()
    };
    let (mut solved, report) = solve_kept(work, &deck, &cases, options)?;
    // Findings on loads that the job does not state are dropped.
    let unasked = |c: &LoadCase| format!("subcase {}", c.subcase);
    let unasked: BTreeSet<String> = cases.iter().skip(of_reference).map(unasked).collect();
    solved.findings.retain(|f| !unasked.contains(&f.subject));
    if let Some(state) = &reference {
        for (case, (_, of_deck)) in cases.iter().skip(of_job).zip(&state.terms) {
            let own = format!("subcase {}", case.subcase);
            let id = of_deck.subcase;
            let of_it = solved.findings.iter_mut().filter(|f| f.subject == own);
            of_it.for_each(|f| f.subject = format!("reference, subcase {id} of the deck"));
        }
    }
    work.findings.extend(solved.findings.iter().cloned());
    let additional = additional.map(|_| Solution {
        cases: solved.cases.split_off(of_reference),
        findings: Vec::new(),
        source: solved.source.clone(),
    });
    let mut terms = solved.cases.split_off(of_job);
    cases.truncate(of_reference);
    let mesh_error = take_out(work, job, &deck, (&cases, at), (&mut solved, &mut terms));
    let reference = match &reference {
        Some(state) => Some(state.add_up(&deck, &terms)?),
        None => None,
    };
    work.go_on()?;
    let of_load = (0..job.loads.len()).map(|i| (0, i)).collect();
    Ok(Fields {
        deck,
        solutions: vec![solved],
        solved_here: true,
        reference,
        of_load,
        mesh_error,
        first_mode: report.modes.first().copied(),
        additional,
    })
}

/// Reads the strain of the unit loads from the results that the job names.
///
/// # Errors
/// Files that cannot be read; loads that do not have exactly one subcase.
fn read_results(
    work: &mut Work,
    job: &Job,
    files: &ModelFiles,
    deck: DeckModel,
) -> Result<Fields, Faults> {
    if files.mesh_error == Some(true) {
        work.findings.push(not_checked(
            "the strain comes from results, and the built-in solver alone can solve a finer mesh",
        ));
    }
    let units = unit_loads(job, &deck.model)?;
    let mut wanted: BTreeSet<u32> = job.loads.iter().map(JobLoad::subcase).collect();
    if let Some(Reference::Subcase(id)) = job.measured.as_ref().map(|m| m.reference) {
        wanted.insert(id);
    }
    let options = ReadOptions {
        displacements: Displacements::Leave,
        subcases: Some(wanted),
        ..ReadOptions::default()
    };
    let (mut solutions, mut repeated_in, mut labels) = (Vec::new(), Vec::new(), Vec::new());
    for named in &files.results {
        let bytes = work.inputs.read_named(job, named).map_err(Faults::from)?;
        let read = work.stage("read results", |_| {
            ResultsFile::read(&bytes, &named.given).map(|file| {
                let solution = solution_from_file(&deck.model, &named.given, &file, &options);
                let repeated = find_repeated_results(&[&file], options.subcases.as_ref());
                (solution, repeated, subcase_labels(&file))
            })
        });
        let (mut solution, repeated, of_file) = read.map_err(|e| results_fault(job, named, &e))?;
        for case in &mut solution.cases {
            case.beams.mark_loaded(loaded_bars(&deck, case.subcase));
        }
        work.findings.extend(solution.findings.iter().cloned());
        if let Some(other) = other_element_types(&solution.findings) {
            return Err(other_deck(job, named, other).into());
        }
        solutions.push(solution);
        repeated_in.push(repeated);
        labels.push(of_file);
    }
    let of_load = find_cases(work, job, &mut solutions, &repeated_in)?;
    check_labels(job, &solutions, &of_load, &labels)?;
    let cases = of_load.iter().map(|(s, c)| &solutions[*s].cases[*c]);
    check_deck_loads(job, &deck, &units, cases.clone())?;
    let supports = check_deck_supports(job, &deck, cases.clone());
    work.findings.extend(supports);
    let contradiction = check_against_solver(work, job, &deck, &cases.collect::<Vec<_>>());
    work.findings.extend(contradiction);
    work.go_on()?;
    work.findings.push(super::source_finding(
        &solutions
            .iter()
            .map(|s| s.source.as_str())
            .collect::<Vec<_>>()
            .join("; "),
    ));
    Ok(Fields {
        deck,
        solutions,
        solved_here: false,
        reference: None,
        of_load,
        mesh_error: None,
        first_mode: None,
        additional: None,
    })
}

/// Reference state of the readings as static subcases of the deck with their factors: one subcase, or the subcases of a combination.
struct ReferenceState {
    subcase: Subcase,
    terms: Vec<(f64, LoadCase)>,
}

impl ReferenceState {
    /// Adds up the results of the subcases, which come in the order of the terms.
    ///
    /// # Errors
    /// Results of bars at different stations, which cannot be added.
    fn add_up(&self, deck: &DeckModel, results: &[CaseResult]) -> Result<CaseResult, Faults> {
        let factors = self.terms.iter().map(|t| t.0);
        let terms: Vec<_> = factors.zip(results).collect();
        combine_results(self.subcase.id, label_of(&self.subcase), &terms)
            .ok_or_else(|| other_stations(deck, &self.subcase).into())
    }
}

/// Returns the subcase of the deck that the job names as its reference state. `None` if the job names no subcase, or if the deck has no such static
/// subcase with a load.
///
/// # Errors
/// A combination that is not a sum of static subcases.
fn reference_state(job: &Job, deck: &DeckModel) -> Result<Option<ReferenceState>, Faults> {
    let Some(Reference::Subcase(id)) = job.measured.as_ref().map(|m| m.reference) else {
        return Ok(None);
    };
    let subcases = deck.deck.case_control.effective_subcases();
    let Some(at) = subcases.iter().position(|s| s.id == id) else {
        return Ok(None);
    };
    let (above, subcase) = (&subcases[..at], subcases[at].clone());
    if !is_combination(&subcase) {
        let case = static_case(&deck.model, &subcase).ok();
        return Ok(case.map(|case| ReferenceState {
            subcase,
            terms: vec![(1.0, case)],
        }));
    }
    let cases: Vec<Option<LoadCase>> = above
        .iter()
        .map(|s| static_case(&deck.model, s).ok())
        .collect();
    let solved: Vec<Option<usize>> = (0..at).map(|i| cases[i].is_some().then_some(i)).collect();
    let combined = read_combination(deck, &subcase, (above, &solved), at)?;
    let terms = combined.terms().iter();
    let terms = terms.filter_map(|(factor, i)| Some((*factor, cases.get(*i)?.clone()?)));
    Ok(Some(ReferenceState {
        terms: terms.collect(),
        subcase,
    }))
}

/// Returns the bars and beams with PLOAD1 in the load set of a subcase; in any load set if the deck has no such subcase.
fn loaded_bars(deck: &DeckModel, subcase: u32) -> Vec<BeamIx> {
    let subcases = deck.deck.case_control.effective_subcases();
    let selected = subcases.iter().find(|s| s.id == subcase);
    let acts = |sid: u32| selected.is_none_or(|s| s.load == Some(sid));
    let sets = deck.model.load_sets.iter().filter(|s| acts(s.sid));
    let loads = sets.flat_map(|s| &s.loads);
    loads
        .filter_map(|(factor, load)| match load {
            ModelLoad::Line { beam, .. } if *factor != 0.0 => Some(*beam),
            _ => None,
        })
        .collect()
}
