//! The answer of `payload`: result, tables, page.

use super::Task;
use super::judge::{findings, words};
use super::model::Parts;
use crate::app::fault::Faults;
use crate::app::{JobArguments, Session};
use crate::payload::{PayloadRun, Place, WeighSpec, WeighedRun, Weighing};
use crate::report::csv_cell;
use crate::report::figure::{IntervalRow, intervals};
use crate::report::page::{Page, Paper, figure_section, number, table_section};
use crate::report::scene::scene_of_job;
use crate::report::scene::scene_section;
use serde_json::{Value, json};

fn finite(v: f64) -> Option<f64> {
    v.is_finite().then_some(v)
}

/// A value where it is not refused.
fn kept(r: &WeighedRun, v: f64) -> Option<f64> {
    if r.refused.is_some() { None } else { finite(v) }
}

/// Puts `payload`, `by_gauge` and the findings.
///
/// # Errors
/// Mistakes of the program only.
pub(super) fn put(
    session: &mut Session,
    task: &Task,
    parts: &Parts,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    weighing: &Weighing,
) -> Result<(), Faults> {
    let free = spec.place == Place::Free;
    let units = &task.job.report_units;
    let rows: Vec<Value> = weighing
        .runs
        .iter()
        .map(|r| {
            let place = [0, 1].map(|k| kept(r, task.nominal[k] + r.shift[k]));
            let spread = [0, 3].map(|k| kept(r, r.shift_covariance[k].max(0.0).sqrt()));
            let (axes, angle) = r.ellipse();
            json!({
                "run": r.run,
                "force": kept(r, r.force),
                "force_sigma": kept(r, r.sigma),
                "force_low": kept(r, r.interval[0]),
                "force_high": kept(r, r.interval[1]),
                "mass": kept(r, r.force / task.weight_of_mass),
                "mass_sigma": kept(r, r.sigma / task.weight_of_mass),
                "position": place,
                "position_sigma": if free { json!(spread) } else { Value::Null },
                "region": if free && r.refused.is_none() {
                    json!({ "half_axes": axes, "angle_deg": angle.to_degrees() })
                } else {
                    Value::Null
                },
                "refused": r.refused.map(|x| words(task, &x)),
                "unit": units.force.name,
            })
        })
        .collect();
    session.put("payload", rows)?;
    let mut singles: Vec<Value> = Vec::new();
    for r in &weighing.runs {
        for (g, name) in parts.model.gauges.iter().enumerate() {
            let verdict = weighing.gauges.iter().find(|v| v.name == *name);
            let estimate = r.estimates.get(g).copied().unwrap_or(f64::NAN);
            singles.push(json!({
                "run": r.run,
                "name": name,
                "estimate": finite(estimate),
                "sigma": r.estimate_sigma.get(g).copied().and_then(finite),
                "used": verdict.is_some_and(|v| v.used) && estimate.is_finite(),
                "reason": verdict.map_or("no gauge says a possible payload", |v| v.reason.as_str()),
            }));
        }
    }
    session.put("by_gauge", singles)?;
    findings(session, task, parts, runs, spec, weighing);
    Ok(())
}

/// What each gauge in use says of a run, and all of them.
fn bars(r: &WeighedRun, weighing: &Weighing) -> Vec<IntervalRow> {
    let used = weighing.gauges.iter().enumerate().filter(|(_, v)| v.used);
    used.filter_map(|(g, v)| {
        let (e, s) = (*r.estimates.get(g)?, *r.estimate_sigma.get(g)?);
        (e.is_finite() && s.is_finite() && s < r.force.abs())
            .then(|| (v.name.clone(), [e - 1.96 * s, e, e + 1.96 * s]))
    })
    .chain(std::iter::once((
        "all".to_owned(),
        [r.interval[0], r.force, r.interval[1]],
    )))
    .collect()
}

