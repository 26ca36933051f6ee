//! Recovered against recorded loads, and loads by section: tables, console, page.

use super::comparison_curves;
use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::measured::conditioning_step::ConditioningStep;
use crate::report::csv_cell;
use crate::report::figure::{CrossPlot, cross_plot};
use crate::report::page::{Block, Page, Section, number, table_section};
use crate::units::{format_fixed, percent};
use crate::workflow::recover::{Comparison, LoadComparison, RecoveredLoads, Sections};
use std::io::Write;

/// Unit of a column that is in the unit of its row.
const OF_LOAD: &str = "report unit of the load";
/// Unit of damage.
const DAMAGE: &str = "report unit to the power of the slope";

const COMPARISON: [(&str, &str); 9] = [
    ("load", ""),
    ("unit", ""),
    ("n", ""),
    ("bias", OF_LOAD),
    ("rms", OF_LOAD),
    ("share_within", ""),
    ("damage_ratio", ""),
    ("damage_ratio_low", ""),
    ("damage_ratio_high", ""),
];

const SECTIONS: [(&str, &str); 12] = [
    ("section", ""),
    ("load", ""),
    ("unit", ""),
    ("seconds [s]", "s"),
    ("repeats", ""),
    ("min", OF_LOAD),
    ("mean", OF_LOAD),
    ("max", OF_LOAD),
    ("damage", DAMAGE),
    ("damage_low", DAMAGE),
    ("damage_high", DAMAGE),
    ("stretches [-]", ""),
];

/// Writes `comparison.csv` and `sections.csv` if they have any content.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write(out: &mut Output, recovered: &RecoveredLoads) -> Result<(), Faults> {
    let loads = &recovered.comparison.loads;
    if !loads.is_empty() {
        out.declare("comparison.csv", COMPARISON);
        out.write("comparison.csv", |w| {
            writeln!(w, "{}", COMPARISON.map(|c| c.0).join(","))?;
            loads.iter().try_for_each(|l| comparison_row(w, l))
        })?;
    }
    comparison_curves::write(out, &recovered.comparison)?;
    if let Some(sections) = &recovered.sections {
        out.declare("sections.csv", SECTIONS);
        out.write("sections.csv", |w| sections_csv(w, sections))?;
    }
    Ok(())
}

/// A number of a table; blank where it does not exist.
fn cell(v: impl Into<Option<f64>>) -> String {
    let known = v.into().filter(|v| v.is_finite());
    known.map_or_else(String::new, |v| v.to_string())
}

fn comparison_row(w: &mut dyn Write, l: &LoadComparison) -> std::io::Result<()> {
    writeln!(
        w,
        "{},{},{},{},{},{},{},{},{}",
        csv_cell(&l.load),
        csv_cell(&l.unit),
        l.n,
        cell(l.bias),
        cell(l.rms),
        cell(l.share_within),
        cell(l.damage_ratio),
        cell(l.damage_ratio_low),
        cell(l.damage_ratio_high)
    )
}

fn sections_csv(w: &mut dyn Write, sections: &Sections) -> std::io::Result<()> {
    writeln!(w, "{}", SECTIONS.map(|c| c.0).join(","))?;
    for s in &sections.sections {
        let numbers = [
            s.seconds,
            s.repeats,
            s.min,
            s.mean,
            s.max,
            s.damage,
            s.damage_low,
            s.damage_high,
        ];
        let names = [&s.section, &s.load, &s.unit].map(|n| csv_cell(n));
        let numbers = numbers.map(cell).join(",");
        writeln!(w, "{},{numbers},{}", names.join(","), s.stretches)?;
    }
    Ok(())
}

/// Damage ratio with its interval; a dash of runs.
fn ratio(l: &LoadComparison) -> String {
    let or_dash = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), number);
    let ends = [l.damage_ratio_low, l.damage_ratio_high].map(or_dash);
    match l.damage_ratio {
        Some(ratio) => format!("{} ({} to {})", number(ratio), ends[0], ends[1]),
        None => "-".to_owned(),
    }
}

/// Returns the cells of a load next to its recovered value on a terminal: bias, rms, share within the interval, damage ratio.
pub(super) fn cells(comparison: &Comparison, load: &str) -> [String; 4] {
    match comparison.loads.iter().find(|l| l.load == load) {
        Some(l) => [
            format!("{} {}", number(l.bias), l.unit),
            format!("{} {}", number(l.rms), l.unit),
            percent(l.share_within),
            ratio(l),
        ],
        None => ["-"; 4].map(str::to_owned),
    }
}

