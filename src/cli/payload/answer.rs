//! The answer of `payload`: result, findings, tables, page.

use super::Task;
use super::model::Parts;
use crate::cli::fault::Faults;
use crate::cli::words::short;
use crate::cli::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::payload::{PayloadRun, Place, Refusal, WeighSpec, WeighedRun, Weighing};
use crate::report::strain::{
    drawing_section, interval_bars, model_with_gauges, number, page, table_section,
};
use serde_json::{Value, json};

/// A share of the weight that an interval leaves open from which the answer says little.
const VAGUE: f64 = 0.5;

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

/// A refusal in plain words.
fn words(task: &Task, refusal: &Refusal) -> String {
    let unit = task.job.report_units.force.name;
    match refusal {
        Refusal::Negative { force } => format!(
            "the readings say {} {unit}: a payload can't pull the structure up",
            short(*force)
        ),
        Refusal::OutsideRegion { sigmas } => format!(
            "the place found lies {} standard deviations outside the region where the payload can be",
            short(*sigmas)
        ),
        Refusal::OutOfBalance {
            strain,
            wheels,
            sigmas,
        } => format!(
            "strain says {} {unit} and the wheels carry {} {unit}: {} standard deviations apart, so forces are not in balance",
            short(*strain),
            short(*wheels),
            short(*sigmas)
        ),
        Refusal::Undetermined => "nothing that was read tells the weight".to_owned(),
    }
}

