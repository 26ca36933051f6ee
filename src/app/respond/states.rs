//! Load states: a table that `recover` wrote, or the job's static runs recovered here.

use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::table::{Table, each_part};
use crate::app::job::unread::unread_columns;
use crate::app::job::{Job, JobLoad, NamedFile};
use crate::app::recover::recovered_runs;
use crate::app::strain::{LoadUnits, Prepared, load_units};
use crate::app::work::Work;
use crate::finding::{Finding, Severity};
use crate::recovery::{NORMAL_95, beyond_expected};
use crate::respond::{LoadState, Spread};
use crate::units::Quantity;

/// Rows of the table whose fields are in memory at a time.
const PART: usize = 10_000;

/// The states of the job.
///
/// # Errors
/// Neither loads nor measured strain; tables that can't be read.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    prepared: &Prepared,
) -> Result<Vec<LoadState>, Faults> {
    if let Some(named) = &job.respond.loads {
        return from_table(work, job, named);
    }
    let Some(measured) = job.measured.as_ref().filter(|_| !job.gauges.is_empty()) else {
        return Err(Faults::from(Fault::at(
            &*job.file,
            job.respond.line,
            "respond.loads",
            "the job names no loads and has no measured strain at gauges",
            "name the table that `recover` wrote: [respond] loads = \"job.out/loads.csv\"",
        )));
    };
    let (_, recovery) = recovered_runs(work, job, measured, prepared)?;
    Ok(recovery
        .runs
        .into_iter()
        .map(|r| {
            // The Birge factor and Student's t of the interval count as a wider sigma.
            let widen = (r.estimate.coverage_factor / NORMAL_95).powi(2);
            LoadState {
                label: r.estimate.run,
                values: r.estimate.values,
                spread: Spread::Covariance(
                    r.estimate.covariance.iter().map(|c| c * widen).collect(),
                ),
            }
        })
        .collect())
}

