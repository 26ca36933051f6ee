//! Names and units of a run table's columns, in the same forms as in records: `A [kN]`, `A (kN)`, or a row of units below the names.

use crate::host::fault::{Fault, FaultList};
use crate::host::files::Inputs;
use crate::job::same_name::{is_same_name, is_same_word};
use crate::job::suggest;
use crate::job::table::Table;
use crate::job::unread_columns::note_unread;
use crate::job::{Job, NamedFile, Runs};
use crate::series::number::DecimalMark;
use crate::series::record::csv::is_units;
use crate::series::record::{Clash, Column, name_and_unit, take_unit_below};
use crate::units::{Quantity, Unit, find_unit, unit_names};
use serde_json::Value;
use std::path::Path;

/// Returns name and unit of every column, and removes a row of units below the names from the table. A unit after the name takes precedence over the
/// row of units.
pub fn take_units(t: &mut Table) -> Vec<Column> {
    let mut columns: Vec<Column> = t.header.iter().map(|h| name_and_unit(h)).collect();
    let is_row = t.rows.first().is_some_and(|(_, fields)| {
        let fields: Vec<&[u8]> = fields.iter().map(|f| f.as_bytes()).collect();
        is_units(&fields, &columns, DecimalMark::Point)
    });
    if is_row {
        let (_, units) = t.rows.remove(0);
        for (c, unit) in columns.iter_mut().zip(&units) {
            take_unit_below(c, unit);
        }
    }
    columns
}

/// Returns name and unit of every column as [`take_units`] does. A column without a unit has the unit that `result.json` of the same folder states.
/// Tables of `recover` have only names in their headers.
pub fn take_units_of(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
    t: &mut Table,
) -> Vec<Column> {
    let mut columns = take_units(t);
    let given = Path::new(&named.given);
    let result = given.with_file_name("result.json");
    let path = job.folder.join(&result);
    let Ok(bytes) = inputs.load(&path) else {
        return columns;
    };
    let answer: Value = serde_json::from_slice(&bytes).unwrap_or_default();
    let name = given
        .file_name()
        .and_then(|n| n.to_str())
        .unwrap_or_default();
    let units = answer.get("tables").and_then(|tables| tables.get(name));
    let Some(units) = units.and_then(Value::as_object) else {
        return columns;
    };
    inputs.record(&result.display().to_string(), path, &bytes);
    for column in columns.iter_mut().filter(|c| c.unit.is_empty()) {
        if let Some(unit) = units.get(&column.header.whole).and_then(Value::as_str) {
            take_unit_below(column, unit);
        }
    }
    columns
}

