//! Files of `reconcile` for motion: gap by equation, band, time and amplitude, restoring forces, page.

use super::columns::declare_written;
use crate::app::fault::Faults;
use crate::app::outcome::Outcome;
use crate::app::output::Output;
use crate::app::reconcile::{MotionPart, Reconciled, SimulationFound};
use crate::reconcile::motion::MotionOutcome;
use crate::reconcile::motion::gap::EquationGap;
use crate::report::figure::gap_by_channel;
use crate::report::page::{Block, Page, Section, figure_section, number, table_section};
use crate::report::vehicle::{
    restoring_curves, restoring_section, restoring_unit, write_restoring_force,
};
use crate::vehicle::term::UnitNames;
use std::fmt::Write;

/// Writes the tables; `units` are the job's.
pub(super) fn write_motion(
    found: &MotionPart,
    units: &UnitNames,
    out: &mut Output,
) -> Result<(), Faults> {
    let table = match &found.identified {
        Some((id, moved)) => write_restoring_force(id, moved),
        None => String::new(),
    };
    for (name, text) in gap_tables(&found.outcome) {
        out.write_bytes(name, text.as_bytes())?;
        declare_written(out, name, gap_unit)?;
    }
    out.write_bytes("restoring_force.csv", table.as_bytes())?;
    declare_written(out, "restoring_force.csv", |c| restoring_unit(c, units))?;
    Ok(())
}

/// The unit of a column of the tables of gaps; empty: a name, or a share of the measured quantity.
fn gap_unit(column: &str) -> String {
    match column {
        "up_to_hz" => "Hz",
        "up_to_s" => "s",
        _ => "",
    }
    .to_owned()
}

/// The page.
pub(super) fn motion_page(outcome: &Outcome<Reconciled>, found: &MotionPart) -> Page {
    let curves = match &found.identified {
        Some((id, moved)) => restoring_curves(id, moved),
        None => Vec::new(),
    };
    let mut sections = gap_sections(&found.outcome);
    sections.extend(effect_sections(found));
    sections.extend(simulation(found).map(simulation_section));
    let units = UnitNames::from_system(outcome.job.units);
    sections.push(restoring_section(&curves, &units));
    Page::new(
        &outcome.job.title,
        "Where vehicle model and record disagree, and what is missing",
        &outcome.findings,
        sections,
    )
}

/// What simulation leaves, a line a sensor.
pub(super) fn simulated_words(found: &MotionPart) -> String {
    let mut text = String::new();
    for c in simulation(found).iter().flat_map(|s| &s.channels) {
        let _ = writeln!(
            text,
            "simulated {}: error {} before, {} after, of {}",
            c.channel,
            number(c.before),
            number(c.after),
            number(c.measured_rms)
        );
    }
    text
}

fn simulation(found: &MotionPart) -> Option<&SimulationFound> {
    found.simulation.as_ref()?.done()
}

/// Equations before, each with itself after.
fn equations(
    outcome: &MotionOutcome,
) -> impl Iterator<Item = (&EquationGap, Option<&EquationGap>)> {
    let after_of = |name: &str| {
        let after = outcome.after.iter().flat_map(|g| &g.equations);
        after.into_iter().find(|e| e.name == name)
    };
    let before = outcome.before.iter().flat_map(|g| &g.equations);
    before.map(move |e| (e, after_of(&e.name)))
}

