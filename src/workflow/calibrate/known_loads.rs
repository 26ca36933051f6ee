//! Known loads of the runs file: values, their sd, sums, repeats.

use super::payloads::{Payloads, add_columns};
use super::run_selection::RunSelection;
use crate::calibrate::KnownLoads;
use crate::finding::{Finding, Severity, list_few};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::table::{Table, read_table};
use crate::job::{HoldOut, Job, Measured, Runs};
use crate::measured::runs_columns::{
    asked_column, column_called, known_column, note_unread_runs, run_column, take_units_of,
};
use crate::sensitivity::Load;
use crate::series::record::Column;
use crate::units::{Quantity, Unit, factor, number};

/// Prior sd of a load that a run leaves unknown, in units of the largest known load of its kind. It is large, so the prior contains almost no
/// information.
const UNKNOWN: f64 = 10.0;

/// Run with known loads.
pub(super) struct LoadedRun {
    /// Row of the strain table.
    pub row: usize,
    /// Loads of the run, job units.
    pub loads: KnownLoads,
    /// Number of the group of repeats that contains the run.
    pub group: usize,
}

impl LoadedRun {
    fn new(row: usize, loads: KnownLoads, group: usize) -> Self {
        Self { row, loads, group }
    }
}

/// Runs of the runs file with known loads.
pub(super) struct KnownRuns {
    /// Calibration runs, in the order of the strain table.
    pub runs: Vec<LoadedRun>,
    /// Check runs, which are recovered and compared with their loads but not used for S.
    pub checks: Vec<LoadedRun>,
    /// Name and values of the column on which the scale may depend, one value for each run (NaN if blank).
    pub column: Option<(String, Vec<f64>)>,
}

/// A quantity of the runs file: a load or a sum of loads.
struct RunQuantity {
    name: String,
    terms: Vec<(usize, f64)>,
    value: usize,
    /// Column of the sd, job units per unit of that column, and SI units per unit of that column.
    sd: Option<(usize, f64, f64)>,
    /// Job units of one unit of the column.
    unit: f64,
    /// Sd if no column states it, job units.
    noise: f64,
    /// Quantity, and SI units per unit of the column.
    size: (Option<Quantity>, f64),
}

