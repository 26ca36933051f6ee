//! The pages of `sensitivity`, `place` and `recover`.

use super::gluing_sheet::{gluing_section, in_length};
use crate::finding::Finding;
use crate::report::figure::{
    CountPoint, Ends, GaugePoints, IntervalRow, LoadTrace, MOST_RATIO, agreement, curve, heat_map,
    history, intervals,
};
use crate::report::page::{Block, Page, Section, figure_section, number, table_section};
use crate::report::scene::{Scene, scene_section};
use crate::sensitivity::Sensitivity;
use crate::workflow::place::PlacedGauge;
use std::collections::BTreeMap;

/// Rows of S that a page shows; longer tables are in `sensitivity.csv`.
const MOST_ROWS: usize = 120;

/// Title of the scene on every page.
pub(super) const SCENE: &str = "Model and gauges";

fn model_section(scene: Option<&Scene>) -> Option<Section> {
    Some(scene_section(SCENE, scene?))
}

fn sensitivity_section(s: &Sensitivity) -> Section {
    let n = s.gauges.len().min(MOST_ROWS);
    let columns: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    // Strain in microstrain per job unit, as in sensitivity.csv.
    let map = heat_map(&s.gauges[..n], &columns, "µε per job unit", |r, c| {
        1e6 * s.values[(r, c)]
    });
    let rank = format!(
        "Rank {} of {}, condition number {} in job units, {} scaled.",
        s.rank(),
        s.loads.len(),
        number(s.condition_number()),
        number(s.condition_number_scaled())
    );
    let mut note = "Microstrain per job unit of the load.".to_owned();
    if n < s.gauges.len() {
        note.push_str(&format!(
            " The first {n} of {} rows; all are in sensitivity.csv.",
            s.gauges.len()
        ));
    }
    let blocks = vec![Block::Text(rank), Block::Figure(map), Block::Note(note)];
    Section::new("Sensitivity", blocks)
}

/// Returns the page of `sensitivity`.
pub fn sensitivity_page(
    title: &str,
    s: &Sensitivity,
    scene: Option<&Scene>,
    findings: &[Finding],
) -> Page {
    let mut sections: Vec<Section> = model_section(scene).into_iter().collect();
    sections.push(sensitivity_section(s));
    Page::new(
        title,
        "Sensitivity of the gauges to the loads",
        findings,
        sections,
    )
}

/// Returns the page of `place`. `counts` contains the results for other gauge counts.
pub fn place_page(
    title: &str,
    scene: &Scene,
    placed: &[PlacedGauge],
    s: &Sensitivity,
    findings: &[Finding],
    numbers: &[(String, String)],
    load_sigma: &[Vec<String>],
    counts: &HowMany,
) -> Page {
    let mut sections = vec![Section::new("Layout", vec![Block::pairs(numbers)])];
    sections.push(table_section(
        "Standard deviation of the loads",
        &["load", "sigma", "as glued", "unit"],
        load_sigma,
        "Standard deviation that `recover` will state for loads of their expected size, from noise and model uncertainty. As glued: with \
         the tolerances of angle, place and gauge factor.",
    ));
    sections.extend(model_section(Some(scene)));
    if !counts.points.is_empty() {
        sections.push(figure_section(
            "How many gauges",
            curve(&counts.points, &counts.loads),
            "Standard deviation of each load from the stated noise; efficiency is certified against the best possible layout of that many gauges.",
        ));
    }
    let [x, y, z] = ["x", "y", "z"].map(|axis| in_length(axis, scene.length));
    let head = [
        "gauge",
        "element",
        "side",
        x.as_str(),
        y.as_str(),
        z.as_str(),
        "angle, deg",
        "seen, deg",
        "leverage",
        "strain, µε",
    ];
    let rows: Vec<Vec<String>> = placed.iter().map(placed_row).collect();
    sections.push(table_section("Gauges", &head, &rows, PLACED));
    sections.push(sensitivity_section(s));
    sections.push(gluing_section(placed, scene.model, scene.length));
    Page::new(title, "Gauge layout", findings, sections)
}

