//! Predicted against measured strain at the installed gauges.

use crate::app::Session;
use crate::app::fault::Faults;
use crate::app::job::strain::{StrainRows, read_strain};
use crate::app::job::{Job, Reference};
use crate::app::strain::Prepared;
use crate::finding::{Finding, Severity};
use crate::report::csv_cell;
use crate::report::figure::GaugePoints;
use crate::respond::LoadState;
use crate::units::MICROSTRAIN;
use serde_json::json;
use std::fmt::Write;

/// Points a drawing takes.
const MOST_POINTS: usize = 2000;
/// Residual over measured rms of a gauge from which its prediction is poor.
const POOR: f64 = 0.1;

/// One gauge over all states, microstrain.
pub(super) struct GaugeCheck {
    pub name: String,
    pub measured_rms: f64,
    pub residual_rms: f64,
    /// NaN where one of them does not vary.
    pub correlation: f64,
}

/// All gauges.
pub(super) struct Check {
    pub rows: Vec<GaugeCheck>,
    /// Predicted, measured, microstrain; thinned.
    pub points: Vec<GaugePoints>,
    /// Names of the states behind the points.
    pub states: Vec<String>,
    pub csv: String,
}

/// Compares where the job has gauges and measured strain whose rows are the states.
///
/// # Errors
/// Unreadable strain.
pub(super) fn check(
    session: &mut Session,
    job: &Job,
    prepared: &Prepared,
    states: &[LoadState],
) -> Result<Check, Faults> {
    let mut out = Check {
        rows: Vec::new(),
        points: Vec::new(),
        states: Vec::new(),
        csv: String::new(),
    };
    let s = &prepared.sensitivity;
    let Some(measured) = job
        .measured
        .as_ref()
        .filter(|m| !s.gauges.is_empty() && m.reference == Reference::None)
    else {
        return Ok(out);
    };
    let table = read_strain(&mut session.inputs, job, &measured.strain)?;
    let zero = match &measured.zero {
        Some(named) => Some(read_strain(&mut session.inputs, job, named)?),
        None => None,
    };
    let mean = |gauge: &str| -> f64 {
        let Some(z) = &zero else { return 0.0 };
        let Some(c) = z.gauges.iter().position(|g| g == gauge) else {
            return 0.0;
        };
        let v: Vec<f64> = (0..z.n_rows())
            .filter_map(|i| z.row(i).get(c).copied())
            .filter(|v| v.is_finite())
            .collect();
        v.iter().sum::<f64>() / v.len().max(1) as f64
    };
    // The row of the strain table that belongs to each state: by name, or by order where there are as many samples.
    let row_of: Vec<Option<usize>> = match &table.rows {
        StrainRows::Runs(names) => states
            .iter()
            .map(|s| names.iter().position(|n| *n == s.label))
            .collect(),
        StrainRows::Times(t) if t.len() == states.len() => (0..t.len()).map(Some).collect(),
        StrainRows::Times(t) => states
            .iter()
            .map(|s| {
                let at: f64 = s.label.parse().ok()?;
                let i = t.partition_point(|x| *x < at - 1e-9);
                t.get(i)
                    .filter(|x| (**x - at).abs() < 1e-6 * at.abs().max(1.0))
                    .map(|_| i)
            })
            .collect(),
    };
    if row_of.iter().all(Option::is_none) {
        session.findings.push(Finding::new(
            Severity::Info,
            "gauges-not-compared",
            "gauges",
            "no row of the strain file belongs to a load state: predicted and measured strain are not compared",
            "name runs alike in both tables",
        ));
        return Ok(out);
    }
    out.csv.push_str("state");
    for g in &s.gauges {
        let measured = format!("{g}.measured");
        let _ = write!(out.csv, ",{},{}", csv_cell(g), csv_cell(&measured));
    }
    out.csv.push('\n');
    let mut pairs: Vec<Vec<(f64, f64)>> = vec![Vec::new(); s.gauges.len()];
    // With the missing ones, so that every point keeps its state.
    let mut drawn = pairs.clone();
    for (state, row) in states.iter().zip(&row_of) {
        let Some(row) = row else { continue };
        out.csv.push_str(&state.label);
        for (g, name) in s.gauges.iter().enumerate() {
            let predicted = state
                .values
                .iter()
                .enumerate()
                .map(|(l, f)| s.values[(g, l)] * f)
                .sum::<f64>()
                / MICROSTRAIN;
            let read = table
                .gauges
                .iter()
                .position(|h| h == name)
                .and_then(|c| table.row(*row).get(c).copied())
                .map_or(f64::NAN, |v| v - mean(name));
            let _ = write!(out.csv, ",{predicted},");
            if read.is_finite() {
                let _ = write!(out.csv, "{read}");
                pairs[g].push((predicted, read));
            }
            drawn[g].push((predicted, read));
        }
        out.csv.push('\n');
    }
    let mut poor: Vec<&str> = Vec::new();
    for (name, pairs) in s.gauges.iter().zip(&pairs) {
        if pairs.is_empty() {
            continue;
        }
        let n = pairs.len() as f64;
        let rms = |f: &dyn Fn(&(f64, f64)) -> f64| {
            (pairs.iter().map(|p| f(p).powi(2)).sum::<f64>() / n).sqrt()
        };
        let (mp, mm) = (
            pairs.iter().map(|p| p.0).sum::<f64>() / n,
            pairs.iter().map(|p| p.1).sum::<f64>() / n,
        );
        let cov: f64 = pairs.iter().map(|p| (p.0 - mp) * (p.1 - mm)).sum();
        let (vp, vm): (f64, f64) = (
            pairs.iter().map(|p| (p.0 - mp).powi(2)).sum(),
            pairs.iter().map(|p| (p.1 - mm).powi(2)).sum(),
        );
        let row = GaugeCheck {
            name: name.clone(),
            measured_rms: rms(&|p| p.1),
            residual_rms: rms(&|p| p.1 - p.0),
            correlation: cov / (vp * vm).sqrt(),
        };
        if row.residual_rms > POOR * row.measured_rms
            && row.residual_rms > 3.0 * measured.noise_microstrain
        {
            poor.push(name);
        }
        out.rows.push(row);
    }
    if !poor.is_empty() {
        session.findings.push(
            Finding::new(
                Severity::Warning,
                "prediction-poor",
                poor.join(", "),
                "the recovered loads do not reproduce what these gauges measured to 10 %: stress near them is as uncertain",
                "run `reconcile`",
            )
            .with_numbers(poor.len() as f64, 0.0),
        );
    }
    let stride = drawn
        .iter()
        .map(Vec::len)
        .sum::<usize>()
        .div_ceil(MOST_POINTS)
        .max(1);
    out.states = states
        .iter()
        .zip(&row_of)
        .filter(|(_, row)| row.is_some())
        .map(|(s, _)| s.label.clone())
        .step_by(stride)
        .collect();
    let residual = |name: &String| {
        let row = out.rows.iter().find(|r| &r.name == name);
        row.map_or(0.0, |r| r.residual_rms)
    };
    out.points = s
        .gauges
        .iter()
        .zip(drawn)
        .map(|(name, list)| GaugePoints {
            name: name.clone(),
            residual: residual(name),
            points: [list.into_iter().step_by(stride).collect(), Vec::new()],
        })
        .collect();
    let finite = |v: f64| v.is_finite().then_some(v);
    let rows: Vec<serde_json::Value> = out
        .rows
        .iter()
        .map(|g| {
            json!({
                "name": g.name,
                "measured_rms_microstrain": g.measured_rms,
                "residual_rms_microstrain": g.residual_rms,
                "correlation": finite(g.correlation),
            })
        })
        .collect();
    session.put("gauges", rows)?;
    Ok(out)
}
