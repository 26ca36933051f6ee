//! The pages of `sensitivity`, `place` and `recover`.

use super::tables::PlacedGauge;
use crate::finding::Finding;
use crate::report::figure::{
    CountPoint, GaugePoints, IntervalRow, LoadTrace, agreement, curve, heat_map, history, intervals,
};
use crate::report::page::{Section, number, page};
use crate::report::scene::{Scene, scene_section};
use crate::sensitivity::Sensitivity;
use maud::{Markup, html};

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
    Section {
        title: "Sensitivity".into(),
        body: html! {
            p { "Rank " (s.rank()) " of " (s.loads.len()) ", condition number " (number(s.condition_number())) " in job units, "
                (number(s.condition_number_scaled())) " scaled." }
            (map)
            p.muted { "Colour: share of the column's largest value. " @if n < s.gauges.len() { "The first " (n) " of " (s.gauges.len()) " rows; all are in sensitivity.csv." } }
        },
    }
}

/// The page of `sensitivity`.
pub fn sensitivity_page(
    title: &str,
    s: &Sensitivity,
    scene: Option<&Scene>,
    findings: &[Finding],
) -> String {
    let mut sections: Vec<Section> = model_section(scene).into_iter().collect();
    sections.push(sensitivity_section(s));
    page(
        title,
        "Sensitivity of the gauges to the loads",
        findings,
        sections,
    )
}

/// The page of `place`; `counts` is what other numbers of gauges give.
pub fn place_page(
    title: &str,
    scene: &Scene,
    placed: &[PlacedGauge],
    s: &Sensitivity,
    findings: &[Finding],
    numbers: &[(String, String)],
    counts: &HowMany,
) -> String {
    let mut sections = vec![Section {
        title: "Layout".into(),
        body: pairs(numbers),
    }];
    sections.extend(model_section(Some(scene)));
    if !counts.points.is_empty() {
        sections.push(Section {
            title: "How many gauges".into(),
            body: html! {
                (curve(&counts.points, &counts.loads))
                p.muted { "One standard deviation of each load, as the stated noise makes it; efficiency is certified against the best possible layout of that many gauges." }
            },
        });
    }
    sections.push(Section {
        title: "Gauges".into(),
        body: html! {
            div.scroll { table {
                tr { th { "gauge" } th { "element" } th { "side" } th { "x" } th { "y" } th { "z" } th { "angle, deg" } th { "seen, deg" } th { "leverage" } th { "strain, µε" } }
                @for p in placed { tr {
                    td { (p.gauge.name) } td { (p.gauge.element) } td { (p.gauge.surface.word()) }
                    td { (format!("{:.1}", p.gauge.position.x)) } td { (format!("{:.1}", p.gauge.position.y)) } td { (format!("{:.1}", p.gauge.position.z)) }
                    td { (format!("{:.1}", p.gauge.angle_rad.to_degrees())) } td { (format!("{:.1}", p.angle_seen_deg())) }
                    td { (format!("{:.3}", p.leverage)) } td { (format!("{:.0}", p.expected_microstrain)) }
                } }
            } }
        },
    });
    sections.push(sensitivity_section(s));
    page(title, "Gauge layout", findings, sections)
}

/// What each number of gauges gives, and the loads (name, unit) that its sigmas belong to.
#[derive(Default)]
pub struct HowMany {
    /// By number.
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

/// What `recover` found.
pub struct Recovered<'a> {
    /// S.
    pub sensitivity: &'a Sensitivity,
    /// Runs.
    pub runs: &'a [RecoveredRun],
    /// Points of static runs: predicted by all gauges, and by all others.
    pub points: &'a [GaugePoints],
    /// Loads of a history.
    pub traces: &'a [LoadTrace],
    /// Residual rms in microstrain, and leverage.
    pub by_gauge: &'a [(String, f64, f64)],
    /// First table.
    pub numbers: &'a [(String, String)],
}

/// Runs whose loads are drawn; all are in `loads.csv`.
const MOST_RUNS: usize = 200;

/// The page of `recover`.
pub fn recover_page(
    title: &str,
    scene: Option<&Scene>,
    found: &Recovered,
    findings: &[Finding],
) -> String {
    let mut sections = vec![Section {
        title: "Result".into(),
        body: pairs(found.numbers),
    }];
    sections.extend(model_section(scene));
    sections.push(Section {
        title: if found.traces.is_empty() {
            "Loads with 95 % intervals".into()
        } else {
            "Loads: smallest, mean, largest".into()
        },
        body: html! {
            (bars(found.runs))
            @if found.runs.len() > MOST_RUNS { p.muted { "The first " (MOST_RUNS) " of " (found.runs.len()) " runs; all are in loads.csv." } }
        },
    });
    if !found.traces.is_empty() {
        sections.push(Section {
            title: "Histories".into(),
            body: html! {
                (history(found.traces))
                p.muted { "Drag to zoom, double click to return. Line: mean. Dark: from the smallest to the largest sample of a span of time. Light: 95 % interval of a sample around it." }
            },
        });
    }
    if !found.points.is_empty() {
        let runs: Vec<String> = found.runs.iter().map(|r| r.run.clone()).collect();
        let kinds = [
            "used: predicted by all gauges",
            "held out: predicted by the others",
        ];
        sections.push(Section {
            title: "Measured against predicted strain".into(),
            body: html! {
                (agreement(found.points, kinds, [&runs, &runs]))
                p.muted { "A point a gauge and run. Held out: what all other gauges say of this one, from its residual and leverage." }
            },
        });
    }
    sections.push(Section {
        title: "Gauges".into(),
        body: html! { div.scroll { table {
            tr { th { "gauge" } th { "residual rms, µε" } th { "leverage" } }
            @for (name, rms, leverage) in found.by_gauge { tr { td { (name) } td { (format!("{rms:.2}")) } td { (format!("{leverage:.3}")) } } }
        } } },
    });
    sections.push(sensitivity_section(found.sensitivity));
    page(
        title,
        "Loads recovered from measured strain",
        findings,
        sections,
    )
}

/// Forces and moments on scales of their own, a run at a time.
fn bars(runs: &[RecoveredRun]) -> Markup {
    let mut units: Vec<&String> = runs.iter().flat_map(|r| &r.loads).map(|l| &l.2).collect();
    units.sort_unstable();
    units.dedup();
    let of_run = |r: &RecoveredRun, unit: &String| -> (String, Vec<IntervalRow>) {
        let rows = r.loads.iter().filter(|l| &l.2 == unit);
        (r.run.clone(), rows.map(|l| (l.0.clone(), l.1)).collect())
    };
    let figure = |unit: &String| {
        let groups: Vec<_> = runs
            .iter()
            .take(MOST_RUNS)
            .map(|r| of_run(r, unit))
            .collect();
        intervals(&groups, unit)
    };
    html! { @for unit in units { (figure(unit)) } }
}

fn pairs(numbers: &[(String, String)]) -> Markup {
    html! { div.scroll { table { @for (name, value) in numbers { tr { td { (name) } td { (value) } } } } } }
}
