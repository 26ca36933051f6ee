//! The strain file: a column a gauge in microstrain, a row a run (`run`) or a sample (`time`); or RPC III, Parquet, MDF4, a channel a
//! gauge.

use super::correct::{Channel, channel_of, column_of};
use super::table::{Table, read_table};
use super::types::{Correction, Job, NamedFile};
use crate::app::fault::{Fault, FaultList, Faults, split_message};
use crate::app::files::{FileBytes, Inputs};
use crate::series::Channels;
use crate::series::record::{Column, Options, is_format, open_record, read_channels};
use std::collections::HashSet;
use std::sync::Arc;

/// What the rows of a strain file are.
#[derive(Clone, Debug, PartialEq)]
pub enum StrainRows {
    /// Static states by name.
    Runs(Vec<String>),
    /// Samples of one record, seconds.
    Times(Vec<f64>),
}

/// A strain file, microstrain as written.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainTable {
    /// File as given.
    pub file: String,
    /// Gauge names.
    pub gauges: Vec<String>,
    /// Runs or samples.
    pub rows: StrainRows,
    /// Row-major, `n_rows x n_gauges`; a blank is NaN.
    pub microstrain: Vec<f64>,
}

impl StrainTable {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        match &self.rows {
            StrainRows::Runs(r) => r.len(),
            StrainRows::Times(t) => t.len(),
        }
    }

    /// Readings of row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        let w = self.gauges.len();
        self.microstrain.get(i * w..(i + 1) * w).unwrap_or(&[])
    }

    /// Gives every column its gauge's name and every reading its gauge's strain.
    fn put_right(&mut self, corrections: &[Correction]) {
        if corrections.is_empty() {
            return;
        }
        let w = self.gauges.len().max(1);
        self.gauges = self
            .gauges
            .iter()
            .map(|c| column_of(corrections, c).to_owned())
            .collect();
        let channels: Vec<Channel> = self
            .gauges
            .iter()
            .map(|g| channel_of(corrections, g))
            .collect();
        for row in self.microstrain.chunks_exact_mut(w) {
            for (v, c) in row.iter_mut().zip(&channels).filter(|(_, c)| !c.is_right()) {
                *v = c.put_right(*v);
            }
        }
    }
}

/// A whole strain file in memory, its channels put right as `[[correction]]` says. Long histories are better streamed.
///
/// # Errors
/// Every fault: no `run` or `time` column, fields that are no numbers, runs named twice, times that don't ascend.
pub fn read_strain(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
) -> Result<StrainTable, Faults> {
    let mut table = strain_as_read(inputs, job, named)?;
    table.put_right(&job.corrections);
    Ok(table)
}

/// The file as it stands.
fn strain_as_read(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
) -> Result<StrainTable, Faults> {
    let bytes = inputs.read_named(job, named).map_err(Faults::from)?;
    if is_format(&bytes) {
        let record = strain_record(&named.given, bytes)?;
        return Ok(strain_from_record(&named.given, &record));
    }
    let text = inputs.read_named_text(job, named).map_err(Faults::from)?;
    strain_from_table(&read_table(&named.given, &text)?)
}

/// Microstrain in one of a unit, as measuring systems write it.
pub fn microstrain_in(unit: &str) -> Option<f64> {
    let word: String = unit
        .to_lowercase()
        .chars()
        .filter(|c| !matches!(c, ' ' | '_' | '-' | '.'))
        .map(|c| if matches!(c, 'µ' | 'μ') { 'u' } else { c })
        .collect();
    match word.as_str() {
        "" | "microstrain" | "ustrain" | "ue" | "uε" | "um/m" | "ustr" | "us" | "1e6" | "ppm"
        | "uin/in" => Some(1.0),
        "strain" | "m/m" | "mm/mm" | "in/in" | "eps" => Some(1e6),
        "mm/m" | "millistrain" | "mstrain" | "me" => Some(1e3),
        _ => None,
    }
}

/// A whole record in microstrain; channels whose unit is none of strain are left out.
fn strain_record(file: &str, bytes: FileBytes) -> Result<Channels, Faults> {
    let read = open_record(Arc::new(bytes), &Options::default()).and_then(|r| read_channels(&r));
    let mut record = read.map_err(|e| {
        let (wrong, remedy) = split_message(&e);
        Faults::from(Fault::of(file, "record", wrong, remedy))
    })?;
    record.list.retain_mut(|c| match microstrain_in(&c.unit) {
        Some(factor) => {
            c.samples.iter_mut().for_each(|v| *v *= factor);
            true
        }
        None => false,
    });
    Ok(record)
}