/// Reads the calibration runs with their loads.
///
/// # Errors
/// Columns that the job names and the file lacks, fields that are no numbers, runs without strain or without known loads.
pub(super) fn read_known(
    work: &mut Work,
    job: &Job,
    (runs, measured): (&Runs, &Measured),
    strain: &[String],
    loads: &[Load],
    origin: [f64; 2],
) -> Result<KnownRuns, Faults> {
    let text = work.inputs.read_named_text(job, &runs.file)?;
    let mut table = read_table(&runs.file.given, &text)?;
    let mut headers = take_units_of(&mut work.inputs, job, &runs.file, &mut table);
    table.check_rows()?;
    let names: Vec<String> = loads.iter().map(|l| l.name.clone()).collect();
    note_unread_runs(&mut work.inputs, job, (&table, &headers), &names);
    let payloads = add_columns(work, (job, runs), &mut table, &mut headers, loads, origin)?;
    let mut faults = FaultList::new();
    let key = run_column(job, &table, &headers)?;
    let stated = find_load_columns(job, runs, &table, &headers, loads, &mut faults);
    let place = |name: &str, key: &str, faults: &mut FaultList| {
        column(job, &table, &headers, name, key, faults)
    };
    let repeats = job.calibration.repeats.iter();
    let repeats = repeats.filter_map(|name| place(name, "calibration.repeats", &mut faults));
    let repeats: Vec<usize> = repeats.collect();
    let depends = job.calibration.depends_on.as_ref();
    let depends = depends.and_then(|name| {
        let at = place(name, "calibration.depends_on", &mut faults)?;
        Some((name.clone(), at))
    });
    let name_of = |row: usize| {
        let cell = table.rows.get(row).and_then(|r| r.1.get(key));
        cell.map_or("", String::as_str)
    };
    faults.extend(named_twice(&table, key));
    let RunSelection { asked, checks } =
        RunSelection::from_job((job, &headers), (&table, key), strain, &mut faults);
    let largest = largest_known(&table, &stated, loads.len(), &mut faults);
    let held_out = |run: &str| matches!(&measured.hold_out, HoldOut::Runs(list) if list.iter().any(|r| r == run));
    let (mut out, mut groups): (Vec<LoadedRun>, Vec<Vec<String>>) = (Vec::new(), Vec::new());
    let mut checked = Vec::new();
    let (mut values, mut partly, mut teaching) = (Vec::new(), Vec::new(), Vec::new());
    for (row, run) in strain.iter().enumerate() {
        let Some(at) = (0..table.rows.len()).find(|i| name_of(*i) == run) else {
            continue;
        };
        let listed = asked.as_ref().is_some_and(|a| a.contains(&at));
        let left_out = match asked {
            Some(_) => !listed,
            None => held_out(run),
        };
        let is_check = checks.contains(&at);
        if left_out && !is_check {
            continue;
        }
        let found = loads_of((&table, at), &stated, payloads.as_ref(), loads, &largest);
        let known = found.unwrap_or_else(|fault| {
            faults.push(fault);
            None
        });
        let Some(known) = known else {
            if listed || is_check {
                let line = table.rows.get(at).map_or(0, |r| r.0);
                let wrong = format!(
                    "the loads of run `{run}` are not known, and it is a calibration or a check run"
                );
                faults.push(Fault::with_line(&*table.file, line, "run", wrong, "fill in its loads (0 if a load did not act), or remove it from `[calibration] runs` or `check`"));
            } else if stated
                .iter()
                .any(|s| matches!(cell(&table, at, s), Ok(Some(_))))
            {
                partly.push(run);
            }
            continue;
        };
        if is_check {
            checked.push(LoadedRun::new(row, known, 0));
            continue;
        }
        let cells = |columns: &[usize]| -> Vec<String> {
            columns
                .iter()
                .map(|c| table.rows[at].1.get(*c).cloned().unwrap_or_default())
                .collect()
        };
        let alike = match cells(&repeats) {
            _ if repeats.is_empty() => known.mean.iter().map(|f| format!("{f:.6e}")).collect(),
            // A run without an entry repeats no other run.
            blank if blank.iter().all(String::is_empty) => vec![String::new(), run.clone()],
            stated => stated,
        };
        let group = groups.iter().position(|g| *g == alike).unwrap_or_else(|| {
            groups.push(alike);
            groups.len() - 1
        });
        if let Some((_, c)) = &depends {
            match table.number(at, *c) {
                Ok(v) => values.push(v.unwrap_or(f64::NAN)),
                Err(f) => faults.push(f),
            }
        }
        teaching.push(at);
        out.push(LoadedRun::new(row, known, group));
    }
    faults.extend(payloads.and_then(|p| p.find_unaccounted_payload(job, &table, &teaching)));
    let none = (out.is_empty() && faults.is_empty()).then(|| nothing_known(&table, loads));
    faults.extend(none);
    Faults::check(faults)?;
    work.findings.extend(partly_known(&table.file, &partly));
    // Runs of a separate hold-out file are not in this strain file.
    let whole = !matches!(measured.hold_out, HoldOut::File(_));
    let lacking = whole.then(|| without_strain(&table, key, &stated, strain));
    work.findings.extend(lacking.flatten());
    Ok(KnownRuns {
        runs: out,
        checks: checked,
        column: depends.map(|(name, _)| (name, values)),
    })
}

/// Returns the finding on runs with known loads that have no strain: names that differ between the two files, or runs of another day. `key` is the
/// column of the names, `strain` has the runs of the strain file.
fn without_strain(
    table: &Table,
    key: usize,
    stated: &[RunQuantity],
    strain: &[String],
) -> Option<Finding> {
    let has_loads = |at: usize| {
        let mut cells = stated.iter().map(|s| cell(table, at, s));
        cells.any(|c| matches!(c, Ok(Some(_))))
    };
    let rows = table.rows.iter().enumerate();
    let lacking = rows.filter_map(|(at, (_, fields))| {
        let run = fields.get(key)?.as_str();
        (!strain.iter().any(|s| s == run) && has_loads(at)).then_some(run)
    });
    let runs: Vec<&str> = lacking.collect();
    (!runs.is_empty()).then(|| {
        let wrong = format!(
            "the strain file has no row for {} with known loads in `{}`: {}",
            count_of(runs.len(), "run"),
            table.file,
            list_few(&runs)
        );
        let remedy = "give the runs the same names in both files, or remove these rows";
        Finding::new(
            Severity::Warning,
            "run-without-record",
            list_few(&runs),
            wrong,
            remedy,
        )
        .with_numbers(runs.len() as f64, 0.0)
    })
}

/// Returns the finding on runs with some known loads and other loads that are unknown both alone and in a sum. Such runs are left out.
fn partly_known(file: &str, runs: &[&String]) -> Option<Finding> {
    let first = runs.first()?;
    let others = match runs.len() - 1 {
        0 => String::new(),
        n => format!(" and {n} more"),
    };
    Some(Finding::new(
        Severity::Warning,
        "run-partly-known",
        file,
        format!(
            "run `{first}`{others}: some loads are known and others blank; these runs are left out"
        ),
        "fill in the blank loads (0 if a load did not act), with the sd of an estimate, or state a sum in [[combination]]",
    ))
}

