//! An open record of a fleet, its readings changed by `[conditioning]` if the job has this section.

use crate::finding::{Finding, Severity};
use crate::host::fault::Faults;
use crate::host::files::{OpenedFile, may_be_cut};
use crate::job::{Job, StrainCorrection};
use crate::measured::columns::strain_without_gauge;
use crate::measured::conditioning::{condition, report_conditioning, report_doubtful_drift};
use crate::measured::faults::record_fault;
use crate::measured::record::Record as StrainRecord;
use crate::recovery::clock;
use crate::series::record::{Clock, Record, open_source};
use std::sync::Arc;

/// An open record of a fleet.
pub struct FleetRecord {
    /// Samples.
    pub record: Arc<Record>,
    /// Times of the file, with its gaps.
    pub clock: Clock,
    /// Whether a low-pass filter reduced the noise of the readings.
    pub is_low_pass: bool,
    /// Corrections that its readings still need.
    pub corrections: Vec<StrainCorrection>,
    /// Findings on its times, its end and the steps of `[conditioning]`.
    pub findings: Vec<Finding>,
}

impl FleetRecord {
    /// Opens a record of a job to read the columns `wanted` for `gauges`; `noise` is the noise of a reading, strain. With `[conditioning]` all of its
    /// readings are in memory, corrected and named after their gauges.
    ///
    /// # Errors
    /// A record that can't be read, and the errors of [`condition`].
    pub fn open(
        job: &Job,
        (wanted, gauges): (&[String], &[String]),
        noise: f64,
        opened: &OpenedFile,
    ) -> Result<Self, Faults> {
        let time_unit_s = job.measured.as_ref().and_then(|m| m.time_unit_s);
        let options = StrainRecord::options(job, time_unit_s, wanted);
        let record = open_source(opened.source(), &options);
        let record = record.map_err(|e| record_fault("record", &e))?;
        let cut = record.left_out();
        let cut = cut.map(|_| may_be_cut("last line", Severity::Warning));
        let mut findings = clock::check_time_steps("time", &record.clock);
        findings.extend(cut);
        let clock = record.clock.clone();
        let Some(asked) = &job.conditioning else {
            return Ok(Self {
                clock,
                is_low_pass: false,
                record: Arc::new(record),
                corrections: job.corrections.clone(),
                findings,
            });
        };
        let strain = StrainRecord::from_series(job, "record", record, wanted)?;
        let others = strain.names.iter().filter(|n| !job.reserved.contains(n));
        let others: Vec<String> = others.cloned().collect();
        findings.extend(strain_without_gauge("", &others, gauges));
        let strain = condition(job, strain, wanted)?;
        let steps = strain.conditioning_steps();
        findings.extend(report_conditioning(steps));
        findings.extend(report_doubtful_drift(steps, noise));
        let ignored = job.corrections.iter().filter(|c| c.ignore);
        Ok(Self {
            corrections: ignored.cloned().collect(),
            record: strain.into_series(),
            clock,
            is_low_pass: asked.low_pass_hz.is_some(),
            findings,
        })
    }
}
