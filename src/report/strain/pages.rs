//! The pages of `sensitivity`, `place` and `recover`.

use super::history::{GaugePoints, LoadTrace, gauge_plot, history_band};
use super::page::{Section, number, page};
use super::svg;
use super::tables::PlacedGauge;
use crate::finding::Finding;
use crate::gauge::Gauge;
use crate::model::Model;
use crate::sensitivity::Sensitivity;
use maud::{Markup, PreEscaped, html};

/// Rows of S that a page shows; longer tables are in `sensitivity.csv`.
const MOST_ROWS: usize = 120;

fn model_section(model: Option<&Model>, gauges: &[&Gauge]) -> Option<Section> {
    let drawing = svg::model_with_gauges(model?, gauges);
    Some(Section {
        title: "Model and gauges".into(),
        body: html! {
            (PreEscaped(drawing))
            p.muted { "Strokes lie along the gauges' axes: red on the top (Z2), blue on the bottom (Z1) of the element." }
        },
    })
}

fn sensitivity_section(s: &Sensitivity) -> Section {
    let n = s.gauges.len().min(MOST_ROWS);
    let columns: Vec<String> = s.loads.iter().map(|l| l.name.clone()).collect();
    let map = svg::heat_map(&s.gauges[..n], &columns, |r, c| s.values[(r, c)]);
    Section {
        title: "Sensitivity".into(),
        body: html! {
            p { "Rank " (s.rank()) " of " (s.loads.len()) ", condition number " (number(s.condition_number())) " in job units, "
                (number(s.condition_number_scaled())) " scaled." }
            (PreEscaped(map))
            p.muted { "Colour: share of the column's largest value. " @if n < s.gauges.len() { "The first " (n) " of " (s.gauges.len()) " rows; all are in sensitivity.csv." } }
        },
    }
}

/// The page of `sensitivity`.
pub fn sensitivity_page(
    title: &str,
    s: &Sensitivity,
    gauges: &[Gauge],
    model: Option<&Model>,
    findings: &[Finding],
) -> String {
    let refs: Vec<&Gauge> = gauges.iter().collect();
    let mut sections: Vec<Section> = model_section(model, &refs).into_iter().collect();
    sections.push(sensitivity_section(s));
    page(
        title,
        "Sensitivity of the gauges to the loads",
        findings,
        sections,
    )
}

/// The page of `place`.
pub fn place_page(
    title: &str,
    model: &Model,
    placed: &[PlacedGauge],
    s: &Sensitivity,
    findings: &[Finding],
    numbers: &[(String, String)],
) -> String {
    let refs: Vec<&Gauge> = placed.iter().map(|p| &p.gauge).collect();
    let mut sections = vec![Section {
        title: "Layout".into(),
        body: pairs(numbers),
    }];
    sections.extend(model_section(Some(model), &refs));
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

/// One run or record for the page: name, by load (name, low, value, high, unit).
pub struct RecoveredRun {
    /// Run.
    pub run: String,
    /// Loads.
    pub loads: Vec<(String, [f64; 3], String)>,
}

/// The page of `recover`. `points` are those of static runs, `traces` those of a history; `by_gauge` residual rms in microstrain and leverage.
#[allow(clippy::too_many_arguments)]
pub fn recover_page(
    title: &str,
    model: Option<&Model>,
    gauges: &[Gauge],
    s: &Sensitivity,
    runs: &[RecoveredRun],
    points: &[GaugePoints],
    traces: &[LoadTrace],
    by_gauge: &[(String, f64, f64)],
    findings: &[Finding],
    numbers: &[(String, String)],
) -> String {
    let refs: Vec<&Gauge> = gauges.iter().collect();
    let mut sections = vec![Section {
        title: "Result".into(),
        body: pairs(numbers),
    }];
    sections.push(Section {
        title: "Loads with 95 % intervals".into(),
        body: html! { @for r in runs { h3 { (r.run) } (PreEscaped(bars(r))) } },
    });
    if !traces.is_empty() {
        sections.push(Section {
            title: "Histories".into(),
            body: html! {
                @for t in traces { (PreEscaped(history_band(t))) }
                p.muted { "Line: mean. Dark: from the smallest to the largest sample of a span of time. Light: 95 % interval of a sample around it." }
            },
        });
    }
    if !points.is_empty() {
        let all: Vec<(f64, f64)> = points
            .iter()
            .flat_map(|g| &g.points)
            .copied()
            .filter(|p| p.0.is_finite() && p.1.is_finite())
            .collect();
        sections.push(Section {
            title: "Measured against predicted strain".into(),
            body: html! {
                (PreEscaped(svg::measured_against_predicted(&all)))
                p.muted { "By gauge, the largest residual first, microstrain; a point a run." }
                div.small { @for g in worst_first(points) { (PreEscaped(gauge_plot(g))) } }
            },
        });
    }
    sections.push(Section {
        title: "Gauges".into(),
        body: html! { table {
            tr { th { "gauge" } th { "residual rms, µε" } th { "leverage" } }
            @for (name, rms, leverage) in by_gauge { tr { td { (name) } td { (format!("{rms:.2}")) } td { (format!("{leverage:.3}")) } } }
        } },
    });
    sections.extend(model_section(model, &refs));
    sections.push(sensitivity_section(s));
    page(
        title,
        "Loads recovered from measured strain",
        findings,
        sections,
    )
}

/// Gauges by falling residual, as many as a page shows.
fn worst_first(points: &[GaugePoints]) -> Vec<&GaugePoints> {
    let mut list: Vec<&GaugePoints> = points.iter().collect();
    list.sort_by(|a, b| b.residual.total_cmp(&a.residual));
    list.truncate(MOST_ROWS);
    list
}

/// Forces and moments on scales of their own.
fn bars(r: &RecoveredRun) -> String {
    let mut units: Vec<&String> = Vec::new();
    for (_, _, u) in &r.loads {
        if !units.contains(&u) {
            units.push(u);
        }
    }
    units
        .into_iter()
        .map(|unit| {
            let rows: Vec<(String, [f64; 3])> = r
                .loads
                .iter()
                .filter(|l| &l.2 == unit)
                .map(|l| (l.0.clone(), l.1))
                .collect();
            svg::interval_bars(&rows, unit)
        })
        .collect()
}

fn pairs(numbers: &[(String, String)]) -> Markup {
    html! { table { @for (name, value) in numbers { tr { td { (name) } td { (value) } } } } }
}
