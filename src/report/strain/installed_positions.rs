//! The table of gauges at their installed positions, as determined from the runs, in columns that a job can name as its gauges.

use crate::job::{Job, StatedPlace};
use crate::report::csv_cell;
use crate::workflow::calibrate::{
    CalibratedGauge, GlueSummary, InstalledGauge, InstalledPositionSummary,
};
use std::io::{self, Write};

/// Columns with their units. `L` stands for the job's unit of length.
pub const COLUMNS: [(&str, &str); 26] = [
    ("name", ""),
    ("element", ""),
    ("point", ""),
    ("station", ""),
    ("surface", ""),
    ("x", "L"),
    ("y", "L"),
    ("z", "L"),
    ("dir_x", ""),
    ("dir_y", ""),
    ("dir_z", ""),
    ("bridge", ""),
    ("bridge_factor", ""),
    ("element2", ""),
    ("surface2", ""),
    ("grid_length", "L"),
    ("transverse_sensitivity", ""),
    ("along", "L"),
    ("along_sigma", "L"),
    ("across", "L"),
    ("across_sigma", "L"),
    ("turned_deg", "deg"),
    ("turned_sigma_deg", "deg"),
    ("gain", ""),
    ("gain_sigma", ""),
    ("told", ""),
];

/// Writes a row for each gauge. Its gain is in `bridge_factor`, so that the table alone gives S of the installed gauges.
///
/// # Errors
/// Errors of `out`.
pub fn write_installed_positions(
    out: &mut dyn Write,
    job: &Job,
    gauges: &[CalibratedGauge],
    glued: &[Option<InstalledGauge>],
) -> io::Result<()> {
    writeln!(out, "{}", COLUMNS.map(|c| c.0).join(","))?;
    for (named, glued) in gauges.iter().zip(glued) {
        let Some(found) = &named.as_glued else {
            continue;
        };
        let cells = match glued {
            Some(g) => on_shell(g),
            None => on_bar(job, &named.name, found.gain.value),
        };
        let name = csv_cell(&named.name);
        writeln!(out, "{name},{},{}", cells.join(","), sizes(found).join(","))?;
    }
    Ok(())
}

/// `element` to `transverse_sensitivity`.
fn on_shell(g: &InstalledGauge) -> [String; 16] {
    let word = |v: f64| v.to_string();
    let blank = String::new;
    let element = if g.by_position {
        blank()
    } else {
        g.gauge.element.to_string()
    };
    let at = |v: f64| if g.by_position { word(v) } else { blank() };
    let d = g.gauge.direction;
    [
        element,
        blank(),
        blank(),
        g.gauge.surface.word().to_owned(),
        at(g.at.x),
        at(g.at.y),
        at(g.at.z),
        word(d.x),
        word(d.y),
        word(d.z),
        g.bridge.to_owned(),
        word(g.spec.bridge_factor / g.gain),
        g.pair.map_or_else(blank, |p| p.0.to_string()),
        g.pair.map_or_else(blank, |p| p.1.word().to_owned()),
        word(g.spec.grid_length),
        word(g.spec.transverse_sensitivity),
    ]
}

fn on_bar(job: &Job, name: &str, gain: f64) -> [String; 16] {
    let mut cells: [String; 16] = Default::default();
    let Some(g) = job.gauges.iter().find(|g| g.name == name) else {
        return cells;
    };
    if let StatedPlace::BeamPoint {
        element,
        point,
        station,
    } = g.place
    {
        cells[0] = element.to_string();
        cells[1] = ["C", "D", "E", "F"]
            .get(usize::from(point))
            .map_or_else(String::new, |p| (*p).to_owned());
        cells[2] = station.to_string();
    }
    cells[10] = g.bridge.name().to_owned();
    cells[11] = (g.bridge_factor / gain).to_string();
    cells
}

/// Returns the cells of the sizes from `along` on, and the list of the sizes that the data determine.
fn sizes(found: &InstalledPositionSummary) -> Vec<String> {
    let named = [
        ("along", found.along),
        ("across", found.across),
        ("angle", found.angle_deg),
        ("gain", Some(found.gain)),
    ];
    let pair = |s: &Option<GlueSummary>| match s {
        Some(s) => [s.value.to_string(), s.sigma.to_string()],
        None => Default::default(),
    };
    let determined: Vec<&str> = named
        .iter()
        .filter(|n| n.1.is_some_and(|s| s.told))
        .map(|n| n.0)
        .collect();
    let mut out: Vec<String> = named.iter().flat_map(|n| pair(&n.1)).collect();
    out.push(determined.join(" "));
    out
}