const PLACED: &str = "Places in the basic frame; angles from the x axis of the element, and as seen on that side; strain: the sum under the expected loads.";

fn placed_row(p: &PlacedGauge) -> Vec<String> {
    let x = p.gauge.position;
    vec![
        p.gauge.name.clone(),
        p.gauge.element.to_string(),
        p.gauge.surface.word().to_owned(),
        format!("{:.1}", x.x),
        format!("{:.1}", x.y),
        format!("{:.1}", x.z),
        format!("{:.1}", p.gauge.angle_rad.to_degrees()),
        format!("{:.1}", p.angle_seen_deg),
        format!("{:.3}", p.leverage),
        format!("{:.0}", p.expected_microstrain),
    ]
}

/// Results by number of gauges, and the loads (name, unit) of their sigmas.
#[derive(Default)]
pub struct HowMany {
    /// Results by number of gauges.
    pub points: Vec<CountPoint>,
    /// Loads.
    pub loads: Vec<(String, String)>,
}

/// One run or record for the page: name, by load (name, low, value, high, unit).
pub struct RecoveredRun {
    /// Run.
    pub run: String,
    /// Loads.
    pub loads: Vec<(String, [f64; 3], String)>,
}

/// Result of `recover`.
pub struct RecoveryPage<'a> {
    /// S.
    pub sensitivity: &'a Sensitivity,
    /// Runs.
    pub runs: &'a [RecoveredRun],
    /// Points of static runs: strain predicted from all gauges, and from all other gauges.
    pub points: &'a [GaugePoints],
    /// Loads of a history.
    pub traces: &'a [LoadTrace],
    /// Residual rms in microstrain, and leverage.
    pub by_gauge: &'a [(String, f64, f64)],
    /// First table.
    pub numbers: &'a [(String, String)],
    /// Table of the loads of static runs, with a row for each run and load: run, load, low, value, high, share of the typical size.
    pub table: Vec<Vec<String>>,
    /// Whether the table lacks runs.
    pub is_cut: bool,
}

/// Maximum number of runs whose loads are drawn. `loads.csv` contains all runs.
const MOST_RUNS: usize = 200;

/// Returns the page of `recover`.
pub fn recover_page(
    title: &str,
    scene: Option<&Scene>,
    found: &RecoveryPage,
    findings: &[Finding],
) -> Page {
    let mut sections = vec![Section::new("Result", vec![Block::pairs(found.numbers)])];
    sections.extend(model_section(scene));
    let ends = match found.traces.is_empty() {
        true => Ends::Interval,
        false => Ends::Span,
    };
    let mut loads = bars(found.runs, ends);
    if !found.table.is_empty() {
        let head = ["run", "load", "low", "value", "high", "± of typical size"];
        loads.push(Block::table(&head, found.table.clone()));
    }
    if found.is_cut || found.runs.len() > MOST_RUNS {
        loads.push(Block::Note(format!(
            "The first of {} runs; all are in loads.csv.",
            found.runs.len()
        )));
    }
    let title_of_loads = if found.traces.is_empty() {
        "Loads with 95 % intervals"
    } else {
        "Loads: smallest, mean, largest"
    };
    sections.push(Section::new(title_of_loads, loads));
    if !found.traces.is_empty() {
        sections.push(figure_section(
            "Histories",
            history(found.traces),
            "Drag to zoom, double click to return.",
        ));
    }
    if !found.points.is_empty() {
        let runs: Vec<String> = found.runs.iter().map(|r| r.run.clone()).collect();
        let kinds = [
            "used: predicted by all gauges",
            "held out: predicted by the others",
        ];
        sections.push(figure_section(
            "Measured against predicted strain",
            agreement(found.points, kinds, [&runs, &runs]),
            "Held out: predicted from all other gauges, by the gauge's residual and leverage.",
        ));
    }
    let row = |(name, rms, leverage): &(String, f64, f64)| {
        vec![name.clone(), format!("{rms:.2}"), format!("{leverage:.3}")]
    };
    let rows: Vec<Vec<String>> = found.by_gauge.iter().map(row).collect();
    let head = ["gauge", "residual rms, µε", "leverage"];
    sections.push(table_section("Gauges", &head, &rows, ""));
    sections.push(sensitivity_section(found.sensitivity));
    Page::new(
        title,
        "Loads recovered from measured strain",
        findings,
        sections,
    )
}

