//! Files of `reconcile` for strain: gap by gauge, loads before and after, page.

use super::columns::declare_written;
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::model::{Model, Vec3};
use crate::reconcile::strain::StrainFrame;
use crate::report::csv_cell;
use crate::report::figure::GaugePoints;
use crate::report::page::Page;
use crate::report::scene::{Field, FieldValues, Mark, PickTargets, Scene, fields_of, mark_of_gap};
use crate::report::strain::{GapReport, RunStrain, reconcile_page};
use crate::workflow::reconcile::{MarkedStiffness, ModelChange, Reconciliation, StrainPart};
use std::fmt::Write;

/// Writes `gap.csv` and `loads_before_after.csv`.
pub(super) fn write_strain(found: &StrainPart, out: &mut Output) -> Result<(), Faults> {
    out.write_bytes("gap.csv", gap_csv(found).as_bytes())?;
    declare_written(out, "gap.csv", |c| match c {
        "gauge" => String::new(),
        _ => "microstrain".to_owned(),
    })?;
    out.write_bytes("loads_before_after.csv", loads_csv(found).as_bytes())?;
    declare_written(out, "loads_before_after.csv", |c| match c {
        "stated" | "before" | "after" | "sigma" => "unit of column unit".to_owned(),
        _ => String::new(),
    })?;
    Ok(())
}

/// Returns the page.
pub(super) fn strain_page(outcome: &Outcome<Reconciliation>, found: &StrainPart) -> Page {
    let job = &outcome.job;
    let metres = match found.fields {
        Some(_) => job.units.length_m(),
        None => 1.0,
    };
    let gauges = found.frame.gauges.iter().zip(&found.outcome.channels);
    let mark = |(g, gap): (&crate::reconcile::strain::GaugeFacts, _)| {
        let at = Vec3::from(g.position?) / metres;
        Some(mark_of_gap(at, gap))
    };
    let mut marks: Vec<Mark> = gauges.filter_map(mark).collect();
    for m in &mut marks {
        m.note.push_str(&smooth_note(found, &m.name));
    }
    marks.extend(found.marked.iter().filter_map(mark_of_place));
    // A job that gives S has no model: the scene then shows only the gauges.
    let nothing = Model::default();
    let fields = found.fields.as_ref();
    let scene = (!marks.is_empty()).then(|| Scene {
        model: fields.map_or(&nothing, |f| f.model()),
        marks,
        fields: fields.map_or_else(Vec::new, |f| {
            let shells = f.model().shells.len();
            let places = found.marked.iter().filter(|m| !m.shells.is_empty());
            let mut list: Vec<Field> = places.map(|m| field_of_place(m, shells)).collect();
            list.extend(fields_of(job, f));
            list
        }),
        arrows: Vec::new(),
        length: job.units.unit(crate::units::Quantity::Length).name,
        pointing: PickTargets::Nothing,
        caption: "Circles show the gap of each gauge, orange before and blue after: smaller circles are better.".to_owned(),
    });
    reconcile_page(&GapReport {
        title: &job.title,
        outcome: &found.outcome,
        added: added_rows(outcome),
        scene: scene.as_ref(),
        strain: &run_strain(found),
        findings: &outcome.findings,
    })
}

/// Returns the note on a gauge in the scene: the factors on its strain from a smooth model error, with 95 % half widths.
fn smooth_note(found: &StrainPart, gauge: &str) -> String {
    let own = found.smooth.iter().filter(|s| s.gauge == gauge);
    own.map(|s| {
        let load = s
            .load
            .as_ref()
            .map_or_else(String::new, |l| format!(" of {l}"));
        let half = NORMAL_95 * s.sd;
        format!("; strain{load} times {:.3} ± {half:.3}", s.factor)
    })
    .collect()
}

/// A joint or small region that is off, where it sits.
fn mark_of_place(m: &MarkedStiffness) -> Option<Mark> {
    Some(Mark {
        name: m.id.clone(),
        at: m.at?,
        axes: None,
        surface: None,
        note: format!("stiffness times {:.3}", m.factor),
        gap: None,
    })
}

