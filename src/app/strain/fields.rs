//! The job's model and the strain of its unit loads, from result files or from the built-in solver.

use super::mesh::{MeshError, WantedAt, not_checked, take_out};
use super::unit_loads::check_places;
use crate::app::deck::DeckModel;
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::{Job, JobLoad, LoadRole, Reference};
use crate::app::job_deck::read_deck;
use crate::app::named_results::results_fault;
use crate::app::solved::{MODES, cases_of_job, solve_kept, support_of_job};
use crate::app::work::Work;
use crate::fe::from_results::{Displacements, ReadOptions, solution_from_file};
use crate::fe::{CaseResult, LoadCase, Solution, SolveOptions, UnitLoad};
use crate::gauge::CornerRows;
use crate::model::Model;
use crate::sensitivity::{Load, LoadCaseOf};
use nastran::results::ResultsFile;
use std::collections::BTreeSet;

/// Model and strain fields.
pub struct Fields {
    /// Deck and model.
    pub deck: DeckModel,
    /// Result files, or one solved here.
    pub solutions: Vec<Solution>,
    /// By load: solution, case.
    of_load: Vec<(usize, usize)>,
    /// The mesh error that was taken out of `solutions`, by load of the job. `None` where that was not computed.
    pub mesh_error: Option<MeshError>,
    /// First elastic frequency of the structure as the job holds it, cycles per unit of time; `None` where another program solved it, and
    /// beside other loads.
    pub first_mode: Option<f64>,
    /// What was solved beside the loads of the job; `None` where nothing was, as another program solved them.
    pub beside: Option<Solution>,
}

/// Loads on a model that are solved for beside those of a job.
pub type Beside<'a> = &'a dyn Fn(&Model) -> Result<Vec<UnitLoad>, Faults>;

impl Fields {
    /// The model.
    pub fn model(&self) -> &Model {
        &self.deck.model
    }

    /// Every load with the case in which it acts, job order.
    pub fn load_cases<'a>(&'a self, job: &Job) -> Vec<LoadCaseOf<'a>> {
        let cases = self.of_load.iter();
        of_loads(job, cases.map(|&(s, c)| &self.solutions[s].cases[c]))
    }

    /// Every load with the mesh error in its case, job order; empty where that was not computed.
    pub fn mesh_cases<'a>(&'a self, job: &Job) -> Vec<LoadCaseOf<'a>> {
        of_loads(job, self.mesh_error.iter().flat_map(|e| &e.cases))
    }

    /// Share of the mesh error that may be left; 0 where it was not computed.
    pub fn mesh_left(&self) -> f64 {
        self.mesh_error.as_ref().map_or(0.0, |e| e.left)
    }

    /// A case by its subcase id.
    pub fn subcase(&self, id: u32) -> Option<&CaseResult> {
        self.solutions
            .iter()
            .flat_map(|s| &s.cases)
            .find(|c| c.subcase == id)
    }

    /// Whether every load's case has strain at corners.
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

/// The loads of a job with their cases.
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

/// Reads the model and finds the case of every load; strain without what the mesh makes, where the job asks for that, is made `at` these places.
///
/// # Errors
/// Faults of the deck, unreadable results, loads without a case.
pub fn read_fields(work: &mut Work, job: &Job, at: WantedAt) -> Result<Fields, Faults> {
    read_fields_beside(work, job, at, None)
}

