//! `respond`: strain and stress anywhere on the structure from recovered loads, by superposition of the unit fields.

mod files;
mod gauges;
mod states;

use super::fault::{Fault, Faults};
use super::job::{self, Job};
use super::strain::{Fields, Prepared, has_covariance, prepare, read_fields};
use super::{JobArguments, Session};
use crate::finding::{Finding, Severity};
use crate::model::{GridIx, Model, RigidKind, Vec3};
use crate::recovery::NORMAL_95;
use crate::report::csv_cell;
use crate::report::figure::agreement;
use crate::report::page::{Page, figure_section, number, table_section};
use crate::report::scene::scene_of;
use crate::report::scene::{Mark, scene_section};
use crate::report::write_cells_vtu;
use crate::respond::{LoadState, Peak, Place, ResponseRow, envelope, hot_spots, response_rows};
use crate::units::factor;
use serde_json::json;
use std::collections::BTreeSet;

/// Reads loads, superposes, writes envelope, hot spots, histories and the check at the gauges.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read job", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &job.report_units);
    let calibrated = has_covariance(&job) && job.model.is_some();
    if job.sensitivity.is_some() && !calibrated {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "sensitivity",
            "S was computed elsewhere: there are no unit fields to superpose",
            "give a [model] instead",
        )));
    }
    let prepared = if job.gauges.is_empty() {
        Prepared {
            sensitivity: crate::sensitivity::Sensitivity {
                gauges: Vec::new(),
                loads: Vec::new(),
                values: crate::linalg::Matrix::zeros(0, job.loads.len()),
                uncertainty: None,
            },
            fields: Some(read_fields(session, &job)?),
            gauges: Vec::new(),
        }
    } else {
        prepare(session, &job)?
    };
    let Some(fields) = &prepared.fields else {
        return Err(Fault::of(
            &*job.file,
            "model",
            "the job has no [model]",
            "name the deck: [model] deck = \"model.bdf\"",
        )
        .into());
    };
    let states = states::read(session, &job, &prepared)?;
    let wanted = job.respond.elements.as_ref();
    let (rows, findings) = response_rows(fields.model(), &fields.load_cases(&job), |_| true);
    session.findings.extend(findings);
    if rows.is_empty() {
        return Err(Faults::from(Fault::of(
            &*job.file,
            "model",
            "no element has strain in every load's subcase",
            "ask for STRAIN(FIBER,CENTER) = ALL in every subcase",
        )));
    }
    let peaks = session.stage("superpose", |_| envelope(&rows, &states));
    let spots = hot_spots(fields.model(), &rows, &peaks);
    let mut order: Vec<usize> = (0..rows.len()).collect();
    match wanted {
        Some(ids) => order.retain(|i| ids.contains(rows[*i].element)),
        None => {
            order.sort_by(|a, b| peaks[*b].von_mises.total_cmp(&peaks[*a].von_mises));
            order.truncate(job.respond.hottest);
        }
    }
    if order.is_empty() {
        return Err(Faults::from(Fault::at(
            &*job.file,
            job.respond.line,
            "respond.elements",
            "none of these elements has stress",
            "name shells, bars or beams of the deck",
        )));
    }
    say_findings(session, &job, fields.model(), &rows, &peaks, &order);
    let check = gauges::check(session, &job, &prepared, &states)?;
    put(session, &job, &rows, &peaks, &order, &spots, &states)?;
    write(
        session, arguments, &job, fields, &rows, &peaks, &order, &spots, &states, &check,
    )
}

/// An element of a row as a mark of the scene, at the middle of its grids.
fn mark_of_row(model: &Model, row: &ResponseRow, note: String) -> Mark {
    let at: Vec<_> = grids(model, row)
        .iter()
        .filter_map(|g| model.grids.get(g.us()).map(|g| g.x))
        .collect();
    Mark {
        name: row.element.to_string(),
        at: at.iter().sum::<Vec3>() / at.len().max(1) as f64,
        axes: None,
        surface: match row.place {
            Place::Shell { surface, .. } => Some(surface),
            Place::Beam { .. } => None,
        },
        note,
        gap: None,
    }
}

