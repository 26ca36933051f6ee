//! Records and tables in `result.json` and in the text for people.

use crate::finding::list_few;
use crate::host::fault::Faults;
use crate::host::files::as_table;
use crate::host::words::format_number;
use crate::host::work::Work;
use crate::measured::faults::record_fault;
use crate::recovery::clock;
use crate::series::record::csv::Layout;
use crate::series::record::{Column, Options, OtherChannel, format_of, open_record};
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
    /// Channels that are sampled at other times, or that are no numbers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    other_channels: Vec<OtherEntry>,
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
    /// Empty where the format has no groups.
    #[serde(skip_serializing_if = "String::is_empty")]
    group: String,
}

/// A channel that is read separately from the other channels.
#[derive(Serialize)]
struct OtherEntry {
    #[serde(flatten)]
    channel: ChannelEntry,
    samples: usize,
    sample_rate_hz: Option<f64>,
}

impl ChannelEntry {
    fn from_column(column: &Column) -> Self {
        Self {
            name: column.name.clone(),
            unit: column.unit.clone(),
            group: String::new(),
        }
    }

    /// Name and unit, for people.
    fn text(&self) -> String {
        match self.unit.as_str() {
            "" => self.name.clone(),
            unit => format!("{} [{unit}]", self.name),
        }
    }
}

impl OtherEntry {
    fn from_channel(c: &OtherChannel) -> Self {
        Self {
            channel: ChannelEntry {
                name: c.name.clone(),
                unit: c.unit.clone(),
                group: c.group.clone(),
            },
            samples: c.samples,
            sample_rate_hz: c.rate_hz,
        }
    }

    /// For people: its name, its unit, how many samples at which rate.
    fn text(&self) -> String {
        let rate = self
            .sample_rate_hz
            .map(|r| format!(" at {} Hz", format_number(r)));
        let (name, rate) = (self.channel.text(), rate.unwrap_or_default());
        let plural = if self.samples == 1 { "" } else { "s" };
        format!("{name}, {} sample{plural}{rate}", self.samples)
    }
}

/// Returns a line for each group, in file order, with the texts of its channels.
fn by_group(list: impl Iterator<Item = (String, String)>) -> Vec<String> {
    let mut groups: Vec<(String, Vec<String>)> = Vec::new();
    for (group, text) in list {
        match groups.iter_mut().find(|g| g.0 == group) {
            Some((_, texts)) => texts.push(text),
            None => groups.push((group, vec![text])),
        }
    }
    let line = |(group, texts): (String, Vec<String>)| match group.as_str() {
        "" => texts.join("; "),
        group => format!("group `{group}`: {}", texts.join("; ")),
    };
    groups.into_iter().map(line).collect()
}

impl RecordEntry {
    /// Returns the entry as one line for people. If the file has channels at other times, it adds one line for each group.
    pub fn text(&self) -> String {
        let is_whole = self.other_channels.is_empty();
        let names = self.channels.iter();
        let listed = match is_whole {
            true => list_few(&names.map(ChannelEntry::text).collect::<Vec<_>>()),
            false => by_group(names.map(|c| (c.group.clone(), c.text()))).join(", "),
        };
        let n = self.channels.len();
        let (kind, what) = match self.samples {
            Some(_) => ("record", "channel"),
            None => ("table", "column"),
        };
        let plural = if n == 1 { "" } else { "s" };
        let times = match (self.samples, self.sample_rate_hz, self.duration_s) {
            (Some(samples), Some(rate), Some(seconds)) => {
                let (rate, seconds) = (format_number(rate), format_number(seconds));
                format!(", {samples} samples at {rate} Hz, {seconds} s")
            }
            _ => String::new(),
        };
        let line = format!(
            "{kind} `{}`: {}, {n} {what}{plural} ({}){times}",
            self.path, self.format, listed
        );
        let others = self.other_channels.iter();
        let others = others.map(|c| (c.channel.group.clone(), c.text()));
        let mut lines = vec![line];
        for group in by_group(others) {
            lines.push(format!("  in another group and not read: {group}"));
        }
        let plain = lines.iter().map(|l| l.replace(char::is_control, " "));
        plain.collect::<Vec<String>>().join("\n")
    }
}

/// Reads the description of a record or a table.
///
/// # Errors
/// Faults of the file.
pub(super) fn check_record(
    work: &mut Work,
    base: &Path,
    given: &str,
) -> Result<RecordEntry, Faults> {
    let bytes = work.inputs.read(base, given)?;
    let format = format_of(&bytes).map_or(text_format(given), |f| f.name());
    let bytes = as_table(given, bytes)?;
    if format_of(&bytes).is_none() {
        let layout = Layout::detect(&bytes).map_err(|e| record_fault(given, &e))?;
        if !layout.is_record() {
            return Ok(RecordEntry {
                path: given.to_owned(),
                format,
                channels: layout
                    .columns
                    .iter()
                    .map(ChannelEntry::from_column)
                    .collect(),
                other_channels: Vec::new(),
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
    work.findings
        .extend(clock::check_time_steps(given, &record.clock));
    let columns = record.columns().iter().enumerate();
    let channels = columns.map(|(i, c)| ChannelEntry {
        group: record.group(i).to_owned(),
        ..ChannelEntry::from_column(c)
    });
    Ok(RecordEntry {
        path: given.to_owned(),
        format,
        channels: channels.collect(),
        other_channels: record
            .other_channels()
            .iter()
            .map(OtherEntry::from_channel)
            .collect(),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn other_entry(group: &str, name: &str, samples: usize, rate: Option<f64>) -> OtherEntry {
        OtherEntry::from_channel(&OtherChannel {
            group: group.to_owned(),
            name: name.to_owned(),
            unit: String::new(),
            samples,
            rate_hz: rate,
        })
    }

    #[test]
    fn channels_at_other_times_are_listed_by_group_with_samples_and_rate() {
        let channel = |i: usize| ChannelEntry {
            name: format!("P{i}"),
            unit: "um/m".to_owned(),
            group: "strain".to_owned(),
        };
        let mut entry = RecordEntry {
            path: "day.tdms".to_owned(),
            format: "TDMS",
            channels: (0..20).map(channel).collect(),
            other_channels: Vec::new(),
            samples: Some(100),
            sample_rate_hz: Some(100.0),
            duration_s: Some(1.0),
        };
        assert!(entry.text().contains("P7 [um/m] and 12 more)"));
        entry.other_channels = vec![
            other_entry("slow", "battery", 3, Some(1.0)),
            other_entry("notes", "remark", 1, None),
            other_entry("slow", "cabin", 3, Some(1.0)),
        ];
        let text = entry.text();
        let lines: Vec<&str> = text.lines().collect();
        assert!(
            lines[0].contains("(group `strain`: P0 [um/m]; P1 [um/m]; "),
            "{text}"
        );
        assert!(
            lines[0].contains("; P19 [um/m]), 100 samples at 100 Hz"),
            "{text}"
        );
        assert_eq!(
            lines[1..],
            [
                "  in another group and not read: group `slow`: battery, 3 samples at 1 Hz; cabin, 3 samples at 1 Hz",
                "  in another group and not read: group `notes`: remark, 1 sample",
            ]
        );
    }
}