/// Returns the fault of a file without a calibration run.
fn nothing_known(table: &Table, loads: &[Load]) -> Fault {
    let names: Vec<&str> = loads.iter().map(|l| l.name.as_str()).collect();
    Fault::new(
        &*table.file,
        "run",
        "no run has both strain and known loads",
        format!(
            "name its columns after the loads ({}), or map them in [runs] columns. A blank is unknown, 0 is known to be zero",
            names.join(", ")
        ),
    )
}

/// Returns a fault for every run whose name is in an earlier row too.
fn named_twice(table: &Table, key: usize) -> FaultList {
    let name_of = |row: &(u32, Vec<String>)| row.1.get(key).cloned().unwrap_or_default();
    let rows = table.rows.iter().enumerate();
    let again = rows.filter(|(i, row)| {
        table
            .rows
            .iter()
            .take(*i)
            .any(|r| name_of(r) == name_of(row))
    });
    again
        .map(|(_, row)| {
            let wrong = format!("run `{}` occurs twice", name_of(row));
            Fault::with_line(
                &*table.file,
                row.0,
                "run",
                wrong,
                "give every run a separate name",
            )
        })
        .collect()
}

/// Returns the column that a key of `[calibration]` names.
fn column(
    job: &Job,
    table: &Table,
    headers: &[Column],
    name: &str,
    key: &str,
    faults: &mut FaultList,
) -> Option<usize> {
    let at = (job.calibration.line, key);
    asked_column(job, at, table, headers, name, faults)
}

/// Columns of loads and of combinations that the file has.
fn find_load_columns(
    job: &Job,
    runs: &Runs,
    table: &Table,
    headers: &[Column],
    loads: &[Load],
    faults: &mut FaultList,
) -> Vec<RunQuantity> {
    let place = |name: &str| loads.iter().position(|l| l.name == name);
    let mut wanted: Vec<(&str, Vec<(usize, f64)>)> = loads
        .iter()
        .enumerate()
        .map(|(i, l)| (l.name.as_str(), vec![(i, 1.0)]))
        .collect();
    for c in &job.combinations {
        let terms = c
            .terms
            .iter()
            .filter_map(|(n, f)| Some((place(n)?, *f)))
            .collect();
        wanted.push((c.name.as_str(), terms));
    }
    let mut out = Vec::new();
    for (name, terms) in wanted {
        let first = terms
            .first()
            .and_then(|t| loads.get(t.0))
            .map_or(name, |l| l.name.as_str());
        let quantity = job.quantity_of_load(first);
        let Some((value, unit)) =
            known_column(job, runs, table, headers, name, quantity, faults).map(|c| (c.at, c.unit))
        else {
            continue;
        };
        let given = runs.columns.get(name).map_or(name, String::as_str);
        let own = [name, given].map(|n| format!("{n}_sd"));
        let sd = own
            .iter()
            .find(|n| !matches!(column_called(job, table, headers, n), Ok(None)));
        let sd = sd.and_then(|n| known_column(job, runs, table, headers, n, quantity, faults));
        let of = |unit: Option<Unit>| unit.map_or(1.0, |u| 1.0 / factor(job.units, u));
        let of_file = of(quantity.map(|q| runs.units.unit(q)));
        let noise = match quantity {
            Some(Quantity::Force) => runs.noise.force,
            Some(Quantity::Moment) => runs.noise.moment,
            _ => None,
        };
        out.push(RunQuantity {
            name: name.to_owned(),
            terms,
            value,
            // The unit of the standard deviation is the unit of the quantity, unless its own column states a unit.
            sd: sd.map(|c| {
                let unit = if c.is_stated { c.unit } else { unit };
                (c.at, of(unit), unit.map_or(1.0, |u| u.si))
            }),
            unit: of(unit),
            noise: noise.unwrap_or(0.0) * of_file,
            size: (quantity, unit.map_or(1.0, |u| u.si)),
        });
    }
    out
}

/// Returns value and standard deviation of a quantity in a row, job units; `None` if its cell is blank.
fn cell(table: &Table, row: usize, s: &RunQuantity) -> Result<Option<(f64, f64)>, Fault> {
    let Some(value) = table.size(row, s.value, s.size)? else {
        return Ok(None);
    };
    let sd = match s.sd {
        Some((c, unit, si)) => table.sd(row, c, (s.size.0, si))?.map(|v| v * unit),
        None => None,
    };
    Ok(Some((value * s.unit, sd.unwrap_or(s.noise))))
}

