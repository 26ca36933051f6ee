//! Load states: a table that `recover` wrote, or the job's static runs recovered here.

use super::record_states;
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::table::{Table, each_part};
use crate::job::unread_columns::unread_columns;
use crate::job::{Job, NamedFile, Runs};
use crate::measured::runs_columns::{known_column, take_units_of};
use crate::recovery::beyond_expected;
use crate::respond::{LoadState, Spread};
use crate::series::record::{Column, is_format, is_time, name_and_unit};
use crate::strain_chain::{JobSensitivity, LoadUnits, load_units};
use crate::units::Quantity;
use crate::workflow::recover::recovered_runs;
use std::collections::HashSet;

/// Rows of the table whose fields are in memory at a time.
const PART: usize = 10_000;

/// Load states. They state whether they are consecutive in time.
pub(super) struct States {
    pub states: Vec<LoadState>,
    pub is_history: bool,
}

/// Returns the states of the job.
///
/// # Errors
/// Neither loads nor measured strain; tables that can't be read.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    prepared: &JobSensitivity,
) -> Result<States, Faults> {
    if let Some(named) = &job.respond.loads {
        return from_table(work, job, named);
    }
    let Some(measured) = job.measured.as_ref().filter(|_| !job.gauges.is_empty()) else {
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            job.respond.line,
            "respond.loads",
            "the job names no loads and has no measured strain at gauges",
            "name the table that `recover` wrote: [respond] loads = \"job.out/loads.csv\"",
        )));
    };
    let (_, recovery) = recovered_runs(work, job, measured, prepared)?;
    let states = recovery.runs.into_iter();
    let states = states
        .map(|r| {
            // The Birge factor and Student's t of the interval widen sigma.
            let widen = (r.estimate.coverage_factor / NORMAL_95).powi(2);
            LoadState {
                label: r.estimate.run,
                values: r.estimate.values,
                spread: Spread::Covariance(
                    r.estimate.covariance.iter().map(|c| c * widen).collect(),
                ),
            }
        })
        .collect();
    Ok(States {
        states,
        is_history: false,
    })
}

/// Reads the columns `<load>` and, if present, `<load>.low` and `<load>.high`, in report units, as `recover` writes them.
pub(super) fn from_table(work: &mut Work, job: &Job, named: &NamedFile) -> Result<States, Faults> {
    let names: Vec<String> = job.loads.iter().map(|l| l.name.clone()).collect();
    let bytes = work.inputs.read_named(job, named)?;
    if is_format(&bytes) {
        let (states, left_out) = record_states::read(work, job, named, bytes, &names)?;
        let states = finish(work, job, (named, &names), states, left_out)?;
        return Ok(States {
            states,
            is_history: true,
        });
    }
    drop(bytes);
    let text = work
        .inputs
        .read_named_text(job, named)
        .map_err(Faults::from)?;
    let units = load_units(job, &names);
    let mut faults = FaultList::new();
    let mut columns: Option<Columns> = None;
    let mut unread = None;
    let mut states = Vec::new();
    let mut blank = 0_usize;
    let mut keys = KeysRead::default();
    each_part(&named.given, &text, PART, &mut |part| {
        let columns = columns.get_or_insert_with(|| {
            let mut header = Table {
                file: part.file.clone(),
                header: part.header.clone(),
                rows: Vec::new(),
            };
            let read = take_units_of(&mut work.inputs, job, named, &mut header);
            unread = unread_loads((&part, &read), job, &names);
            Columns::find_in_table((&part, &read), job, named, &mut faults)
        });
        for row in 0..part.rows.len() {
            faults.extend(columns.wrong_key(&part, row, &mut keys));
            match columns.state(&part, row, &units, &mut faults) {
                Some(state) => states.push(state),
                None => blank += 1,
            }
        }
    })?;
    if let Some(unread) = unread {
        work.inputs.note(&named.given, unread);
    }
    Faults::check(faults)?;
    let is_history = columns.as_ref().is_some_and(|c| c.kind == Key::Time);
    let exact = columns.map_or_else(Vec::new, |c| c.without_interval);
    let states = finish(work, job, (named, &exact), states, blank)?;
    Ok(States { states, is_history })
}

