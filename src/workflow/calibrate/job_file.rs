//! `calibrated.toml`: the job with the calibrated S in it.

use super::CalibratedSensitivity;
use crate::host::fault::{Fault, Faults};
use crate::units::MICROSTRAIN;
use crate::workflow::reconcile::folder_paths::relative_path;
use crate::workflow::reconcile::redirect::redirect;
use std::collections::BTreeSet;
use std::path::Path;
use toml::{Table, Value};

/// Returns the job for folder `out`, with S and its covariance from `calibrate`. Everything else is kept, and file names are relative to `out`. The
/// model error is no longer added, because the covariance contains it.
///
/// # Errors
/// A job that is no TOML, which is a mistake of the program.
pub fn calibrated_job(answer: &CalibratedSensitivity, out: &Path) -> Result<String, Faults> {
    let job = &answer.job;
    let mistake = |e: String| {
        Faults::from(Fault::new(
            &*job.file,
            "job",
            e,
            "report this as an error of the program",
        ))
    };
    let mut table: Table = answer
        .job_text
        .parse()
        .map_err(|e: toml::de::Error| mistake(e.to_string()))?;
    redirect(&mut table, &relative_path(out, &job.folder));
    let mut s = match table.remove("sensitivity") {
        Some(Value::Table(given)) => given,
        _ => Table::new(),
    };
    s.remove("per");
    s.remove("columns");
    s.insert("file".into(), Value::String("sensitivity.csv".into()));
    s.insert("covariance".into(), Value::String("calibration.bin".into()));
    s.remove("common_zero");
    if !answer.found.common_zero.is_empty() {
        s.insert(
            "common_zero".into(),
            Value::String("common_zero.csv".into()),
        );
    }
    let range = &answer.found.range;
    let loads = answer.sensitivity.loads.iter().map(|l| l.name.as_str());
    s.insert(
        "range".into(),
        ranges(loads.zip(range.loads.iter().copied())),
    );
    let gauges = answer.sensitivity.gauges.iter().map(String::as_str);
    let strain = range.strain.iter().map(|r| r.map(|v| v / MICROSTRAIN));
    s.insert("strain_range".into(), ranges(gauges.zip(strain)));
    table.insert("sensitivity".into(), Value::Table(s));
    // The list of calibration runs is kept, because `recover` does not compare these runs with their recorded loads.
    let mut only = match table.remove("calibration") {
        Some(Value::Table(keys)) => keys,
        _ => Table::new(),
    };
    only.retain(|key, _| key == "runs");
    let checks = answer.calibration.checks.iter().map(|c| c.run.clone());
    let checks: BTreeSet<String> = checks.collect();
    if !checks.is_empty() {
        let checks = checks.into_iter().map(Value::String).collect();
        only.insert("check".into(), Value::Array(checks));
    }
    if !only.is_empty() {
        table.insert("calibration".into(), Value::Table(only));
    }
    // The rows of S now contain the angle corrections.
    if let Some(Value::Array(list)) = table.get_mut("correction") {
        for c in list.iter_mut().filter_map(Value::as_table_mut) {
            c.remove("angle_deg");
        }
        list.retain(|c| c.as_table().is_none_or(|c| c.keys().any(|k| k != "gauge")));
        if list.is_empty() {
            table.remove("correction");
        }
    }
    if let Some(Value::Table(measured)) = table.get_mut("measured") {
        measured.remove("model_uncertainty_rel");
    }
    if job.loads.is_empty() {
        let name = |l: &crate::sensitivity::Load| {
            Value::Table(Table::from_iter([(
                "name".to_owned(),
                Value::String(l.name.clone()),
            )]))
        };
        let loads = answer.sensitivity.loads.iter().map(name).collect();
        table.insert("load".into(), Value::Array(loads));
    }
    let body = toml::to_string(&table).map_err(|e| mistake(e.to_string()))?;
    Ok(format!(
        "# The job with S as calibrated: `strainbridge recover calibrated.toml`.\n{body}"
    ))
}

/// Ranges by name; what no run states has none.
fn ranges<'a>(all: impl Iterator<Item = (&'a str, [f64; 2])>) -> Value {
    let stated = all.filter(|(_, r)| r.iter().all(|v| v.is_finite()));
    let entry = |(name, r): (&str, [f64; 2])| {
        let ends = r.map(Value::Float).to_vec();
        (name.to_owned(), Value::Array(ends))
    };
    Value::Table(stated.map(entry).collect())
}
