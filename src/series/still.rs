//! Columns of a record that give nothing, or one and the same value.

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
