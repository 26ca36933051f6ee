//! `[dynamic]` in a fleet: the vibration of the structure is removed from a record before its loads are recovered.

use super::kernel::Kernel;
use super::record_recovery::RecordRecovery;
use crate::finding::Finding;
use crate::host::fault::{Fault, Faults};
use crate::measured::faults::record_fault;
use crate::recovery::Widening;
use crate::series::record::{MemoryRecord, Record, Times};
use std::sync::Arc;

impl Kernel {
    /// Returns the record without vibration, and changes `r` to its readings and their errors. `None` for a job without `[dynamic]`.
    ///
    /// # Errors
    /// A record that is too long for the memory, or to which the modes do not apply.
    pub(super) fn remove_vibration(
        &self,
        record: &Record,
        r: &mut RecordRecovery,
        findings: &mut Vec<Finding>,
    ) -> Result<Option<Record>, Faults> {
        let Some(model) = &self.vibration else {
            return Ok(None);
        };
        let (model, n) = (model.of_gauges(&r.used), r.used.len());
        let step_s = 1.0 / record.clock.rate_hz;
        model.check_length(record.clock.samples, n, step_s)?;
        let failed = |e| record_fault("record", &e);
        let readings = r.strain_columns(record).map_err(failed)?;
        let of_record = (step_s, "record");
        let removed = model.remove(
            &r.sensitivity,
            self.errors,
            &readings,
            of_record,
            &|| Ok(()),
        )?;
        drop(readings);
        let noise_factor = removed.noise_factor(self.noise_factor);
        findings.extend(removed.findings);
        let quasi_static = MemoryRecord {
            columns: Vec::new(),
            times: Times::Even {
                start_s: record.clock.start_s,
                step_s,
                samples: record.clock.samples,
                unit_stated: record.is_time_unit_stated(),
            },
            samples: removed.readings,
            stored: Vec::new(),
            others: Vec::new(),
        };
        r.columns = (0..n).map(Some).collect();
        r.scale = [vec![1.0; n], vec![0.0; n]];
        r.blank.clear();
        r.noise_factor = noise_factor;
        r.errors_beyond = Some(Arc::new(removed.doubt));
        r.apart = removed.apart;
        r.blank_by_filter = removed.blank as u64;
        let filter = self.filter(&r.sensitivity, r, Widening::none());
        r.filter = filter.ok_or_else(|| {
            let wrong = "S contains numbers that are not finite";
            Fault::new("record", "sensitivity", wrong, "check the table of S")
        })?;
        let record = Record::new(Box::new(quasi_static), None, None);
        Ok(Some(record.map_err(failed)?))
    }
}
