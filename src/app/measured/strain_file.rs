//! The strain file: a column a gauge in microstrain, a row a run (`run`) or a sample (`time`); or RPC III, Parquet, MDF4, a channel a
//! gauge. Text is read in [`super::strain_text`], means of long records in [`super::means`].

use super::gauge_columns::find_gauge_columns;
pub use super::strain_table::{StrainRows, StrainTable};
use super::strain_text::strain_from_text;
use crate::app::fault::{Fault, Faults};
use crate::app::files::{FileBytes, Inputs};
use crate::app::job::correct::{check_channels, columns_wanted};
use crate::app::job::readings::{readings_of, stated_readings};
use crate::app::job::same_name::is_same_name;
use crate::app::job::table::read_table;
use crate::app::job::{Job, JobGauge, NamedFile};
use crate::finding::few;
use crate::series::SeriesError;
use crate::series::record::{Options, Record, is_format, open_record};
use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;

/// A whole strain file in memory, its channels put right as `[[correction]]` says; `wanted`: its [`wanted_columns`]. Long histories are better
/// streamed.
///
/// # Errors
/// Every fault: no `run` or `time` column, fields that are no numbers, runs named twice, times that don't ascend.
pub fn read_strain(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
    wanted: &[String],
) -> Result<StrainTable, Faults> {
    let mut table = strain_as_read(inputs, job, named, wanted)?;
    check_corrected(job, named, &table.gauges)?;
    table.put_right(&job.corrections);
    table.leave_out(&job.reserved);
    Ok(table)
}

/// Refuses corrections of channels that the job's strain file lacks, where nothing else names the channels.
pub(in crate::app) fn check_corrected(
    job: &Job,
    named: &NamedFile,
    columns: &[String],
) -> Result<(), Faults> {
    let measured = job.measured.as_ref();
    let is_own = measured.is_some_and(|m| m.strain.given == named.given);
    if job.sensitivity.is_some() || !is_own {
        return Ok(());
    }
    check_channels(job, columns, &format!("`{}`", named.given))
}

/// The file as it stands.
fn strain_as_read(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
    wanted: &[String],
) -> Result<StrainTable, Faults> {
    let bytes = inputs.read_named(job, named).map_err(Faults::from)?;
    if is_format(&bytes) {
        return strain_from_record(&named.given, bytes, wanted);
    }
    let text = inputs.read_named_text(job, named).map_err(Faults::from)?;
    strain_from_text(&named.given, &text, wanted)
}

/// Names of the columns that the readings of the job's gauges are taken from; none where the job doesn't tell its gauges. Where a given S
/// names them, its whole table is read for it: once a question will do.
pub fn wanted_columns(inputs: &mut Inputs, job: &Job) -> Vec<String> {
    let mut names = gauge_names(inputs, job);
    names.extend(job.reserved.iter().cloned());
    columns_wanted(&job.corrections, &names)
}

/// Readings of the job's gauges that a strain file has no column of. A rosette may have one column of its own name in place of its legs.
pub fn without_column(inputs: &mut Inputs, job: &Job, columns: &[String]) -> Vec<String> {
    let known: HashSet<&String> = columns.iter().collect();
    let has = |name: &String| known.contains(name);
    if job.gauges.is_empty() {
        let mut names = gauge_names(inputs, job);
        names.retain(|n| !has(n));
        return names;
    }
    let of_gauge = |g: &JobGauge| {
        let mut legs = readings_of(g);
        legs.retain(|leg| !has(leg) && !has(&g.name));
        legs
    };
    job.gauges.iter().flat_map(of_gauge).collect()
}

/// Names of the job's gauges: those it states, legs of rosettes by theirs, else the rows of a given S; none where neither tells. A table of S
/// that can't be read is a fault of whoever asks for S.
pub fn gauge_names(inputs: &mut Inputs, job: &Job) -> Vec<String> {
    let mut names: Vec<String> = job.gauges.iter().map(|g| g.name.clone()).collect();
    // A rosette is called by its own name too where S comes from a table.
    let own: HashSet<&str> = job.gauges.iter().map(|g| g.name.as_str()).collect();
    let legs = stated_readings(job).into_iter();
    names.extend(legs.filter(|r| !own.contains(r.as_str())));
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

/// Returns the fault of a strain file without a column of a gauge. Where a table of S alone names the gauges, either file may be wrong.
pub fn no_gauge_column(job: &Job, file: &str, columns: &[String], gauges: &[String]) -> Fault {
    let (wrong, remedy) = match &job.sensitivity {
        Some(s) if job.gauges.is_empty() => (
            format!("no column is named after a gauge of `{}`", s.file.given),
            "call the gauges alike in both tables",
        ),
        _ => (
            "no column is named after a gauge of the job".to_owned(),
            "name the columns after the gauges",
        ),
    };
    let alike = gauges.iter().filter_map(|g| {
        let column = columns.iter().find(|c| is_same_name(c, g))?;
        Some(format!("`{column}` and `{g}`"))
    });
    let alike: Vec<String> = alike.collect();
    if !alike.is_empty() {
        let wrong = format!(
            "{wrong}; columns and gauges differ by case or separators: {}",
            few(&alike)
        );
        return Fault::at(
            file,
            1,
            "gauge",
            wrong,
            "write the names alike in both tables",
        );
    }
    let wrong = match columns.is_empty() {
        true => format!("{wrong}; the file has no column of numbers"),
        false => format!("{wrong}; its columns are {}", few(columns)),
    };
    Fault::at(file, 1, "gauge", wrong, remedy)
}

/// A record that is read whole or passed over: its columns of strain, each with its name, as `gauges` are called, and microstrain in one of
/// its unit.
pub(in crate::app) fn open_strain(
    file: &str,
    bytes: FileBytes,
    gauges: &[String],
) -> Result<(Record, Vec<(usize, String, f64)>), Faults> {
    let options = Options {
        wanted: gauges.to_vec(),
        ..Options::default()
    };
    let record =
        open_record(Arc::new(bytes), &options).map_err(|e| Faults::from(record_fault(file, &e)))?;
    let columns = find_gauge_columns(file, record.columns(), gauges)?
        .into_iter()
        .enumerate()
        .filter_map(|(i, c)| Some((i, c.name, c.microstrain?)))
        .collect();
    Ok((record, columns))
}

/// The fault of a record that can't be read.
pub fn record_fault(file: &str, e: &SeriesError) -> Fault {
    let (wrong, remedy) = e.parts();
    match e {
        SeriesError::Line { line, what, remedy } => {
            Fault::at(file, *line as u32, "row", what, *remedy)
        }
        SeriesError::NotAscending { line, .. } | SeriesError::NoTime { line } => {
            Fault::at(file, *line as u32, "time", wrong, remedy)
        }
        SeriesError::Empty => Fault::at(
            file,
            1,
            "rows",
            "a header and no rows",
            "write a row a sample",
        ),
        SeriesError::NoRate => Fault::at(
            file,
            1,
            "time",
            "no column `time`",
            "add a column `time` in seconds",
        ),
        _ => Fault::of(file, "record", wrong, remedy),
    }
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