/// Returns the column whose header is `name`, or `name` with a unit. `None` if there is no such column.
///
/// # Errors
/// Several columns that are `name` and a unit, without a column that is `name` alone.
pub fn place_of(t: &Table, columns: &[Column], name: &str) -> Result<Option<usize>, Fault> {
    // Last, the name without its brackets: they contain a label if their text differs from the row of units.
    let readings: [fn(&Column) -> &str; 3] = [|c| &c.header.whole, |c| &c.name, |c| &c.header.name];
    for reading in readings {
        let found = sole_column(t, columns, name, |c| reading(c) == name)?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

/// Returns the only column that `is_meant` accepts.
///
/// # Errors
/// Several columns.
fn sole_column(
    t: &Table,
    columns: &[Column],
    name: &str,
    is_meant: impl Fn(&Column) -> bool,
) -> Result<Option<usize>, Fault> {
    let mut meant = columns.iter().enumerate().filter(|(_, c)| is_meant(c));
    let first = meant.next();
    match meant.next() {
        None => Ok(first.map(|(i, _)| i)),
        Some((_, second)) => Err(Fault::with_line(
            &*t.file,
            1,
            &*second.header.whole,
            format!("two columns contain `{name}`"),
            "delete one of them, or name the right one in the job (`columns`)",
        )),
    }
}

/// Returns the column for the name `name` of the job: [`place_of`], or else the only column with this name apart from case and separators. This
/// column must not have another name of the job.
///
/// # Errors
/// Several columns.
pub fn column_called(
    job: &Job,
    t: &Table,
    columns: &[Column],
    name: &str,
) -> Result<Option<usize>, Fault> {
    column_among(&names_in_runs(job), t, columns, name)
}

/// Returns the column of `name` among the `names` that columns may have.
///
/// # Errors
/// Several columns.
fn column_among(
    names: &[String],
    t: &Table,
    columns: &[Column],
    name: &str,
) -> Result<Option<usize>, Fault> {
    let exact = place_of(t, columns, name)?;
    if exact.is_some() {
        return Ok(exact);
    }
    let is_other = |c: &Column| names.iter().any(|n| is_called(c, n));
    let is_meant = |c: &Column| header_names(c).iter().any(|n| is_same_word(n, name));
    sole_column(t, columns, name, |c| is_meant(c) && !is_other(c))
}

/// Returns the names that a header may state.
fn header_names(c: &Column) -> [&str; 3] {
    [&c.header.whole, &c.name, &c.header.name]
}

fn is_called(c: &Column, name: &str) -> bool {
    header_names(c).contains(&name)
}

/// Names of the payload in a runs file.
pub const PAYLOAD: [(&str, Quantity); 4] = [
    ("payload_force", Quantity::Force),
    ("payload_mass", Quantity::Mass),
    ("payload_x", Quantity::Length),
    ("payload_y", Quantity::Length),
];

/// Column of the runs file that marks check runs: runs that are recovered and compared, but not calibrated with.
pub const CHECK: &str = "check";

/// Returns the names that a column of the runs file may have for any command, except the names of a given S.
pub fn names_in_runs(job: &Job) -> Vec<String> {
    let loads = job.loads.iter().map(|l| l.name.clone());
    let sums = job.combinations.iter().map(|c| c.name.clone());
    let payload = PAYLOAD.iter().map(|p| p.0.to_owned());
    let files = job
        .runs
        .iter()
        .chain(job.compare.iter().map(|c| &c.recorded));
    let mapped = files.flat_map(|r| r.columns.values().cloned());
    let mut out: Vec<String> = loads.chain(sums).chain(payload).chain(mapped).collect();
    let sd: Vec<String> = out.iter().map(|n| format!("{n}_sd")).collect();
    out.extend(sd);
    let causes = job.reconcile.iter().flat_map(|r| &r.causes);
    out.extend(causes.map(|c| c.1.clone()));
    out.extend(job.calibration.repeats.iter().cloned());
    out.extend(job.calibration.depends_on.clone());
    out.push("run".to_owned());
    out.push(CHECK.to_owned());
    out
}

/// Returns the names that columns of the runs file may have, and for each column whether it has one of these names. `given` are the loads of a given
/// S.
fn columns_claimed(
    job: &Job,
    (t, columns): (&Table, &[Column]),
    given: &[String],
) -> (Vec<String>, Vec<bool>) {
    let of_job = names_in_runs(job);
    let mut names = of_job.clone();
    names.extend(given.iter().flat_map(|n| [n.clone(), format!("{n}_sd")]));
    let mut read = vec![false; columns.len()];
    for name in &names {
        if let Ok(Some(at)) = column_among(&of_job, t, columns, name) {
            read[at] = true;
        }
    }
    (names, read)
}

/// Returns a column that no name of the job claims and that may belong to a load: `FZ_FL` for `FL.FZ`, or else the column with the closest spelling.
pub fn column_meant<'a>(
    job: &Job,
    (t, columns): (&Table, &'a [Column]),
    given: &[String],
    name: &str,
) -> Option<&'a str> {
    let (_, claimed) = columns_claimed(job, (t, columns), given);
    let free = columns.iter().zip(claimed).filter(|(_, claimed)| !claimed);
    let free: Vec<&str> = free.map(|(c, _)| c.name.as_str()).collect();
    let words = |name: &str| {
        let lower = name.to_lowercase();
        let parts = lower.split(|c: char| !c.is_alphanumeric());
        let mut words: Vec<String> = parts.filter(|w| !w.is_empty()).map(Into::into).collect();
        words.sort_unstable();
        words
    };
    let turned = free.iter().find(|c| words(c) == words(name)).copied();
    turned.or_else(|| suggest::find_closest_name(name, free))
}

/// Adds a warning on the columns of the runs file that no command reads. `given` contains the loads of a given S.
pub fn note_unread_runs(
    inputs: &mut Inputs,
    job: &Job,
    (t, columns): (&Table, &[Column]),
    given: &[String],
) {
    let (names, read) = columns_claimed(job, (t, columns), given);
    let lacking = |n: &&String| {
        !columns.iter().any(|c| is_called(c, n)) && !n.ends_with("_sd") && *n != CHECK
    };
    let lacking: Vec<&str> = names.iter().filter(lacking).map(String::as_str).collect();
    note_unread(inputs, t, |c| read[c], &lacking);
}

/// Returns the column that the job requests by `name`, at this line and key. Adds a fault if no column or several columns have this name.
pub fn asked_column(
    job: &Job,
    (line, key): (u32, &str),
    t: &Table,
    columns: &[Column],
    name: &str,
    faults: &mut FaultList,
) -> Option<usize> {
    let missing = || {
        let wrong = format!("`{}` has no column `{name}`", t.file);
        let remedy = suggest::remedy(name, t.header.iter().map(String::as_str));
        Fault::with_line(&*job.file, line, key, wrong, remedy)
    };
    place_of(t, columns, name)
        .and_then(|at| at.ok_or_else(missing))
        .map_err(|f| faults.push(f))
        .ok()
}

/// Returns the column that names the runs.
///
/// # Errors
/// A fault if no column names them.
pub fn run_column(job: &Job, t: &Table, columns: &[Column]) -> Result<usize, Fault> {
    column_called(job, t, columns, "run")?.ok_or_else(|| {
        let headers = t.header.iter().map(String::as_str);
        let general = "add a column `run` with the runs' names";
        let remedy = suggest::header_remedy("run", headers, general);
        Fault::with_line(&*t.file, 1, "run", "no column `run`", remedy)
    })
}

/// A column of the runs file with numbers of one quantity, and their unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownColumn {
    /// Number of the column in the table.
    pub at: usize,
    /// Unit that the column states, else the unit of the job; `None` for amplitudes of load sets, which have no unit.
    pub unit: Option<Unit>,
    /// Whether the column states its unit.
    pub is_stated: bool,
}

