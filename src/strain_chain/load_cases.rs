//! Search for the case of the results in which each load of a job acts.

use crate::fe::from_results::{HOLD_ONCE, RepeatedSubcase, complete_case, find_repeated_results};
use crate::fe::{CaseResult, Solution};
use crate::finding::list_few;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::{Job, JobLoad, NamedFile, Reference};
use crate::strain_chain::named_results::results_fault;
use nastran::results::ResultsFile;
use std::collections::{BTreeMap, BTreeSet};

/// Load or reference state that takes a subcase of the results.
struct Taker<'a> {
    line: u32,
    key: &'static str,
    what: String,
    subcase: u32,
    /// The file that the job names for the load.
    file: Option<&'a str>,
}

impl Taker<'_> {
    fn fault(&self, job: &Job, wrong: &str, remedy: impl Into<String>) -> Fault {
        let wrong = format!("{}: {wrong}", self.what);
        Fault::with_line(&*job.file, self.line, self.key, wrong, remedy)
    }
}

/// Returns solution and case of every load, in job order. A subcase whose elements are spread over several files becomes one case.
///
/// `solutions` contains the solution of each result file. `repeated_in` contains, by file, the subcases that it states more than once with different
/// values.
///
/// # Errors
/// Loads without a case; subcases that are present more than once with different values.
pub(super) fn find_cases(
    work: &mut Work,
    job: &Job,
    solutions: &mut [Solution],
    repeated_in: &[Vec<RepeatedSubcase>],
) -> Result<Vec<(usize, usize)>, Faults> {
    let files: Vec<&NamedFile> = job.model.iter().flat_map(|m| &m.results).collect();
    let takers = takers(job);
    let mut faults = FaultList::new();
    let mut shared: BTreeSet<u32> = BTreeSet::new();
    for taker in &takers {
        for (named, repeated) in files.iter().zip(repeated_in) {
            let is_meant = taker.file.is_none_or(|f| f == named.given);
            let mut found = repeated.iter().filter(|r| r.is_of_strain());
            if let Some(r) = found.find(|r| is_meant && r.subcase == taker.subcase) {
                faults.push(taker.fault(job, &r.words(&[&named.given]), HOLD_ONCE));
            }
        }
        if taker.file.is_none() && holders(solutions, taker.subcase).len() > 1 {
            shared.insert(taker.subcase);
        }
    }
    Faults::check(faults)?;
    if !shared.is_empty() {
        check_shared(work, job, &files, (&takers, &shared))?;
        shared.iter().for_each(|id| join(solutions, *id));
    }
    let names: Vec<&str> = files.iter().map(|f| f.given.as_str()).collect();
    cases_of_loads(job, solutions, &names)
}

/// Returns the loads of a job, and its reference if that is a subcase.
fn takers(job: &Job) -> Vec<Taker<'_>> {
    let loads = job.loads.iter().map(|load| Taker {
        line: load.line,
        key: "load.subcase",
        what: format!("load `{}`", load.name),
        subcase: load.subcase(),
        file: load.result.as_ref().map(|r| r.given.as_str()),
    });
    let reference = job.measured.as_ref().and_then(|m| match m.reference {
        Reference::Subcase(subcase) => Some(Taker {
            line: m.line,
            key: "measured.reference",
            what: "the reference".to_owned(),
            subcase,
            file: None,
        }),
        Reference::None | Reference::Gravity => None,
    });
    loads.chain(reference).collect()
}

/// Returns the index of each solution that contains the subcase with strain, and the index of its case.
fn holders(solutions: &[Solution], subcase: u32) -> Vec<(usize, usize)> {
    let case = |s: &Solution| {
        let mut cases = s.cases.iter();
        cases.position(|c| c.subcase == subcase && has_strain(c))
    };
    let all = solutions.iter().enumerate();
    all.filter_map(|(i, s)| Some((i, case(s)?))).collect()
}

/// Refuses subcases whose values differ between files. The files are read again, since all of them are compared at the same time.
fn check_shared(
    work: &mut Work,
    job: &Job,
    files: &[&NamedFile],
    (takers, shared): (&[Taker], &BTreeSet<u32>),
) -> Result<(), Faults> {
    let mut bytes = Vec::new();
    for named in files {
        bytes.push(work.inputs.read_named(job, named)?);
    }
    let mut read = Vec::new();
    for (named, bytes) in files.iter().zip(&bytes) {
        let file = ResultsFile::read(bytes, &named.given);
        read.push(file.map_err(|e| results_fault(job, named, &e))?);
    }
    let found = find_repeated_results(&read.iter().collect::<Vec<_>>(), Some(shared));
    let names: Vec<&str> = files.iter().map(|f| f.given.as_str()).collect();
    let mut faults = FaultList::new();
    for taker in takers.iter().filter(|t| t.file.is_none()) {
        let mut differing = found.iter().filter(|r| r.is_of_strain());
        if let Some(r) = differing.find(|r| r.subcase == taker.subcase) {
            let first = r.files.first().and_then(|(f, _)| names.get(*f));
            let remedy = match taker.key {
                "load.subcase" => format!(
                    "name the file that contains the load: result = \"{}\"",
                    first.copied().unwrap_or_default()
                ),
                _ => "name result files in `model.results` of which only one contains the load"
                    .to_owned(),
            };
            faults.push(taker.fault(job, &r.words(&names), remedy));
        }
    }
    Faults::check(faults)
}