fn findings(
    session: &mut Session,
    task: &Task,
    parts: &Parts,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    weighing: &Weighing,
) {
    for (r, run) in weighing.runs.iter().zip(runs) {
        if let Some(refusal) = &r.refused {
            let (code, remedy) = match refusal {
                Refusal::Negative { .. } => (
                    "payload-negative",
                    "check the signs of gauges and wheel forces, the zero, and which run is the unloaded one",
                ),
                Refusal::OutsideRegion { .. } => (
                    "payload-outside-region",
                    "check `region`, signs and names of gauges, and for a load that is not the payload",
                ),
                Refusal::OutOfBalance { .. } => (
                    "payload-out-of-balance",
                    "check scale and sign of the channels, the zero of both, and `use` one of them alone",
                ),
                Refusal::Undetermined => (
                    "payload-undetermined",
                    "glue gauges where the payload strains the structure, or measure wheel forces",
                ),
            };
            session.findings.push(Finding::new(
                Severity::Error,
                code,
                &r.run,
                words(task, refusal),
                remedy,
            ));
            continue;
        }
        let wide = (r.interval[1] - r.interval[0]) / r.force;
        if wide > VAGUE {
            session.findings.push(
                Finding::new(
                    Severity::Warning,
                    "payload-vague",
                    &r.run,
                    "the 95 % interval is wider than half the payload",
                    "add gauges where the payload strains the structure, longer means, or wheel forces",
                )
                .with_numbers(wide, VAGUE),
            );
        }
        // Wheels under structure and payload together.
        let total: Vec<f64> = match (&parts.model.floor, run.reactions.is_empty()) {
            (Some(floor), true) => {
                let p = [r.force, r.force * r.shift[0], r.force * r.shift[1]];
                task.empty
                    .iter()
                    .enumerate()
                    .map(|(w, e)| e + (0..3).map(|k| floor[(w, k)] * p[k]).sum::<f64>())
                    .collect()
            }
            _ => task
                .empty
                .iter()
                .zip(&run.reactions)
                .map(|(e, r)| e + r)
                .collect(),
        };
        for (w, t) in total.iter().enumerate().filter(|t| *t.1 < 0.0) {
            session.findings.push(
                Finding::new(
                    Severity::Error,
                    "wheel-lifts-off",
                    format!("{}: {}", r.run, task.wheels[w]),
                    "this payload at this place lifts the wheel off the floor: the structure does not stand as the model says",
                    "check the place of the payload, and the model's masses (`ballast`)",
                )
                .with_numbers(*t, 0.0),
            );
        }
        if spec.place == Place::Free {
            let (axes, _) = r.ellipse();
            let room = spec.region.map_or(f64::INFINITY, |v| {
                (v[0][1] - v[0][0]).max(v[1][1] - v[1][0]) / 2.0
            });
            if axes[0] > room {
                session.findings.push(
                    Finding::new(
                        Severity::Warning,
                        "place-not-determined",
                        &r.run,
                        "the 95 % region of the place is as large as the region where the payload can be: the readings don't tell it",
                        "add gauges between the axles on both rails, or wheel forces",
                    )
                    .with_numbers(axes[0], room),
                );
            }
        } else if let (Some(arms), false) = (&parts.model.arms, run.reactions.is_empty()) {
            // Moments of measured wheel forces against the place that the job states.
            let sum: f64 = run.reactions.iter().sum();
            let at = [0, 1].map(|k| {
                run.reactions
                    .iter()
                    .zip(arms)
                    .map(|(r, a)| r * a[k])
                    .sum::<f64>()
                    / sum
            });
            let sd = [0, 1].map(|k| {
                arms.iter()
                    .map(|a| ((a[k] - at[k]) * spec.reaction_sigma / sum).powi(2))
                    .sum::<f64>()
                    .sqrt()
            });
            let worst = (0..2)
                .map(|k| (at[k] - r.shift[k]).abs() / sd[k])
                .fold(0.0, f64::max);
            if worst > 4.0 {
                let unit = task.job.report_units.length.name;
                session.findings.push(
                    Finding::new(
                        Severity::Warning,
                        "payload-elsewhere",
                        &r.run,
                        format!(
                            "the moments of the wheel forces put the payload at {}, {} {unit}, not where the job states it",
                            short(task.nominal[0] + at[0]),
                            short(task.nominal[1] + at[1])
                        ),
                        "correct the place, or let it free: position = \"free\"",
                    )
                    .with_numbers(worst, 4.0),
                );
            }
        }
    }
    let rejected: Vec<&str> = weighing
        .gauges
        .iter()
        .filter(|v| !v.used)
        .map(|v| v.name.as_str())
        .collect();
    if !rejected.is_empty() {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "gauges-not-used",
                rejected.join(", "),
                "these gauges disagree with the rest and carry nothing in the answer (reasons in by_gauge)",
                "check their wiring, place and sign",
            )
            .with_numbers(rejected.len() as f64, 0.0),
        );
    }
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
            let (axes, angle) = r.ellipse();
            vec![
                r.run.clone(),
                if r.refused.is_some() {
                    "refused".into()
                } else {
                    number(r.force)
                },
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
                        angle.to_degrees()
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
        for r in weighing.runs.iter().take(6) {
            let bars: Vec<(String, [f64; 3])> = weighing
                .gauges
                .iter()
                .enumerate()
                .filter(|(_, v)| v.used)
                .filter_map(|(g, v)| {
                    let (e, s) = (*r.estimates.get(g)?, *r.estimate_sigma.get(g)?);
                    (e.is_finite() && s.is_finite() && s < r.force.abs())
                        .then(|| (v.name.clone(), [e - 1.96 * s, e, e + 1.96 * s]))
                })
                .chain(std::iter::once((
                    "all".to_owned(),
                    [r.interval[0], r.force, r.interval[1]],
                )))
                .collect();
            sections.push(drawing_section(
                &format!("{}: gauges in use and all together", r.run),
                interval_bars(&bars, units.force.name),
                "",
            ));
        }
    }
    if let Some(p) = &parts.prepared
        && let Some(fields) = &p.fields
    {
        let refs: Vec<&crate::gauge::Gauge> = p.gauges.iter().collect();
        sections.push(drawing_section(
            "Model and gauges",
            model_with_gauges(fields.model(), &refs),
            "",
        ));
    }
    let html = page(&task.job.title, "Payload", &session.findings, sections);
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
                r.run,
                line.join(","),
                r.refused.as_ref().map_or("", |_| "yes")
            )?;
        }
        Ok(())
    })
    .map_err(|f| vec![f])?;
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
                    r.run,
                    v.name,
                    of(&run.strain, 1e6),
                    of(&r.estimates, 1.0),
                    of(&r.estimate_sigma, 1.0),
                    v.used
                )?;
            }
        }
        Ok(())
    })
    .map_err(|f| vec![f])?;
    out.write_bytes("report.html", html.as_bytes())
        .map_err(|f| vec![f])
}
