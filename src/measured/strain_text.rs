//! Strain in a CSV text: a row a run or a sample.

use super::gauge_columns::{find_gauge_columns, no_strain};
use super::runs_columns::take_units;
use super::strain_table::{StrainRows, StrainTable};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::job::suggest::header_remedy;
use crate::job::table::{Table, each_part};
use crate::series::record::{Clash, Column, seconds_in};
use std::collections::HashSet;

/// Rows whose fields are in memory at a time.
const PART: usize = 10_000;

/// Reads the strain in a CSV text. Units are after the names or in a row below them; without a unit, numbers are microstrain. A column with the whole
/// name of one of `gauges` belongs to that gauge. Without known gauges, every column may be a gauge.
///
/// # Errors
/// Every fault: no `run` or `time` column, gauge units other than strain, fields without a number, repeated run names, times that don't ascend.
pub fn strain_from_text(file: &str, text: &str, gauges: &[String]) -> Result<StrainTable, Faults> {
    let mut reading: Option<Result<Reading, Faults>> = None;
    each_part(file, text, PART, &mut |mut part| {
        let reading = reading.get_or_insert_with(|| {
            let headers = take_units(&mut part);
            Reading::from_table(&part, &headers, gauges)
        });
        if let Ok(reading) = reading {
            reading.add(&part);
        }
    })?;
    match reading {
        Some(Ok(reading)) => reading.finish(file),
        Some(Err(faults)) => Err(faults),
        None => Err(no_rows(file).into()),
    }
}

/// The number in a field, not a number where it is blank or none.
fn number(t: &Table, row: usize, column: usize, faults: &mut FaultList) -> f64 {
    match t.number(row, column) {
        Ok(value) => value.unwrap_or(f64::NAN),
        Err(fault) => {
            faults.push(fault);
            f64::NAN
        }
    }
}

fn no_rows(file: &str) -> Fault {
    Fault::with_line(
        file,
        1,
        "rows",
        "the file has a header and no rows",
        "write one row for each run or sample",
    )
}

/// Content of a file read so far.
struct Reading {
    key: usize,
    /// Seconds in one unit of the times.
    second: f64,
    /// Columns of strain, and microstrain in one unit of each.
    columns: Vec<(usize, f64)>,
    gauges: Vec<String>,
    is_runs: bool,
    runs: Vec<String>,
    seen: HashSet<String>,
    times: Vec<f64>,
    microstrain: Vec<f64>,
    ascends: bool,
    faults: FaultList,
}

impl Reading {
    fn from_table(t: &Table, headers: &[Column], known: &[String]) -> Result<Self, Faults> {
        let run = headers.iter().position(|c| c.name == "run");
        let mut times = headers.iter().enumerate();
        let time = times.find(|(i, c)| c.is_time(*i == 0)).map(|t| t.0);
        // In a record, a channel `Run` does not contain names of runs.
        let any_case = || headers.iter().position(Column::is_run);
        let run = run.or_else(|| if time.is_none() { any_case() } else { None });
        let Some(key) = run.or(time) else {
            return Err(Faults::from(Fault::with_line(
                &*t.file,
                1,
                "run",
                "the file has no column `run` and no column `time`",
                header_remedy(
                    "run",
                    t.header.iter().map(String::as_str),
                    "add `run` with the runs' names, or `time` in seconds",
                ),
            )));
        };
        let clashing = headers.get(key).filter(|c| c.clash() == Some(Clash::Size));
        if let Some(column) = clashing.filter(|_| run.is_none()) {
            let remedy = "correct the wrong one";
            let wrong = column.clash_words();
            return Err(Fault::with_line(&*t.file, 1, "time", wrong, remedy).into());
        }
        let unit = headers.get(key).map_or("", |c| c.unit.as_str());
        let second = match run {
            Some(_) => 1.0,
            None => seconds_in(unit).ok_or_else(|| {
                let wrong = format!("`{unit}` is not a unit of time");
                Faults::from(Fault::with_line(
                    &*t.file,
                    1,
                    "time",
                    wrong,
                    "give times in s or ms",
                ))
            })?,
        };
        let mut faults = FaultList::new();
        let (mut places, mut others) = (Vec::new(), Vec::new());
        for (c, column) in headers.iter().enumerate().filter(|(c, _)| *c != key) {
            places.push(c);
            others.push(column.clone());
        }
        let (mut columns, mut gauges) = (Vec::new(), Vec::new());
        let found = find_gauge_columns(&t.file, &others, known)?;
        for ((c, column), found) in places.into_iter().zip(&others).zip(found) {
            if found.microstrain.is_none() && known.is_empty() {
                faults.push(no_strain(&t.file, column));
            }
            gauges.push(found.name);
            // Values of a column that is not a gauge are kept as written.
            columns.push((c, found.microstrain.unwrap_or(1.0)));
        }
        Faults::check(faults)?;
        Ok(Self {
            key,
            second,
            gauges,
            columns,
            is_runs: run.is_some(),
            runs: Vec::new(),
            seen: HashSet::new(),
            times: Vec::new(),
            microstrain: Vec::new(),
            ascends: true,
            faults: FaultList::new(),
        })
    }

    fn add(&mut self, t: &Table) {
        let faults = &mut self.faults;
        for (row, (line, fields)) in t.rows.iter().enumerate() {
            for (c, scale) in &self.columns {
                self.microstrain.push(number(t, row, *c, faults) * scale);
            }
            if self.is_runs {
                let name = fields.get(self.key).cloned().unwrap_or_default();
                if !self.seen.insert(name.clone()) {
                    let wrong = format!("run `{name}` occurs twice");
                    let remedy = "give every run a separate name";
                    faults.push(Fault::with_line(&*t.file, *line, "run", wrong, remedy));
                }
                self.runs.push(name);
            } else {
                let time = number(t, row, self.key, faults) * self.second;
                if self.ascends
                    && let Some(before) = self.times.last()
                    && !(time > *before)
                {
                    self.ascends = false;
                    let wrong = format!("time {time} after {before}");
                    let remedy = "write samples in order of time";
                    faults.push(Fault::with_line(&*t.file, *line, "time", wrong, remedy));
                }
                self.times.push(time);
            }
        }
    }

    fn finish(self, file: &str) -> Result<StrainTable, Faults> {
        if self.runs.is_empty() && self.times.is_empty() && self.faults.is_empty() {
            return Err(no_rows(file).into());
        }
        Faults::check(self.faults)?;
        Ok(StrainTable {
            file: file.to_owned(),
            gauges: self.gauges,
            rows: if self.is_runs {
                StrainRows::Runs(self.runs)
            } else {
                StrainRows::Times(self.times)
            },
            microstrain: self.microstrain,
        })
    }
}
