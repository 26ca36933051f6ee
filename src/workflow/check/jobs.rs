//! Jobs: their own faults, and the contents of the files that they name, read by the readers of the commands.

use super::checked_files::CheckedFiles;
use super::command_checks::{ask, recovers};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::outcome::StatedUnits;
use crate::host::work::Work;
use crate::job::readings::stated_readings;
use crate::job::{self, GivenSensitivity, HoldOut, Job, Measured, NamedFile};
use crate::linalg::Matrix;
use crate::measured::runs_file;
use crate::measured::zero::read_zeroed;
use crate::model::Model;
use crate::sensitivity::Sensitivity;
use crate::strain_chain::built_in_solver::{relief_of_job, support_finding, support_of_job};
use crate::strain_chain::job_deck::against_units;
use crate::strain_chain::{given_as_asked, point_findings};
use crate::workflow::{calibrate, identify, reconcile, recover, respond, simulate};
use std::collections::HashSet;
use std::path::Path;

/// Function that checks a file of a folder, by its stated name.
type CheckFile = fn(&mut Work, &Path, &str, &mut CheckedFiles);

/// Checks a job, and with `check_file` every file that the job names.
pub(super) fn check_job(
    work: &mut Work,
    base: &Path,
    given: &str,
    found: &mut CheckedFiles,
    check_file: CheckFile,
) {
    let job = match job::read_job(&mut work.inputs, &base.join(given)) {
        Ok(job) => job,
        Err(f) => return found.faults.extend(f),
    };
    found.units = StatedUnits::from_units(job.units, &job.report_units);
    found.candidates = Some(job.candidates.clone());
    let (decks, of_others) = (found.decks.len(), found.faults.len());
    let results = found.results.len();
    files(work, &job, found, check_file);
    let of_job = found.results.iter_mut().skip(results);
    of_job.for_each(|r| r.is_of_job = true);
    let its_decks = found.decks.iter_mut().skip(decks);
    its_decks.for_each(|d| d.state_units(&job));
    let mut faults = std::mem::take(&mut found.faults);
    let s = job.sensitivity.as_ref().and_then(|_| {
        let read = given_as_asked(work, &job);
        collect_faults(read, &mut faults)
    });
    let gauges = gauges_of(work, &job, s.as_ref(), &mut faults);
    let command = match &job.measured {
        Some(_) if recovers(&job) => "recover",
        _ if simulate::is_asked(&job) => "simulate",
        _ if job.vehicle.is_some() => "identify",
        None => "place",
        Some(_) if job.reconcile.is_some() => "reconcile",
        Some(_) if job.payload.is_some() => "payload",
        Some(_) if job.ballast.is_some() => "ballast",
        Some(_) if job.study.is_some() => "study",
        Some(_) => "calibrate",
    };
    found.next = Some(format!("run `strainbridge {command} {given}`"));
    found.jobs.push(format!(
        "job `{given}`: {} loads, {} gauges, units {}",
        s.as_ref().map_or(job.loads.len(), |s| s.loads.len()),
        match (&s, job.gauges.len()) {
            (None, stated @ 1..) => stated,
            _ => gauges.len(),
        },
        job.units.name()
    ));
    if let Some(m) = &job.measured {
        faults.extend(check_measured_strain(work, &job, m, s.as_ref(), &gauges));
    }
    if let Some((given, _)) = job.sensitivity.as_ref().zip(s.as_ref()) {
        faults.extend(signatures(work, &job, given, &gauges));
    }
    if let Some(r) = &job.runs {
        collect_faults(runs_file::read_runs(&mut work.inputs, &job, r), &mut faults);
    }
    if simulate::is_asked(&job) {
        collect_faults(simulate::check_inputs(work, &job), &mut faults);
    } else if job.vehicle.is_some() {
        collect_faults(identify::check_inputs(work, &job), &mut faults);
    }
    collect_faults(respond::check_inputs(work, &job), &mut faults);
    if let Some(job) = collect_faults(job.without_validation_gauges(), &mut faults) {
        collect_faults(reconcile::check_inputs(work, &job), &mut faults);
        collect_faults(calibrate::check_inputs(work, &job), &mut faults);
    }
    if faults.len() == of_others {
        let deck = found.decks.get(decks).and_then(|d| d.model());
        let grids = deck.map_or(0, |m| m.grids.len());
        collect_faults(ask(work, &job, grids), &mut faults);
    }
    // Two commands can report the same fault or finding of a file. It is kept once.
    each_once(&mut faults, ToString::to_string);
    each_once(&mut work.findings, |f| {
        format!("{} {} {}", f.code, f.subject, f.message)
    });
    found.faults = faults;
}

/// Returns the value; on an error, adds the faults to the list and returns `None`.
fn collect_faults<T>(read: Result<T, Faults>, faults: &mut FaultList) -> Option<T> {
    read.map_err(|f| faults.extend(f)).ok()
}

/// Keeps the first of several entries with one name.
fn each_once<T>(list: &mut Vec<T>, called: impl Fn(&T) -> String) {
    let mut seen = HashSet::with_capacity(list.len());
    list.retain(|entry| seen.insert(called(entry)));
}

/// Returns the names of the readings: from a given S, else from the gauges of the job, else from the strain file.
fn gauges_of(
    work: &mut Work,
    job: &Job,
    s: Option<&Sensitivity>,
    faults: &mut FaultList,
) -> Vec<String> {
    if let Some(s) = s {
        return s.gauges.clone();
    }
    let stated = stated_readings(job);
    match &job.measured {
        Some(m) if stated.is_empty() => {
            collect_faults(recover::gauges_of_file(work, job, m), faults).unwrap_or_default()
        }
        _ => stated,
    }
}