/// Adds the comparison and the sections to the page, after its first section.
pub(super) fn add_sections(page: &mut Page, recovered: &RecoveredLoads) {
    let mut added = Vec::new();
    let comparison = &recovered.comparison;
    if !comparison.loads.is_empty() {
        added.push(comparison_section(comparison));
        added.extend(comparison_curves::curve_section(comparison));
    }
    if let Some(sections) = &recovered.sections {
        added.push(section_table(sections));
        added.push(duty_cycle(sections));
    }
    if !recovered.reading_conditioning.is_empty() {
        added.push(conditioning_section(&recovered.reading_conditioning));
    }
    let at = page.sections.len().min(1);
    page.sections.splice(at..at, added);
}

fn comparison_section(comparison: &Comparison) -> Section {
    let row = |l: &LoadComparison| {
        vec![
            l.load.clone(),
            l.unit.clone(),
            l.n.to_string(),
            number(l.bias),
            number(l.rms),
            percent(l.share_within),
            ratio(l),
        ]
    };
    let head = [
        "load",
        "unit",
        "n",
        "bias",
        "rms",
        "inside the 95 % interval",
        "damage ratio (95 % interval)",
    ];
    let plots: Vec<CrossPlot> = comparison
        .loads
        .iter()
        .map(|l| CrossPlot {
            name: &l.load,
            unit: &l.unit,
            points: &l.points,
        })
        .collect();
    let shift = comparison.shift.as_ref().map(|s| {
        let half = s.half_width_s.map_or_else(
            || ", as stated".to_owned(),
            |h| format!(" ± {}", format_fixed(h, 5)),
        );
        let shift = format_fixed(s.shift_s, 5);
        Block::Text(format!("Time shift of {}: {shift}{half} s.", s.file))
    });
    let mut blocks: Vec<Block> = shift.into_iter().collect();
    blocks.push(Block::table(
        &head,
        comparison.loads.iter().map(row).collect(),
    ));
    blocks.push(Block::Figure(cross_plot(&plots)));
    blocks.push(Block::Note(
        "Bias and rms: mean and root mean square of recovered minus recorded load. Damage ratio: pseudo-damage of the recovered load \
         divided by the pseudo-damage of the recorded load, between the same times. The plot shows some of the points."
            .to_owned(),
    ));
    Section::new("Recovered against recorded loads", blocks)
}

/// Returns the table of the changes by `[conditioning]`, with a row for each step and gauge.
fn conditioning_section(steps: &[ConditioningStep]) -> Section {
    let row = |s: &ConditioningStep| {
        vec![
            s.step.replace('_', "-"),
            s.gauge.clone(),
            s.samples.to_string(),
            number(s.rms_microstrain),
        ]
    };
    let head = [
        "step",
        "gauge",
        "samples changed",
        "change, microstrain rms",
    ];
    let table = Block::table(&head, steps.iter().map(row).collect());
    Section::new("Conditioning of the readings", vec![table])
}

fn section_table(sections: &Sections) -> Section {
    let rows = sections.sections.iter().map(|s| {
        vec![
            s.section.clone(),
            s.load.clone(),
            s.unit.clone(),
            number(s.seconds),
            number(s.repeats),
            number(s.min),
            number(s.mean),
            number(s.max),
            number(s.damage),
            format!("{} to {}", number(s.damage_low), number(s.damage_high)),
        ]
    });
    let head = [
        "section",
        "load",
        "unit",
        "duration, s",
        "repeats",
        "min",
        "mean",
        "max",
        "damage",
        "95 % interval",
    ];
    let rows: Vec<Vec<String>> = rows.collect();
    table_section(
        "Loads by section",
        &head,
        &rows,
        "Damage: of one pass of the section.",
    )
}

fn duty_cycle(sections: &Sections) -> Section {
    let rows = sections.duty_cycle.iter().map(|d| {
        vec![
            d.load.clone(),
            d.unit.clone(),
            number(d.seconds),
            number(d.damage),
            format!("{} to {}", number(d.damage_low), number(d.damage_high)),
        ]
    });
    let head = ["load", "unit", "duration, s", "damage", "95 % interval"];
    let rows: Vec<Vec<String>> = rows.collect();
    let note = "Sum of repeats times damage over the sections.";
    table_section("Duty cycle", &head, &rows, note)
}
