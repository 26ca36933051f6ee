//! The gauges of a record that read, and S of them.

use super::task::Task;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, Faults};
use crate::host::work::Work;
use crate::job::correct::channel_of;
use crate::measured::columns::columns_of;
use crate::measured::faults::no_gauge_column;
use crate::measured::record::{Record, section_channels};
use crate::sensitivity::Sensitivity;
use crate::series::constant_columns::{ColumnContents, Gives};

/// A record with the gauges of S as columns. Every gauge has a reading at some time.
pub(super) struct ActiveGaugeRecord {
    pub record: Record,
    pub sensitivity: Sensitivity,
    /// Zero that is subtracted from readings, strain by gauge.
    pub zero: Vec<f64>,
}

/// Leaves out the gauges of a record that have no column, are ignored, or have no signal.
///
/// # Errors
/// A record that can't be read, or without a single reading.
pub(super) fn exclude_silent_gauges(
    work: &mut Work,
    task: &Task,
    record: &Record,
) -> Result<ActiveGaugeRecord, Faults> {
    let all = &task.prepared.sensitivity;
    let named = &task.measured.strain;
    let file = named.given.as_str();
    let corrections = &task.job.corrections;
    work.findings.extend(record.findings());
    // Channels of sections are no gauges, and are not left out.
    let is_in_file = |channel: &String| record.names.contains(channel);
    let channels = section_channels(task.job).filter(is_in_file);
    let known: Vec<String> = all.gauges.iter().cloned().chain(channels).collect();
    let found = columns_of(work, named, &record.names, &known);
    let channel = |g: usize| (found[g], channel_of(corrections, &all.gauges[g]));
    // Gauges without a column are not used.
    let mut used: Vec<usize> = task
        .estimating
        .iter()
        .copied()
        .filter(|&g| found[g].is_some() && task.zero[g].is_finite() && !channel(g).1.ignore)
        .collect();
    if used.is_empty() {
        return Err(no_gauge_column(task.job, file, &record.names, &all.gauges).into());
    }
    let mut record = record
        .clone()
        .with_columns(used.iter().map(|&g| channel(g)).collect());
    let given = columns_of_record(&record)?;
    if given.iter().any(|g| *g != Gives::Signal) {
        for gives in [Gives::Nothing, Gives::OneValue] {
            let those = used.iter().zip(&given).filter(|(_, g)| **g == gives);
            let names: Vec<&str> = those.map(|(g, _)| all.gauges[*g].as_str()).collect();
            work.findings.extend(silent_throughout(&names, gives));
        }
        let mut speaks = given.iter().map(|g| *g == Gives::Signal);
        used.retain(|_| speaks.next().unwrap_or(true));
        record = record.with_columns(used.iter().map(|&g| channel(g)).collect());
    }
    if used.is_empty() {
        return Err(Faults::from(Fault::new(
            file,
            "gauge",
            "no gauge has a single reading",
            "check the export of the record",
        )));
    }
    Ok(ActiveGaugeRecord {
        sensitivity: all.of_gauges(&used),
        zero: used.iter().map(|&g| task.zero[g]).collect(),
        record,
    })
}

/// Returns the warning on gauges without a reading, or with one constant value, in the whole record.
pub(crate) fn silent_throughout(names: &[&str], gives: Gives) -> Option<Finding> {
    let what = match gives {
        Gives::Signal => return None,
        Gives::Nothing => "no reading",
        Gives::OneValue => "a constant reading",
    };
    (!names.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "gauge-silent",
            list_few(names),
            format!(
                "these gauges have {what}. The loads are computed from the other gauges, with wider intervals"
            ),
            "repair the channel, or exclude its gauge: [[correction]] ignore = true",
        )
    })
}

/// Returns whether each column has a signal, from ten pieces spread over the record. A column without a signal in these is tested on the whole
/// record.
fn columns_of_record(record: &Record) -> Result<Vec<Gives>, Faults> {
    let (n, pieces) = (record.n_columns(), record.n_pieces());
    let mut looked = ColumnContents::new(n);
    for p in 0..pieces.min(10) {
        let (_, values) = record
            .piece(p * pieces / pieces.min(10))
            .map_err(Faults::from)?;
        looked.look(&values);
        if looked.columns().iter().all(|g| *g == Gives::Signal) && p > 0 {
            break;
        }
    }
    Ok(record.column_contents(&looked)?)
}