/// Adds the findings on the states of a file. `exact` are loads without an interval, and `blank` is the number of rows that lack a load.
///
/// # Errors
/// A fault if the file contains no state.
fn finish(
    work: &mut Work,
    job: &Job,
    (named, exact): (&NamedFile, &[String]),
    states: Vec<LoadState>,
    blank: usize,
) -> Result<Vec<LoadState>, Faults> {
    if states.is_empty() {
        return Err(Faults::from(Fault::new(
            &*named.given,
            "loads",
            "no row with all loads",
            "give one row for each run or sample",
        )));
    }
    if blank > 0 {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "load-states-skipped",
                &named.given,
                format!("{blank} rows lack a load and are left out"),
                "fill them, or cut the record",
            )
            .with_numbers(blank as f64, 0.0),
        );
    }
    for (l, load) in job.loads.iter().enumerate() {
        let values = states.iter().filter_map(|s| s.values.get(l).copied());
        let found = beyond_expected(&load.name, load.expected, values);
        work.findings.extend(found);
    }
    work.findings.push(Finding::new(
        Severity::Info,
        "load-errors-independent",
        &named.given,
        if exact.is_empty() {
            "a table of intervals contains no correlations between loads: their errors are treated as independent".to_owned()
        } else {
            format!("{} have no interval in the file and are treated as exact", exact.join(", "))
        },
        "let `respond` recover the runs itself ([measured], no [respond] loads) to keep correlations",
    ));
    Ok(states)
}

/// Returns the warning on columns of a table of loads that no command reads. Sums of loads, which `recover` also writes, are not reported.
fn unread_loads((t, columns): (&Table, &[Column]), job: &Job, names: &[String]) -> Option<Finding> {
    let key = key_of(t).0;
    let sums = job.combinations.iter().map(|c| &c.name);
    let known: Vec<String> = names
        .iter()
        .chain(sums)
        .flat_map(|n| ["", ".low", ".high"].map(|end| format!("{n}{end}")))
        .collect();
    let is_called = |c: &Column, n: &String| c.header.whole == *n || c.name == *n;
    let is_read = |c: usize| c == key || known.iter().any(|n| is_called(&columns[c], n));
    let lacking = known.iter();
    let lacking = lacking.filter(|n| !columns.iter().any(|c| is_called(c, n)));
    let lacking: Vec<&str> = lacking.map(String::as_str).collect();
    unread_columns(t, is_read, &lacking)
}

/// Names of the column with the run or the time of a row.
const KEYS: [&str; 4] = ["run", "time", "t", "state"];

/// Kind of the key of a row.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Key {
    Run,
    Time,
    /// The first column, whatever it contains.
    Label,
}

/// Keys of the rows so far.
#[derive(Default)]
struct KeysRead {
    runs: HashSet<String>,
    time: Option<f64>,
}

/// Returns the number of the column with the run or the time of a row.
fn key_of(t: &Table) -> (usize, Key) {
    let is_time = |header: &str, first| is_time(&name_and_unit(header).name, first);
    let named = t.column(&KEYS);
    let mut headers = t.header.iter().enumerate();
    let of_time = headers.find(|(c, h)| is_time(h, *c == 0)).map(|(c, _)| c);
    let key = named.or(of_time).unwrap_or(0);
    match t.header.get(key) {
        Some(header) if is_time(header, key == 0) => (key, Key::Time),
        _ if named.is_some() => (key, Key::Run),
        _ => (key, Key::Label),
    }
}

/// Columns of the table of loads.
struct Columns {
    key: usize,
    kind: Key,
    /// Value and interval columns of each load.
    loads: Vec<LoadColumns>,
    without_interval: Vec<String>,
}

/// Columns of a load: its value, and the ends of its interval if the table has them.
struct LoadColumns {
    value: QuantityColumn,
    interval: Option<[QuantityColumn; 2]>,
}

/// Column with its quantity, the SI units of one of its numbers, and the number of report units in one of its numbers.
#[derive(Clone, Copy)]
struct QuantityColumn {
    at: usize,
    size: (Option<Quantity>, f64),
    in_report_units: f64,
}

impl Columns {
    fn find_in_table(
        (t, columns): (&Table, &[Column]),
        job: &Job,
        named: &NamedFile,
        faults: &mut FaultList,
    ) -> Self {
        let runs = Runs::in_report_units(named.clone(), "respond", job.report_units);
        let (key, kind) = key_of(t);
        let mut out = Self {
            key,
            kind,
            loads: Vec::new(),
            without_interval: Vec::new(),
        };
        for load in &job.loads {
            let (name, quantity) = (&load.name, load.quantity());
            let report = load.report_unit(&job.report_units).map_or(1.0, |u| u.si);
            let mut of = |name: &str| {
                let found = known_column(job, &runs, t, columns, name, quantity, faults)?;
                let si = found.unit.map_or(1.0, |u| u.si);
                Some(QuantityColumn {
                    at: found.at,
                    size: (quantity, si),
                    in_report_units: si / report,
                })
            };
            let value = of(name);
            let ends = [".low", ".high"].map(|end| of(&format!("{name}{end}")));
            let Some(value) = value else {
                faults.push(Fault::with_line(
                    &*t.file,
                    1,
                    name.clone(),
                    format!("no column `{name}`"),
                    "name the columns after the loads of the job",
                ));
                continue;
            };
            let [low, high] = ends;
            let interval = low.zip(high).map(|(low, high)| [low, high]);
            if interval.is_none() {
                out.without_interval.push(name.clone());
            }
            out.loads.push(LoadColumns { value, interval });
        }
        out
    }

