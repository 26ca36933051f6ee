//! S from a table that the job names.

use super::covariance::read_covariance;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::given_columns::columns_of_given;
use crate::job::quantity::quantity_of_name;
use crate::job::readings::readings_of;
use crate::job::suggest;
use crate::job::table::{Table, read_table};
use crate::job::unread_columns::note_unread;
use crate::job::{Job, JobLoad, LoadRole};
use crate::linalg::Matrix;
use crate::placement::Role;
use crate::sensitivity::{Load, Sensitivity};
use crate::units::{MICROSTRAIN, factor};
use std::collections::HashMap;

/// Reads the table of `[sensitivity]` as S in strain per job unit. Rows are in the order of the job's gauges if it has gauges.
///
/// # Errors
/// Missing columns, missing rows for gauges of the job, fields that are not numbers.
pub fn read_given(work: &mut Work, job: &Job) -> Result<Sensitivity, Faults> {
    let Some(given) = &job.sensitivity else {
        return Err(Fault::new(
            &*job.file,
            "sensitivity",
            "the job has no [sensitivity]",
            "name the table of S: [sensitivity] file = \"S.csv\"",
        )
        .into());
    };
    let text = work
        .inputs
        .read_named_text(job, &given.file)
        .map_err(Faults::from)?;
    let table = read_table(&given.file.given, &text)?;
    let mut faults = FaultList::new();
    let Some(key) = table.column(&["gauge", "name"]) else {
        return Err(Faults::from(Fault::with_line(
            &*table.file,
            1,
            "gauge",
            "no column `gauge`",
            "name the gauges in a column `gauge`",
        )));
    };
    faults.extend(table.rows_named_twice(key, "gauge"));
    let header = table.header.iter().enumerate();
    let header = header.filter(|(i, _)| *i != key).map(|(_, h)| h.clone());
    let columns = columns_of_given(job, given, header);
    let mut loads = Vec::new();
    let mut at = Vec::new();
    for (name, column) in &columns {
        let Some(c) = table.column(&[column]) else {
            let wrong = format!("no column `{column}` in `{}`", table.file);
            faults.push(Fault::with_line(
                &*job.file,
                given.line,
                "sensitivity.columns",
                wrong,
                "name a column of the table",
            ));
            continue;
        };
        let stated = job.loads.iter().find(|l| &l.name == name);
        let quantity = stated
            .and_then(JobLoad::quantity)
            .unwrap_or_else(|| quantity_of_name(name));
        let per = given.per.unit(quantity);
        at.push((c, MICROSTRAIN * factor(job.units, per)));
        loads.push(Load {
            name: name.clone(),
            expected: stated.and_then(|l| l.expected),
            wanted: stated.is_none_or(|l| l.role == LoadRole::Wanted),
            quantity: Some(quantity),
        });
    }
    check_wanted(job, given.line, &table, &loads, &mut faults);
    let is_load = |name: &&String| loads.iter().any(|l| l.name == **name);
    for name in given.range.keys().filter(|n| !is_load(n)) {
        faults.push(Fault::with_line(
            &*job.file,
            given.line,
            "sensitivity.range",
            format!("`{name}` is not a load of `{}`", table.file),
            suggest::remedy(name, loads.iter().map(|l| l.name.as_str())),
        ));
    }
    let is_read = |c: usize| c == key || at.iter().any(|a| a.0 == c);
    let lacking = job.loads.iter().map(|l| l.name.as_str());
    let lacking = lacking.filter(|n| loads.iter().all(|l| l.name != *n));
    let lacking: Vec<&str> = lacking.collect();
    note_unread(&mut work.inputs, &table, is_read, &lacking);
    let names: Vec<String> = table
        .rows
        .iter()
        .map(|r| r.1.get(key).cloned().unwrap_or_default())
        .collect();
    for name in given.strain_range.keys().filter(|n| !names.contains(n)) {
        faults.push(Fault::with_line(
            &*job.file,
            given.line,
            "sensitivity.strain_range",
            format!("`{name}` is not a gauge of `{}`", table.file),
            suggest::remedy(name, names.iter().map(String::as_str)),
        ));
    }
    let order = rows_of(job, &table.file, &names, &mut faults);
    let mut values = Matrix::zeros(order.len(), loads.len());
    for (r, (_, row)) in order.iter().enumerate() {
        for (l, (c, f)) in at.iter().enumerate() {
            match table.number(*row, *c) {
                Ok(Some(v)) => values[(r, l)] = v * f,
                Ok(None) => faults.push(Fault::with_line(
                    &*table.file,
                    table.rows.get(*row).map_or(0, |r| r.0),
                    &*loads[l].name,
                    "blank",
                    "give every influence coefficient (0 if a load does not strain the gauge)",
                )),
                Err(f) => faults.push(f),
            }
        }
    }
    Faults::check(faults)?;
    let gauges: Vec<String> = order.into_iter().map(|o| o.0).collect();
    let mut uncertainty = None;
    if let Some(named) = &given.covariance {
        let bytes = work.inputs.read_named(job, named).map_err(Faults::from)?;
        let names: Vec<String> = loads.iter().map(|l: &Load| l.name.clone()).collect();
        uncertainty = Some(read_covariance(&named.given, &bytes, &gauges, &names)?);
    }
    Ok(Sensitivity {
        gauges,
        loads,
        values,
        uncertainty,
        noise: None,
    })
}

/// Refuses a table that lacks the column of a wanted load, since the strain of this load would be assigned to other loads.
fn check_wanted(job: &Job, line: u32, table: &Table, loads: &[Load], faults: &mut FaultList) {
    let wanted = job.loads.iter().filter(|l| l.role == LoadRole::Wanted);
    for load in wanted.filter(|l| loads.iter().all(|own| own.name != l.name)) {
        let remedy = suggest::remedy(&load.name, table.header.iter().map(String::as_str));
        faults.push(Fault::with_line(
            &*job.file,
            line,
            "sensitivity.file",
            format!(
                "`{}` has no column for the load `{}`",
                table.file, load.name
            ),
            format!("name its column in [sensitivity] columns; {remedy}"),
        ));
    }
}

/// Returns the readings of the job's gauges with their rows in the table of S. `names` are the names of the rows. A job that states no gauges has all
/// rows.
fn rows_of(
    job: &Job,
    file: &str,
    names: &[String],
    faults: &mut FaultList,
) -> Vec<(String, usize)> {
    if job.gauges.is_empty() {
        return names.iter().cloned().zip(0..).collect();
    }
    let places: HashMap<&String, usize> = names.iter().rev().zip((0..names.len()).rev()).collect();
    let mut out = Vec::new();
    for g in &job.gauges {
        // A table may contain one row for a whole rosette.
        let readings = match places.contains_key(&g.name) {
            true => vec![g.name.clone()],
            false => readings_of(g),
        };
        for reading in readings {
            match places.get(&reading).copied() {
                Some(row) => out.push((reading, row)),
                // A calibration does not determine the rows of validation gauges.
                None if g.role == Role::Validation => {}
                None => faults.push(Fault::with_line(
                    &*g.file,
                    g.line,
                    "gauge",
                    format!("gauge `{reading}` has no row in `{file}`"),
                    "add its row, or remove the gauge",
                )),
            }
        }
    }
    out
}
