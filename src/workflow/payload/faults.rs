//! Faults of gauges by the strain of the payload.

use super::model::{Parts, model_of};
use super::task::Task;
use crate::finding::{Finding, Severity};
use crate::host::work::Work;
use crate::input_faults::{FaultTreatment, SIGN_OF_ALL};
use crate::payload::{PayloadRun, Refusal, WeighSpec, Weighing, faults_of_gauges, payload_rows};
use crate::strain_chain::alternatives_of;

/// Reports faults of gauges that the strain of all runs shows, and readings that all have the opposite sign.
pub(super) fn search(
    work: &mut Work,
    task: &Task,
    parts: &Parts,
    runs: &[PayloadRun],
    (spec, weighing): (&WeighSpec, &Weighing),
) {
    work.findings.extend(all_reversed(weighing));
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

/// Returns the finding on readings that give a payload below zero in every run.
fn all_reversed(weighing: &Weighing) -> Option<Finding> {
    let negative = |r: &Option<Refusal>| matches!(r, Some(Refusal::Negative { .. }));
    let told = weighing.runs.iter().map(|r| &r.refused);
    let told: Vec<&Option<Refusal>> = told
        .filter(|r| **r != Some(Refusal::Undetermined))
        .collect();
    (!told.is_empty() && told.iter().all(|r| negative(r))).then(|| {
        Finding::new(
            Severity::Error,
            "input-sign-reversed",
            "all",
            "the readings give a negative payload in every run: all readings have reversed sign, or the zero was measured with the payload",
            format!("{SIGN_OF_ALL}. Otherwise name the unloaded run or file as the zero"),
        )
        .with_numbers(told.len() as f64, 0.0)
    })
}