/// The shells whose stiffness is off, coloured by how much.
fn field_of_place(m: &MarkedStiffness, n_shells: usize) -> Field<'static> {
    let mut values = vec![[f64::NAN; 2]; n_shells];
    for &s in &m.shells {
        if let Some(v) = values.get_mut(s) {
            *v = [(m.factor - 1.0).abs(); 2];
        }
    }
    let (way, id) = (if m.factor < 1.0 { "less" } else { "more" }, &m.id);
    Field {
        name: format!("stiffness {way} than in the model: {id}"),
        unit: "%".into(),
        values: FieldValues::Magnitudes(values),
        scale: 100.0,
    }
}

/// Returns a row for each change of the model: effect, path, old and new value.
pub(super) fn added_rows(found: &Reconciliation) -> Vec<Vec<String>> {
    let row = |a: &ModelChange| {
        let cells = [&a.effect, &a.path, &a.old, &a.new];
        cells.map(String::clone).to_vec()
    };
    found.added.iter().map(row).collect()
}

fn gap_csv(found: &StrainPart) -> String {
    let mut text = String::from(
        "gauge,before_microstrain,after_microstrain,floor_microstrain,reading_microstrain\n",
    );
    for c in &found.outcome.channels {
        let _ = writeln!(
            text,
            "{},{:.4},{:.4},{:.4},{:.4}",
            csv_cell(&c.channel),
            c.before,
            c.after,
            c.floor,
            c.reading
        );
    }
    text
}

fn loads_csv(found: &StrainPart) -> String {
    let mut text = String::from("run,load,unit,stated,before,after,sigma,moved\n");
    for l in &found.outcome.loads {
        let moved = if l.is_significant() { "yes" } else { "no" };
        let _ = writeln!(
            text,
            "{},{},{},{:.4},{:.4},{:.4},{:.4},{moved}",
            csv_cell(&l.run),
            csv_cell(&l.load),
            l.unit,
            l.stated,
            l.before,
            l.after,
            l.sigma
        );
    }
    text
}

/// Measured and predicted strain of the runs, by the model as it was given and with the effects in.
fn run_strain(found: &StrainPart) -> RunStrain {
    let frame = &found.frame;
    let o = &frame.observations;
    let held = |run: &usize| o.held_out.get(*run).copied().unwrap_or(false);
    let (held_out, used): (Vec<usize>, Vec<usize>) = (0..frame.n_runs()).partition(held);
    let points = |predicted: &[f64]| gauge_points(frame, predicted, [&used, &held_out]);
    let names = |runs: &[usize]| runs.iter().map(|r| o.runs[*r].clone()).collect();
    RunStrain {
        before: points(&found.predicted),
        after: points(&found.predicted_after),
        used: names(&used),
        held_out: names(&held_out),
    }
}

fn gauge_points(
    frame: &StrainFrame,
    predicted: &[f64],
    kinds: [&Vec<usize>; 2],
) -> Vec<GaugePoints> {
    let o = &frame.observations;
    let n = frame.n_gauges();
    let one = |g: usize| {
        let pairs = kinds.map(|runs| -> Vec<(f64, f64)> {
            let of = |r: &usize| (predicted[r * n + g], o.value(*r, g));
            runs.iter().map(of).collect()
        });
        let square = |p: &(f64, f64)| (p.1 - p.0).powi(2);
        let known: Vec<f64> = pairs.iter().flatten().map(square).collect();
        let known: Vec<f64> = known.into_iter().filter(|v| v.is_finite()).collect();
        GaugePoints {
            name: o.channels.get(g).cloned().unwrap_or_default(),
            residual: (known.iter().sum::<f64>() / known.len().max(1) as f64).sqrt(),
            points: pairs,
        }
    };
    (0..n).map(one).collect()
}
