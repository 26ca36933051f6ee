//! Readings against causes measured in every run, where no model gives their strain: `[reconcile] causes`.

use crate::app::Session;
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::table::read_table;
use crate::app::job::{Job, Reconcile};
use crate::finding::{Finding, Severity};
use crate::reconcile::{Cause, CauseOutcome, CauseSet, Observations, weigh_causes};
use crate::report::page::{Page, Paper, table_section};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Weighs the causes of the job and writes what it finds.
pub(super) fn run(
    job: &Job,
    reconcile: &Reconcile,
    path: &Path,
    session: &mut Session,
    observations: &Observations,
) -> Result<(), Faults> {
    let causes = read(job, reconcile, session, observations)?;
    let noise = job.measured.as_ref().map_or(1.0, |m| m.noise_microstrain);
    let noise = vec![noise; observations.n_channels()];
    let outcome = session.stage("search", |_| weigh_causes(observations, &noise, &causes));
    let best = outcome.sets.first();
    let named = outcome.verdict == crate::reconcile::Verdict::Named;
    session.put("verdict", outcome.verdict.word())?;
    session.put(
        "named",
        best.filter(|_| named)
            .map_or(Vec::new(), |b| b.names.clone()),
    )?;
    let effects = best
        .filter(|_| named)
        .map_or(Vec::new(), |b| slopes(b, observations));
    session.put("effects", effects)?;
    let evidence = best.map_or(0.0, |b| b.log_evidence);
    let rival = |s: &CauseSet| {
        json!({ "id": s.names.join(" + "), "where": Value::Null, "evidence_difference": evidence - s.log_evidence, "gap_after": s.gap,
                "indistinguishable": outcome.rivals.contains(s) })
    };
    let rivals: Vec<Value> = if outcome.rivals.is_empty() {
        outcome
            .sets
            .iter()
            .skip(1)
            .filter(|s| !s.names.is_empty())
            .map(rival)
            .collect()
    } else {
        outcome.rivals.iter().map(rival).collect()
    };
    session.put("rivals", rivals)?;
    let before = outcome
        .sets
        .iter()
        .find(|s| s.names.is_empty())
        .map_or(0.0, |s| s.gap);
    session.put(
        "gap",
        json!({ "metric": "RMS(reading - prediction) / RMS(reading) over held-out runs, from the mean of the others, each channel over its range",
                "before": before, "after": best.map_or(before, |b| b.gap) }),
    )?;
    session.put("next_measurement", &outcome.next_measurement)?;
    session.put("extended_model", Value::Null)?;
    say(session, &outcome);
    let row = |s: &CauseSet| {
        vec![
            s.names.join(" + "),
            format!("{:.1}", evidence - s.log_evidence),
            format!("{:.2} %", 100.0 * s.gap),
        ]
    };
    let rows: Vec<Vec<String>> = outcome.sets.iter().map(row).collect();
    let head = ["causes", "log evidence behind", "gap"];
    let section = table_section("Causes", &head, &rows, "");
    let lead = format!(
        "Verdict: {}. Next measurement: {}",
        outcome.verdict.word(),
        outcome.next_measurement
    );
    let page = Page::new(&job.title, &lead, &session.findings, vec![section]);
    session.write_page(path, page.on_paper(Paper::Report))
}

fn slopes(best: &CauseSet, observations: &Observations) -> Vec<Value> {
    let by_channel = |slopes: &Vec<(f64, f64)>| -> BTreeMap<String, Value> {
        let channels = observations.channels.iter().cloned();
        channels
            .zip(
                slopes
                    .iter()
                    .map(|s| json!({ "per_unit": s.0, "sigma": s.1 })),
            )
            .collect()
    };
    best.names
        .iter()
        .zip(&best.slopes)
        .map(|(name, s)| json!({ "id": name, "where": Value::Null, "channels": by_channel(s), "plausible": true }))
        .collect()
}

fn say(session: &mut Session, outcome: &CauseOutcome) {
    session.say(format!("verdict: {}", outcome.verdict.word()));
    for s in &outcome.sets {
        let names = if s.names.is_empty() {
            "nothing".into()
        } else {
            s.names.join(" + ")
        };
        session.say(format!(
            "  {names}: log evidence {:.1}, gap {:.2} %",
            s.log_evidence,
            100.0 * s.gap
        ));
    }
    if !outcome.rivals.is_empty() {
        let names: Vec<String> = outcome.rivals.iter().map(|r| r.names.join(" + ")).collect();
        session.findings.push(Finding::new(
            Severity::Warning,
            "rival",
            names.join(", "),
            "these causes explain the runs alike: they can't be told apart",
            outcome.next_measurement.clone(),
        ));
    }
    session.say(format!("next measurement: {}", outcome.next_measurement));
}

/// Columns of the runs file that the job names as causes, in the order of the observed runs.
fn read(
    job: &Job,
    reconcile: &Reconcile,
    session: &mut Session,
    observations: &Observations,
) -> Result<Vec<Cause>, Faults> {
    let Some(runs) = &job.runs else {
        let remedy = "add `[runs]` with a file that has a column for each cause";
        return Err(Faults::from(Fault::of(
            &*job.file,
            "runs",
            "no `[runs]`",
            remedy,
        )));
    };
    let text = session
        .inputs
        .read_named_text(job, &runs.file)
        .map_err(Faults::from)?;
    let t = read_table(&runs.file.given, &text)?;
    let Some(key) = t.column(&["run"]) else {
        return Err(Faults::from(Fault::of(
            &*t.file,
            "run",
            "no column `run`",
            "add a column `run` with the runs' names",
        )));
    };
    let mut faults = FaultList::new();
    let mut causes = Vec::new();
    for (name, column) in &reconcile.causes {
        let Some(c) = t.header.iter().position(|h| h == column) else {
            faults.push(Fault::at(
                &*job.file,
                reconcile.line,
                format!("reconcile.causes.{name}"),
                format!("`{}` has no column `{column}`", t.file),
                "name a column of the runs file",
            ));
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
                _ => faults.push(Fault::of(
                    &*t.file,
                    column.clone(),
                    format!("no value for run `{run}`"),
                    "give every run of the strain file its causes",
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
