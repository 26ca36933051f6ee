//! Gauges that are dead or stuck in a part of a record. Their readings are left out there, and the results of their days list these parts.

use super::day::GaugeDay;
use super::record_recovery::RecordRecovery;
use super::sample_tests::TestedSamples;
use crate::finding::Finding;
use crate::host::fault::Fault;
use crate::measured::faults::record_fault;
use crate::recovery::ErrorModel;
use crate::recovery::dead_gauges::check;
use crate::series::constant_columns::{Gives, extent};
use crate::series::record::{Clock, Record};
use crate::workflow::recover::silent_in_part;
use std::ops::Range;

/// A dead part: the gauge (number among the used gauges), its content in this part, and the samples of this part.
pub(super) type DeadPart = (usize, Gives, Range<usize>);

/// Returns the dead parts, found with samples spread over the record. Their limits are exact to the sample.
///
/// # Errors
/// A fault if a piece of the record cannot be decoded.
pub(super) fn dead_parts(
    record: &Record,
    r: &RecordRecovery,
    tested: &TestedSamples,
    errors: ErrorModel,
    noise_factor: f64,
) -> Result<Vec<DeadPart>, Fault> {
    let samples: Vec<(usize, &[f64])> = tested.numbered_samples().collect();
    check(&r.sensitivity, &samples, errors, noise_factor)
        .into_iter()
        .map(|stuck| {
            let column = r.columns.get(stuck.gauge).copied().flatten();
            let span = extent(record, column, stuck.gives, stuck.span, stuck.within);
            let span = span.map_err(|e| record_fault("record", &e))?;
            Ok((stuck.gauge, stuck.gives, span))
        })
        .collect()
}

/// Returns the readings that are left out.
pub(super) fn blank_of(dead: &[DeadPart]) -> Vec<(usize, Range<usize>)> {
    let of_one_value = dead.iter().filter(|d| d.1 == Gives::OneValue);
    of_one_value
        .map(|(g, _, span)| (*g, span.clone()))
        .collect()
}

/// Returns one finding for each dead part of the record, and adds the parts to the gauges.
pub(super) fn report_dead_parts(
    dead: &[DeadPart],
    gauges: &mut [GaugeDay],
    clock: &Clock,
) -> Vec<Finding> {
    let mut out = Vec::new();
    for (g, gives, span) in dead {
        let Some(gauge) = gauges.get_mut(*g) else {
            continue;
        };
        let hours = |at: usize| at as f64 / clock.rate_hz / 3600.0;
        gauge.dead.push([hours(span.start), hours(span.end)]);
        let times = [span.start, span.end - 1].map(|at| clock.time_s(at));
        out.push(silent_in_part(&gauge.name, *gives, times));
    }
    out
}
