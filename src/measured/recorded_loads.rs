//! Loads that another instrument recorded, as runs or as a record of any format, by the job's names.

use super::faults::record_fault;
use super::open::is_record;
use super::runs_columns::{known_column, note_unread_runs};
use super::runs_file::{RunRow, given_loads, read_runs};
use crate::finding::{Finding, list_few};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::{FileBytes, Inputs};
use crate::job::table::Table;
use crate::job::{Compare, Job, Runs};
use crate::recovery::clock;
use crate::series::record::{Clock, Options, Record, open_record};
use crate::units::Quantity;
use std::ops::ControlFlow;
use std::sync::Arc;

/// Recorded loads.
pub(crate) enum RecordedLoads {
    /// Loads of static runs.
    Runs(Vec<RunRow>),
    /// Loads of a record.
    Record(Box<LoadRecord>),
}

/// A record of loads in memory, with four bytes for each number.
pub(crate) struct LoadRecord {
    /// File, as the job names it.
    pub file: String,
    /// Times of the samples.
    pub clock: Clock,
    /// Loads with a column, in the order of the names.
    pub loads: Vec<RecordedLoad>,
    /// Samples of each load, SI units. NaN if nothing was recorded.
    pub samples: Vec<Vec<f32>>,
    /// Findings on the times.
    pub findings: Vec<Finding>,
}

/// A load of a record of loads.
pub(crate) struct RecordedLoad {
    /// Load or combination of the job.
    pub name: String,
    /// Standard deviation of the noise, SI units. 0 if the job states none.
    pub noise_si: f64,
}

impl LoadRecord {
    /// Returns the seconds from the start of another record's clock to the start of this record's clock. It is 0 unless both files state absolute
    /// times.
    pub fn epoch_after(&self, other: &Clock) -> f64 {
        let both = self.clock.epoch_s.zip(other.epoch_s);
        both.map_or(0.0, |(own, other)| own - other)
    }
}

/// Reads the recorded loads of `[compare]`. `names` contains the loads and combinations of the job.
///
/// # Errors
/// A file that can't be read; units that don't fit the load or contradict the job; a file without these loads.
pub(crate) fn read_recorded(
    inputs: &mut Inputs,
    job: &Job,
    compare: &Compare,
    names: &[String],
) -> Result<RecordedLoads, Faults> {
    let runs = &compare.recorded;
    let bytes = inputs.read_named(job, &runs.file)?;
    if !is_record(&bytes) {
        return read_runs(inputs, job, runs).map(RecordedLoads::Runs);
    }
    let record = read_load_record(inputs, job, (runs, compare.time_unit_s), bytes, names)?;
    Ok(RecordedLoads::Record(Box::new(record)))
}

/// Reads a record of loads from the bytes of its file. `time_unit_s` is used if the file states no unit of time.
///
/// # Errors
/// A file that is not a record; units that don't fit the load or contradict the job; a file without the loads `names`.
pub(crate) fn read_load_record(
    inputs: &mut Inputs,
    job: &Job,
    (runs, time_unit_s): (&Runs, Option<f64>),
    bytes: FileBytes,
    names: &[String],
) -> Result<LoadRecord, Faults> {
    let file = &runs.file.given;
    let in_file = |name: &String| runs.columns.get(name).unwrap_or(name).clone();
    let options = Options {
        declared_hz: None,
        time_unit_s,
        wanted: names.iter().map(in_file).collect(),
    };
    let record = open_record(Arc::new(bytes), &options).map_err(|e| record_fault(file, &e))?;
    let header = record.columns().iter().map(|c| c.header.whole.clone());
    let table = Table {
        file: file.clone(),
        header: header.collect(),
        rows: Vec::new(),
    };
    let is_strain_file = job
        .measured
        .as_ref()
        .is_some_and(|m| m.strain.given == *file);
    if !is_strain_file {
        let given = given_loads(inputs, job)?;
        note_unread_runs(inputs, job, (&table, record.columns()), &given);
    }
    let mut faults = FaultList::new();
    let (mut loads, mut picks) = (Vec::new(), Vec::new());
    for name in names {
        let quantity = quantity_of(job, name);
        let columns = record.columns();
        let found = known_column(job, runs, &table, columns, name, quantity, &mut faults);
        let Some(found) = found else { continue };
        let noise = quantity.map_or(0.0, |q| noise_si(runs, q));
        loads.push(RecordedLoad {
            name: name.clone(),
            noise_si: noise,
        });
        picks.push((found.at, found.unit.map_or(1.0, |u| u.si)));
    }
    Faults::check(faults)?;
    if loads.is_empty() {
        let wrong = format!(
            "no column has the name of a load of the job; the columns are {}",
            list_few(&table.header)
        );
        let remedy = match runs.section {
            "respond" => "name the columns after the loads",
            _ => {
                "name the columns after the loads, or map them: [compare] columns = { \"LF.FZ\" = \"FZ_LF\" }"
            }
        };
        return Err(Fault::new(&**file, "columns", wrong, remedy).into());
    }
    Ok(LoadRecord {
        samples: samples_of(&record, &picks).map_err(|e| record_fault(file, &e))?,
        findings: clock::check_time_steps(file, &record.clock),
        clock: record.clock.clone(),
        file: file.clone(),
        loads,
    })
}

/// Returns the quantity of a load or a combination. `None` for a load set.
pub(crate) fn quantity_of(job: &Job, name: &str) -> Option<Quantity> {
    let combination = job.combinations.iter().find(|c| c.name == name);
    let first = combination.and_then(|c| c.terms.first());
    job.quantity_of_load(first.map_or(name, |term| term.0.as_str()))
}

/// Returns the stated standard deviation of recorded loads of a quantity, SI units. It is 0 if the job states none.
pub(crate) fn noise_si(runs: &Runs, quantity: Quantity) -> f64 {
    let stated = match quantity {
        Quantity::Force => runs.noise.force,
        Quantity::Moment => runs.noise.moment,
        _ => None,
    };
    stated.map_or(0.0, |noise| noise * runs.units.unit(quantity).si)
}

/// Reads columns of a record, each times a factor.
fn samples_of(
    record: &Record,
    picks: &[(usize, f64)],
) -> Result<Vec<Vec<f32>>, crate::series::SeriesError> {
    let columns: Vec<Option<usize>> = picks.iter().map(|p| Some(p.0)).collect();
    let mut out = vec![Vec::with_capacity(record.clock.samples); picks.len()];
    for piece in 0..record.n_pieces() {
        record.read(piece, &columns, &mut |block| {
            for row in block.values.chunks_exact(picks.len()) {
                for ((samples, value), pick) in out.iter_mut().zip(row).zip(picks) {
                    samples.push((value * pick.1) as f32);
                }
            }
            ControlFlow::Continue(())
        })?;
    }
    Ok(out)
}