/// Names of a record's columns as `gauges` are called, and microstrain in one of each (1 for columns that are no gauges). A gauge may be
/// named with what looks like a unit: `SG1 (left)`.
///
/// # Errors
/// A fault for each gauge whose unit is none of strain.
pub fn strain_columns(
    file: &str,
    columns: &[Column],
    gauges: &[String],
) -> Result<(Vec<String>, Vec<f64>), Faults> {
    let known: HashSet<&str> = gauges.iter().map(String::as_str).collect();
    let mut faults = FaultList::new();
    let (mut names, mut scales) = (Vec::new(), Vec::new());
    for c in columns {
        let whole = [
            format!("{} [{}]", c.name, c.unit),
            format!("{} ({})", c.name, c.unit),
        ];
        let (name, scale) = if known.contains(c.name.as_str()) {
            let scale = microstrain_in(&c.unit);
            if scale.is_none() {
                faults.push(no_strain(file, &c.name, &c.unit));
            }
            (c.name.clone(), scale.unwrap_or(1.0))
        } else {
            let full = whole.into_iter().find(|w| known.contains(w.as_str()));
            (full.unwrap_or_else(|| c.name.clone()), 1.0)
        };
        names.push(name);
        scales.push(scale);
    }
    Faults::check(faults)?;
    Ok((names, scales))
}

fn no_strain(file: &str, channel: &str, unit: &str) -> Fault {
    Fault::of(
        file,
        channel,
        format!("`{unit}` is no unit of strain"),
        "export it in microstrain (uE, um/m) or strain (m/m)",
    )
}

/// A whole record as a table.
fn strain_from_record(file: &str, record: &Channels) -> StrainTable {
    let n = record.n_samples();
    let row = |i: usize| record.list.iter().map(move |c| c.samples[i]);
    StrainTable {
        file: file.to_owned(),
        gauges: record.list.iter().map(|c| c.name.clone()).collect(),
        rows: StrainRows::Times(
            (0..n)
                .map(|i| record.start_s + i as f64 / record.rate_hz)
                .collect(),
        ),
        microstrain: (0..n).flat_map(row).collect(),
    }
}

/// The strain in a table.
///
/// # Errors
/// As [`read_strain`].
pub fn strain_from_table(t: &Table) -> Result<StrainTable, Faults> {
    let run = t.column(&["run"]);
    let time = t.column(&["time", "t", "t_s", "time_s"]);
    let Some(key) = run.or(time) else {
        return Err(Faults::from(Fault::at(
            &*t.file,
            1,
            "run",
            "no column `run` and no column `time`",
            "add `run` with the runs' names, or `time` in seconds",
        )));
    };
    if t.rows.is_empty() {
        return Err(Faults::from(Fault::at(
            &*t.file,
            1,
            "rows",
            "a header and no rows",
            "write a row a run or a sample",
        )));
    }
    let mut faults = FaultList::new();
    let columns: Vec<usize> = (0..t.header.len()).filter(|c| *c != key).collect();
    let mut microstrain = Vec::with_capacity(t.rows.len() * columns.len());
    let mut number = |row, column, blank: f64| {
        t.number(row, column)
            .unwrap_or_else(|f| {
                faults.push(f);
                None
            })
            .unwrap_or(blank)
    };
    for row in 0..t.rows.len() {
        for c in &columns {
            microstrain.push(number(row, *c, f64::NAN));
        }
    }
    let rows = if run.is_some() {
        let mut names: Vec<String> = Vec::new();
        for (line, fields) in &t.rows {
            let name = fields.get(key).cloned().unwrap_or_default();
            if names.contains(&name) {
                let wrong = format!("run `{name}` stands twice");
                faults.push(Fault::at(
                    &*t.file,
                    *line,
                    "run",
                    wrong,
                    "give every run its own name",
                ));
            }
            names.push(name);
        }
        StrainRows::Runs(names)
    } else {
        StrainRows::Times(
            (0..t.rows.len())
                .map(|row| number(row, key, f64::NAN))
                .collect(),
        )
    };
    if let StrainRows::Times(times) = &rows {
        for (i, w) in times.windows(2).enumerate() {
            if let [a, b] = w
                && !(b > a)
            {
                let line = t.rows.get(i + 1).map_or(0, |r| r.0);
                let wrong = format!("time {b} after {a}");
                faults.push(Fault::at(
                    &*t.file,
                    line,
                    "time",
                    wrong,
                    "write samples in order of time",
                ));
                break;
            }
        }
    }
    Faults::check(faults)?;
    let gauges = columns
        .iter()
        .filter_map(|c| t.header.get(*c))
        .cloned()
        .collect();
    Ok(StrainTable {
        file: t.file.clone(),
        gauges,
        rows,
        microstrain,
    })
}
