//! Names of the readings of a gauge.

use super::types::{Job, JobGauge};

/// Returns the names of the readings of a gauge; a rosette has one a leg.
pub fn readings_of(g: &JobGauge) -> Vec<String> {
    let leg = |leg: &str| format!("{}.{leg}", g.name);
    match g.rosette {
        Some(r) => r.legs().iter().map(|(name, _)| leg(name)).collect(),
        None => vec![g.name.clone()],
    }
}

/// Returns the names of the readings of the job's stated gauges; a rosette has one a leg.
pub fn stated_readings(job: &Job) -> Vec<String> {
    job.gauges.iter().flat_map(readings_of).collect()
}
