//! Readings compared with causes that are measured in every run, if no model gives their strain: `[reconcile] causes`.

use super::answer::{AlternativeSummary, EffectFound, GapFound, Reconciliation, SlopeFound};
use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::table::read_table;
use crate::job::{Job, Reconcile};
use crate::measured::runs_columns::{asked_column, note_unread_runs, run_column, take_units};
use crate::measured::runs_file::given_loads;
use crate::reconcile::{Cause, CauseOutcome, CauseSet, Observations, Verdict, evaluate_cause_sets};
use crate::strain_chain::stated_noise;

/// Compares the causes of the job.
///
/// # Errors
/// A runs file that lacks a cause or a run.
pub(super) fn answer(
    job: &Job,
    reconcile: &Reconcile,
    work: &mut Work,
    observations: &Observations,
) -> Result<Reconciliation, Faults> {
    let causes = read(job, reconcile, work, observations)?;
    let noise = job.measured.as_ref().map_or(1.0, |m| m.noise_microstrain);
    let noise: Vec<f64> = match stated_noise(job, &observations.channels)? {
        Some(stated) => stated.sd().iter().map(|sd| noise * sd).collect(),
        None => vec![noise; observations.n_channels()],
    };
    let outcome = work.stage("search", |_| {
        evaluate_cause_sets(observations, &noise, &causes)
    });
    if !outcome.rivals.is_empty() {
        let names: Vec<String> = outcome.rivals.iter().map(|r| r.names.join(" + ")).collect();
        work.findings.push(Finding::new(
            Severity::Warning,
            "rival",
            names.join(", "),
            "these causes fit the runs equally well and are indistinguishable",
            outcome.next_measurement.clone(),
        ));
    }
    let best = outcome.sets.first();
    let named = best.filter(|_| outcome.verdict == Verdict::Named);
    let before = outcome.sets.iter().find(|s| s.names.is_empty());
    let before = before.map_or(0.0, |s| s.gap);
    Ok(Reconciliation {
        verdict: outcome.verdict,
        named: named.map_or(Vec::new(), |b| b.names.clone()),
        effects: named.map_or(Vec::new(), |b| effects(b, observations)),
        best_attempt: None,
        rivals: list_alternatives(&outcome),
        gap: GapFound {
            metric: "RMS(reading - prediction) / RMS(reading), cross-validated: the prediction of each run is the mean of the other runs, each \
             channel over its range"
                .to_owned(),
            before,
            after: best.map_or(before, |b| b.gap),
            floor: None,
            explained_share: None,
            strain: None,
            judged_by: None,
        },
        evidence: None,
        reduced_chi2: None,
        remains: None,
        next_measurement: outcome.next_measurement.clone(),
        detectable: None,
        strain: None,
        motion: None,
        causes: Some(outcome),
        added: Vec::new(),
        extended_model: None,
        job: job.clone(),
    })
}

/// Returns the sets that are indistinguishable from the best one; without such sets, all sets of causes except the best one.
fn list_alternatives(outcome: &CauseOutcome) -> Vec<AlternativeSummary> {
    let evidence = outcome.sets.first().map_or(0.0, |b| b.log_evidence);
    let rival = |s: &CauseSet| AlternativeSummary {
        id: s.names.join(" + "),
        place: None,
        evidence_difference: evidence - s.log_evidence,
        gap_after: s.gap,
        indistinguishable: outcome.rivals.contains(s),
    };
    if !outcome.rivals.is_empty() {
        return outcome.rivals.iter().map(rival).collect();
    }
    let others = outcome.sets.iter().skip(1);
    others.filter(|s| !s.names.is_empty()).map(rival).collect()
}

/// Returns the causes of a set, each with the change of the channels per unit of the cause.
fn effects(best: &CauseSet, observations: &Observations) -> Vec<EffectFound> {
    let by_channel = |slopes: &Vec<(f64, f64)>| {
        let channels = observations.channels.iter().cloned();
        let slopes = slopes
            .iter()
            .map(|&(per_unit, sigma)| SlopeFound { per_unit, sigma });
        channels.zip(slopes).collect()
    };
    let slopes = best.names.iter().zip(&best.slopes);
    slopes
        .map(|(name, s)| EffectFound {
            id: name.clone(),
            place: None,
            size: None,
            plausible: true,
            channels: Some(by_channel(s)),
        })
        .collect()
}

/// Columns of the runs file that the job names as causes, in the order of the observed runs.
fn read(
    job: &Job,
    reconcile: &Reconcile,
    work: &mut Work,
    observations: &Observations,
) -> Result<Vec<Cause>, Faults> {
    let Some(runs) = &job.runs else {
        let remedy = "add `[runs]` with a file that has a column for each cause";
        return Err(Faults::from(Fault::new(
            &*job.file,
            "runs",
            "no `[runs]`",
            remedy,
        )));
    };
    let text = work
        .inputs
        .read_named_text(job, &runs.file)
        .map_err(Faults::from)?;
    let mut t = read_table(&runs.file.given, &text)?;
    let headers = take_units(&mut t);
    t.check_rows()?;
    let given = given_loads(&mut work.inputs, job)?;
    note_unread_runs(&mut work.inputs, job, (&t, &headers), &given);
    let key = run_column(job, &t, &headers)?;
    let mut faults = FaultList::new();
    let mut causes = Vec::new();
    for (name, column) in &reconcile.causes {
        let field = format!("reconcile.causes.{name}");
        let at = (reconcile.line, field.as_str());
        let Some(c) = asked_column(job, at, &t, &headers, column, &mut faults) else {
            continue;
        };
        let mut values = Vec::new();
        for run in &observations.runs {
            let row = t
                .rows
                .iter()
                .position(|(_, fields)| fields.get(key) == Some(run));
            match row.map(|r| t.number(r, c)) {
                Some(Ok(Some(v))) => values.push(v),
                Some(Err(f)) => faults.push(f),
                _ => faults.push(Fault::new(
                    &*t.file,
                    column.clone(),
                    format!("no value for run `{run}`"),
                    "state the causes of every run of the strain file",
                )),
            }
        }
        causes.push(Cause {
            name: name.clone(),
            values,
        });
    }
    Faults::check(faults)?;
    Ok(causes)
}
