//! Records and tables in `result.json` and in the text for people.

use crate::app::fault::Faults;
use crate::app::files::as_table;
use crate::app::job::strain::record_fault;
use crate::app::words::short;
use crate::app::work::Work;
use crate::finding::few;
use crate::recovery::clock;
use crate::series::record::csv::Layout;
use crate::series::record::{Column, Options, format_of, open_record};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;

/// One record, or one table.
#[derive(Serialize)]
pub struct RecordEntry {
    path: String,
    /// RPC III, Parquet ..
    format: &'static str,
    channels: Vec<ChannelEntry>,
    /// `None` for a table without times.
    samples: Option<usize>,
    sample_rate_hz: Option<f64>,
    duration_s: Option<f64>,
}

/// A channel of a record, or a column of a table.
#[derive(Serialize)]
struct ChannelEntry {
    name: String,
    /// Empty where the file states none.
    unit: String,
}

impl ChannelEntry {
    fn of(column: &Column) -> Self {
        Self {
            name: column.name.clone(),
            unit: column.unit.clone(),
        }
    }
}

impl RecordEntry {
    /// Returns the entry as one line for people.
    pub fn text(&self) -> String {
        let name = |c: &ChannelEntry| match c.unit.as_str() {
            "" => c.name.clone(),
            unit => format!("{} [{unit}]", c.name),
        };
        let names: Vec<String> = self.channels.iter().map(name).collect();
        let n = self.channels.len();
        let (kind, what) = match self.samples {
            Some(_) => ("record", "channel"),
            None => ("table", "column"),
        };
        let plural = if n == 1 { "" } else { "s" };
        let times = match (self.samples, self.sample_rate_hz, self.duration_s) {
            (Some(samples), Some(rate), Some(seconds)) => {
                let (rate, seconds) = (short(rate), short(seconds));
                format!(", {samples} samples at {rate} Hz, {seconds} s")
            }
            _ => String::new(),
        };
        let line = format!(
            "{kind} `{}`: {}, {n} {what}{plural} ({}){times}",
            self.path,
            self.format,
            few(&names)
        );
        line.replace(char::is_control, " ")
    }
}

/// Looks into a record or a table.
///
/// # Errors
/// Faults of the file.
pub(super) fn look(work: &mut Work, base: &Path, given: &str) -> Result<RecordEntry, Faults> {
    let bytes = work.inputs.read(base, given)?;
    let format = format_of(&bytes).map_or(text_format(given), |f| f.name());
    let bytes = as_table(given, bytes)?;
    if format_of(&bytes).is_none() {
        let layout = Layout::of(&bytes).map_err(|e| record_fault(given, &e))?;
        if !layout.is_record() {
            return Ok(RecordEntry {
                path: given.to_owned(),
                format,
                channels: layout.columns.iter().map(ChannelEntry::of).collect(),
                samples: None,
                sample_rate_hz: None,
                duration_s: None,
            });
        }
    }
    let record = open_record(Arc::new(bytes), &Options::default());
    let record = record.map_err(|e| record_fault(given, &e))?;
    let rate = record.clock.rate_hz;
    if !record.is_time_unit_stated() {
        work.findings.extend(clock::check_rate(rate));
    }
    work.findings.extend(clock::irregular(given, &record.clock));
    Ok(RecordEntry {
        path: given.to_owned(),
        format,
        channels: record.columns().iter().map(ChannelEntry::of).collect(),
        samples: Some(record.clock.samples),
        sample_rate_hz: Some(rate),
        duration_s: Some(record.clock.duration_s()),
    })
}

fn text_format(given: &str) -> &'static str {
    let name = given.to_ascii_lowercase();
    match name.rsplit('.').next() {
        Some("xlsx" | "xlsm") => "XLSX",
        Some("csv") => "CSV",
        _ => "text",
    }
}
