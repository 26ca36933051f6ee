//! Strain in a CSV text: a row a run or a sample.

use super::strain_table::{StrainRows, StrainTable};
use super::table::{Table, each_part};
use crate::app::fault::{Fault, FaultList, Faults};
use std::collections::HashSet;

/// Rows whose fields are in memory at a time.
const PART: usize = 10_000;

/// The strain in a CSV text.
///
/// # Errors
/// Every fault: no `run` or `time` column, fields that are no numbers, runs named twice, times that don't ascend.
pub fn strain_from_text(file: &str, text: &str) -> Result<StrainTable, Faults> {
    let mut reading: Option<Result<Reading, Fault>> = None;
    each_part(file, text, PART, &mut |part| {
        let reading = reading.get_or_insert_with(|| Reading::of(&part));
        if let Ok(reading) = reading {
            reading.add(&part);
        }
    })?;
    match reading {
        Some(Ok(reading)) => reading.finish(file),
        Some(Err(fault)) => Err(fault.into()),
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
    Fault::at(
        file,
        1,
        "rows",
        "a header and no rows",
        "write a row a run or a sample",
    )
}

/// What has been read so far.
struct Reading {
    key: usize,
    columns: Vec<usize>,
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
    fn of(t: &Table) -> Result<Self, Fault> {
        let run = t.column(&["run"]);
        let time = t.column(&["time", "t", "t_s", "time_s"]);
        let Some(key) = run.or(time) else {
            return Err(Fault::at(
                &*t.file,
                1,
                "run",
                "no column `run` and no column `time`",
                "add `run` with the runs' names, or `time` in seconds",
            ));
        };
        let columns: Vec<usize> = (0..t.header.len()).filter(|c| *c != key).collect();
        let names = columns.iter().filter_map(|c| t.header.get(*c));
        Ok(Self {
            key,
            gauges: names.cloned().collect(),
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
            for c in &self.columns {
                self.microstrain.push(number(t, row, *c, faults));
            }
            if self.is_runs {
                let name = fields.get(self.key).cloned().unwrap_or_default();
                if !self.seen.insert(name.clone()) {
                    let wrong = format!("run `{name}` stands twice");
                    let remedy = "give every run its own name";
                    faults.push(Fault::at(&*t.file, *line, "run", wrong, remedy));
                }
                self.runs.push(name);
            } else {
                let time = number(t, row, self.key, faults);
                if self.ascends
                    && let Some(before) = self.times.last()
                    && !(time > *before)
                {
                    self.ascends = false;
                    let wrong = format!("time {time} after {before}");
                    let remedy = "write samples in order of time";
                    faults.push(Fault::at(&*t.file, *line, "time", wrong, remedy));
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
