//! `place`: gauges chosen from the candidates, with the certificate, beside the installed ones where the job has some.

mod answer;
mod choose;
mod curve;
mod installed;
mod points;
mod pool;
mod region;
mod sheet;
mod task;

pub(super) use pool::{angles, column_order, scales, scatter};
pub(super) use region::allowed_sites;

use super::fault::{Fault, Faults};
use super::job;
use super::scene::{placed_mark, scene_of};
use super::spreadsheets::write_spreadsheet;
use super::strain::{load_units, read_fields};
use super::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::placement::quality::{judge_rows, reserve};
use crate::report::page::Paper;
use crate::report::spreadsheet::gauge_sheets;
use crate::report::strain::{
    HowMany, gauges_csv, gluing_sheet_csv, gluing_sheet_md, place_page, sensitivity_csv,
};
use crate::sensitivity::{check_separability, common_shells, from_cases};
use serde_json::json;

/// Reads, places, compares, writes `gauges.csv`, the gluing sheet and the report.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read job", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &job.report_units);
    let fields = read_fields(session, &job)?;
    let cases = fields.load_cases(&job);
    let (common, findings) = common_shells(&cases);
    session.findings.extend(findings);
    let sites = allowed_sites(&job, &fields, &common)?;
    let k = cases.len();
    let scales = scales(session, &cases, &common);
    let mut task = task::task(&job, &fields, cases, scales, sites);
    task.keep(session)?;
    let (led, led_scales) = task.led();
    let kinds = session.stage("candidates", |_| {
        let angles = angles(job.candidates.angles);
        pool::kinds(
            &job,
            fields.model(),
            &task.sites,
            &led,
            &led_scales,
            &angles,
        )
    });
    let mut spec = task.spec(session);
    let chosen = session.stage("place", |s| choose::choose(s, &task, &kinds, &mut spec))?;
    let rows: Vec<Vec<f64>> = chosen.channels.iter().map(|c| c.row.clone()).collect();
    let Some(quality) =
        judge_rows(&rows, &spec.prior, k).map(|q| answer::in_job_order(q, &task.order))
    else {
        let singular = crate::placement::PlaceError::Singular {
            gauges: spec.gauges,
            loads: k,
        };
        return Err(Faults::from(task.refusal(&singular)));
    };
    let validation = reserved(session, &task, &rows, &spec.prior)?;
    let all: Vec<_> = chosen
        .channels
        .iter()
        .map(|c| c.gauge.clone())
        .chain(task.kept.clone())
        .collect();
    let s = from_cases(&all, &task.cases).map_err(|_| Vec::new())?;
    let names: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    let units = load_units(&job, &names);
    let placed = sheet::placed(&task, &chosen, &spec.prior, &quality, &validation);
    let installed = match kinds.first().filter(|_| choose::is_plain(&task)) {
        Some(kind) => installed::installed(session, &task, &kind.candidates, &spec)?,
        None => None,
    };
    let counted = kinds.iter().map(|k| k.candidates.n_rows()).sum();
    let size = [task.sites.len(), counted];
    answer::put_result(session, &task, size, &chosen, &s, &quality, &units, &placed)?;
    let reserved: Vec<_> = validation
        .iter()
        .map(|(i, inflation)| {
            let c = &chosen.channels[*i];
            json!({ "name": c.gauge.name, "prediction_sd_microstrain": c.sd * inflation })
        })
        .collect();
    session.put("reserved", reserved)?;
    session.put("installed", &installed)?;
    session.findings.extend(check_separability(&s));
    answer::judge_layout(session, &chosen, &quality, &spec, &placed, k);
    answer::say(session, &chosen, &s, &placed, installed.as_ref());
    let mut how_many = HowMany::default();
    if !job.placement.curve.is_empty() {
        let (points, left_out) =
            session.stage("curve", |_| curve::curve(&task, &kinds, &spec, &units));
        session.put("how_many", curve::curve_json(&points, &names, &units))?;
        answer::say_curve(session, &points, &names, &units);
        how_many = curve::drawn(&points, &names, &units);
        if !left_out.is_empty() {
            let counts: Vec<String> = left_out.iter().map(usize::to_string).collect();
            session.findings.push(Finding::new(
                Severity::Info,
                "curve-incomplete",
                "placement.curve",
                format!(
                    "no layout of {} gauges separates the loads and keeps the spacing",
                    counts.join(", ")
                ),
                "",
            ));
        }
    }
    let marks = placed.iter().map(placed_mark).collect();
    let scene = scene_of(&job, &fields, marks);
    let page = place_page(
        &job.title,
        &scene,
        &placed,
        &s,
        &session.findings,
        &answer::session_numbers(&chosen, &s, &installed),
        &how_many,
    );
    let out = session.output_for(&arguments.job)?;
    let write = |f: Result<(), Fault>| f.map_err(Faults::from);
    write(out.write("gauges.csv", |w| gauges_csv(w, &placed)))?;
    write(out.write("sensitivity.csv", |w| sensitivity_csv(w, &s)))?;
    write(out.write("gluing_sheet.csv", |w| {
        gluing_sheet_csv(w, &placed, fields.model())
    }))?;
    write(out.write_bytes(
        "gluing_sheet.md",
        gluing_sheet_md(&job.title, &placed, fields.model()).as_bytes(),
    ))?;
    write(out.write("gauges.vtu", |w| points::gauges_vtu(w, &placed)))?;
    session.write_page(&arguments.job, page.on_paper(Paper::Signed))?;
    let sheets = gauge_sheets(&placed, fields.model(), &s);
    write_spreadsheet(session, &job, &arguments.job, "gauges.xlsx", &sheets)
}

/// Gauges reserved for validation: index and prediction's standard deviation over the reading's.
///
/// # Errors
/// Where the rest would not separate the loads.
fn reserved(
    session: &mut Session,
    task: &task::Task,
    rows: &[Vec<f64>],
    prior: &[f64],
) -> Result<Vec<(usize, f64)>, Faults> {
    let n = task.job.placement.reserve;
    if n == 0 {
        return Ok(Vec::new());
    }
    let Some(found) = reserve(rows, prior, task.cases.len(), n) else {
        return Err(Faults::from(Fault::at(
            &*task.job.file,
            task.job.placement.line,
            "placement.reserve",
            format!("{} gauges less {n} do not separate the loads", rows.len()),
            "reserve fewer, or place more",
        )));
    };
    session.findings.push(Finding::new(
        Severity::Info,
        "gauges-reserved",
        "placement.reserve",
        format!("{n} gauges are marked for validation: load sigmas and condition number count all gauges"),
        "leave the reserved ones out of `recover`, and compare them with its prediction",
    ));
    Ok(found)
}
