//! The page of `identify`.

use super::restoring::restoring_section;
use crate::finding::Finding;
use crate::report::figure::{Line, Scale, lines};
use crate::report::page::{Section, number, page, table_section};
use crate::series::detrend::rms;
use crate::vehicle::chassis::ChassisForce;
use crate::vehicle::identify::Identification;
use maud::{Markup, html};

/// A signal recovered and measured over one axis; `measured` is empty where it was not measured.
pub struct Curve {
    /// Load or link name.
    pub name: String,
    /// Time (s), frequency (Hz) or stretch.
    pub x: Vec<f64>,
    /// Recovered.
    pub recovered: Vec<f64>,
    /// Measured.
    pub measured: Vec<f64>,
}

/// Parameters, verdicts, fit, a stretch of wheel force over time, spectra, restoring forces.
pub fn identify_page(
    title: &str,
    found: &Identification,
    findings: &[Finding],
    histories: &[Curve],
    spectra: &[Curve],
    restoring: &[Curve],
    chassis: &[ChassisForce],
) -> String {
    let mut sections = vec![Section {
        title: "Parameters".into(),
        body: parameters(found),
    }];
    if !found.unidentifiable.is_empty() {
        let body = html! { @for s in &found.unidentifiable { p { (s) } } };
        sections.push(Section {
            title: "What this record can't tell".into(),
            body,
        });
    }
    sections.push(Section {
        title: "Fit".into(),
        body: fit(found),
    });
    sections.push(Section {
        title: "Wheel force".into(),
        body: plots(histories, "time, s", "force", Scale::Linear),
    });
    let rows = chassis.iter().map(|f| {
        let sizes = [rms(&f.by_mass), rms(&f.by_springs), f.difference()].map(number);
        std::iter::once(f.body.clone()).chain(sizes).collect()
    });
    sections.push(table_section(
        "Chassis force, RMS in the band",
        &["body", "by mass", "by springs", "difference"],
        &rows.collect::<Vec<Vec<String>>>(),
        "By mass: inertia times acceleration. By springs: what springs and dampers pass on. Either may be wrong by their difference.",
    ));
    sections.push(Section {
        title: "Spectra".into(),
        body: plots(spectra, "frequency, Hz", "density", Scale::LogY),
    });
    sections.push(restoring_section(restoring));
    page(
        title,
        "Vehicle parameters and wheel loads from accelerations",
        findings,
        sections,
    )
}

fn parameters(found: &Identification) -> Markup {
    let number = |v: Option<f64>| v.map_or("not told".to_owned(), |v| format!("{v:.5e}"));
    html! { div.scroll { table {
        tr { th { "parameter" } th { "value" } th { "sigma" } th { "95 % from" } th { "to" } th { "unit" } }
        @for p in &found.parameters { tr {
            td { (p.name) @if p.known { " (known)" } }
            td { (number(p.value)) }
            td { (p.sigma.map_or(String::new(), |s| format!("{s:.2e}"))) }
            td { (p.interval.map_or(String::new(), |i| format!("{:.5e}", i[0]))) }
            td { (p.interval.map_or(String::new(), |i| format!("{:.5e}", i[1]))) }
            td { (p.unit) }
        } }
    } } }
}

fn fit(found: &Identification) -> Markup {
    html! {
        div.scroll { table {
            tr { th { "channel" } th { "left over, %" } th { "judged on" } th { "left over where fitted, %" } }
            @for f in &found.fit { tr {
                td { (f.channel) }
                td { (format!("{:.2}", 100.0 * f.relative_rms)) }
                td { (f.on) }
                td { (format!("{:.2}", 100.0 * f.relative_rms_fitted)) }
            } }
        } }
        @if let Some(m) = found.mass_closure {
            p { "Identified mass over weighed mass: " (format!("{:.4}", m.ratio)) "." }
        }
    }
}

/// Curves one at a time, what was measured below what was recovered.
pub(super) fn plots(curves: &[Curve], x_label: &str, y_label: &str, scale: Scale) -> Markup {
    let groups: Vec<(String, Vec<Line>)> = curves
        .iter()
        .map(|c| {
            let line = |name, y| Line { name, x: &c.x, y };
            let mut list = vec![line("recovered", &c.recovered)];
            if !c.measured.is_empty() {
                list.insert(0, line("measured", &c.measured));
            }
            (c.name.clone(), list)
        })
        .collect();
    html! {
        @if groups.is_empty() { p.muted { "None." } }
        @else { (lines(&groups, x_label, y_label, scale)) }
    }
}
