//! The strain file: a column a gauge in microstrain, a row a run (`run`) or a sample (`time`); or RPC III, Parquet, MDF4, a channel a
//! gauge. Text is read in [`super::strain_text`], means of long records in [`super::strain_means`].

use super::column_unit::no_strain;
pub use super::strain_table::{StrainRows, StrainTable};
use super::strain_text::strain_from_text;
use super::table::read_table;
use super::types::{Job, NamedFile};
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::files::{FileBytes, Inputs};
use crate::gauge::Rosette;
use crate::series::SeriesError;
use crate::series::record::{Column, Options, Record, is_format, open_record};
use crate::units::microstrain_in;
use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;

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
        return strain_from_record(&named.given, bytes, &gauge_names(inputs, job));
    }
    let text = inputs.read_named_text(job, named).map_err(Faults::from)?;
    strain_from_text(&named.given, &text, &gauge_names(inputs, job))
}

/// Names of the job's gauges: those it states, legs of rosettes by theirs, else the rows of a given S; none where neither tells. A table of S
/// that can't be read is a fault of whoever asks for S.
pub(super) fn gauge_names(inputs: &mut Inputs, job: &Job) -> Vec<String> {
    let mut names = Vec::new();
    for g in &job.gauges {
        names.push(g.name.clone());
        // Both kinds name their legs alike.
        let legs = g.rosette.iter().flat_map(|_| Rosette::Rectangular.legs());
        names.extend(legs.map(|(leg, _)| format!("{}.{leg}", g.name)));
    }
    let given = job.sensitivity.as_ref().filter(|_| names.is_empty());
    let text = given.and_then(|s| inputs.read_named_text(job, &s.file).ok());
    if let Some((s, text)) = given.zip(text)
        && let Ok(table) = read_table(&s.file.given, &text)
        && let Some(key) = table.column(&["gauge", "name"])
    {
        names.extend(
            table
                .rows
                .into_iter()
                .filter_map(|(_, mut r)| (key < r.len()).then(|| r.swap_remove(key))),
        );
    }
    names
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
    // `P01 (raw)` beside `P01` is another column.
    let of_strain = columns.iter().filter(|c| microstrain_in(&c.unit).is_some());
    let of_strain: HashSet<&str> = of_strain.map(|c| c.name.as_str()).collect();
    for c in columns {
        let whole = [
            format!("{} [{}]", c.name, c.unit),
            format!("{} ({})", c.name, c.unit),
        ];
        let scale = microstrain_in(&c.unit);
        let is_other = scale.is_none() && of_strain.contains(c.name.as_str());
        let (name, scale) = if known.contains(c.name.as_str()) && !is_other {
            if scale.is_none() {
                faults.push(no_strain(file, &c.name, &c.unit));
            }
            (c.name.clone(), scale.unwrap_or(1.0))
        } else {
            let plain = match is_other {
                true => format!("{} [{}]", c.name, c.unit),
                false => c.name.clone(),
            };
            let full = whole.into_iter().find(|w| known.contains(w.as_str()));
            let scale = scale.filter(|_| full.is_some());
            (full.unwrap_or(plain), scale.unwrap_or(1.0))
        };
        names.push(name);
        scales.push(scale);
    }
    Faults::check(faults)?;
    Ok((names, scales))
}

/// A record that is read whole or passed over: its columns of strain, each with its name, as `gauges` are called, and microstrain in one of
/// its unit.
pub(super) fn open_strain(
    file: &str,
    bytes: FileBytes,
    gauges: &[String],
) -> Result<(Record, Vec<(usize, String, f64)>), Faults> {
    let record = open_record(Arc::new(bytes), &Options::default())
        .map_err(|e| Faults::from(record_fault(file, &e)))?;
    let (names, scales) = strain_columns(file, record.columns(), gauges)?;
    let named = names.into_iter().zip(scales).zip(record.columns());
    let strain = |((name, scale), c): ((String, f64), &Column)| {
        let scale = match gauges.contains(&name) {
            true => Some(scale),
            false => microstrain_in(&c.unit),
        };
        Some((name, scale?))
    };
    let columns = named
        .enumerate()
        .filter_map(|(i, column)| strain(column).map(|(name, scale)| (i, name, scale)))
        .collect();
    Ok((record, columns))
}

pub(super) fn record_fault(file: &str, e: &SeriesError) -> Fault {
    let (wrong, remedy) = e.parts();
    Fault::of(file, "record", wrong, remedy)
}

/// A whole record as a table; channels whose unit is none of strain are left out.
fn strain_from_record(
    file: &str,
    bytes: FileBytes,
    gauges: &[String],
) -> Result<StrainTable, Faults> {
    let (record, columns) = open_strain(file, bytes, gauges)?;
    let picks: Vec<Option<usize>> = columns.iter().map(|c| Some(c.0)).collect();
    let clock = &record.clock;
    let mut microstrain = Vec::with_capacity(clock.samples.saturating_mul(columns.len()));
    for piece in 0..record.n_pieces() {
        let read = record.read(piece, &picks, &mut |block| {
            for row in block.values.chunks_exact(columns.len().max(1)) {
                microstrain.extend(row.iter().zip(&columns).map(|(v, c)| v * c.2));
            }
            ControlFlow::Continue(())
        });
        read.map_err(|e| Faults::from(record_fault(file, &e)))?;
    }
    Ok(StrainTable {
        file: file.to_owned(),
        rows: StrainRows::Times((0..clock.samples).map(|i| clock.time_s(i)).collect()),
        gauges: columns.into_iter().map(|c| c.1).collect(),
        microstrain,
    })
}