/// `gap.csv`, and the gap by band, time and amplitude: equation, upper edge of the stretch, before, after.
fn gap_tables(outcome: &MotionOutcome) -> [(&'static str, String); 4] {
    let mut gap = String::from("equation,before,after,floor\n");
    let mut bands = String::from("equation,up_to_hz,before,after\n");
    let mut times = String::from("equation,up_to_s,before,after\n");
    let mut sizes = String::from("equation,up_to_size_over_rms,before,after\n");
    for (e, after) in equations(outcome) {
        let left = after.map_or(f64::NAN, |a| a.gap);
        let _ = writeln!(gap, "{},{:.6},{left:.6},{:.6}", e.name, e.gap, e.floor);
        let lists = [
            (&mut bands, &e.by_band, after.map(|a| &a.by_band)),
            (
                &mut times,
                &e.profile.by_time,
                after.map(|a| &a.profile.by_time),
            ),
            (
                &mut sizes,
                &e.profile.by_amplitude,
                after.map(|a| &a.profile.by_amplitude),
            ),
        ];
        for (table, before, after) in lists {
            for (i, b) in before.iter().enumerate() {
                let a = after.and_then(|a| a.get(i)).map_or(f64::NAN, |a| a[1]);
                let _ = writeln!(table, "{},{:.3},{:.6},{a:.6}", e.name, b[0], b[1]);
            }
        }
    }
    [
        ("gap.csv", gap),
        ("gap_bands.csv", bands),
        ("gap_times.csv", times),
        ("gap_amplitudes.csv", sizes),
    ]
}

/// Verdict, and the gap by equation.
fn gap_sections(outcome: &MotionOutcome) -> Vec<Section> {
    // Gap before, after, floor, percent.
    let gaps: Vec<(String, [f64; 3])> = equations(outcome)
        .map(|(e, after)| {
            let left = after.map_or(f64::NAN, |a| a.gap);
            (e.name.clone(), [e.gap, left, e.floor].map(|v| 100.0 * v))
        })
        .collect();
    let rows: Vec<Vec<String>> = gaps
        .iter()
        .map(|(name, values)| {
            let cells = values.map(|v| format!("{v:.2}"));
            std::iter::once(name.clone()).chain(cells).collect()
        })
        .collect();
    let verdict = format!("{}.", outcome.verdict.word());
    vec![
        Section::new(
            "Verdict",
            vec![
                Block::Stressed(verdict, outcome.remains.clone()),
                Block::Stressed("Next measurement:".into(), outcome.next_measurement.clone()),
            ],
        ),
        figure_section(
            "Gap before and after",
            gap_by_channel(&gaps, "% of the measured quantity,"),
            &format!(
                "On {}, by equation of motion; stroke: the floor.",
                outcome.judged_by.words()
            ),
        ),
        table_section(
            "Gap by equation, % of the measured quantity",
            &["equation", "before", "after", "floor"],
            &rows,
            "",
        ),
    ]
}

/// Effects, other explanations, wheel forces.
fn effect_sections(found: &MotionPart) -> [Section; 3] {
    let effects: Vec<Vec<String>> = found
        .outcome
        .best_attempt
        .iter()
        .map(|e| {
            let sizes: Vec<String> = e
                .size
                .iter()
                .zip(&e.sigma)
                .map(|(v, s)| format!("{v:.5e} +- {s:.1e}"))
                .collect();
            vec![e.id.clone(), sizes.join(", "), e.unit.clone()]
        })
        .collect();
    let rivals: Vec<Vec<String>> = found
        .outcome
        .rivals
        .iter()
        .map(|r| {
            vec![
                r.ids.join(" + "),
                format!("{:.1}", r.evidence_difference),
                format!("{:.2}", 100.0 * r.gap_after),
            ]
        })
        .collect();
    let forces: Vec<Vec<String>> = found
        .wheel_force
        .iter()
        .map(|w| {
            vec![
                w.channel.clone(),
                format!("{:.2}", 100.0 * w.before),
                w.after.map_or("-".into(), |a| format!("{:.2}", 100.0 * a)),
            ]
        })
        .collect();
    [
        table_section("Effects", &["effect", "size", "unit"], &effects, ""),
        table_section(
            "Other explanations",
            &["effects", "log evidence behind", "gap after, %"],
            &rivals,
            "",
        ),
        table_section(
            "Wheel force, % left over",
            &["channel", "before", "after"],
            &forces,
            "",
        ),
    ]
}

fn simulation_section(s: &SimulationFound) -> Section {
    let cells = s.channels.iter().map(|c| {
        let values = [c.measured_rms, c.before, c.after].map(number);
        std::iter::once(c.channel.clone()).chain(values).collect()
    });
    table_section(
        "Simulated held-out data, RMS in the unit of the channel",
        &["channel", "measured", "error before", "error after"],
        &cells.collect::<Vec<Vec<String>>>(),
        "Both models with the parameters that simulate the fitted record best.",
    )
}
