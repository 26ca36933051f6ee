//! Strain in a CSV text: a row a run or a sample.

use super::column_unit::{no_strain, take_units};
use super::strain_table::{StrainRows, StrainTable};
use super::table::{Table, each_part};
use crate::app::fault::{Fault, FaultList, Faults};
use crate::series::record::{Column, is_time, name_and_unit, seconds_in};
use crate::units::microstrain_in;
use std::collections::HashSet;

/// Rows whose fields are in memory at a time.
const PART: usize = 10_000;

/// The strain in a CSV text. Units stand beside the names or in a row below them; none stated is microstrain. A column named as one of
/// `gauges` in whole is that gauge's; where none are known, every column may be one.
///
/// # Errors
/// Every fault: no `run` or `time` column, units of gauges that are none of strain, fields that are no numbers, runs named twice, times
/// that don't ascend.
pub fn strain_from_text(file: &str, text: &str, gauges: &[String]) -> Result<StrainTable, Faults> {
    let mut reading: Option<Result<Reading, Faults>> = None;
    each_part(file, text, PART, &mut |mut part| {
        let reading = reading.get_or_insert_with(|| {
            let headers = take_units(&mut part);
            Reading::of(&part, &headers, gauges)
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

/// What tables of strain hold beside strain, and strain before it is scaled. Single letters are left out: `SG1 (t)` is the top one.
const OTHER_UNITS: &[&str] = &[
    "mv/v", "v/v", "uv/v", "µv/v", "mv", "volt", "volts", "kn", "mn", "lbf", "kip", "kgf", "kg",
    "mm", "cm", "pa", "kpa", "mpa", "gpa", "psi", "n/mm2", "n/mm²", "m/s2", "m/s²", "deg", "°",
    "°c", "degc", "°f", "%", "hz", "bar", "counts",
];

/// Which names are whose.
struct Names<'a> {
    /// The job's gauges; none where it doesn't tell.
    known: HashSet<&'a str>,
    /// Headers of the table.
    headers: HashSet<&'a str>,
}

/// The gauge that a column is named after, and microstrain in one of its unit; `None` where a gauge's unit is none of strain. What looks like
/// a unit may be part of a name: `SG1 (left)`.
fn gauge_of<'a>(header: &'a str, column: &'a Column, names: &Names) -> Option<(&'a str, f64)> {
    let scale = microstrain_in(&column.unit);
    let is_known = |name: &str| names.known.contains(name);
    let beside = name_and_unit(header);
    let is_below = column.unit != beside.unit;
    if is_known(header) {
        // Its own unit, if any, is the one in the row below or a unit of strain in its brackets.
        return match scale {
            None if is_below => None,
            _ => Some((header, scale.unwrap_or(1.0))),
        };
    }
    let is_gauge = if names.known.is_empty() {
        let unit = column.unit.to_lowercase();
        is_below || header.ends_with(']') || OTHER_UNITS.contains(&unit.as_str())
    } else {
        // `P01 (raw)` beside `P01` is another column.
        is_known(&beside.name) && !names.headers.contains(beside.name.as_str())
    };
    match scale {
        // What stands in brackets is not what the row of units says.
        Some(_) if column.name != beside.name && is_known(&beside.name) && is_gauge => None,
        Some(scale) => Some((column.name.as_str(), scale)),
        None if is_gauge => None,
        None => Some((header, 1.0)),
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
    /// Seconds in one of the times.
    second: f64,
    /// Columns of strain, and microstrain in one of each.
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
    fn of(t: &Table, headers: &[Column], known: &[String]) -> Result<Self, Faults> {
        let run = headers.iter().position(|c| c.name == "run");
        let mut times = headers.iter().enumerate();
        let time = times.find(|(i, c)| is_time(&c.name, *i == 0)).map(|t| t.0);
        let Some(key) = run.or(time) else {
            return Err(Faults::from(Fault::at(
                &*t.file,
                1,
                "run",
                "no column `run` and no column `time`",
                "add `run` with the runs' names, or `time` in seconds",
            )));
        };
        let unit = headers.get(key).map_or("", |c| c.unit.as_str());
        let second = match run {
            Some(_) => 1.0,
            None => seconds_in(unit).ok_or_else(|| {
                let wrong = format!("`{unit}` is no unit of time");
                Faults::from(Fault::at(
                    &*t.file,
                    1,
                    "time",
                    wrong,
                    "give times in s or ms",
                ))
            })?,
        };
        let mut faults = FaultList::new();
        let names = Names {
            known: known.iter().map(String::as_str).collect(),
            headers: t.header.iter().map(String::as_str).collect(),
        };
        let (mut columns, mut gauges) = (Vec::new(), Vec::new());
        let mut named: HashSet<&str> = HashSet::new();
        for (c, (header, column)) in t.header.iter().zip(headers).enumerate() {
            if c == key {
                continue;
            }
            let (name, scale) = gauge_of(header, column, &names).unwrap_or_else(|| {
                // Beside the name, or else in the row below.
                let beside = name_and_unit(header);
                let stated = [&beside.unit, &column.unit];
                let unit = stated.into_iter().find(|u| microstrain_in(u).is_none());
                faults.push(no_strain(
                    &t.file,
                    &beside.name,
                    unit.unwrap_or(&column.unit),
                ));
                (header.as_str(), 1.0)
            });
            if !named.insert(name) {
                let remedy = "give every column its own name";
                faults.push(Fault::at(&*t.file, 1, name, "column named twice", remedy));
            }
            gauges.push(name.to_owned());
            columns.push((c, scale));
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
                    let wrong = format!("run `{name}` stands twice");
                    let remedy = "give every run its own name";
                    faults.push(Fault::at(&*t.file, *line, "run", wrong, remedy));
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
