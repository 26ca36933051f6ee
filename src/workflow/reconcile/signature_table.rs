//! A CSV file with a row a gauge: influence or signature columns, in the order of the job's gauges.

use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::files::Inputs;
use crate::job::table::{Table, read_table};
use crate::job::unread_columns::note_unread;
use crate::job::{Job, NamedFile};
use std::cell::RefCell;

/// A column of a frame that a table may give.
pub(super) struct TableColumn {
    /// Names of the column: name of the column of S, then name of the load.
    pub(super) names: Vec<String>,
    /// Factor from the table's unit to microstrain per unit of the frame.
    pub(super) factor: f64,
}

/// Columns of numbers over gauges.
pub(super) struct SignatureTable {
    table: Table,
    /// Row of each gauge.
    rows: Vec<usize>,
    /// Columns that were read.
    read: RefCell<Vec<bool>>,
}

impl SignatureTable {
    /// Reads `named` and finds the row of every gauge in its first column (or `gauge`, `name`).
    pub(super) fn read(
        inputs: &mut Inputs,
        job: &Job,
        named: &NamedFile,
        gauges: &[String],
    ) -> Result<Self, Faults> {
        let text = inputs.read_named_text(job, named).map_err(Faults::from)?;
        let table = read_table(&named.given, &text)?;
        let key = table.column(&["gauge", "name"]).unwrap_or(0);
        let mut faults: FaultList = table.rows_named_twice(key, "gauge");
        let mut rows = Vec::with_capacity(gauges.len());
        for gauge in gauges {
            match table.rows.iter().position(|r| r.1.get(key) == Some(gauge)) {
                Some(row) => rows.push(row),
                None => faults.push(Fault::new(
                    &*named.given,
                    "gauge",
                    format!("no row for gauge `{gauge}`"),
                    "add a row for every gauge",
                )),
            }
        }
        Faults::check(faults)?;
        let read = RefCell::new((0..table.header.len()).map(|c| c == key).collect());
        Ok(Self { table, rows, read })
    }

    /// Names of the number columns.
    pub(super) fn names(&self) -> Vec<String> {
        let key = self.table.column(&["gauge", "name"]).unwrap_or(0);
        self.table
            .header
            .iter()
            .enumerate()
            .filter(|(c, _)| *c != key)
            .map(|(_, h)| h.clone())
            .collect()
    }

    /// Marks a column as known but not wanted.
    pub(super) fn leave(&self, name: &str) {
        if let Some(c) = self.table.column(&[name]) {
            self.mark(c);
        }
    }

    fn mark(&self, column: usize) {
        if let Some(read) = self.read.borrow_mut().get_mut(column) {
            *read = true;
        }
    }

    /// Adds a finding that names the columns which were not read.
    pub(super) fn note_unread(&self, inputs: &mut Inputs) {
        let read = self.read.borrow();
        note_unread(inputs, &self.table, |c| read[c], &[]);
    }

    /// Returns whether the column exists.
    pub(super) fn has(&self, name: &str) -> bool {
        self.table.column(&[name]).is_some()
    }

    /// Returns the column `name` times `factor`, by gauge.
    pub(super) fn column(&self, name: &str, factor: f64) -> Result<Vec<f64>, Faults> {
        let Some(c) = self.table.column(&[name]) else {
            let found = self.table.header.join(", ");
            let wrong = format!("no column `{name}` (found: {found})");
            return Err(Faults::from(Fault::with_line(
                &*self.table.file,
                1,
                name,
                wrong,
                "name the columns as in the job",
            )));
        };
        self.mark(c);
        let number = |&row: &usize| {
            let blank = || Fault::new(&*self.table.file, name, "blank", "write a number");
            Ok(self.table.number(row, c)?.ok_or_else(blank)? * factor)
        };
        self.rows
            .iter()
            .map(number)
            .collect::<Result<Vec<f64>, Fault>>()
            .map_err(Faults::from)
    }
}