fn stress_unit(job: &Job) -> f64 {
    factor(job.units, job.report_units.stress)
}

/// Grids of the element of a row.
fn grids(model: &Model, row: &ResponseRow) -> Vec<GridIx> {
    match row.place {
        Place::Shell { shell, .. } => model
            .shells
            .get(shell.us())
            .map_or_else(Vec::new, |s| s.grids[..s.shape.n_corners()].to_vec()),
        Place::Beam { beam, .. } => model
            .beams
            .get(beam.us())
            .map_or_else(Vec::new, |b| b.grids.to_vec()),
    }
}

fn say_findings(
    session: &mut Session,
    job: &Job,
    model: &Model,
    rows: &[ResponseRow],
    peaks: &[Peak],
    order: &[usize],
) {
    let joints: BTreeSet<GridIx> = model
        .rigids
        .iter()
        .flat_map(|r| match &r.kind {
            RigidKind::Body {
                independent,
                dependent,
                ..
            } => independent
                .iter()
                .chain(dependent)
                .map(|d| d.0)
                .collect::<Vec<_>>(),
            RigidKind::Mean { arms, .. } => arms.iter().map(|a| a.2).collect(),
        })
        .collect();
    let at_joint: Vec<String> = order
        .iter()
        .filter(|i| grids(model, &rows[**i]).iter().any(|g| joints.contains(g)))
        .map(|i| rows[*i].element.to_string())
        .collect::<BTreeSet<_>>()
        .into_iter()
        .collect();
    if !at_joint.is_empty() {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "hot-at-a-joint",
                at_joint.join(", "),
                "these elements touch a rigid element: their stress is that of the idealised joint and grows as the mesh is refined",
                "judge the joint by its forces, or by elements a plate thickness away",
            )
            .with_numbers(at_joint.len() as f64, 0.0),
        );
    }
    if job
        .measured
        .as_ref()
        .is_none_or(|m| m.reference == job::Reference::None)
    {
        session.findings.push(Finding::new(
            Severity::Info,
            "stress-is-change",
            "respond",
            "loads that are changes give stress that is the change from the state at which the gauges read zero",
            "state [measured] reference to get totals",
        ));
    }
    if let Some(p) = order.first().map(|i| &peaks[*i])
        && p.sigma > 0.1 * p.von_mises
    {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "stress-uncertain",
                "respond",
                "the loads are so uncertain that the largest stress is known to worse than 10 % (1 sd)",
                "improve the gauge layout (`place`), or lower the noise",
            )
            .with_numbers(p.sigma / p.von_mises, 0.1),
        );
    }
}

fn put(
    session: &mut Session,
    job: &Job,
    rows: &[ResponseRow],
    peaks: &[Peak],
    order: &[usize],
    spots: &[usize],
    states: &[LoadState],
) -> Result<(), Faults> {
    let u = stress_unit(job);
    let entry = |i: &usize| {
        let (r, p) = (&rows[*i], &peaks[*i]);
        json!({
            "element": r.element,
            "surface": r.surface_word(),
            "max_von_mises": p.von_mises * u,
            "at": states.get(p.at).map(|s| s.label.as_str()),
            "sigma": p.sigma * u,
            "low": (p.von_mises - NORMAL_95 * p.sigma).max(0.0) * u,
            "high": (p.von_mises + NORMAL_95 * p.sigma) * u,
        })
    };
    session.put("elements", order.iter().map(entry).collect::<Vec<_>>())?;
    let hottest = spots.iter().take(job.respond.hottest);
    session.put("hot_spots", hottest.map(entry).collect::<Vec<_>>())?;
    session.put("states", states.len())?;
    session.put("stress_unit", job.report_units.stress.name)
}

