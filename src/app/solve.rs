//! `solve`: the built-in solver on a job's unit loads or on a deck's own static subcases.

use super::deck::{DeckModel, read_model};
use super::fault::{Fault, Faults};
use super::solved::{cases_of_job, solve_kept};
use super::{JobArguments, Session, job};
use crate::fe::{
    Corners, HeatedStrain, LoadCase, Solution, SolveOptions, SolveReport, loads_of_subcase,
    relief_of,
};
use crate::finding::{Finding, Severity};
use crate::model::{Model, Shell};
use crate::report::scene::scene_of_solution;
use crate::report::{PlannedBlock, planned_blocks, rows_of_block, write_vtu};
use nastran::bdf::Request;
use nastran::cards::ShellShape;
use nastran::op2::{EncodedBlock, Op2Writer, WriteError};
use rayon::prelude::*;
use serde_json::json;
use std::path::{Path, PathBuf};

/// What is to be solved.
struct Task {
    read: DeckModel,
    cases: Vec<LoadCase>,
    /// Where strain is wanted.
    corners: Corners,
    /// Why a subcase of the deck is left out.
    left_out: Vec<String>,
}

/// Reads the job or deck, solves, writes `results.op2`, `results.vtu` and the report.
pub fn run(
    arguments: &JobArguments,
    heated: HeatedStrain,
    session: &mut Session,
) -> Result<(), Faults> {
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
        corners,
        left_out,
    } = task;
    let options = SolveOptions {
        corners,
        heated,
        ..SolveOptions::default()
    };
    for why in left_out {
        session.findings.push(Finding::new(
            Severity::Warning,
            "subcase-left-out",
            read.given.clone(),
            why,
            "solve it with Nastran",
        ));
    }
    let (solution, report) = solve_kept(session, &read, &cases, options)?;
    session.findings.extend(solution.findings.iter().cloned());
    session.stage("write", |s| {
        write(s, &arguments.job, &read.model, &cases, &solution, &report)
    })
}

fn of_job(session: &mut Session, path: &Path) -> Result<Task, Faults> {
    let job = job::read_job(&mut session.inputs, path)?;
    session.put_units(job.units, &job.report_units);
    let Some(files) = &job.model else {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )));
    };
    let read =
        read_model(&mut session.inputs, &job.folder, &files.deck.given).map_err(Faults::from)?;
    session.findings.extend(read.findings.iter().cloned());
    Faults::check(read.faults.clone())?;
    let cases = cases_of_job(&job, &read)?;
    Ok(Task {
        read,
        cases,
        corners: Corners::Compute,
        left_out: Vec::new(),
    })
}

fn of_deck(session: &mut Session, path: &Path) -> Result<Task, Faults> {
    let given = path.display().to_string();
    let base = PathBuf::new();
    let read = read_model(&mut session.inputs, &base, &given).map_err(Faults::from)?;
    session.findings.extend(read.findings.iter().cloned());
    Faults::check(read.faults.clone())?;
    let mut left_out = Vec::new();
    let mut cases = Vec::new();
    let mut corners = corners_always_written(&read.model);
    for s in read.deck.case_control.effective_subcases() {
        let loads = loads_of_subcase(&s);
        if s.deform.is_some() {
            left_out.push(format!("subcase {}: DEFORM is not carried", s.id));
        } else if loads.is_empty() && !has_enforced(&read.model, s.spc) {
            left_out.push(format!("subcase {}: no LOAD", s.id));
        } else {
            if s.request("STRAIN").is_none_or(asks_for_corners) {
                corners = Corners::Compute;
            }
            cases.push(LoadCase {
                subcase: s.id,
                label: s.label.clone().or(s.subtitle.clone()).unwrap_or_default(),
                loads,
                spc: s.spc,
                mpc: s.mpc,
                relief: relief_of(&read.model, s.spc, s.suport1),
            });
        }
    }
    if cases.is_empty() {
        return Err(Faults::from(Fault::of(
            given,
            "case control",
            "no static subcase with a LOAD",
            "add `LOAD = n` to a subcase, or give a job with [[load]] entries",
        )));
    }
    Ok(Task {
        read,
        cases,
        corners,
        left_out,
    })
}

/// Whether a request for strain names a method for corners; Nastran's default is the centre. A deck that asks for no strain at all gets
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

fn has_enforced(model: &Model, spc: Option<u32>) -> bool {
    model
        .spcs
        .iter()
        .any(|s| Some(s.sid) == spc && s.terms.iter().any(|t| t.2 != 0.0))
}

fn write(
    session: &mut Session,
    input: &Path,
    model: &Model,
    cases: &[LoadCase],
    solution: &Solution,
    report: &SolveReport,
) -> Result<(), Faults> {
    session.put("grids", report.grids)?;
    session.put("dofs", report.dofs)?;
    session.put("factor_nonzeros", report.factor_nonzeros)?;
    session.put("ordering", report.ordering)?;
    session.put("smallest_pivot", report.smallest_pivot)?;
    session.put("epsilon", report.epsilon)?;
    session.put("balance", &report.balance)?;
    session.put(
        "mass",
        report
            .mass
            .map(|m| json!({ "mass": m.mass, "cg": [m.cg.x, m.cg.y, m.cg.z] })),
    )?;
    session.put("elastic_modes_hz", &report.modes)?;
    session.say(format!(
        "{} load cases on {} grids, {} unknowns; factor of {} entries",
        solution.cases.len(),
        report.grids,
        report.dofs,
        report.factor_nonzeros
    ));
    if let Some(first) = report.modes.first() {
        session.say(format!(
            "first elastic mode of the free structure: {first:.4} per unit of time"
        ));
    }
    let out = session.output_for(input)?;
    let plan = planned_blocks(model, solution);
    out.write_both(
        ("results.op2", |w| write_op2(model, solution, &plan, w)),
        ("results.vtu", |w| write_vtu(model, &solution.cases, w)),
    )
    .map_err(Faults::from)?;
    let title = input
        .file_stem()
        .map_or_else(String::new, |s| s.to_string_lossy().into_owned());
    session.put("peak_memory_bytes", peak_memory())?;
    let scene = scene_of_solution(model, cases, solution);
    let page =
        crate::report::strain::solution_page(&title, solution, report, &scene, &session.findings);
    session.write_page(input, page)
}

/// Blocks are made into words in parallel, a few at a time.
fn write_op2(
    model: &Model,
    solution: &Solution,
    plan: &[PlannedBlock],
    out: &mut dyn std::io::Write,
) -> std::io::Result<()> {
    let encode = |group: &[PlannedBlock]| -> Result<Vec<EncodedBlock>, WriteError> {
        group
            .par_iter()
            .map(|p| {
                let (block, rows) = rows_of_block(model, solution, *p);
                EncodedBlock::new(&block, &rows)
            })
            .collect()
    };
    let mut op2 = Op2Writer::new(out, [1, 1, 2000]).map_err(std::io::Error::other)?;
    for group in plan.chunks(rayon::current_num_threads().clamp(1, 4)) {
        for block in encode(group).map_err(std::io::Error::other)? {
            op2.write_encoded(&block).map_err(std::io::Error::other)?;
        }
    }
    op2.finish().map(|_| ()).map_err(std::io::Error::other)
}

/// Largest resident memory of this process so far, bytes; `None` where the system does not tell.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}
