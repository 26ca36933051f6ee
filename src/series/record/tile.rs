//! Columns decoded one after the other, laid out row by row.

use super::reader::BLOCK;

/// Columns laid out together: a line of the processor's cache holds their numbers of one row.
const WIDE: usize = 8;

/// A few decoded columns that are adjacent in the rows.
pub(super) struct Tile {
    values: Vec<f64>,
    /// Place of the first in a row.
    first: usize,
    /// Number of columns.
    n: usize,
    /// Rows of each.
    rows: usize,
}

impl Tile {
    /// Creates an empty tile.
    pub(super) fn new() -> Self {
        Self {
            values: vec![f64::NAN; WIDE * BLOCK],
            first: 0,
            n: 0,
            rows: 0,
        }
    }

    /// Returns room for the numbers of column `j` of at most [`BLOCK`] rows. If the columns are not contiguous, they are first arranged in `values`,
    /// `k` for each row.
    pub(super) fn column(
        &mut self,
        j: usize,
        rows: usize,
        values: &mut [f64],
        k: usize,
    ) -> &mut [f64] {
        let is_next = j == self.first + self.n && self.n < WIDE && rows == self.rows;
        if !is_next {
            self.lay_out(values, k);
            (self.first, self.rows) = (j, rows);
        }
        let at = self.n * BLOCK;
        self.n += 1;
        self.values.get_mut(at..at + rows).unwrap_or_default()
    }

    /// Copies the stored columns into `values`, which has `k` numbers in each row.
    pub(super) fn lay_out(&mut self, values: &mut [f64], k: usize) {
        let from = &self.values;
        let rows = values.chunks_exact_mut(k.max(1)).take(self.rows);
        let rows = rows.filter_map(|row| row.get_mut(self.first..));
        let column = |c: usize| from.get(c * BLOCK..).unwrap_or_default();
        if self.n == WIDE {
            let [a, b, c, d, e, f, g, h] = [0, 1, 2, 3, 4, 5, 6, 7].map(column);
            let left = a.iter().zip(b).zip(c).zip(d);
            let right = e.iter().zip(f).zip(g).zip(h);
            for (row, ((((a, b), c), d), (((e, f), g), h))) in rows.zip(left.zip(right)) {
                if let Some(slots) = row.first_chunk_mut() {
                    *slots = [*a, *b, *c, *d, *e, *f, *g, *h];
                }
            }
        } else if self.n > 0 {
            for (i, row) in rows.enumerate() {
                for (slot, c) in row.iter_mut().zip(0..self.n) {
                    *slot = column(c).get(i).copied().unwrap_or(f64::NAN);
                }
            }
        }
        self.n = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stand_in_their_places_and_those_left_out_stay() {
        let (k, rows) = (21, 37);
        let mut values = vec![-1.0; rows * k];
        let mut tile = Tile::new();
        for j in (0..k).filter(|j| *j != 5) {
            let column = tile.column(j, rows, &mut values, k);
            for (i, slot) in column.iter_mut().enumerate() {
                *slot = (100 * j + i) as f64;
            }
        }
        tile.lay_out(&mut values, k);
        for (i, row) in values.chunks(k).enumerate() {
            for (j, v) in row.iter().enumerate() {
                let right = if j == 5 { -1.0 } else { (100 * j + i) as f64 };
                assert_eq!(*v, right);
            }
        }
    }
}