/// Columns `<load>`, and where there `<load>.low`, `<load>.high`, in report units, as `recover` writes them.
pub(super) fn from_table(
    work: &mut Work,
    job: &Job,
    named: &NamedFile,
) -> Result<Vec<LoadState>, Faults> {
    let text = work
        .inputs
        .read_named_text(job, named)
        .map_err(Faults::from)?;
    let names: Vec<String> = job.loads.iter().map(|l| l.name.clone()).collect();
    let units = load_units(job, &names);
    let mut faults = FaultList::new();
    let mut columns: Option<Columns> = None;
    let mut unread = None;
    let mut states = Vec::new();
    let mut blank = 0_usize;
    let mut before = None;
    each_part(&named.given, &text, PART, &mut |part| {
        let columns = columns.get_or_insert_with(|| {
            unread = unread_loads(&part, job, &names);
            Columns::of(&part, job, &names, &mut faults)
        });
        for row in 0..part.rows.len() {
            faults.extend(columns.out_of_order(&part, row, &mut before));
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
    if states.is_empty() {
        return Err(Faults::from(Fault::of(
            &*named.given,
            "loads",
            "no row with all loads",
            "give a row a run or a sample",
        )));
    }
    if blank > 0 {
        work.findings.push(
            Finding::new(
                Severity::Warning,
                "states-left-out",
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
    let exact = columns.map_or_else(Vec::new, |c| c.without_interval);
    work.findings.push(Finding::new(
        Severity::Info,
        "load-errors-independent",
        &named.given,
        if exact.is_empty() {
            "a table of intervals holds no correlations between loads: their errors are taken as independent".to_owned()
        } else {
            format!("{} have no interval in the table and count as exact", exact.join(", "))
        },
        "let `respond` recover the runs itself ([measured], no [respond] loads) to keep correlations",
    ));
    Ok(states)
}

/// Returns the warning of columns of a table of loads that nothing reads. Sums of loads, which `recover` writes too, are known.
fn unread_loads(t: &Table, job: &Job, names: &[String]) -> Option<Finding> {
    let key = t.column(&KEYS).unwrap_or(0);
    let sums = job.combinations.iter().map(|c| &c.name);
    let known: Vec<String> = names
        .iter()
        .chain(sums)
        .flat_map(|n| ["", ".low", ".high"].map(|end| format!("{n}{end}")))
        .collect();
    let is_read = |c: usize| c == key || known.contains(&t.header[c]);
    let lacking = known.iter().filter(|n| !t.header.contains(n));
    let lacking: Vec<&str> = lacking.map(String::as_str).collect();
    unread_columns(t, is_read, &lacking)
}

/// Names of the column with the run or the time of a row.
const KEYS: [&str; 4] = ["run", "time", "t", "state"];

/// Where in the table the loads stand.
struct Columns {
    key: usize,
    /// Whether the rows are samples of a record.
    is_record: bool,
    /// Of each load its value and its interval.
    loads: Vec<(usize, Option<(usize, usize)>)>,
    /// Of each load what it measures, and SI units of one report unit.
    sizes: Vec<(Option<Quantity>, f64)>,
    without_interval: Vec<String>,
}

impl Columns {
    fn of(t: &Table, job: &Job, names: &[String], faults: &mut FaultList) -> Self {
        let unit = |l: &JobLoad| l.report_unit(&job.report_units).map_or(1.0, |u| u.si);
        let sizes = job.loads.iter().map(|l| (l.quantity(), unit(l)));
        let key = t.column(&KEYS).unwrap_or(0);
        let named = t.header.get(key).map(String::as_str);
        let mut out = Self {
            key,
            is_record: matches!(named, Some("time" | "t")),
            loads: Vec::new(),
            sizes: sizes.collect(),
            without_interval: Vec::new(),
        };
        for name in names {
            let of = |suffix: &str| t.column(&[&format!("{name}{suffix}")]);
            let Some(c) = of("") else {
                faults.push(Fault::at(
                    &*t.file,
                    1,
                    name.clone(),
                    format!("no column `{name}`"),
                    "name the columns after the loads of the job",
                ));
                continue;
            };
            let interval = of(".low").zip(of(".high"));
            if interval.is_none() {
                out.without_interval.push(name.clone());
            }
            out.loads.push((c, interval));
        }
        out
    }

    /// A fault where the time of a row is no number, or not later than that of the row before.
    fn out_of_order(&self, t: &Table, row: usize, before: &mut Option<f64>) -> Option<Fault> {
        if !self.is_record {
            return None;
        }
        let time = match t.number(row, self.key) {
            Ok(time) => time?,
            Err(fault) => return Some(fault),
        };
        let last = before.replace(time).filter(|last| time <= *last)?;
        let line = t.rows.get(row).map_or(0, |r| r.0);
        let wrong = format!("time {time} after {last}");
        let remedy = "write samples in order of time, each once";
        Some(Fault::at(&*t.file, line, "time", wrong, remedy))
    }

    /// The state of a row; `None` where it lacks a load.
    fn state(
        &self,
        t: &Table,
        row: usize,
        units: &[LoadUnits],
        faults: &mut FaultList,
    ) -> Option<LoadState> {
        let mut number = |c: usize, size: (Option<Quantity>, f64)| {
            t.size(row, c, size).unwrap_or_else(|f| {
                faults.push(f);
                None
            })
        };
        let (mut values, mut sigma) = (Vec::new(), Vec::new());
        let mut reversed = None;
        for (((c, interval), u), size) in self.loads.iter().zip(units).zip(&self.sizes) {
            values.push(number(*c, *size)? / u.factor);
            sigma.push(match interval {
                Some((low, high)) => match (number(*low, *size), number(*high, *size)) {
                    (Some(l), Some(h)) => {
                        reversed = reversed.or((l > h).then_some(*low));
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
            faults.push(Fault::at(&*t.file, line, name, wrong, remedy));
        }
        let label = t.rows.get(row).and_then(|r| r.1.get(self.key));
        Some(LoadState {
            label: label.cloned().unwrap_or_default(),
            values,
            spread: Spread::Sigma(sigma),
        })
    }
}