    /// Returns a fault if a run has two rows, or if the time of a row is missing or not later than the time before.
    fn wrong_key(&self, t: &Table, row: usize, before: &mut KeysRead) -> Option<Fault> {
        let (line, fields) = t.rows.get(row)?;
        let (field, wrong, remedy) = match self.kind {
            Key::Label => return None,
            Key::Run => {
                let run = fields.get(self.key).map_or("", String::as_str);
                if before.runs.insert(run.to_owned()) {
                    return None;
                }
                let wrong = format!("run `{run}` has two rows");
                ("run", wrong, "give every run its own name")
            }
            Key::Time => {
                let remedy = "write samples in order of time, each once";
                let time = match t.number(row, self.key) {
                    Ok(time) => time,
                    Err(fault) => return Some(fault),
                };
                match time {
                    None => ("time", "the time is missing".to_owned(), remedy),
                    Some(time) => {
                        let last = before.time.replace(time).filter(|last| time <= *last)?;
                        ("time", format!("time {time} after {last}"), remedy)
                    }
                }
            }
        };
        Some(Fault::with_line(&*t.file, *line, field, wrong, remedy))
    }

    /// Returns the state of a row; `None` if the row lacks a load.
    fn state(
        &self,
        t: &Table,
        row: usize,
        units: &[LoadUnits],
        faults: &mut FaultList,
    ) -> Option<LoadState> {
        let mut number = |c: QuantityColumn| {
            let found = t.size(row, c.at, c.size).unwrap_or_else(|f| {
                faults.push(f);
                None
            });
            found.map(|x| x * c.in_report_units)
        };
        let (mut values, mut sigma) = (Vec::new(), Vec::new());
        let mut reversed = None;
        for (LoadColumns { value, interval }, u) in self.loads.iter().zip(units) {
            values.push(number(*value)? / u.factor);
            sigma.push(match interval {
                Some([low, high]) => match (number(*low), number(*high)) {
                    (Some(l), Some(h)) => {
                        reversed = reversed.or((l > h).then_some(low.at));
                        (h - l) / (2.0 * NORMAL_95) / u.factor
                    }
                    _ => 0.0,
                },
                None => 0.0,
            });
        }
        if let Some(low) = reversed {
            let line = t.rows.get(row).map_or(0, |r| r.0);
            let name = t.header.get(low).map_or("", String::as_str);
            let remedy = "take the table as `recover` wrote it";
            let wrong = "the low end of this interval is above its high end";
            faults.push(Fault::with_line(&*t.file, line, name, wrong, remedy));
        }
        let label = t.rows.get(row).and_then(|r| r.1.get(self.key));
        Some(LoadState {
            label: label.cloned().unwrap_or_default(),
            values,
            spread: Spread::Sigma(sigma),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::table::read_table;

    fn wrong_keys(text: &str) -> Vec<String> {
        let t = read_table("loads.csv", text).unwrap();
        let (key, kind) = key_of(&t);
        let columns = Columns {
            key,
            kind,
            loads: Vec::new(),
            without_interval: Vec::new(),
        };
        let mut before = KeysRead::default();
        let rows = 0..t.rows.len();
        rows.filter_map(|row| columns.wrong_key(&t, row, &mut before))
            .map(|f| format!("{}: {}", f.line.unwrap(), f.wrong))
            .collect()
    }

    #[test]
    fn a_run_has_one_row_and_a_history_each_time_once() {
        for (text, expected) in [
            (
                "run,A\nR1,1\nR2,2\nR1,3\n",
                vec!["4: run `R1` has two rows"],
            ),
            ("state,A\nR1,1\nR1,1\n", vec!["3: run `R1` has two rows"]),
            ("run,A\nR1,1\nR2,1\n", vec![]),
            (
                "time,A\n0,1\n0.01,2\n0.01,3\n",
                vec!["4: time 0.01 after 0.01"],
            ),
            ("time [s],A\n0,1\n0,2\n", vec!["3: time 0 after 0"]),
            ("A,t\n1,1\n2,0.5\n", vec!["3: time 0.5 after 1"]),
            ("time,A\n0,1\n,2\n", vec!["3: the time is missing"]),
            // Rows without a name may have equal loads.
            ("A,B\n1,1\n1,2\n", vec![]),
        ] {
            assert_eq!(wrong_keys(text), expected, "{text}");
        }
    }
}
