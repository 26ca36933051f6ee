//! Files of `reconcile` for motion: gap by equation, band, time and amplitude, restoring forces, page.

use super::columns::declare_written;
use super::reconcile_strain::added_rows;
use crate::estimate::NORMAL_95;
use crate::host::fault::Faults;
use crate::host::outcome::Outcome;
use crate::host::output::Output;
use crate::reconcile::motion::gap::EquationGap;
use crate::reconcile::motion::sits::{GapSits, Stretch};
use crate::reconcile::motion::{MotionEffect, MotionOutcome};
use crate::reconcile::{AlternativeExplanation, Verdict};
use crate::report::covariance::covariance_block;
use crate::report::figure::gap_by_channel;
use crate::report::page::{Block, Page, Section, number, table_section};
use crate::report::strain::ADDED;
use crate::report::vehicle::{
    restoring_curves, restoring_section, restoring_unit, write_restoring_force,
};
use crate::units::plus_minus;
use crate::vehicle::term::UnitNames;
use crate::workflow::reconcile::{MotionPart, Reconciliation, SimulationFound};
use std::fmt::Write;

/// Writes the tables. `units` are the units of the job.
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

/// Returns the page.
pub(super) fn motion_page(outcome: &Outcome<Reconciliation>, found: &MotionPart) -> Page {
    let curves = match &found.identified {
        Some((id, moved)) => restoring_curves(id, moved),
        None => Vec::new(),
    };
    let mut sections = vec![
        verdict_section(outcome, found),
        where_section(found),
        added_section(outcome, found),
        gap_section(&found.outcome),
    ];
    sections.extend(scatter_section(found));
    sections.extend(alternatives_section(&found.outcome));
    sections.push(Section::new(
        "Remaining gap",
        vec![
            Block::Text(found.outcome.remains.clone()),
            Block::Stressed(
                "Next measurement:".into(),
                found.outcome.next_measurement.clone(),
            ),
        ],
    ));
    let units = UnitNames::from_system(outcome.job.units);
    sections.push(restoring_section(&curves, &units));
    Page::new(
        &outcome.job.title,
        "Differences between vehicle model and record, and missing effects",
        &outcome.findings,
        sections,
    )
}