/// Loads of a similar size in one unit.
struct LoadSizeGroup<'a> {
    unit: &'a str,
    largest: f64,
    names: Vec<&'a str>,
}

/// Groups the loads of all runs by unit and size, the largest first, so that no load flattens the axis of another.
fn group_loads_by_size(runs: &[RecoveredRun]) -> Vec<LoadSizeGroup<'_>> {
    let mut sizes: BTreeMap<(&str, &str), f64> = BTreeMap::new();
    for (name, values, unit) in runs.iter().flat_map(|r| &r.loads) {
        let size = sizes.entry((unit.as_str(), name.as_str())).or_default();
        *size = values.iter().fold(*size, |m, v| m.max(v.abs()));
    }
    let mut sorted: Vec<_> = sizes.into_iter().collect();
    sorted.sort_by(|a, b| (a.0.0).cmp(b.0.0).then(b.1.total_cmp(&a.1)));
    let mut out: Vec<LoadSizeGroup> = Vec::new();
    for ((unit, name), size) in sorted {
        match out.last_mut() {
            Some(a) if a.unit == unit && size * MOST_RATIO >= a.largest => a.names.push(name),
            _ => out.push(LoadSizeGroup {
                unit,
                largest: size,
                names: vec![name],
            }),
        }
    }
    out
}

/// Loads with their ends, a run at a time; an axis for each unit and size.
fn bars(runs: &[RecoveredRun], ends: Ends) -> Vec<Block> {
    let caption = match ends {
        Ends::Interval => {
            "Points are the recovered loads, thin lines their 95 % intervals: shorter lines are better."
        }
        Ends::Span => {
            "Wide bars reach from the smallest to the largest value of the record, points are means. They show the size of a load, not its uncertainty."
        }
    };
    let groups = group_loads_by_size(runs);
    let figure = |group: &LoadSizeGroup| {
        let of_run = |r: &RecoveredRun| -> (String, Vec<IntervalRow>) {
            let of_group = |l: &&(String, [f64; 3], String)| {
                l.2 == group.unit && group.names.contains(&l.0.as_str())
            };
            let rows = r.loads.iter().filter(of_group);
            (r.run.clone(), rows.map(|l| (l.0.clone(), l.1)).collect())
        };
        let drawn: Vec<_> = runs.iter().take(MOST_RUNS).map(of_run).collect();
        let mut figure = intervals(&drawn, group.unit, ends, caption);
        if groups.iter().filter(|g| g.unit == group.unit).count() > 1 {
            figure.label = format!("{}, up to {}", figure.label, number(group.largest));
        }
        Block::Figure(figure)
    };
    groups.iter().map(figure).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_load_twenty_times_as_large_has_an_axis_of_its_own() {
        let load = |name: &str, size: f64, unit: &str| {
            (name.to_owned(), [-size, 0.0, 0.5 * size], unit.to_owned())
        };
        let loads = vec![
            load("small", 1.0, "kN"),
            load("payload", 41.0, "kN"),
            load("middle", 3.0, "kN"),
            load("moment", 1.0, "kN m"),
        ];
        let run = RecoveredRun {
            run: "R1".to_owned(),
            loads,
        };
        let groups = group_loads_by_size(std::slice::from_ref(&run));
        let names: Vec<Vec<&str>> = groups.iter().map(|g| g.names.clone()).collect();
        assert_eq!(
            names,
            [vec!["payload", "middle"], vec!["small"], vec!["moment"]]
        );
        let labels: Vec<String> = bars(&[run], Ends::Interval)
            .iter()
            .map(|b| match b {
                Block::Figure(f) => f.label.clone(),
                _ => String::new(),
            })
            .collect();
        assert_eq!(
            labels,
            [
                "values with intervals, kN, up to 41.00",
                "values with intervals, kN, up to 1.000",
                "values with intervals, kN m",
            ]
        );
    }
}
