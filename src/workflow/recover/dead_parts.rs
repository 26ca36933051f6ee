//! A record without the readings of gauges that are dead in a part of it.

use super::record_tests::spread_readings;
use super::task::Task;
use crate::finding::{Finding, Severity};
use crate::host::fault::Faults;
use crate::host::work::Work;
use crate::measured::record::Record;
use crate::recovery::Readings;
use crate::recovery::dead_gauges::{check, still_parts};
use crate::sensitivity::Sensitivity;
use crate::series::constant_columns::{Gives, blank_readings};
use std::ops::Range;

/// A record without the readings of gauges in their dead parts.
pub(super) struct MaskedRecord {
    pub record: Record,
    /// Readings of samples spread over the record.
    pub readings: Vec<Readings>,
    /// Dead parts: gauge of S, and samples.
    pub dead: Vec<(usize, Range<usize>)>,
}

/// Removes readings of gauges in their dead parts, and reports these parts as findings. In these parts the loads come from the other gauges.
///
/// # Errors
/// A piece that can't be read.
pub(super) fn without_dead_parts(
    work: &mut Work,
    task: &Task,
    record: Record,
    s: &Sensitivity,
    zero: &[f64],
) -> Result<MaskedRecord, Faults> {
    let mut samples = spread_readings(task, &record, zero)?;
    let looked: Vec<(usize, &[f64])> = samples.iter().map(|r| (r.0, &*r.1.strain)).collect();
    // Gauge names alone, without S, give no prediction from the other gauges.
    let stuck = match s.loads.is_empty() {
        true => Vec::new(),
        false => check(s, &looked, task.errors, task.noise_factor),
    };
    work.findings
        .extend(report_constant_parts(&record, &still_parts(&looked)));
    let (mut parts, mut blanked) = (Vec::new(), Vec::new());
    for dead in &stuck {
        let span = record.extent(dead)?;
        let times = [span.start, span.end - 1].map(|i| record.time_s(i));
        let gauge = &s.gauges[dead.gauge];
        work.findings.push(silent_in_part(gauge, dead.gives, times));
        if dead.gives == Gives::OneValue {
            blanked.push((dead.gauge, span.clone()));
        }
        parts.push((dead.gauge, span));
    }
    let n = s.gauges.len();
    for (at, readings) in &mut samples {
        blank_readings(&mut readings.strain, n, *at, &blanked);
    }
    let readings = samples.into_iter().map(|r| r.1).collect();
    Ok(MaskedRecord {
        record: record.with_blank_readings(blanked),
        readings,
        dead: parts,
    })
}

/// Returns the warning of a gauge that is dead from one time to another, s.
pub(crate) fn silent_in_part(gauge: &str, gives: Gives, [from, to]: [f64; 2]) -> Finding {
    let [what, why] = match gives {
        Gives::Nothing => ["no reading", "have readings"],
        Gives::OneValue | Gives::Signal => ["a constant reading", "show that its strain changes"],
    };
    Finding::new(
        Severity::Warning,
        "gauge-silent",
        gauge,
        format!(
            "it has {what} from t = {from:.6} s to t = {to:.6} s, while the others {why}. Loads in this span are computed from the other \
             gauges, with wider intervals"
        ),
        "repair the channel, or exclude its gauge: [[correction]] ignore = true",
    )
    .with_numbers(to - from, 0.0)
}

/// Returns the warning of parts in which no gauge changes. The record does not show whether the structure is at standstill or the logger failed.
fn report_constant_parts(record: &Record, parts: &[[usize; 2]]) -> Option<Finding> {
    let [first, last] = *parts.first()?;
    let [from, to] = [first, last].map(|i| record.time_s(i));
    let others = match parts.len() {
        1 => String::new(),
        n => format!(" (and in {} more parts)", n - 1),
    };
    let finding = Finding::new(
        Severity::Warning,
        "record-constant",
        record.file(),
        format!(
            "from t = {from:.6} s to t = {to:.6} s{others} all gauges are constant. Either the structure is at standstill, or the logger \
             recorded no signal and repeats its last values. The readings are used"
        ),
        "leave the field blank if nothing was measured: loads and cycles are then blank too",
    );
    Some(finding.with_numbers(parts.len() as f64, 0.0))
}
