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

    /// What each column gives in all of `record`, of which the rows looked at are some; `columns` are theirs. Where none varies the vehicle may stand
    /// still, and every number counts as a signal.
    ///
    /// # Errors
    /// What can't be decoded.
    pub fn throughout(
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

/// The samples about first and last sample `span` in which a column gives what it `gives` there, of those after and before `within`. A sample
/// without a number neither begins nor ends a part of one value.
///
/// # Errors
/// What can't be decoded.
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
