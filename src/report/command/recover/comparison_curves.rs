//! Spectra, coherence and level crossings of recovered and recorded loads: tables and figures.

use crate::host::fault::Faults;
use crate::host::output::Output;
use crate::report::csv_cell;
use crate::report::figure::{Figure, Line, Scale, lines};
use crate::report::page::{Block, Section, number};
use crate::workflow::recover::{Comparison, ComparisonSpectra};

/// A column: name, unit (empty for a plain number), cells.
type Column = (String, String, Vec<String>);

/// Writes `comparison_spectra.csv` and `comparison_levels.csv`, where there is something in them.
///
/// # Errors
/// A file that can't be written.
pub(super) fn write(out: &mut Output, comparison: &Comparison) -> Result<(), Faults> {
    if let Some(spectra) = &comparison.spectra {
        table(out, "comparison_spectra.csv", &spectrum_columns(spectra))?;
    }
    if !comparison.levels.is_empty() {
        let mut columns: Vec<Column> = Vec::new();
        for l in &comparison.levels {
            let count = |x: &[u64]| x.iter().map(u64::to_string).collect();
            let name = |part: &str| format!("{}.{part}", l.load);
            let levels = l.levels.iter().map(|v| v.to_string()).collect();
            columns.push((name("level"), l.unit.clone(), levels));
            columns.push((name("recovered"), String::new(), count(&l.recovered)));
            columns.push((name("recorded"), String::new(), count(&l.recorded)));
        }
        table(out, "comparison_levels.csv", &columns)?;
    }
    Ok(())
}

fn spectrum_columns(spectra: &ComparisonSpectra) -> Vec<Column> {
    let cells = |x: &[f64]| {
        let cell = |v: &f64| v.is_finite().then(|| format!("{v:.9e}"));
        x.iter().map(|v| cell(v).unwrap_or_default()).collect()
    };
    let frequencies = spectra.f_hz.iter().map(|f| f.to_string()).collect();
    let mut columns = vec![("frequency".to_owned(), "Hz".to_owned(), frequencies)];
    for l in &spectra.loads {
        let name = |part: &str| format!("{}.{part}", l.load);
        let density = format!("{}2/Hz", unit_in_parentheses(&l.unit));
        columns.push((name("recovered"), density.clone(), cells(&l.recovered)));
        columns.push((name("recorded"), density, cells(&l.recorded)));
        columns.push((name("coherence"), String::new(), cells(&l.coherence)));
        columns.push((name("phase"), "deg".to_owned(), cells(&l.phase_deg)));
    }
    columns
}

/// A unit of two words in parentheses, as it is raised to a power.
fn unit_in_parentheses(unit: &str) -> String {
    match unit.contains(' ') {
        true => format!("({unit})"),
        false => unit.to_owned(),
    }
}

fn table(out: &mut Output, name: &str, columns: &[Column]) -> Result<(), Faults> {
    let head = |c: &Column| {
        let unit = if c.1.is_empty() { "-" } else { &c.1 };
        format!("{} [{unit}]", c.0)
    };
    let heads: Vec<String> = columns.iter().map(head).collect();
    let rows = columns.iter().map(|c| c.2.len()).max().unwrap_or(0);
    out.write(name, |w| {
        let cells: Vec<_> = heads.iter().map(|h| csv_cell(h)).collect();
        writeln!(w, "{}", cells.join(","))?;
        for i in 0..rows {
            let row: Vec<&str> = columns.iter().map(|c| c.2[i].as_str()).collect();
            writeln!(w, "{}", row.join(","))?;
        }
        Ok(())
    })?;
    let units = columns.iter().map(|c| c.1.clone());
    out.declare(name, heads.into_iter().zip(units).collect::<Vec<_>>());
    Ok(())
}

/// The section of the page with spectra, coherence and level crossings; `None` for runs.
pub(super) fn curve_section(comparison: &Comparison) -> Option<Section> {
    let mut blocks = Vec::new();
    if let Some(spectra) = &comparison.spectra {
        blocks.push(Block::Figure(densities(spectra)));
        blocks.push(Block::Figure(coherences(spectra)));
        blocks.push(Block::Note(format!(
            "Welch: Hann window, segments of {} s with 50 % overlap, {} averages.",
            number(spectra.segment_s),
            spectra.averages
        )));
    }
    if !comparison.levels.is_empty() {
        blocks.push(Block::Figure(crossings(comparison)));
        blocks.push(Block::Note(
            "ASTM E1049, 5.1: rises beyond levels at or above the mean of the recorded load, falls beyond levels below it.".to_owned(),
        ));
    }
    (!blocks.is_empty()).then(|| Section::new("Spectra and level crossings", blocks))
}

fn densities(spectra: &ComparisonSpectra) -> Figure {
    // The mean is removed, so that the first line contains nothing.
    let x = spectra.f_hz.get(1..).unwrap_or_default();
    let groups: Vec<(String, Vec<Line>)> = (spectra.loads.iter())
        .map(|l| {
            let of = |name, y| Line { name, x, y };
            let (measured, recovered) = (&l.recorded[1..], &l.recovered[1..]);
            (
                format!("{}, {}²/Hz", l.load, unit_in_parentheses(&l.unit)),
                vec![of("measured", measured), of("recovered", recovered)],
            )
        })
        .collect();
    let caption = "Spectral density of recovered and recorded load: curves that agree are better.";
    lines(&groups, "frequency, Hz", "density", Scale::LogY, caption)
}

fn coherences(spectra: &ComparisonSpectra) -> Figure {
    let x = spectra.f_hz.get(1..).unwrap_or_default();
    let groups: Vec<(String, Vec<Line>)> = (spectra.loads.iter())
        .map(|l| {
            let y = &l.coherence[1..];
            (
                l.load.clone(),
                vec![Line {
                    name: "coherence",
                    x,
                    y,
                }],
            )
        })
        .collect();
    let caption = "Coherence of recovered and recorded load: values near 1 are better.";
    lines(
        &groups,
        "frequency, Hz",
        "coherence",
        Scale::Linear,
        caption,
    )
}

fn crossings(comparison: &Comparison) -> Figure {
    let counts: Vec<[Vec<f64>; 2]> = (comparison.levels.iter())
        .map(|l| [&l.recorded, &l.recovered].map(|c| c.iter().map(|n| *n as f64).collect()))
        .collect();
    let groups: Vec<(String, Vec<Line>)> = (comparison.levels.iter().zip(&counts))
        .map(|(l, [recorded, recovered])| {
            let of = |name, y| Line {
                name,
                x: &l.levels,
                y,
            };
            (
                format!("{}, {}", l.load, l.unit),
                vec![of("measured", recorded), of("recovered", recovered)],
            )
        })
        .collect();
    let caption =
        "Crossings of each level by recovered and recorded load: curves that agree are better.";
    lines(&groups, "level", "crossings", Scale::Linear, caption)
}