/// Returns the faults of the measured strain, of its zero, and of a separate file with held-out runs.
fn check_measured_strain(
    work: &mut Work,
    job: &Job,
    m: &Measured,
    s: Option<&Sensitivity>,
    gauges: &[String],
) -> FaultList {
    let s = s.cloned().unwrap_or_else(|| Sensitivity {
        gauges: gauges.to_vec(),
        loads: Vec::new(),
        values: Matrix::zeros(gauges.len(), 0),
        uncertainty: None,
        noise: None,
    });
    // If the gauge names can't be read, a fault is already reported.
    let mut faults = match gauges.is_empty() {
        true => FaultList::new(),
        false => recover::check_inputs(work, job, m, s),
    };
    if let HoldOut::File(named) = &m.hold_out {
        collect_faults(read_zeroed(work, job, m, named), &mut faults);
    }
    faults
}

/// Returns the faults of the signatures that belong to a given S, for the measured gauges.
fn signatures(
    work: &mut Work,
    job: &Job,
    given: &GivenSensitivity,
    gauges: &[String],
) -> FaultList {
    let mut faults = FaultList::new();
    if given.signatures != job::Signatures::default() && job.reconcile.is_none() {
        let mut unread = FaultList::new();
        let file = job.measured.as_ref();
        let file =
            file.and_then(|m| collect_faults(recover::gauges_of_file(work, job, m), &mut unread));
        let is_measured = |g: &&String| file.as_ref().is_none_or(|f| f.contains(g));
        let names: Vec<String> = gauges.iter().filter(is_measured).cloned().collect();
        collect_faults(
            reconcile::check_signature_inputs(work, job, given, &names),
            &mut faults,
        );
    }
    faults
}

/// Opens every file that the job names, and checks decks and results.
fn files(work: &mut Work, job: &Job, found: &mut CheckedFiles, check_file: CheckFile) {
    if let Some(m) = &job.model {
        let before = found.decks.len();
        for named in std::iter::once(&m.deck).chain(&m.results) {
            match work.inputs.read_named(job, named) {
                Ok(_) => check_file(work, &job.folder, &named.given, found),
                Err(f) => found.faults.push(f),
            }
        }
        if let Some(model) = found.decks.get(before).and_then(|d| d.model.as_ref()) {
            work.findings.extend(against_units(job.units, model));
            work.findings.extend(point_findings(model, job));
            match support_of_job(job, model) {
                Ok(support) => {
                    work.findings.push(support_finding(&m.deck.given, support));
                    work.findings
                        .extend(relief_of_job(job, model).ok().flatten());
                }
                Err(faults) => found.faults.extend(faults.into_list()),
            }
            found.faults.extend(missing_ids(job, model));
            match job.with_property_ids(&model.property_names) {
                Ok(with_ids) => found.candidates = Some(with_ids.candidates),
                Err(faults) => found.faults.extend(faults.into_list()),
            }
        }
    }
    for named in other_files(job) {
        if let Err(f) = work.inputs.read_named(job, named) {
            found.faults.push(f);
        }
    }
}

/// Returns the files that a job names, other than model, measured strain, runs and gauges.
fn other_files(job: &Job) -> Vec<&NamedFile> {
    let mut out: Vec<&NamedFile> = Vec::new();
    if let Some(s) = &job.sensitivity {
        out.push(&s.file);
        out.extend(s.signatures.files());
    }
    if let Some(v) = &job.vehicle {
        out.push(&v.data);
        out.extend(&v.hold_out);
    }
    out.extend(&job.respond.loads);
    out
}

/// Grids, elements and sets that the job names and the deck lacks.
fn missing_ids(job: &Job, model: &Model) -> Vec<Fault> {
    let mut out = Vec::new();
    for l in &job.loads {
        match l.acts {
            job::LoadActs::AtGrid { grid, cid, .. } => {
                if model.grid_ix(grid).is_none() {
                    out.push(lacks(
                        &job.file,
                        l.line,
                        "load.grid",
                        &format!("grid {grid}"),
                        &l.name,
                    ));
                }
                if model.frame_ix(cid).is_none() {
                    out.push(lacks(
                        &job.file,
                        l.line,
                        "load.cid",
                        &format!("coordinate system {cid}"),
                        &l.name,
                    ));
                }
            }
            job::LoadActs::Set(sid) if !model.load_sets.iter().any(|s| s.sid == sid) => {
                out.push(lacks(
                    &job.file,
                    l.line,
                    "load.load_set",
                    &format!("load set {sid}"),
                    &l.name,
                ));
            }
            job::LoadActs::Set(_) | job::LoadActs::Named => {}
        }
    }
    for g in &job.gauges {
        let element = match g.place {
            job::StatedPlace::Element(e) if model.shell_ix(e).is_none() => {
                Some(format!("shell {e}"))
            }
            job::StatedPlace::BeamPoint { element, .. } if model.beam_ix(element).is_none() => {
                Some(format!("bar or beam {element}"))
            }
            _ => None,
        };
        let second = g
            .pair
            .map(|p| p.0)
            .filter(|e| model.shell_ix(*e).is_none() && model.beam_ix(*e).is_none());
        for missing in element
            .into_iter()
            .chain(second.map(|e| format!("element {e}")))
        {
            out.push(lacks(&g.file, g.line, "element", &missing, &g.name));
        }
    }
    out
}

fn lacks(file: &str, line: u32, field: &str, what: &str, name: &str) -> Fault {
    Fault::with_line(
        file,
        line,
        field,
        format!("`{name}`: the deck has no {what}"),
        "correct the id, or name the deck of these results",
    )
}
