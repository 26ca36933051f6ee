//! The strain file: a column a gauge in microstrain, a row a run (`run`) or a sample (`time`).

use super::table::{Table, read_table};
use super::types::{Job, NamedFile};
use crate::cli::fault::{Fault, Faults};
use crate::cli::files::Inputs;

/// What the rows of a strain file are.
#[derive(Clone, Debug, PartialEq)]
pub enum StrainRows {
    /// Static states by name.
    Runs(Vec<String>),
    /// Samples of one record, seconds.
    Times(Vec<f64>),
}

/// A strain file, microstrain as written.
#[derive(Clone, Debug, PartialEq)]
pub struct StrainTable {
    /// File as given.
    pub file: String,
    /// Gauge names.
    pub gauges: Vec<String>,
    /// Runs or samples.
    pub rows: StrainRows,
    /// Row-major, `n_rows x n_gauges`; a blank is NaN.
    pub microstrain: Vec<f64>,
}

impl StrainTable {
    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        match &self.rows {
            StrainRows::Runs(r) => r.len(),
            StrainRows::Times(t) => t.len(),
        }
    }

    /// Readings of row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        let w = self.gauges.len();
        self.microstrain.get(i * w..(i + 1) * w).unwrap_or(&[])
    }
}

/// A whole strain file in memory. Long histories are better streamed.
///
/// # Errors
/// Every fault: no `run` or `time` column, fields that are no numbers, runs named twice, times that don't ascend.
pub fn read_strain(
    inputs: &mut Inputs,
    job: &Job,
    named: &NamedFile,
) -> Result<StrainTable, Faults> {
    let text = inputs.read_named_text(job, named).map_err(|f| vec![f])?;
    strain_from_table(&read_table(&named.given, &text)?)
}

/// The strain in a table.
///
/// # Errors
/// As [`read_strain`].
pub fn strain_from_table(t: &Table) -> Result<StrainTable, Faults> {
    let run = t.column(&["run"]);
    let time = t.column(&["time", "t", "t_s", "time_s"]);
    let Some(key) = run.or(time) else {
        return Err(vec![Fault::at(
            &*t.file,
            1,
            "run",
            "no column `run` and no column `time`",
            "add `run` with the runs' names, or `time` in seconds",
        )]);
    };
    let mut faults = Faults::new();
    let columns: Vec<usize> = (0..t.header.len()).filter(|c| *c != key).collect();
    let mut microstrain = Vec::with_capacity(t.rows.len() * columns.len());
    let mut number = |row, column, blank: f64| {
        t.number(row, column)
            .unwrap_or_else(|f| {
                faults.push(f);
                None
            })
            .unwrap_or(blank)
    };
    for row in 0..t.rows.len() {
        for c in &columns {
            microstrain.push(number(row, *c, f64::NAN));
        }
    }
    let rows = if run.is_some() {
        let mut names: Vec<String> = Vec::new();
        for (line, fields) in &t.rows {
            let name = fields.get(key).cloned().unwrap_or_default();
            if names.contains(&name) {
                let wrong = format!("run `{name}` stands twice");
                faults.push(Fault::at(
                    &*t.file,
                    *line,
                    "run",
                    wrong,
                    "give every run its own name",
                ));
            }
            names.push(name);
        }
        StrainRows::Runs(names)
    } else {
        StrainRows::Times(
            (0..t.rows.len())
                .map(|row| number(row, key, f64::NAN))
                .collect(),
        )
    };
    if let StrainRows::Times(times) = &rows {
        for (i, w) in times.windows(2).enumerate() {
            if let [a, b] = w
                && !(b > a)
            {
                let line = t.rows.get(i + 1).map_or(0, |r| r.0);
                let wrong = format!("time {b} after {a}");
                faults.push(Fault::at(
                    &*t.file,
                    line,
                    "time",
                    wrong,
                    "write samples in order of time",
                ));
                break;
            }
        }
    }
    if !faults.is_empty() {
        return Err(faults);
    }
    let gauges = columns
        .iter()
        .filter_map(|c| t.header.get(*c))
        .cloned()
        .collect();
    Ok(StrainTable {
        file: t.file.clone(),
        gauges,
        rows,
        microstrain,
    })
}
