//! The strain file: a column a gauge in microstrain, a row a run (`run`) or a sample (`time`); or RPC III, Parquet, MDF4, a channel a
//! gauge.

use super::correct::{Channel, channel_of, column_of};
use super::table::{Table, read_table};
use super::types::{Correction, Job, NamedFile};
use crate::app::fault::{Fault, FaultList, Faults, split_message};
use crate::app::files::Inputs;
use crate::series::Channels;
use crate::series::foreign::{Foreign, read_foreign};
use crate::series::rpc;

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
    if rpc::is_rpc(&bytes) {
        return strain_from_rpc(&named.given, &bytes);
    }
    if let Some(kind) = Foreign::of(&bytes) {
        let record = strain_record(&named.given, kind, &bytes, &[])?;
        return Ok(strain_from_record(&named.given, &record));
    }
    let text = inputs.read_named_text(job, named).map_err(Faults::from)?;
    strain_from_table(&read_table(&named.given, &text)?)
}

/// The header of an RPC III file.
///
/// # Errors
/// A fault of the file.
pub fn read_strain_header(file: &str, bytes: &[u8]) -> Result<rpc::Header, Faults> {
    rpc::read_header(bytes).map_err(|e| {
        let (wrong, remedy) = split_message(&e);
        Faults::from(Fault::of(file, "header", wrong, remedy))
    })
}

/// Turns the channels that are named after gauges into microstrain. No unit means microstrain.
///
/// # Errors
/// A fault for each of them whose unit is none of strain.
pub fn in_microstrain(file: &str, h: &mut rpc::Header, gauges: &[String]) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    let used = h.channels.iter_mut().filter(|c| gauges.contains(&c.name));
    for channel in used {
        match microstrain_in(&channel.unit) {
            Some(factor) => channel.scale *= factor,
            None => faults.push(no_strain(file, &channel.name, &channel.unit)),
        }
    }
    Faults::check(faults)?;
    Ok(())
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

/// A Parquet or MDF4 record in microstrain; `gauges` must be sampled together and have a unit of strain, other channels whose unit is
/// none are left out.
///
/// # Errors
/// Faults of the file.
pub fn strain_record(
    file: &str,
    kind: Foreign,
    bytes: &[u8],
    gauges: &[String],
) -> Result<Channels, Faults> {
    let mut record = read_foreign(kind, bytes, None, gauges).map_err(|e| {
        let (wrong, remedy) = split_message(&e);
        Faults::from(Fault::of(file, "record", wrong, remedy))
    })?;
    let mut faults = FaultList::new();
    record.list.retain_mut(|c| match microstrain_in(&c.unit) {
        Some(factor) => {
            c.samples.iter_mut().for_each(|v| *v *= factor);
            true
        }
        None => {
            if gauges.contains(&c.name) {
                faults.push(no_strain(file, &c.name, &c.unit));
            }
            false
        }
    });
    Faults::check(faults)?;
    Ok(record)
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

/// A whole RPC III file; columns whose unit is none of strain are left out.
fn strain_from_rpc(file: &str, bytes: &[u8]) -> Result<StrainTable, Faults> {
    let mut h = read_strain_header(file, bytes)?;
    let columns: Vec<Option<usize>> = (0..h.channels.len())
        .filter(|c| microstrain_in(&h.channels[*c].unit).is_some())
        .map(Some)
        .collect();
    let gauges: Vec<String> = columns
        .iter()
        .filter_map(|c| h.channels.get((*c)?).map(|c| c.name.clone()))
        .collect();
    in_microstrain(file, &mut h, &gauges)?;
    let mut microstrain = Vec::new();
    rpc::read_samples(&h, bytes, 0, h.samples, &columns, &mut microstrain);
    Ok(StrainTable {
        file: file.to_owned(),
        gauges,
        rows: StrainRows::Times((0..h.samples).map(|i| h.dt * i as f64).collect()),
        microstrain,
    })
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
