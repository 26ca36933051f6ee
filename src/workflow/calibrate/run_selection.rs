//! Which rows of the runs file are calibrated with, and which are checks.

use crate::host::fault::{Fault, FaultList};
use crate::job::Job;
use crate::job::suggest;
use crate::job::table::Table;
use crate::measured::runs_columns::{CHECK, column_called};
use crate::series::record::Column;

/// Rows that the job selects.
pub(super) struct RunSelection {
    /// Rows of the runs in `[calibration] runs`; `None` if the list is missing.
    pub asked: Option<Vec<usize>>,
    /// Rows of the check runs.
    pub checks: Vec<usize>,
}

impl RunSelection {
    /// Reads which runs `[calibration]` and the column `check` of the table select. Column `key` of the table contains its runs; `strain`
    /// are the runs of the strain file.
    pub fn from_job(
        (job, headers): (&Job, &[Column]),
        (table, key): (&Table, usize),
        strain: &[String],
        faults: &mut FaultList,
    ) -> Self {
        let list = job.calibration.runs.as_ref();
        let asked =
            list.map(|l| asked_rows((job, "calibration.runs", l), table, key, strain, faults));
        let checks = check_rows(
            (job, headers),
            (table, key),
            strain,
            asked.as_deref(),
            faults,
        );
        Self { asked, checks }
    }
}

/// Rows of the runs that a key of `[calibration]` names.
fn asked_rows(
    (job, key, list): (&Job, &str, &[String]),
    table: &Table,
    column: usize,
    strain: &[String],
    faults: &mut FaultList,
) -> Vec<usize> {
    let names: Vec<&str> = table
        .rows
        .iter()
        .filter_map(|r| r.1.get(column))
        .map(String::as_str)
        .collect();
    let mut out = Vec::new();
    for run in list {
        let place = names.iter().position(|n| n == run);
        let known = [
            (place.is_some(), &*table.file, names.clone()),
            (
                strain.contains(run),
                "the strain file",
                strain.iter().map(String::as_str).collect(),
            ),
        ];
        for (found, file, choices) in known {
            if !found {
                let wrong = format!("`{file}` has no run `{run}`");
                faults.push(Fault::with_line(
                    &*job.file,
                    job.calibration.line,
                    key,
                    wrong,
                    suggest::remedy(run, choices),
                ));
            }
        }
        out.extend(place);
    }
    out
}

/// Returns the rows of the check runs: those listed in `[calibration] check`, and those with true in the column `check` of the runs file. Adds a
/// fault for each check run among the rows `asked` to calibrate with.
fn check_rows(
    (job, headers): (&Job, &[Column]),
    (table, key): (&Table, usize),
    strain: &[String],
    asked: Option<&[usize]>,
    faults: &mut FaultList,
) -> Vec<usize> {
    let listed = (job, "calibration.check", job.calibration.check.as_slice());
    let mut out = asked_rows(listed, table, key, strain, faults);
    if let Ok(Some(column)) = column_called(job, table, headers, CHECK) {
        for (row, (line, fields)) in table.rows.iter().enumerate() {
            let word = fields.get(column).map_or("", |f| f.trim());
            match word.to_ascii_lowercase().as_str() {
                "" | "0" | "false" | "no" => {}
                "1" | "true" | "yes" => out.push(row),
                _ => faults.push(Fault::with_line(
                    &*table.file,
                    *line,
                    "check",
                    format!("`{word}`, expected true or false"),
                    "write true for a run that is recovered and only compared, else false",
                )),
            }
        }
    }
    for row in asked.into_iter().flatten().filter(|a| out.contains(a)) {
        let run = table.rows[*row].1.get(key).map_or("", String::as_str);
        faults.push(Fault::with_line(
            &*job.file,
            job.calibration.line,
            "calibration.check",
            format!("run `{run}` is a calibration run and a check run"),
            "remove it from `[calibration] runs`, or from the check runs",
        ));
    }
    out
}