/// Returns the column of the runs file for `name`. `None` if the file has no such column and the job requests none.
///
/// The column determines the unit. If the job's `[runs] units` states another unit for the quantity, one of the two units is wrong. Nothing shows
/// which one, so this is a fault.
pub fn known_column(
    job: &Job,
    runs: &Runs,
    t: &Table,
    columns: &[Column],
    name: &str,
    quantity: Option<Quantity>,
    faults: &mut FaultList,
) -> Option<KnownColumn> {
    let given = runs.columns.get(name);
    let wanted = given.map_or(name, String::as_str);
    let key = format!("{}.columns.{name}", runs.section);
    let at = match given {
        Some(_) => asked_column(job, (runs.line, &key), t, columns, wanted, faults)?,
        None => column_called(job, t, columns, wanted)
            .map_err(|f| faults.push(f))
            .ok()??,
    };
    let of_job = quantity.map(|q| runs.units.unit(q));
    let here = KnownColumn {
        at,
        unit: of_job,
        is_stated: false,
    };
    let (header, stated) = (t.header.get(at)?, columns.get(at)?);
    let is_named = header == wanted || is_same_name(&stated.name, wanted);
    if !is_named || stated.clash() == Some(Clash::Size) {
        let remedy = match is_named {
            true => "correct the wrong one",
            false => "correct the wrong one, or name the column in the job (`columns`)",
        };
        faults.push(Fault::with_line(
            &*t.file,
            1,
            header,
            stated.clash_words(),
            remedy,
        ));
        return Some(here);
    }
    if matches!(stated.unit.as_str(), "" | "-") {
        return Some(here);
    }
    // `Axle (front)` is a name if the job states that the column has this name.
    let is_name = header == wanted
        && stated.header.bracket == stated.unit
        && (given.is_some() || !header.ends_with(']'));
    let Some((quantity, of_job)) = quantity.zip(of_job) else {
        if !is_name && stated.unit != "1" {
            let wrong = format!(
                "`{name}` is a factor of a load set, and the column states `{}`",
                stated.unit
            );
            let remedy = "write how many times the set acts, without a unit";
            faults.push(Fault::with_line(&*t.file, 1, header, wrong, remedy));
        }
        return Some(here);
    };
    let Some(unit) = find_unit(quantity, &stated.unit) else {
        if !is_name {
            let wrong = format!("`{}` is not a unit of {}", stated.unit, quantity.word());
            let remedy = format!("write one of {}", unit_names(quantity).join(", "));
            faults.push(Fault::with_line(&*t.file, 1, header, wrong, remedy));
        }
        return Some(here);
    };
    if unit != of_job && runs.stated_units.contains(&quantity) {
        let wrong = format!(
            "the column states `{}`, the job states `{}` ({}.units.{})",
            unit.name,
            of_job.name,
            runs.section,
            quantity.word()
        );
        let remedy = format!(
            "correct the wrong one; without {}.units the unit of the column is used",
            runs.section
        );
        faults.push(Fault::with_line(&*t.file, 1, header, wrong, remedy));
    } else if unit != of_job {
        let ambiguous = find_ambiguous_noise(job, runs, quantity, unit, of_job);
        if let Some(fault) = ambiguous.filter(|f| !faults.contains(f)) {
            faults.push(fault);
        }
    }
    Some(KnownColumn {
        at,
        unit: Some(unit),
        is_stated: true,
    })
}

/// Returns the fault of a noise in the job whose unit is ambiguous: the columns of the file have another unit than the job.
fn find_ambiguous_noise(
    job: &Job,
    runs: &Runs,
    quantity: Quantity,
    of_column: Unit,
    of_job: Unit,
) -> Option<Fault> {
    let noise = match quantity {
        Quantity::Force => runs.noise.force,
        Quantity::Moment => runs.noise.moment,
        Quantity::Mass => runs.noise.mass,
        Quantity::Length => runs.noise.length,
        Quantity::Stress | Quantity::Acceleration => None,
    };
    let noise = noise.filter(|n| *n > 0.0)?;
    let word = quantity.word();
    Some(Fault::with_line(
        &*job.file,
        runs.line,
        format!("{}.noise.{word}", runs.section),
        format!(
            "the unit of {noise} may be `{}` or, as in the columns of the file, `{}`",
            of_job.name, of_column.name
        ),
        format!(
            "state the unit of file and noise: [{}] units = {{ {word} = \"{}\" }}",
            runs.section, of_column.name
        ),
    ))
}
