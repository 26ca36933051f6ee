//! Predicted against measured strain at the installed gauges.

use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::Faults;
use crate::host::outcome::finite_or_none;
use crate::host::work::Work;
use crate::job::{Job, Reference};
use crate::measured::means::is_long_record;
use crate::measured::strain_table::StrainRows;
use crate::measured::zero::{read_zeroed, subtract_and_test_zero};
use crate::respond::LoadState;
use crate::strain_chain::JobSensitivity;
use crate::units::MICROSTRAIN;
use serde::Serialize;

/// Limit of residual over measured rms of a gauge above which its prediction is poor.
const POOR: f64 = 0.1;
/// Limit of residual over measured rms of a gauge above which the loads explain almost nothing of its reading. A model is wrong by some tens of per
/// cent at its worst gauges. With wrong loads, more than half of the reading remains unexplained at most gauges. Examples are loads of another run,
/// in pounds for newtons (a residual of .78 or 3.4), or in another power of ten.
const MISSED: f64 = 0.5;

/// One gauge over all states, microstrain.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GaugeCheck {
    /// Gauge.
    pub name: String,
    /// Root mean square of the measured strain.
    #[serde(rename = "measured_rms_microstrain")]
    pub measured_rms: f64,
    /// Root mean square of measured less predicted strain.
    #[serde(rename = "residual_rms_microstrain")]
    pub residual_rms: f64,
    /// Correlation of measured and predicted strain; `None` if either does not vary.
    pub correlation: Option<f64>,
}

/// Comparison of all gauges.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Check {
    /// A row for each gauge with readings.
    pub rows: Vec<GaugeCheck>,
    /// Gauges of S.
    pub gauges: Vec<String>,
    /// States that have a row of strain.
    pub states: Vec<String>,
    /// Predicted and measured strain by state and gauge, microstrain. NaN if nothing was measured.
    pub pairs: Vec<Vec<(f64, f64)>>,
}

/// Compares predicted and measured strain, if the job has gauges and measured strain whose rows are the states.
///
/// # Errors
/// A strain file that can't be read.
pub(super) fn check(
    work: &mut Work,
    job: &Job,
    prepared: &JobSensitivity,
    states: &[LoadState],
) -> Result<Check, Faults> {
    let mut out = Check::default();
    let s = &prepared.sensitivity;
    let Some(measured) = job
        .measured
        .as_ref()
        .filter(|m| !s.gauges.is_empty() && m.reference == Reference::None)
    else {
        return Ok(out);
    };
    let bytes = work.inputs.read_named(job, &measured.strain)?;
    if is_long_record(&bytes) {
        work.findings.push(not_compared(
            "the strain file is a long record: predicted and measured strain are not compared",
            "name means of runs in [measured] strain, and their loads in [respond] loads",
        ));
        return Ok(out);
    }
    let zeroed = read_zeroed(work, job, measured, &measured.strain)?;
    let table = &zeroed.table;
    let read = subtract_and_test_zero(work, measured, &s.gauges, &zeroed.readings(&s.gauges));
    // Each state needs its row of the strain table. Rows are found by name, or by order if there are as many samples as states.
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
        work.findings.push(not_compared(
            "no row of the strain file belongs to a load state: predicted and measured strain are not compared",
            "use the same names of runs in both tables",
        ));
        return Ok(out);
    }
    out.gauges.clone_from(&s.gauges);
    let mut pairs: Vec<Vec<(f64, f64)>> = vec![Vec::new(); s.gauges.len()];
    for (state, row) in states.iter().zip(&row_of) {
        let Some(row) = row else { continue };
        let mut of_state = Vec::new();
        for g in 0..s.gauges.len() {
            let predicted = state
                .values
                .iter()
                .enumerate()
                .map(|(l, f)| s.values[(g, l)] * f)
                .sum::<f64>()
                / MICROSTRAIN;
            let read = read.get(*row).map_or(f64::NAN, |r| r.strain[g]) / MICROSTRAIN;
            if read.is_finite() {
                pairs[g].push((predicted, read));
            }
            of_state.push((predicted, read));
        }
        out.states.push(state.label.clone());
        out.pairs.push(of_state);
    }
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
            correlation: finite_or_none(cov / (vp * vm).sqrt()),
        };
        out.rows.push(row);
    }
    work.findings
        .extend(check_prediction(&out.rows, measured.noise_microstrain));
    Ok(out)
}

/// Returns the finding that the gauges are not compared.
fn not_compared(why: &str, remedy: &str) -> Finding {
    Finding::new(Severity::Info, "gauges-not-compared", "gauges", why, remedy)
}

/// Returns a finding if the loads do not reproduce the measured strain.
fn check_prediction(rows: &[GaugeCheck], noise_microstrain: f64) -> Option<Finding> {
    let beyond = |share: f64| -> Vec<&str> {
        let off = rows.iter().filter(|r| {
            r.residual_rms > share * r.measured_rms && r.residual_rms > 3.0 * noise_microstrain
        });
        off.map(|r| r.name.as_str()).collect()
    };
    let missed = beyond(MISSED);
    if 2 * missed.len() > rows.len() {
        let finding = Finding::new(
            Severity::Error,
            "prediction-poor",
            list_few(&missed),
            "the loads explain less than half of the strain at most gauges: they are in another unit, of other runs, or of another model, \
             and the stress is wrong too",
            "check the unit of the table of loads against `report_units`, and the names of its runs; then run `reconcile`",
        );
        return Some(finding.with_numbers(missed.len() as f64, rows.len() as f64 / 2.0));
    }
    let poor = beyond(POOR);
    (!poor.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "prediction-poor",
            list_few(&poor),
            "the recovered loads do not reproduce the strain of these gauges to 10 %: stress near them is uncertain by as much",
            "run `reconcile`",
        )
        .with_numbers(poor.len() as f64, 0.0)
    })
}
