//! `solve`: the built-in solver on a job's unit loads or on a deck's own static subcases.

use super::deck::{DeckModel, read_model};
use super::fault::{Fault, Faults};
use super::{JobArguments, Session, job};
use crate::fe::{
    FeError, LoadCase, Relief, Solution, SolveOptions, SolveReport, UnitLoad, free_modes,
    relief_of, solve_cases,
};
use crate::finding::{Finding, Severity};
use crate::model::Model;
use crate::report::{for_each_block, write_vtu};
use nastran::op2::Op2Writer;
use serde_json::json;
use std::path::{Path, PathBuf};

/// Elastic modes of a free structure that are computed beside the strain.
const MODES: usize = 10;

/// What is to be solved.
struct Task {
    read: DeckModel,
    cases: Vec<LoadCase>,
    /// Why a subcase of the deck is left out.
    left_out: Vec<String>,
}

/// Reads the job or deck, solves, writes `results.op2`, `results.vtu` and the report.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let is_job = arguments
        .job
        .extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"));
    let task = session.stage("read", |s| {
        if is_job {
            of_job(s, &arguments.job)
        } else {
            of_deck(s, &arguments.job)
        }
    })?;
    let Task {
        read,
        cases,
        left_out,
    } = task;
    for why in left_out {
        session.findings.push(Finding::new(
            Severity::Warning,
            "subcase-left-out",
            read.given.clone(),
            why,
            "solve it with Nastran",
        ));
    }
    let (solution, report) = session
        .stage("solve", |_| {
            solve_cases(&read.model, &cases, &SolveOptions::default())
        })
        .map_err(|e| faults_of(&e, &read))?;
    session.findings.extend(solution.findings.iter().cloned());
    let free = cases.iter().find(|c| c.relief != Relief::None);
    let frequencies = match free {
        Some(case) => session
            .stage("free modes", |_| {
                free_modes(&read.model, case.spc, case.mpc, MODES)
            })
            .map(|(modes, _)| modes.iter().map(|m| m.frequency).collect())
            .map_err(|e| faults_of(&e, &read))?,
        None => Vec::new(),
    };
    session.stage("write", |s| {
        write(
            s,
            &arguments.job,
            &read.model,
            &solution,
            &report,
            &frequencies,
        )
    })
}

fn of_job(session: &mut Session, path: &Path) -> Result<Task, Faults> {
    let job = job::read_job(&mut session.inputs, path)?;
    session.put_units(job.units, &job.report_units);
    let Some(files) = &job.model else {
        return Err(vec![Fault::of(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )]);
    };
    let read =
        read_model(&mut session.inputs, &job.folder, &files.deck.given).map_err(|f| vec![f])?;
    session.findings.extend(read.findings.iter().cloned());
    if !read.faults.is_empty() {
        return Err(read.faults);
    }
    let relief = relief_of(&read.model, None, None);
    let loads = super::strain::unit_loads(&job, &read.model)?;
    let cases = job
        .loads
        .iter()
        .zip(loads)
        .map(|(l, load)| LoadCase {
            subcase: l.number,
            label: l.name.clone(),
            loads: vec![load],
            spc: None,
            mpc: read.model.mpc,
            relief,
        })
        .collect();
    Ok(Task {
        read,
        cases,
        left_out: Vec::new(),
    })
}