/// Adds the elements of a subcase in further files to its case in the first one.
fn join(solutions: &mut [Solution], subcase: u32) {
    let mut holders = holders(solutions, subcase).into_iter();
    let Some((first, case)) = holders.next() else {
        return;
    };
    for (s, c) in holders {
        let other = solutions.get(s).and_then(|s| s.cases.get(c)).cloned();
        let own = solutions.get_mut(first).and_then(|s| s.cases.get_mut(case));
        if let (Some(own), Some(other)) = (own, other) {
            complete_case(own, other);
        }
    }
}

fn cases_of_loads(
    job: &Job,
    solutions: &[Solution],
    names: &[&str],
) -> Result<Vec<(usize, usize)>, Faults> {
    let (mut faults, mut found) = (FaultList::new(), Vec::new());
    for load in &job.loads {
        let file = load.result.as_ref().map(|r| r.given.as_str());
        let holders = holders(solutions, load.subcase()).into_iter();
        let mut hits = holders.filter(|(i, _)| file.is_none_or(|f| names.get(*i) == Some(&f)));
        // One file for each load case is common. If the file named for the load has a single case, the subcase is not needed.
        let hit = hits.next().or_else(|| {
            let i = names.iter().position(|n| Some(*n) == file)?;
            let only = solutions[i].cases.len() == 1 && load.subcase.is_none();
            only.then_some((i, 0))
        });
        match hit {
            Some(h) => found.push(h),
            None => faults.push(without_case(job, load, solutions)),
        }
    }
    Faults::check(faults)?;
    Ok(found)
}

fn without_case(job: &Job, load: &JobLoad, solutions: &[Solution]) -> Fault {
    let cases = solutions.iter().flat_map(|s| &s.cases);
    let there = cases.filter(|c| has_strain(c));
    let there: Vec<String> = there.map(|c| c.subcase.to_string()).collect();
    let wrong = format!(
        "load `{}`: no static subcase {} with strain in the results",
        load.name,
        load.subcase()
    );
    let remedy = match there.is_empty() {
        true => "ask for STRAIN(FIBER,CENTER) = ALL and PARAM,POST,-1 in the run (`cases` writes such a deck)".to_owned(),
        false => format!("state `subcase`; the results contain {}", list_few(&there)),
    };
    Fault::with_line(&*job.file, load.line, "load.subcase", wrong, remedy)
}

/// Refuses loads whose subcase follows from their number in the job, if labels of the results name another subcase.
///
/// `labels` has LABEL or SUBTITLE by subcase of each result file. Labels that are not load names are free text.
///
/// # Errors
/// Every load whose subcase has the name of another load of the job, or whose name another subcase has.
pub(super) fn check_labels(
    job: &Job,
    solutions: &[Solution],
    of_load: &[(usize, usize)],
    labels: &[BTreeMap<u32, String>],
) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    let same = |label: &str, name: &str| label_alone(label).eq_ignore_ascii_case(name.trim());
    for (load, (file, case)) in job.loads.iter().zip(of_load) {
        let case = solutions.get(*file).and_then(|s| s.cases.get(*case));
        let (Some(case), Some(in_file), None) = (case, labels.get(*file), load.subcase) else {
            continue;
        };
        let own = in_file.get(&case.subcase).map_or("", String::as_str);
        if same(own, &load.name) {
            continue;
        }
        // A label of several subcases does not identify a subcase.
        let mut with_own = in_file.values().filter(|l| l.as_str() == own);
        let is_single = with_own.next().is_some() && with_own.next().is_none();
        let mut others = job.loads.iter().filter(|l| l.name != load.name);
        let other = others.find(|l| is_single && same(own, &l.name));
        let mut named = in_file.iter().filter(|(_, label)| same(label, &load.name));
        let named = match (named.next(), named.next()) {
            (Some((subcase, _)), None) => Some(*subcase),
            _ => None,
        };
        if other.is_some() || named.is_some() {
            faults.push(other_label(job, load, (case.subcase, own), named));
        }
    }
    Faults::check(faults)
}

/// Returns the label without text that a program appends far to the right.
fn label_alone(label: &str) -> &str {
    label.trim().split("   ").next().unwrap_or_default()
}

fn other_label(
    job: &Job,
    load: &JobLoad,
    (subcase, label): (u32, &str),
    named: Option<u32>,
) -> Fault {
    let wrong = format!(
        "job-contradicts-deck: load `{}` has number {} in the job and takes subcase {subcase}, whose label in the results is `{}`",
        load.name,
        load.number,
        label_alone(label)
    );
    let remedy = match named {
        Some(named) => format!(
            "state subcase = {named}, which has the label `{}`; or state subcase = {subcase} if the label is wrong",
            load.name
        ),
        None => format!("state `subcase` of the load; subcase = {subcase} if the label is wrong"),
    };
    Fault::with_line(&*job.file, load.line, "load.subcase", wrong, remedy)
}

fn has_strain(c: &CaseResult) -> bool {
    !c.shells.elements.is_empty() || !c.beams.elements.is_empty()
}