/// As [`read_fields`], and solves for the loads `beside` with the same factor; elastic modes are then left out, which nobody asks for there.
///
/// # Errors
/// As [`read_fields`]; those of `beside`.
pub fn read_fields_beside(
    work: &mut Work,
    job: &Job,
    at: WantedAt,
    beside: Option<Beside<'_>>,
) -> Result<Fields, Faults> {
    let Some(files) = &job.model else {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )));
    };
    if job.loads.is_empty() {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "load",
            "the job has no [[load]]",
            "name the loads to be recovered, one [[load]] each",
        )));
    }
    let deck = work.stage("read model", |s| read_deck(s, job, files))?;
    if files.results.is_empty() {
        let mut cases = cases_of_job(job, &deck)?;
        let of_job = cases.len();
        if let Some(beside) = beside {
            let support = support_of_job(job, &deck.model)?;
            let more = support.unit_cases(&deck.model, &beside(&deck.model)?);
            let first = cases.iter().map(|c| c.subcase + 1).max().unwrap_or(1);
            let numbered = |(subcase, case)| LoadCase { subcase, ..case };
            cases.extend((first..).zip(more).map(numbered));
        }
        let options = SolveOptions {
            modes: if beside.is_some() { 0 } else { MODES },
            ..SolveOptions::default()
        };
        let (mut solved, report) = solve_kept(work, &deck, &cases, options)?;
        // What is said of a load that nobody asked for is said to nobody.
        let unasked = |c: &LoadCase| format!("subcase {}", c.subcase);
        let unasked: BTreeSet<String> = cases.iter().skip(of_job).map(unasked).collect();
        solved.findings.retain(|f| !unasked.contains(&f.subject));
        work.findings.extend(solved.findings.iter().cloned());
        let beside = beside.map(|_| Solution {
            cases: solved.cases.split_off(of_job),
            findings: Vec::new(),
            source: solved.source.clone(),
        });
        let mesh_error = take_out(work, job, &deck, (&mut solved, at));
        work.go_on()?;
        let of_load = (0..job.loads.len()).map(|i| (0, i)).collect();
        return Ok(Fields {
            deck,
            solutions: vec![solved],
            of_load,
            mesh_error,
            first_mode: report.modes.first().copied(),
            beside,
        });
    }
    if files.mesh_error {
        work.findings.push(not_checked(
            "the strain comes from results, and the built-in solver alone can solve a finer mesh",
        ));
    }
    check_places(job, &deck.model)?;
    let mut wanted: BTreeSet<u32> = job.loads.iter().map(JobLoad::subcase).collect();
    if let Some(Reference::Subcase(id)) = job.measured.as_ref().map(|m| m.reference) {
        wanted.insert(id);
    }
    let options = ReadOptions {
        displacements: Displacements::Leave,
        subcases: Some(wanted),
        ..ReadOptions::default()
    };
    let mut solutions = Vec::new();
    for named in &files.results {
        let bytes = work.inputs.read_named(job, named).map_err(Faults::from)?;
        let solution = work.stage("read results", |_| {
            ResultsFile::read(&bytes, &named.given)
                .map(|file| solution_from_file(&deck.model, &named.given, &file, &options))
        });
        let solution = solution.map_err(|e| results_fault(job, named, &e))?;
        work.findings.extend(solution.findings.iter().cloned());
        solutions.push(solution);
    }
    let of_load = find_cases(job, &solutions)?;
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
        of_load,
        mesh_error: None,
        first_mode: None,
        beside: None,
    })
}

fn find_cases(job: &Job, solutions: &[Solution]) -> Result<Vec<(usize, usize)>, Faults> {
    let mut faults = FaultList::new();
    let mut found = Vec::new();
    let names: Vec<&str> = job
        .model
        .iter()
        .flat_map(|m| &m.results)
        .map(|n| n.given.as_str())
        .collect();
    for load in &job.loads {
        let file = load.result.as_ref().map(|r| r.given.as_str());
        let hit = solutions
            .iter()
            .enumerate()
            .filter(|(i, _)| file.is_none_or(|f| names.get(*i) == Some(&f)))
            .find_map(|(i, s)| {
                let c = s
                    .cases
                    .iter()
                    .position(|c| c.subcase == load.subcase() && has_strain(c))?;
                Some((i, c))
            });
        // A file a load case is common: a file named for the load with a single case needs no subcase.
        let hit = hit.or_else(|| {
            let i = names.iter().position(|n| Some(*n) == file)?;
            let only = solutions[i].cases.len() == 1 && load.subcase.is_none();
            only.then_some((i, 0))
        });
        match hit {
            Some(h) => found.push(h),
            None => {
                let there: Vec<String> = solutions
                    .iter()
                    .flat_map(|s| &s.cases)
                    .filter(|c| has_strain(c))
                    .map(|c| c.subcase.to_string())
                    .collect();
                let wrong = format!(
                    "load `{}`: no static subcase {} with strain in the results",
                    load.name,
                    load.subcase()
                );
                let remedy = if there.is_empty() {
                    "ask for STRAIN(FIBER,CENTER) = ALL and PARAM,POST,-1 in the run (`cases` writes such a deck)".to_owned()
                } else {
                    format!("state `subcase`; the results hold {}", there.join(", "))
                };
                faults.push(Fault::at(
                    &*job.file,
                    load.line,
                    "load.subcase",
                    wrong,
                    remedy,
                ));
            }
        }
    }
    Faults::check(faults)?;
    Ok(found)
}

fn has_strain(c: &CaseResult) -> bool {
    !c.shells.elements.is_empty() || !c.beams.elements.is_empty()
}
