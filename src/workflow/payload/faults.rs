//! Faults of gauges by the strain of the payload.

use super::model::{Parts, model_of};
use super::task::Task;
use crate::estimate::median;
use crate::finding::{Finding, Severity};
use crate::host::work::Work;
use crate::input_faults::recorded_loads::{NEAR, UNIT};
use crate::input_faults::{FaultTreatment, SIGN_OF_ALL};
use crate::payload::{PayloadRun, Refusal, WeighSpec, Weighing, faults_of_gauges, payload_rows};
use crate::strain_chain::alternatives_of;
use crate::units::number;

/// Reports faults of gauges that the strain of all runs shows, and readings that all have the opposite sign.
pub(super) fn search(
    work: &mut Work,
    task: &Task,
    parts: &Parts,
    runs: &[PayloadRun],
    (spec, weighing): (&WeighSpec, &Weighing),
) {
    work.findings.extend(all_reversed(runs, weighing));
    work.findings.extend(strain_contradicts_wheels(weighing));
    let mut others = || {
        alternatives_of(work, task.job, &parts.model.gauges, &|work, job| {
            let mut changed = Task {
                job,
                payload: job.payload.as_ref()?,
                wheels: Vec::new(),
                empty: Vec::new(),
                ..*task
            };
            let model = model_of(work, &mut changed, true).ok()?.model;
            Some((model.gauges.clone(), payload_rows(&model)))
        })
    };
    let found = faults_of_gauges(&parts.model, runs, spec, &mut others);
    let unused = |g: &usize| {
        let name = parts.model.gauges.get(*g);
        weighing
            .gauges
            .iter()
            .any(|v| Some(&v.name) == name && !v.used)
    };
    work.findings.extend(found.iter().map(|f| {
        let handling = match f.fault.gauges().iter().all(unused) {
            true => FaultTreatment::LeftOut,
            false => FaultTreatment::AsMeasured,
        };
        f.finding(&parts.model.gauges, handling)
    }));
}

/// Returns the refusals of the runs that determine the payload; empty if a run is not refused.
fn refusals(weighing: &Weighing) -> Vec<Refusal> {
    let each = weighing.runs.iter().map(|r| r.refused);
    let refused: Option<Vec<Refusal>> =
        each.filter(|r| *r != Some(Refusal::Undetermined)).collect();
    refused.unwrap_or_default()
}

/// Returns the finding on readings, or recorded wheel forces, that give a payload below zero in every run.
fn all_reversed(runs: &[PayloadRun], weighing: &Weighing) -> Option<Finding> {
    let refused = refusals(weighing);
    let negative = |r: &Refusal| matches!(r, Refusal::Negative { .. });
    if refused.is_empty() || !refused.iter().all(negative) {
        return None;
    }
    let sums = runs.iter().map(|r| r.reactions.iter().sum::<f64>());
    let has_wheels = runs.iter().any(|r| !r.reactions.is_empty());
    let (what, remedy) = match has_wheels && sums.fold(f64::NEG_INFINITY, f64::max) < 0.0 {
        true => (
            "the recorded wheel forces sum to a negative payload in every run: they have reversed sign, or the zero was measured with the payload",
            "correct the sign of the wheel forces in the runs file, or name the unloaded run as the zero".to_owned(),
        ),
        false => (
            "the readings give a negative payload in every run: all readings have reversed sign, or the zero was measured with the payload",
            format!("{SIGN_OF_ALL}. Otherwise name the unloaded run or file as the zero"),
        ),
    };
    let finding = Finding::new(Severity::Error, "input-sign-reversed", "all", what, remedy);
    Some(finding.with_numbers(refused.len() as f64, 0.0))
}

/// Returns the finding on payloads from strain that are one multiple of the payloads from wheel forces in all runs, at least two: a sign or a unit is
/// wrong.
fn strain_contradicts_wheels(weighing: &Weighing) -> Option<Finding> {
    let ratio = |r: Refusal| match r {
        Refusal::OutOfBalance { strain, wheels, .. } => Some(strain / wheels),
        _ => None,
    };
    let ratios: Vec<f64> = refusals(weighing)
        .into_iter()
        .map(ratio)
        .collect::<Option<_>>()?;
    let common = median(ratios.clone())?;
    let alike = |c: &f64| (c / common - 1.0).abs() < NEAR;
    if ratios.len() < 2 || !ratios.iter().all(alike) {
        return None;
    }
    let is_unit = common.abs() > UNIT || common.abs() < 1.0 / UNIT;
    let (code, what) = match (is_unit, common < 0.0) {
        (true, _) => (
            "input-unit",
            "the readings or the wheel forces are in another unit",
        ),
        (false, true) => (
            "input-sign-reversed",
            "all readings, or all wheel forces, have reversed sign",
        ),
        (false, false) => return None,
    };
    let message = format!(
        "strain gives {} times the payload of the wheel forces in every run: {what}",
        number(common)
    );
    let remedy = "check sign and unit of the readings, and of the wheel forces ([runs] units)";
    let finding = Finding::new(Severity::Error, code, "all", message, remedy);
    Some(finding.with_numbers(common, UNIT))
}
