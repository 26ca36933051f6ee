//! The runs file: what else was measured in each run, by the job's names, in SI units.

use super::runs_columns::{
    PAYLOAD, column_meant, known_column, note_unread_runs, run_column, take_units, take_units_of,
};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::Inputs;
use crate::job::given_columns::columns_of_given;
use crate::job::quantity::quantity_of_name;
use crate::job::table::read_table;
use crate::job::{Job, Runs};
use crate::units::Quantity;
use std::collections::{BTreeMap, HashSet};

/// One run, SI units. Missing or blank fields are absent.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct RunRow {
    /// Name.
    pub run: String,
    /// Value of each load by name: force in N, moment in N m.
    pub loads_si: BTreeMap<String, f64>,
    /// Payload weight, N.
    pub payload_force_n: Option<f64>,
    /// Payload mass, kg.
    pub payload_mass_kg: Option<f64>,
    /// Payload position along x, m.
    pub payload_x_m: Option<f64>,
    /// Payload position along y, m.
    pub payload_y_m: Option<f64>,
    /// Line in the file.
    pub line: u32,
}

/// Reads the runs of `[runs]`. The load columns have the names of the job's loads, or of the columns of a given S.
///
/// # Errors
/// Every fault: missing columns, unknown or contradicting units, fields that are not numbers or do not fit their quantity, runs named twice.
pub fn read_runs(inputs: &mut Inputs, job: &Job, runs: &Runs) -> Result<Vec<RunRow>, Faults> {
    runs_of_first_sheet(inputs, job, runs)
        .map_err(|faults| inputs.with_sheet_read(job, &runs.file, faults))
}

/// Reads the runs, of a spreadsheet those in its first sheet.
fn runs_of_first_sheet(inputs: &mut Inputs, job: &Job, runs: &Runs) -> Result<Vec<RunRow>, Faults> {
    let text = inputs
        .read_named_text(job, &runs.file)
        .map_err(Faults::from)?;
    let mut t = read_table(&runs.file.given, &text)?;
    let headers = take_units_of(inputs, job, &runs.file, &mut t);
    t.check_rows()?;
    let mut faults = FaultList::new();
    let key = run_column(job, &t, &headers)?;
    let mut columns: Vec<(String, usize, (Option<Quantity>, f64))> = Vec::new();
    let given = given_loads(inputs, job)?;
    note_unread_runs(inputs, job, (&t, &headers), &given);
    for (name, quantity) in known_columns(job, &given) {
        let column = known_column(job, runs, &t, &headers, &name, Some(quantity), &mut faults);
        columns.extend(column.map(|c| {
            let si = c.unit.map_or(1.0, |u| u.si);
            (name, c.at, (Some(quantity), si))
        }));
    }
    let mut out: Vec<RunRow> = Vec::new();
    let mut seen: HashSet<&str> = HashSet::with_capacity(t.rows.len());
    for (row, (line, fields)) in t.rows.iter().enumerate() {
        let run = fields.get(key).cloned().unwrap_or_default();
        if !seen.insert(fields.get(key).map_or("", String::as_str)) {
            let wrong = format!("run `{run}` occurs twice");
            faults.push(Fault::with_line(
                &*t.file,
                *line,
                "run",
                wrong,
                "give every run a separate name",
            ));
        }
        let mut entry = RunRow {
            run,
            line: *line,
            ..RunRow::default()
        };
        for (name, c, unit) in &columns {
            let x = match t.size(row, *c, *unit) {
                Ok(Some(x)) => x * unit.1,
                Ok(None) => continue,
                Err(f) => {
                    faults.push(f);
                    continue;
                }
            };
            match name.as_str() {
                "payload_force" => entry.payload_force_n = Some(x),
                "payload_mass" => entry.payload_mass_kg = Some(x),
                "payload_x" => entry.payload_x_m = Some(x),
                "payload_y" => entry.payload_y_m = Some(x),
                _ => {
                    entry.loads_si.insert(name.clone(), x);
                }
            }
        }
        out.push(entry);
    }
    Faults::check(faults)?;
    Ok(out)
}

/// Returns the fault of a runs file without a column of a load.
///
/// # Errors
/// Faults of the file.
pub fn no_load_column(
    inputs: &mut Inputs,
    job: &Job,
    runs: &Runs,
    name: &str,
) -> Result<Fault, Faults> {
    let text = inputs.read_named_text(job, &runs.file)?;
    let mut t = read_table(&runs.file.given, &text)?;
    let columns = take_units(&mut t);
    let given = given_loads(inputs, job)?;
    let remedy = match column_meant(job, (&t, &columns), &given, name) {
        Some(column) => format!(
            "rename column `{column}`, or name it in the job: [runs] columns = {{ \"{name}\" = \"{column}\" }}"
        ),
        None => "add the column, or name it in the job under [runs] columns".to_owned(),
    };
    let wrong = format!("no run has a value for load `{name}`");
    Ok(Fault::with_line(&*t.file, 1, name, wrong, remedy))
}

/// Returns the loads of a given S. They are listed in the job, or else in the table of S.
pub fn given_loads(inputs: &mut Inputs, job: &Job) -> Result<Vec<String>, Faults> {
    let Some(given) = &job.sensitivity else {
        return Ok(Vec::new());
    };
    let mut header = Vec::new();
    if given.columns.is_empty() {
        let text = inputs
            .read_named_text(job, &given.file)
            .map_err(Faults::from)?;
        let table = read_table(&given.file.given, &text)?;
        let names = ["gauge", "name", "run"];
        header.extend(
            table
                .header
                .into_iter()
                .filter(|h| !names.contains(&h.as_str())),
        );
    }
    let columns = columns_of_given(job, given, header);
    Ok(columns.into_iter().map(|c| c.0).collect())
}

/// Names that a runs file may carry, with what they measure.
fn known_columns(job: &Job, given: &[String]) -> Vec<(String, Quantity)> {
    let mut out: Vec<(String, Quantity)> = Vec::new();
    for load in &job.loads {
        if let Some(quantity) = load.quantity() {
            out.push((load.name.clone(), quantity));
        }
    }
    for name in given {
        if !out.iter().any(|o| &o.0 == name) {
            out.push((name.clone(), quantity_of_name(name)));
        }
    }
    out.extend(PAYLOAD.map(|(n, q)| (n.to_owned(), q)));
    out
}
