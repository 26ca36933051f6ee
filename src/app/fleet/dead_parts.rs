//! Gauges that are dead in a part of a record: their readings are left out there, and their days say so.

use super::day::{DayFinding, GaugeDay};
use super::judged::Judged;
use super::recovering::Recovering;
use crate::finding::{Finding, Severity};
use crate::recovery::ErrorModel;
use crate::recovery::stuck::check;
use crate::series::record::Record;
use crate::series::still::{Gives, extent};
use std::ops::Range;

/// A gauge (of those used), what it gives in a part of the record, and the samples of that part.
pub(super) type DeadPart = (usize, Gives, Range<usize>);

/// Dead parts by the samples spread over the record, to the sample.
///
/// # Errors
/// What can't be decoded.
pub(super) fn dead_parts(
    record: &Record,
    r: &Recovering,
    judged: &Judged,
    errors: ErrorModel,
    noise_factor: f64,
) -> Result<Vec<DeadPart>, String> {
    let samples: Vec<(usize, &[f64])> = judged.numbered().collect();
    check(&r.sensitivity, &samples, errors, noise_factor)
        .into_iter()
        .map(|stuck| {
            let column = r.columns.get(stuck.gauge).copied().flatten();
            let span = extent(record, column, stuck.gives, stuck.span, stuck.within);
            let span = span.map_err(|e| e.to_string())?;
            Ok((stuck.gauge, stuck.gives, span))
        })
        .collect()
}

/// The readings that are left out.
pub(super) fn blank_of(dead: &[DeadPart]) -> Vec<(usize, Range<usize>)> {
    let of_one_value = dead.iter().filter(|d| d.1 == Gives::OneValue);
    of_one_value
        .map(|(g, _, span)| (*g, span.clone()))
        .collect()
}

/// Findings of the record, one a part, noted with the gauges as well; `hours` turns samples into hours.
pub(super) fn told_dead(
    dead: &[DeadPart],
    gauges: &mut [GaugeDay],
    hours: impl Fn(f64) -> f64,
) -> Vec<DayFinding> {
    let mut out = Vec::new();
    for (g, gives, span) in dead {
        let Some(gauge) = gauges.get_mut(*g) else {
            continue;
        };
        let part = [span.start, span.end].map(|at| hours(at as f64));
        gauge.dead.push(part);
        let what = match gives {
            Gives::Nothing => "it gives nothing",
            Gives::OneValue | Gives::Signal => "it reads one and the same value",
        };
        let [from, to] = part;
        let message = format!(
            "{what} from hour {from:.3} to hour {to:.3} of the record: there the loads are those of the others"
        );
        let found = Finding::new(
            Severity::Warning,
            "dead_channel",
            &gauge.name,
            message,
            "look at the logger",
        );
        out.push(found.with_numbers(to - from, 0.0).into());
    }
    out
}
