//! Gauges with the role `validation`: no load is estimated from their readings.

use super::Job;
use super::readings::readings_of;
use crate::host::fault::{Fault, Faults};
use crate::placement::Role;

impl Job {
    /// Returns the names of the readings of all validation gauges. The readings of a rosette are its legs, or the rosette itself in a given S.
    pub fn validation_readings(&self) -> Vec<String> {
        let validation = self.gauges.iter().filter(|g| g.role == Role::Validation);
        let mut names: Vec<String> = Vec::new();
        for gauge in validation {
            names.extend(readings_of(gauge).into_iter().filter(|r| *r != gauge.name));
            names.push(gauge.name.clone());
        }
        names
    }

    /// Returns the job without its validation gauges, for commands that estimate from readings. [`Job::reserved`] contains the names of the readings
    /// of validation gauges. Their columns are known, but no command reads them.
    ///
    /// # Errors
    /// One fault if every gauge of the job is a validation gauge.
    pub fn without_validation_gauges(&self) -> Result<Self, Faults> {
        let mut job = self.clone();
        job.reserved.extend(self.validation_readings());
        job.gauges.retain(|g| g.role == Role::Estimate);
        match (self.gauges.first(), job.gauges.is_empty()) {
            (Some(first), true) => Err(Fault::with_line(
                &*first.file,
                first.line,
                "role",
                "every gauge has the role `validation`: no gauge is left to estimate loads from",
                "give the role `estimate` to the gauges that loads are estimated from",
            )
            .into()),
            _ => Ok(job),
        }
    }
}