#[allow(clippy::too_many_arguments)]
fn write(
    session: &mut Session,
    arguments: &JobArguments,
    job: &Job,
    fields: &Fields,
    rows: &[ResponseRow],
    peaks: &[Peak],
    order: &[usize],
    spots: &[usize],
    states: &[LoadState],
    check: &gauges::Check,
) -> Result<(), Faults> {
    let model = fields.model();
    let (u, unit) = (stress_unit(job), job.report_units.stress.name);
    let shown = |list: &[usize]| -> Vec<Vec<String>> {
        list.iter()
            .take(60)
            .map(|i| {
                let (r, p) = (&rows[*i], &peaks[*i]);
                vec![
                    r.element.to_string(),
                    r.surface_word(),
                    number(p.von_mises * u),
                    format!("± {}", number(NORMAL_95 * p.sigma * u)),
                    states
                        .get(p.at)
                        .map_or_else(String::new, |s| s.label.clone()),
                ]
            })
            .collect()
    };
    for i in order.iter().take(5) {
        let (r, p) = (&rows[*i], &peaks[*i]);
        session.say(format!(
            "element {} {}: {:.2} +- {:.2} {unit} at {}",
            r.element,
            r.surface_word(),
            p.von_mises * u,
            NORMAL_95 * p.sigma * u,
            states.get(p.at).map_or("", |s| s.label.as_str())
        ));
    }
    let header = ["element", "surface", unit, "95 %", "at"];
    let mut sections = vec![
        table_section(
            "Largest von Mises stress",
            &header,
            &shown(order),
            "From the loads by superposition; the interval is that of the loads.",
        ),
        table_section(
            "Hot spots",
            &header,
            &shown(&spots[..spots.len().min(job.respond.hottest)]),
            "Elements hotter than all that share a grid with them.",
        ),
    ];
    let marks = spots[..spots.len().min(job.respond.hottest)]
        .iter()
        .map(|i| {
            let (r, p) = (&rows[*i], &peaks[*i]);
            let [value, half] = [p.von_mises, NORMAL_95 * p.sigma].map(|v| number(v * u));
            let at = states.get(p.at).map_or("", |s| s.label.as_str());
            let at = csv_cell(at);
            let note = format!("{} {value} ± {half} {unit} in {at}", r.surface_word());
            mark_of_row(model, r, note)
        })
        .collect();
    sections.push(scene_section(
        "Hot spots on the model",
        &scene_of(job, fields, marks),
    ));
    if !check.rows.is_empty() {
        let gauge_rows: Vec<Vec<String>> = check
            .rows
            .iter()
            .map(|g| {
                vec![
                    g.name.clone(),
                    number(g.measured_rms),
                    number(g.residual_rms),
                    number(g.correlation),
                ]
            })
            .collect();
        let kinds = ["states", ""];
        sections.push(figure_section(
            "Measured against predicted strain at the gauges",
            agreement(&check.points, kinds, [&check.states, &[]]),
            "",
        ));
        sections.push(table_section(
            "Gauges, microstrain",
            &["gauge", "measured rms", "residual rms", "correlation"],
            &gauge_rows,
            "",
        ));
    }
    let page = Page::new(
        &job.title,
        "Stress from recovered loads",
        &session.findings,
        sections,
    );
    let out = session.output_for(&arguments.job)?;
    let write = |f: Result<(), Fault>| f.map_err(Faults::from);
    write(out.write("elements.csv", |w| {
        writeln!(w, "element,surface,max_von_mises,sigma,at")?;
        for i in order {
            let (r, p) = (&rows[*i], &peaks[*i]);
            let at = states.get(p.at).map_or("", |s| s.label.as_str());
            let at = csv_cell(at);
            writeln!(
                w,
                "{},{},{},{},{at}",
                r.element,
                r.surface_word(),
                p.von_mises * u,
                p.sigma * u
            )?;
        }
        Ok(())
    }))?;
    write(out.write("histories.csv", |w| {
        files::histories(w, rows, order, states, u)
    }))?;
    write(out.write("envelope.vtu", |w| {
        write_cells_vtu(model, &files::arrays(model, rows, peaks, u, unit), w)
    }))?;
    if !check.rows.is_empty() {
        write(out.write_bytes("predicted.csv", check.csv.as_bytes()))?;
    }
    session.write_page(&arguments.job, page)
}
