//! Columns of a record that contain no numbers, or a constant, in all of it or in a part.

use super::error::SeriesError;
use super::record::Record;
use std::ops::{ControlFlow, Range};

/// Content of a column over the examined rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gives {
    /// No number.
    Nothing,
    /// One number in all rows.
    OneValue,
    /// Different numbers.
    Signal,
}

/// Number of rows below which equal numbers do not show a constant column.
const FEW: usize = 4;

/// Contents of the `n` columns of a record, from its rows in sequence.
#[derive(Clone, Debug)]
pub struct ColumnContents {
    first: Vec<Option<f64>>,
    varies: Vec<bool>,
    rows: usize,
}

impl ColumnContents {
    /// Returns the state before any row.
    pub fn new(n: usize) -> Self {
        Self {
            first: vec![None; n],
            varies: vec![false; n],
            rows: 0,
        }
    }

    /// Updates the contents of the columns with complete rows, stored one after another in `values`.
    pub fn look(&mut self, values: &[f64]) {
        for row in values.chunks_exact(self.first.len().max(1)) {
            self.rows += 1;
            for ((first, varies), v) in self.first.iter_mut().zip(&mut self.varies).zip(row) {
                if v.is_finite() {
                    *varies |= *first.get_or_insert(*v) != *v;
                }
            }
        }
    }

    /// Returns the content of each column. With few rows every number counts as a signal.
    pub fn columns(&self) -> Vec<Gives> {
        let gives = |(first, varies): (&Option<f64>, &bool)| match first {
            None => Gives::Nothing,
            Some(_) if *varies || self.rows < FEW => Gives::Signal,
            Some(_) => Gives::OneValue,
        };
        self.first.iter().zip(&self.varies).map(gives).collect()
    }

    /// Returns the content of each column in all of `record`, of which the examined rows are a part; `columns` are the columns of those rows.
    /// If no column varies the vehicle may be stationary, and every number counts as a signal.
    ///
    /// # Errors
    /// A record that can't be decoded.
    pub fn columns_in_record(
        &self,
        record: &Record,
        columns: &[Option<usize>],
    ) -> Result<Vec<Gives>, SeriesError> {
        let mut all = self.columns();
        if !all.contains(&Gives::Signal) {
            let still = all.iter_mut().filter(|g| **g == Gives::OneValue);
            still.for_each(|g| *g = Gives::Signal);
        }
        for (gives, column) in all.iter_mut().zip(columns) {
            if *gives != Gives::Signal {
                let span = extent(record, *column, *gives, [0, 0], [0, usize::MAX])?;
                if span != (0..record.clock.samples) {
                    *gives = Gives::Signal;
                }
            }
        }
        Ok(all)
    }
}

/// Returns the extent of a part around the samples `span` in which a column gives the value or the gap `gives`. The part is within the samples
/// `within`. A sample without a number neither begins nor ends a part with one value.
///
/// # Errors
/// Data that can't be decoded.
pub fn extent(
    record: &Record,
    column: Option<usize>,
    gives: Gives,
    [first, last]: [usize; 2],
    within: [usize; 2],
) -> Result<Range<usize>, SeriesError> {
    let (mut from, mut to) = (None, last + 1);
    let (mut value, mut ended) = (None, false);
    for piece in 0..record.n_pieces() {
        let (begin, end) = record.span(piece);
        let is_at_begin = begin <= first && end > within[0];
        let is_at_end = begin <= within[1] && end > last;
        if ended || !(is_at_begin || is_at_end) {
            continue;
        }
        record.read(piece, &[column], &mut |block| {
            for (at, v) in (block.first..).zip(block.values) {
                let belongs = match gives {
                    Gives::Nothing => !v.is_finite(),
                    Gives::OneValue | Gives::Signal => {
                        !v.is_finite() || value.is_none_or(|one| one == *v)
                    }
                };
                if at <= first && !belongs {
                    from = Some(if gives == Gives::Nothing { at + 1 } else { at });
                }
                from = from.or(Some(at));
                if v.is_finite() && (at <= first || value.is_none()) {
                    value = Some(*v);
                }
                ended |= at > last && !belongs;
                if at > last && !ended {
                    to = at + 1;
                }
            }
            match ended {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        })?;
    }
    Ok(from.unwrap_or(first)..to)
}

/// Replaces readings of columns in their spans by NaN. `values` has rows of `n` columns, and the first row is sample `first`.
pub fn blank_readings(values: &mut [f64], n: usize, first: usize, spans: &[(usize, Range<usize>)]) {
    let rows = values.len() / n.max(1);
    for (column, span) in spans {
        let [from, to] = [span.start, span.end].map(|at| at.clamp(first, first + rows) - first);
        let readings = values.iter_mut().skip(from * n + column).step_by(n.max(1));
        readings
            .take(to.saturating_sub(from))
            .for_each(|v| *v = f64::NAN);
    }
}
