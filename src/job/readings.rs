//! Names of the readings of a gauge.

use super::types::{Job, JobGauge};

/// Returns the names of the readings of a gauge. A rosette has one reading for each leg.
pub fn readings_of(g: &JobGauge) -> Vec<String> {
    let leg = |leg: &str| format!("{}.{leg}", g.name);
    match g.rosette {
        Some(r) => r.legs().iter().map(|(name, _)| leg(name)).collect(),
        None => vec![g.name.clone()],
    }
}

/// Returns the names of the readings of the stated gauges. A rosette has one reading for each leg.
pub fn stated_readings(job: &Job) -> Vec<String> {
    job.gauges.iter().flat_map(readings_of).collect()
}