/// Tables and page.
///
/// # Errors
/// Files that can't be written.
pub(super) fn write(
    session: &mut Session,
    arguments: &JobArguments,
    task: &Task,
    parts: &Parts,
    runs: &[PayloadRun],
    weighing: &Weighing,
) -> Result<(), Faults> {
    let units = &task.job.report_units;
    for r in &weighing.runs {
        session.say(match &r.refused {
            Some(x) => format!("{}: refused: {}", r.run, words(task, x)),
            None => format!(
                "{}: {:.3} +- {:.3} {} ({:.1} {}), at {:.3}, {:.3} {}",
                r.run,
                r.force,
                r.sigma,
                units.force.name,
                r.force / task.weight_of_mass,
                units.mass.name,
                task.nominal[0] + r.shift[0],
                task.nominal[1] + r.shift[1],
                units.length.name
            ),
        });
    }
    let rows: Vec<Vec<String>> = weighing
        .runs
        .iter()
        .map(|r| {
            // What is refused has no numbers to sign for.
            if r.refused.is_some() {
                let nothing = std::iter::repeat_n(String::new(), 4);
                let cells = [r.run.clone(), "refused".into()].into_iter();
                return cells.chain(nothing).collect();
            }
            let (axes, angle) = r.ellipse();
            vec![
                r.run.clone(),
                number(r.force),
                format!("{} to {}", number(r.interval[0]), number(r.interval[1])),
                number(r.force / task.weight_of_mass),
                format!(
                    "{}, {}",
                    number(task.nominal[0] + r.shift[0]),
                    number(task.nominal[1] + r.shift[1])
                ),
                if r.shift_covariance[0] > 0.0 {
                    format!(
                        "{} x {} at {:.0}°",
                        number(axes[0]),
                        number(axes[1]),
                        angle.to_degrees().round() + 0.0
                    )
                } else {
                    "known".into()
                },
            ]
        })
        .collect();
    let mut sections = vec![table_section(
        "Payload",
        &[
            "run",
            &format!("weight, {}", units.force.name),
            "95 %",
            &format!("mass, {}", units.mass.name),
            &format!("place, {}", units.length.name),
            "95 % half axes",
        ],
        &rows,
        "The place is that of the job where it is known; half axes are of the region that holds it with 95 %.",
    )];
    let gauge_rows: Vec<Vec<String>> = weighing
        .gauges
        .iter()
        .enumerate()
        .map(|(g, v)| {
            let mut row = vec![v.name.clone()];
            row.extend(
                weighing
                    .runs
                    .iter()
                    .map(|r| number(r.estimates.get(g).copied().unwrap_or(f64::NAN))),
            );
            row.push(if v.used {
                "used".into()
            } else {
                "not used".into()
            });
            row.push(v.reason.clone());
            row
        })
        .collect();
    if !gauge_rows.is_empty() {
        let mut header = vec!["gauge".to_owned()];
        header.extend(weighing.runs.iter().map(|r| r.run.clone()));
        header.extend(["".to_owned(), "reason".to_owned()]);
        let header: Vec<&str> = header.iter().map(String::as_str).collect();
        sections.push(table_section(
            &format!("Each gauge alone, {}", units.force.name),
            &header,
            &gauge_rows,
            "",
        ));
        let runs: Vec<(String, Vec<IntervalRow>)> = weighing
            .runs
            .iter()
            .map(|r| (r.run.clone(), bars(r, weighing)))
            .collect();
        sections.push(figure_section(
            "Gauges in use and all together",
            intervals(&runs, units.force.name),
            "A gauge alone whose interval is wider than the payload is left out.",
        ));
    }
    if let Some(scene) = parts
        .prepared
        .as_ref()
        .and_then(|p| scene_of_job(task.job, p))
    {
        sections.push(scene_section("Model and gauges", &scene));
    }
    let page = Page::new(&task.job.title, "Payload", &session.findings, sections);
    let out = session.output_for(&arguments.job)?;
    out.write("payload.csv", |w| {
        writeln!(
            w,
            "run,force,force.low,force.high,mass,x,y,x.sigma,y.sigma,refused"
        )?;
        for r in &weighing.runs {
            let c = |v: Option<f64>| v.map_or(String::new(), |v| v.to_string());
            let fields = [
                kept(r, r.force),
                kept(r, r.interval[0]),
                kept(r, r.interval[1]),
                kept(r, r.force / task.weight_of_mass),
                kept(r, task.nominal[0] + r.shift[0]),
                kept(r, task.nominal[1] + r.shift[1]),
                kept(r, r.shift_covariance[0].max(0.0).sqrt()),
                kept(r, r.shift_covariance[3].max(0.0).sqrt()),
            ];
            let line: Vec<String> = fields.into_iter().map(c).collect();
            writeln!(
                w,
                "{},{},{}",
                csv_cell(&r.run),
                line.join(","),
                r.refused.as_ref().map_or("", |_| "yes")
            )?;
        }
        Ok(())
    })
    .map_err(Faults::from)?;
    out.write("by_gauge.csv", |w| {
        writeln!(w, "run,gauge,net_microstrain,estimate,sigma,used")?;
        for (r, run) in weighing.runs.iter().zip(runs) {
            for (g, v) in weighing.gauges.iter().enumerate() {
                let of = |list: &[f64], scale: f64| {
                    list.get(g)
                        .filter(|v| v.is_finite())
                        .map_or(String::new(), |v| (v * scale).to_string())
                };
                writeln!(
                    w,
                    "{},{},{},{},{},{}",
                    csv_cell(&r.run),
                    csv_cell(&v.name),
                    of(&run.strain, 1e6),
                    of(&r.estimates, 1.0),
                    of(&r.estimate_sigma, 1.0),
                    v.used
                )?;
            }
        }
        Ok(())
    })
    .map_err(Faults::from)?;
    session.write_page(&arguments.job, page.on_paper(Paper::Signed))
}
