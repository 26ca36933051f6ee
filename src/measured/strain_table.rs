//! Measured strain in memory: a row a run or a sample.

use crate::job::StrainCorrection;
use crate::job::correct::{Channel, channel_of, column_of};

/// Kind of the rows of a strain file.
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
    /// Strain by rows, `n_rows x n_gauges`. NaN for a blank field.
    pub microstrain: Vec<f64>,
}

impl StrainTable {
    /// Returns the number of rows.
    pub fn n_rows(&self) -> usize {
        match &self.rows {
            StrainRows::Runs(r) => r.len(),
            StrainRows::Times(t) => t.len(),
        }
    }

    /// Returns the names of the runs. The list is empty for a record.
    pub fn runs(&self) -> &[String] {
        match &self.rows {
            StrainRows::Runs(names) => names,
            StrainRows::Times(_) => &[],
        }
    }

    /// Returns the readings of row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        let w = self.gauges.len();
        self.microstrain.get(i * w..(i + 1) * w).unwrap_or(&[])
    }

    /// Removes the columns of these gauges.
    pub(crate) fn leave_out(&mut self, gauges: &[String]) {
        let kept: Vec<bool> = self.gauges.iter().map(|g| !gauges.contains(g)).collect();
        if kept.iter().all(|k| *k) {
            return;
        }
        let mut of_value = kept.iter().cycle();
        self.microstrain.retain(|_| of_value.next() == Some(&true));
        let mut of_gauge = kept.iter();
        self.gauges.retain(|_| of_gauge.next() == Some(&true));
    }

    /// Replaces the name of each column by the name of its gauge, and each reading by the corrected strain of the gauge.
    pub(crate) fn put_right(&mut self, corrections: &[StrainCorrection]) {
        if corrections.is_empty() {
            return;
        }
        let w = self.gauges.len().max(1);
        self.gauges = self
            .gauges
            .iter()
            .map(|c| column_of(corrections, c).to_owned())
            .collect();
        let channels: Vec<Channel> = self
            .gauges
            .iter()
            .map(|g| channel_of(corrections, g))
            .collect();
        for row in self.microstrain.chunks_exact_mut(w) {
            for (v, c) in row.iter_mut().zip(&channels).filter(|(_, c)| !c.is_right()) {
                *v = c.put_right(*v);
            }
        }
    }
}
