//! A job: its own faults, then the files it names.

use super::checked::Checked;
use crate::app::fault::{Fault, Faults};
use crate::app::job::strain::wanted_columns;
use crate::app::job::strain_means::{StrainFile, read_strain_file};
use crate::app::job::suggest;
use crate::app::job::{self, HoldOut, Job, Measured, NamedFile};
use crate::app::job_deck::against_units;
use crate::app::outcome::StatedUnits;
use crate::app::solved::{support_finding, support_of_job};
use crate::app::work::Work;
use crate::app::zeroed::{no_zero_runs, zeros_by_row};
use crate::finding::{Finding, Severity, few};
use crate::model::Model;
use std::path::Path;

/// Looks into a file: of a folder, as named.
type Look = fn(&mut Work, &Path, &str, &mut Checked);

pub(super) fn look(work: &mut Work, base: &Path, given: &str, found: &mut Checked, into: Look) {
    let job = match job::read_job(&mut work.inputs, &base.join(given)) {
        Ok(job) => job,
        Err(f) => return found.faults.extend(f),
    };
    found.units = StatedUnits::of(job.units, &job.report_units);
    found.jobs.push(format!(
        "job `{given}`: {} loads, {} gauges, units {}",
        job.loads.len(),
        job.gauges.len(),
        job.units.name()
    ));
    found.candidates = Some(job.candidates.clone());
    files(work, &job, found, into);
    if let Some(m) = &job.measured {
        let wanted = wanted_columns(&mut work.inputs, &job);
        match read_strain_file(&mut work.inputs, &job, &m.strain, &wanted) {
            Ok(file) => {
                work.findings.extend(gauges_and_strain(&job, file.gauges()));
                found.faults.extend(zero_faults(work, &job, m, &file));
            }
            Err(f) => found.faults.extend(f),
        }
        if let Some(named) = &m.zero {
            let read = read_strain_file(&mut work.inputs, &job, named, &wanted);
            found.faults.extend(faults_of(read));
        }
        if let HoldOut::File(named) = &m.hold_out {
            match read_strain_file(&mut work.inputs, &job, named, &wanted) {
                Ok(file) => {
                    // A run that neither file has was said of the first.
                    let mut more = zero_faults(work, &job, m, &file);
                    more.retain(|f| !found.faults.contains(f));
                    found.faults.extend(more);
                }
                Err(f) => found.faults.extend(f),
            }
        }
    }
    if let Some(r) = &job.runs {
        let read = job::runs::read_runs(&mut work.inputs, &job, r);
        found.faults.extend(faults_of(read));
    }
}

/// What stands in the way of following the zero through the runs of a strain file.
fn zero_faults(work: &mut Work, job: &Job, m: &Measured, file: &StrainFile) -> Vec<Fault> {
    match file {
        StrainFile::Table(table) => faults_of(zeros_by_row(work, job, m, table)),
        StrainFile::Means(means) => faults_of(no_zero_runs(job, m, &means.file)),
    }
}

fn faults_of<T>(read: Result<T, Faults>) -> Vec<Fault> {
    read.err().map_or_else(Vec::new, Faults::into_list)
}

/// Opens every file that the job names; decks and results are looked into.
fn files(work: &mut Work, job: &Job, found: &mut Checked, into: Look) {
    if let Some(m) = &job.model {
        let before = found.decks.len();
        for named in std::iter::once(&m.deck).chain(&m.results) {
            match work.inputs.read_named(job, named) {
                Ok(_) => into(work, &job.folder, &named.given, found),
                Err(f) => found.faults.push(f),
            }
        }
        if let Some(model) = found.decks.get(before).and_then(|d| d.model.as_ref()) {
            work.findings.extend(against_units(job, model));
            match support_of_job(job, model) {
                Ok(support) => work.findings.push(support_finding(&m.deck.given, support)),
                Err(faults) => found.faults.extend(faults.into_list()),
            }
            found.faults.extend(missing_ids(job, model));
        }
    }
    for named in other_files(job) {
        if let Err(f) = work.inputs.read_named(job, named) {
            found.faults.push(f);
        }
    }
}

/// Files beside model, measured strain, runs and gauges.
fn other_files(job: &Job) -> Vec<&NamedFile> {
    let mut out: Vec<&NamedFile> = Vec::new();
    if let Some(s) = &job.sensitivity {
        let g = &s.signatures;
        out.push(&s.file);
        out.extend(
            [
                &g.lateral_wheel_loads,
                &g.thermal,
                &g.payload,
                &g.unaccounted_mass,
                &g.gauge_angle,
            ]
            .into_iter()
            .flatten(),
        );
        out.extend(g.rail_stiffness.values());
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
    Fault::at(
        file,
        line,
        field,
        format!("`{name}`: the deck has no {what}"),
        "correct the id, or name the deck of these results",
    )
}

/// Gauges without a column and columns without a gauge.
fn gauges_and_strain(job: &Job, columns: &[String]) -> Vec<Finding> {
    let names: Vec<&str> = job.gauges.iter().map(|g| g.name.as_str()).collect();
    let unknown: Vec<&str> = columns
        .iter()
        .map(String::as_str)
        .filter(|c| !names.contains(c))
        .collect();
    let silent: Vec<&str> = names
        .iter()
        .copied()
        .filter(|n| !columns.iter().any(|c| c == n))
        .collect();
    let mut out = Vec::new();
    let mut note = |code, what: &str, list: &[&str], remedy: &str| {
        if !list.is_empty() {
            let message = format!("{} {what}: {}", list.len(), few(list));
            out.push(Finding::new(
                Severity::Warning,
                code,
                "measured.strain",
                message,
                remedy,
            ));
        }
    };
    // A rosette's legs have columns of their own, `<name>.a` and so on; where S is given its table names the gauges.
    let told = !job.gauges.is_empty() && job.gauges.iter().all(|g| g.rosette.is_none());
    if told {
        note(
            "gauge-without-strain",
            "gauges have no column in the strain file",
            &silent,
            &suggest::column_remedy(&silent, &unknown),
        );
        note(
            "strain-without-gauge",
            "columns of the strain file belong to no gauge",
            &unknown,
            "add the gauges, or drop the columns",
        );
    }
    out
}