fn simulation(found: &MotionPart) -> Option<&SimulationFound> {
    found.simulation.as_ref()?.result()
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

fn verdict_section(outcome: &Outcome<Reconciliation>, found: &MotionPart) -> Section {
    let words = match found.outcome.verdict {
        Verdict::Named => format!(
            "An effect is missing in the model and is identified: {}.",
            outcome.named.join(", ")
        ),
        Verdict::None => "Model and record agree within noise and declared tolerances.".into(),
        Verdict::Unknown => {
            "Model and record differ, and no effect of the library explains the gap.".into()
        }
        Verdict::BelowDetectability => {
            "The record indicates an effect that is too small to identify.".into()
        }
    };
    let verdict = format!("{}.", found.outcome.verdict.word());
    Section::new("Verdict", vec![Block::Stressed(verdict, words)])
}

/// Returns the section with the place of the largest gap of each equation: band, time and size of the motion, before and after.
fn where_section(found: &MotionPart) -> Section {
    let stretch = |s: &Option<Stretch>| match s {
        Some(s) => format!("{:.2} to {:.2}: {:.2}", s.from, s.to, 100.0 * s.gap),
        None => "-".into(),
    };
    let rows = |list: &[GapSits]| -> Vec<Vec<String>> {
        let row = |s: &GapSits| {
            let at = [&s.band_hz, &s.time_s, &s.size_over_rms].map(stretch);
            [s.equation.clone(), format!("{:.2}", 100.0 * s.gap)]
                .into_iter()
                .chain(at)
                .collect()
        };
        list.iter().map(row).collect()
    };
    let head = [
        "equation",
        "gap, %",
        "worst band, Hz: %",
        "worst stretch, s: %",
        "worst amplitude of the motion, times its rms: %",
    ];
    let mut blocks = vec![Block::Text(format!("{}.", found.sits))];
    if !found.sits_at.is_empty() {
        blocks.push(Block::table(&head, rows(&found.sits_at)));
    }
    if !found.sits_after.is_empty() && !found.outcome.best_attempt.is_empty() {
        blocks.push(Block::Folded {
            summary: "the same with the effects included".into(),
            blocks: vec![Block::table(&head, rows(&found.sits_after))],
        });
    }
    Section::new("Largest gaps", blocks)
}

/// Effects with their sizes, their joint probability, and their places in the extended job.
fn added_section(outcome: &Outcome<Reconciliation>, found: &MotionPart) -> Section {
    let attempt = &found.outcome.best_attempt;
    if attempt.is_empty() {
        let nothing = Block::Text("No effect is identified.".into());
        return Section::new(ADDED, vec![nothing]);
    }
    let row = |e: &MotionEffect| {
        let sizes: Vec<String> = e
            .size
            .iter()
            .zip(&e.sigma)
            .map(|(v, s)| plus_minus(*v, NORMAL_95 * s))
            .collect();
        vec![e.id.clone(), sizes.join(", "), e.unit.clone()]
    };
    let head = ["effect", "size (± half width of the 95 % interval)", "unit"];
    let mut blocks = vec![Block::table(&head, attempt.iter().map(row).collect())];
    let added = added_rows(outcome);
    blocks.push(match (found.outcome.verdict, added.is_empty()) {
        (Verdict::Named, false) => {
            Block::table(&["effect", "path", "old value", "new value"], added)
        }
        (Verdict::Named, true) => {
            Block::Text("No extended model is written: the findings state the reason.".into())
        }
        _ => Block::Text("The best attempt. It is not identified, and nothing was added.".into()),
    });
    let names = attempt.iter().flat_map(|e| {
        let name = |k: usize| match e.size.len() {
            1 => e.id.clone(),
            _ => format!("{} ({})", e.id, k + 1),
        };
        (0..e.size.len()).map(name).collect::<Vec<_>>()
    });
    blocks.extend(covariance_block(
        &names.collect::<Vec<_>>(),
        &found.covariance.concat(),
    ));
    Section::new(ADDED, blocks)
}

/// The gap by equation, before and after.
fn gap_section(outcome: &MotionOutcome) -> Section {
    // Gap before, gap after and noise floor, in percent.
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
    Section::new(
        "Gap before and after",
        vec![
            Block::Figure(gap_by_channel(&gaps, "% of the measured quantity, rms")),
            Block::Note(format!(
                "On {}, by equation of motion; stroke: the floor.",
                outcome.judged_by.words()
            )),
            Block::table(
                &[
                    "equation",
                    "before, % of the measured quantity",
                    "after",
                    "floor",
                ],
                rows,
            ),
        ],
    )
}

/// Section with the errors of the simulation and of measured wheel forces, before and after the correction.
fn scatter_section(found: &MotionPart) -> Option<Section> {
    let mut blocks = Vec::new();
    if let Some(s) = simulation(found) {
        let cells = s.channels.iter().map(|c| {
            let values = [c.measured_rms, c.before, c.after].map(number);
            std::iter::once(c.channel.clone()).chain(values).collect()
        });
        let head = [
            "simulated channel",
            "measured",
            "error before",
            "error after",
        ];
        blocks.push(Block::table(&head, cells.collect()));
        blocks.push(Block::Note(format!(
            "{}. These parameters give the best simulation of the fitted record.",
            s.metric
        )));
    }
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
    if !forces.is_empty() {
        let head = ["wheel force", "left over before, %", "after, %"];
        blocks.push(Block::table(&head, forces));
    }
    (!blocks.is_empty()).then(|| Section::new("Scatter before and after", blocks))
}

fn alternatives_section(outcome: &MotionOutcome) -> Option<Section> {
    let row = |r: &AlternativeExplanation| {
        vec![
            r.ids.join(" + "),
            format!("{:.1}", r.evidence_difference),
            format!("{:.2}", 100.0 * r.gap_after),
        ]
    };
    let rivals: Vec<Vec<String>> = outcome.rivals.iter().map(row).collect();
    let head = ["effects", "log evidence behind", "gap after, %"];
    (!rivals.is_empty()).then(|| table_section("Other explanations", &head, &rivals, ""))
}