fn of_deck(session: &mut Session, path: &Path) -> Result<Task, Faults> {
    let given = path.display().to_string();
    let base = PathBuf::new();
    let read = read_model(&mut session.inputs, &base, &given).map_err(|f| vec![f])?;
    session.findings.extend(read.findings.iter().cloned());
    if !read.faults.is_empty() {
        return Err(read.faults);
    }
    let mut left_out = Vec::new();
    let mut cases = Vec::new();
    for s in read.deck.case_control.effective_subcases() {
        let thermal = s.temperature_load.is_some() || s.deform.is_some();
        match s.load {
            _ if thermal => left_out.push(format!(
                "subcase {}: thermal loads and DEFORM are not carried",
                s.id
            )),
            Some(load) => cases.push(LoadCase {
                subcase: s.id,
                label: s.label.clone().or(s.subtitle.clone()).unwrap_or_default(),
                loads: vec![UnitLoad::Set(load)],
                spc: s.spc,
                mpc: s.mpc,
                relief: relief_of(&read.model, s.spc, s.suport1),
            }),
            None if has_enforced(&read.model, s.spc) => cases.push(LoadCase {
                subcase: s.id,
                label: s.label.clone().unwrap_or_default(),
                loads: Vec::new(),
                spc: s.spc,
                mpc: s.mpc,
                relief: relief_of(&read.model, s.spc, s.suport1),
            }),
            None => left_out.push(format!("subcase {}: no LOAD", s.id)),
        }
    }
    if cases.is_empty() {
        return Err(vec![Fault::of(
            given,
            "case control",
            "no static subcase with a LOAD",
            "add `LOAD = n` to a subcase, or give a job with [[load]] entries",
        )]);
    }
    Ok(Task {
        read,
        cases,
        left_out,
    })
}

fn has_enforced(model: &Model, spc: Option<u32>) -> bool {
    model
        .spcs
        .iter()
        .any(|s| Some(s.sid) == spc && s.terms.iter().any(|t| t.2 != 0.0))
}

/// The solver's faults with file and line.
pub(super) fn faults_of(error: &FeError, read: &DeckModel) -> Faults {
    error
        .faults()
        .into_iter()
        .map(|f| {
            let file = match f.at.line {
                0 => read.given.clone(),
                _ => read.deck.path(f.at).to_owned(),
            };
            Fault::at(file, f.at.line, f.card, f.reason, f.remedy)
        })
        .collect()
}

fn write(
    session: &mut Session,
    input: &Path,
    model: &Model,
    solution: &Solution,
    report: &SolveReport,
    frequencies: &[f64],
) -> Result<(), Faults> {
    session.put("grids", report.grids)?;
    session.put("dofs", report.dofs)?;
    session.put("factor_nonzeros", report.factor_nonzeros)?;
    session.put("ordering", report.ordering)?;
    session.put("smallest_pivot", report.smallest_pivot)?;
    session.put("balance", &report.balance)?;
    session.put(
        "mass",
        report
            .mass
            .map(|m| json!({ "mass": m.mass, "cg": [m.cg.x, m.cg.y, m.cg.z] })),
    )?;
    session.put("elastic_modes_hz", frequencies)?;
    session.put("peak_memory_bytes", peak_memory())?;
    session.say(format!(
        "{} load cases on {} grids, {} unknowns; factor of {} entries",
        solution.cases.len(),
        report.grids,
        report.dofs,
        report.factor_nonzeros
    ));
    if let Some(first) = frequencies.first() {
        session.say(format!(
            "first elastic mode of the free structure: {first:.4} per unit of time"
        ));
    }
    let out = session.output_for(input)?;
    out.write("results.op2", |w| {
        let mut op2 = Op2Writer::new(w, [1, 1, 2000]).map_err(std::io::Error::other)?;
        for_each_block(model, solution, |block, rows| op2.write_block(block, rows))
            .map_err(std::io::Error::other)?;
        op2.finish().map(|_| ()).map_err(std::io::Error::other)
    })
    .map_err(|f| vec![f])?;
    out.write("results.vtu", |w| write_vtu(model, &solution.cases, w))
        .map_err(|f| vec![f])?;
    let title = input
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    let page = crate::report::strain::page(
        &title,
        "Solution of the built-in solver",
        &session.findings,
        Vec::new(),
    );
    session
        .output_for(input)?
        .write_bytes("report.html", page.as_bytes())
        .map_err(|f| vec![f])
}

/// Largest resident memory of this process so far, bytes; `None` where the system does not tell.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}