/// Returns the largest known value of all quantities, once for each load, and adds the faults of the cells. It is 1 if no value is known.
fn largest_known(
    table: &Table,
    stated: &[RunQuantity],
    n_loads: usize,
    faults: &mut FaultList,
) -> Vec<f64> {
    let mut largest = 0.0_f64;
    for s in stated {
        for row in 0..table.rows.len() {
            match cell(table, row, s) {
                Ok(v) => largest = largest.max(v.map_or(0.0, |v| v.0.abs())),
                Err(f) => faults.push(f),
            }
        }
    }
    vec![if largest > 0.0 { largest } else { 1.0 }; n_loads]
}

/// Returns the loads of one run, conditioned on the known sums. Unknown loads have a wide distribution. Returns `None` if nothing is known, or if a
/// wanted load has neither a value nor a known sum.
///
/// # Errors
/// A sum that contradicts its loads.
fn loads_of(
    (table, row): (&Table, usize),
    stated: &[RunQuantity],
    payloads: Option<&Payloads>,
    loads: &[Load],
    largest: &[f64],
) -> Result<Option<KnownLoads>, Fault> {
    let k = loads.len();
    let mut mean = vec![0.0; k];
    let mut covariance = vec![0.0; k * k];
    let mut known = vec![false; k];
    let mut sums = Vec::new();
    for s in stated {
        let Ok(Some((value, sd))) = cell(table, row, s) else {
            continue;
        };
        match s.terms.as_slice() {
            [(l, f)] if *f == 1.0 => {
                mean[*l] = value;
                covariance[l * k + l] = sd * sd;
                known[*l] = true;
            }
            _ => sums.push((s, value, sd)),
        }
    }
    if let Some(payloads) = payloads {
        payloads.share_error(row, &mut covariance, k);
    }
    for l in (0..k).filter(|l| !known[*l]) {
        let in_sum = sums
            .iter()
            .any(|s| s.0.terms.iter().any(|t| t.0 == l && t.1 != 0.0));
        if loads[l].wanted && !in_sum {
            return Ok(None);
        }
        let sd = loads[l].expected.unwrap_or(UNKNOWN * largest[l]);
        covariance[l * k + l] = sd * sd;
    }
    if !known.iter().any(|k| *k) && sums.is_empty() {
        return Ok(None);
    }
    for (s, value, sd) in sums {
        let parts = s.terms.iter().map(|(l, f)| (f * mean[*l]).abs());
        let size = parts.sum::<f64>().max(value.abs());
        let (left, variance) = condition(&mut mean, &mut covariance, &s.terms, value, sd);
        if left.abs() > ROUNDED * size + CONTRADICTS * variance.sqrt() {
            let line = table.rows.get(row).map_or(0, |r| r.0);
            let [stated_sum, made] = [value, value - left].map(|v| number(v / s.unit));
            return Err(Fault::with_line(
                &*table.file,
                line,
                &*s.name,
                format!(
                    "`{}` is {stated_sum}, and the loads of this run give {made}",
                    s.name
                ),
                "correct one of the two, or state their standard deviations in columns `<load>_sd`",
            ));
        }
    }
    Ok(Some(KnownLoads { mean, covariance }))
}

/// Share of a sum by which the sum of its loads may differ from it. Rounding to two or three digits causes such differences.
const ROUNDED: f64 = 0.01;
/// Standard deviations from which a sum contradicts its loads: once in two million sums that are right.
const CONTRADICTS: f64 = 5.0;

/// Conditions Gaussian loads on a sum of them that is `value` with the standard deviation `sd`. Returns the difference of `value` from the sum before
/// conditioning, and the variance of this difference.
fn condition(
    mean: &mut [f64],
    covariance: &mut [f64],
    terms: &[(usize, f64)],
    value: f64,
    sd: f64,
) -> (f64, f64) {
    let k = mean.len();
    let carried: Vec<f64> = (0..k)
        .map(|l| terms.iter().map(|(m, f)| f * covariance[l * k + m]).sum())
        .collect();
    let variance: f64 = terms.iter().map(|(m, f)| f * carried[*m]).sum::<f64>() + sd * sd;
    let left = value - terms.iter().map(|(m, f)| f * mean[*m]).sum::<f64>();
    if !(variance > 0.0) {
        return (left, 0.0);
    }
    for l in 0..k {
        mean[l] += carried[l] * left / variance;
        for m in 0..k {
            covariance[l * k + m] -= carried[l] * carried[m] / variance;
        }
    }
    (left, variance)
}
