//! Columns of a record that give nothing, or one and the same value, in all of it or in a part.

use super::error::SeriesError;
use super::record::Record;
use std::ops::{ControlFlow, Range};

/// What a column gives over the rows looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Gives {
    /// No number.
    Nothing,
    /// One and the same number every time.
    OneValue,
    /// Different numbers.
    Signal,
}

/// Rows below which equal numbers say nothing of a column.
const FEW: usize = 4;

/// Rows of a record as they come, of `n` columns.
#[derive(Clone, Debug)]
pub struct Still {
    first: Vec<Option<f64>>,
    varies: Vec<bool>,
    rows: usize,
}

impl Still {
    /// Nothing looked at yet.
    pub fn new(n: usize) -> Self {
        Self {
            first: vec![None; n],
            varies: vec![false; n],
            rows: 0,
        }
    }

    /// Looks at rows, one after the other in `values`.
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

    /// What each column gives. Where the rows are few every number counts as a signal.
    pub fn columns(&self) -> Vec<Gives> {
        let gives = |(first, varies): (&Option<f64>, &bool)| match first {
            None => Gives::Nothing,
            Some(_) if *varies || self.rows < FEW => Gives::Signal,
            Some(_) => Gives::OneValue,
        };
        self.first.iter().zip(&self.varies).map(gives).collect()
    }
}

/// The samples about first and last sample `span` in which a column gives what it gives there, of those after and before `within`.
///
/// # Errors
/// What can't be decoded.
pub fn extent(
    record: &Record,
    column: Option<usize>,
    [first, last]: [usize; 2],
    within: [usize; 2],
) -> Result<Range<usize>, SeriesError> {
    let same = |a: f64, b: f64| a == b || !(a.is_finite() || b.is_finite());
    let (mut from, mut to) = (first, last + 1);
    let (mut value, mut alive) = (None, false);
    for piece in 0..record.n_pieces() {
        let (begin, end) = record.span(piece);
        let is_at_begin = begin <= first && end > within[0];
        let is_at_end = begin <= within[1] && end > last;
        if alive || !(is_at_begin || is_at_end) {
            continue;
        }
        record.read(piece, &[column], &mut |block| {
            for (at, v) in (block.first..).zip(block.values) {
                let as_before = value.is_some_and(|before| same(*v, before));
                if at <= first && !as_before {
                    (from, value) = (at, Some(*v));
                }
                alive |= at > last && !as_before;
                if at > last && !alive {
                    to = at + 1;
                }
            }
            ControlFlow::Continue(())
        })?;
    }
    Ok(from..to)
}

/// Takes readings out of rows of `n` columns, the first row being sample `first`: those of columns in their spans.
pub fn blank(values: &mut [f64], n: usize, first: usize, spans: &[(usize, Range<usize>)]) {
    let rows = values.len() / n.max(1);
    for (column, span) in spans {
        let [from, to] = [span.start, span.end].map(|at| at.clamp(first, first + rows) - first);
        let readings = values.iter_mut().skip(from * n + column).step_by(n.max(1));
        readings
            .take(to.saturating_sub(from))
            .for_each(|v| *v = f64::NAN);
    }
}
