//! The page of `identify`.

use super::curve::{Curve, plots};
use super::restoring_forces::restoring_section;
use crate::finding::Finding;
use crate::report::figure::Scale;
use crate::report::page::{Block, Page, Section, number, table_section};
use crate::series::detrend::rms;
use crate::vehicle::chassis::ChassisForce;
use crate::vehicle::identify::{Estimate, Identification};
use crate::vehicle::term::UnitNames;

/// Curves on the page.
pub struct Curves {
    /// Wheel forces over time.
    pub histories: Vec<Curve>,
    /// Spectra of the wheel forces.
    pub spectra: Vec<Curve>,
    /// Forces of links against their stretch.
    pub restoring: Vec<Curve>,
    /// Band of the equations, Hz.
    pub band_hz: [f64; 2],
}

/// Returns the page of `identify` in job units: parameters, verdicts, fit, a part of the wheel forces over time, spectra, restoring forces.
pub fn identify_page(
    title: &str,
    units: &UnitNames,
    found: &Identification,
    findings: &[Finding],
    curves: &Curves,
    chassis: &[ChassisForce],
) -> Page {
    let force = &units.force;
    let [low, high] = curves.band_hz.map(number);
    let band = format!("band of the equations, {low} to {high} Hz");
    let mut sections = vec![parameters(found)];
    if !found.unidentifiable.is_empty() {
        let blocks = found.unidentifiable.iter().cloned().map(Block::Text);
        sections.push(Section::new(
            "Quantities that this record does not determine",
            blocks.collect(),
        ));
    }
    sections.push(Section::new("Fit", fit(found)));
    sections.push(Section::new(
        "Wheel force",
        vec![plots(
            &curves.histories,
            ["time, s", &format!("force, {force}")],
            Scale::Linear,
            &format!("Wheel force in the {band}, recovered and, if known, measured: curves that agree are better."),
            None,
        )],
    ));
    let rows = chassis.iter().map(|f| {
        let difference = f.difference();
        let by_springs = difference.map(|_| rms(&f.by_springs));
        let size = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), number);
        let sizes = [Some(rms(&f.by_mass)), by_springs, difference].map(size);
        std::iter::once(f.body.clone()).chain(sizes).collect()
    });
    sections.push(table_section(
        "Chassis force, RMS in the band",
        &[
            "body",
            &format!("by mass, {force}"),
            &format!("by springs, {force}"),
            &format!("difference, {force}"),
        ],
        &rows.collect::<Vec<Vec<String>>>(),
        "By mass: inertia times acceleration. By springs: force of springs and dampers. Either may be wrong by their difference.",
    ));
    sections.push(Section::new(
        "Spectra",
        vec![plots(
            &curves.spectra,
            ["frequency, Hz", &format!("density of force, {force}²/Hz")],
            Scale::LogY,
            "Spectral density of the wheel force: curves that agree in the shaded band are better. Nothing is fitted outside it.",
            Some((curves.band_hz, band)),
        )],
    ));
    sections.push(restoring_section(&curves.restoring, units));
    Page::new(
        title,
        "Vehicle parameters and wheel loads from accelerations",
        findings,
        sections,
    )
}

fn parameters(found: &Identification) -> Section {
    let format_value =
        |v: Option<f64>, known: &str| v.map_or(known.to_owned(), |v| format!("{v:.5e}"));
    let row = |p: &Estimate| {
        vec![
            format!("{}{}", p.name, if p.known { " (known)" } else { "" }),
            format_value(p.value, "not determined"),
            p.sigma.map_or(String::new(), |s| format!("{s:.2e}")),
            format_value(p.interval.map(|i| i[0]), ""),
            format_value(p.interval.map(|i| i[1]), ""),
            p.unit.clone(),
        ]
    };
    let rows: Vec<Vec<String>> = found.parameters.iter().map(row).collect();
    let head = ["parameter", "value", "sigma", "95 % from", "to", "unit"];
    table_section("Parameters", &head, &rows, "")
}

fn fit(found: &Identification) -> Vec<Block> {
    let rows = found.fit.iter().map(|f| {
        vec![
            f.channel.clone(),
            format!("{:.2}", 100.0 * f.relative_rms),
            f.on.to_owned(),
            format!("{:.2}", 100.0 * f.relative_rms_fitted),
        ]
    });
    let head = [
        "channel",
        "left over, %",
        "tested on",
        "residual on the fitted record, %",
    ];
    let mut out = vec![Block::table(&head, rows.collect())];
    if let Some(m) = found.mass_closure {
        out.push(Block::Text(format!(
            "Identified mass over weighed mass: {:.4}.",
            m.ratio
        )));
    }
    out
}
