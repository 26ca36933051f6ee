//! A symmetric matrix in blocks, stored in elimination order, ready to be assembled in parallel.

use super::graph::BlockGraph;
use super::symbolic::Symbolic;
use rayon::prelude::*;

/// Number of groups of a task.
pub(super) const GROUPS: usize = 4096;

/// Lower triangle of a symmetric matrix by block columns. Each block is stored by columns. Diagonal blocks are stored in full.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix {
    /// First block of each block column, and the total.
    pub(super) column: Vec<usize>,
    /// Row of each block, ascending within a block column. The first block of a column is the diagonal block.
    pub(super) row: Vec<u32>,
    /// First value of each block, and the total.
    pub(super) value_start: Vec<usize>,
    pub(super) values: Vec<f64>,
}

/// A dense symmetric matrix to be added.
#[derive(Clone, Debug, Default)]
pub struct DenseTerm {
    /// Groups (caller's numbering), each once, in any order.
    pub groups: Vec<u32>,
    /// First row of each group in `matrix`, and its order.
    pub offsets: Vec<usize>,
    /// Entries, row by row.
    pub matrix: Vec<f64>,
}

impl BlockMatrix {
    /// Returns a zero matrix with a block wherever the graph has an edge.
    pub fn zeros(symbolic: &Symbolic, graph: &BlockGraph) -> Self {
        let n = graph.n();
        let size = |g: u32| symbolic.start[g as usize + 1] - symbolic.start[g as usize];
        let mut column = Vec::with_capacity(n + 1);
        let mut row = Vec::with_capacity(n + graph.neighbours.len() / 2);
        let mut value_start = Vec::with_capacity(row.capacity() + 1);
        let mut total = 0;
        for g in 0..n as u32 {
            column.push(row.len());
            let first = row.len();
            row.push(g);
            row.extend(
                graph
                    .neighbours(symbolic.order[g as usize] as usize)
                    .iter()
                    .map(|&w| symbolic.position[w as usize])
                    .filter(|&h| h > g),
            );
            row[first..].sort_unstable();
            for &h in &row[first..] {
                value_start.push(total);
                total += size(g) * size(h);
            }
        }
        column.push(row.len());
        value_start.push(total);
        Self {
            column,
            row,
            value_start,
            values: vec![0.0; total],
        }
    }

    /// Returns the blocks in the column of a group, each with its block row, by columns. Both numberings are in elimination order.
    pub(super) fn column_of(&self, g: usize) -> impl Iterator<Item = (u32, &[f64])> {
        let blocks = self.column[g]..self.column[g + 1];
        blocks.map(|b| {
            let values = self.value_start[b]..self.value_start[b + 1];
            (self.row[b], &self.values[values])
        })
    }

    /// Scales rows and columns in place. `scale` is in elimination order.
    pub(super) fn scale(&mut self, symbolic: &Symbolic, scale: &[f64]) {
        let (column, row, value_start) = (&self.column, &self.row, &self.value_start);
        let mut rest = self.values.as_mut_slice();
        let mut pieces = Vec::new();
        let n = symbolic.order.len();
        for first in (0..n).step_by(GROUPS) {
            let groups = first..n.min(first + GROUPS);
            let length = value_start[column[groups.end]] - value_start[column[first]];
            let (own, tail) = rest.split_at_mut(length);
            pieces.push((groups, own));
            rest = tail;
        }
        pieces.into_par_iter().for_each(|(groups, mut values)| {
            for g in groups {
                for b in column[g]..column[g + 1] {
                    let rows = &scale[symbolic.of_group(row[b])];
                    let (block, tail) = values.split_at_mut(value_start[b + 1] - value_start[b]);
                    values = tail;
                    let columns = block.chunks_exact_mut(rows.len().max(1));
                    for (column, own) in columns.zip(&scale[symbolic.of_group(g as u32)]) {
                        let both = column.iter_mut().zip(rows);
                        both.for_each(|(v, s)| *v *= s * own);
                    }
                }
            }
        });
    }

    /// Subtracts a product: `r -= A y`. `r` contains `M` columns row by row. `y` contains `k` columns, of which the `M` columns from number `c` on
    /// are used. Elimination order.
    pub(super) fn subtract_product<const M: usize>(
        &self,
        symbolic: &Symbolic,
        y: &[f64],
        (k, c): (usize, usize),
        r: &mut [[f64; M]],
    ) {
        let row = |i: usize| -> [f64; M] { std::array::from_fn(|m| y[i * k + c + m]) };
        let (mut own, mut sums) = (Vec::<[f64; M]>::new(), Vec::<[f64; M]>::new());
        for g in 0..symbolic.order.len() {
            let unknowns = symbolic.of_group(g as u32);
            own.clear();
            own.extend(unknowns.clone().map(row));
            sums.clear();
            sums.resize(own.len(), [0.0; M]);
            for (h, block) in self.column_of(g) {
                let rows = symbolic.of_group(h);
                let n = rows.len();
                for (i, at) in rows.enumerate() {
                    let (yi, mut ri) = (row(at), [0.0; M]);
                    for (j, (yj, sum)) in own.iter().zip(&mut sums).enumerate() {
                        let a = block[j * n + i];
                        (0..M).for_each(|m| ri[m] += a * yj[m]);
                        if h as usize != g {
                            (0..M).for_each(|m| sum[m] += a * yi[m]);
                        }
                    }
                    (0..M).for_each(|m| r[at][m] -= ri[m]);
                }
            }
            for (at, sum) in unknowns.zip(&sums) {
                (0..M).for_each(|m| r[at][m] -= sum[m]);
            }
        }
    }

    /// Adds to the diagonal at an unknown, elimination order.
    pub(super) fn add_to_place(&mut self, symbolic: &Symbolic, unknown: usize, value: f64) {
        let group = symbolic.start.partition_point(|&s| s <= unknown) - 1;
        let (m, i) = (
            symbolic.of_group(group as u32).len(),
            unknown - symbolic.start[group],
        );
        self.values[self.value_start[self.column[group]] + i * m + i] += value;
    }

    /// Returns the diagonal in elimination order.
    pub(super) fn diagonal(&self, symbolic: &Symbolic) -> Vec<f64> {
        let mut d = Vec::with_capacity(symbolic.n_unknowns());
        for g in 0..symbolic.order.len() {
            let m = symbolic.start[g + 1] - symbolic.start[g];
            let first = self.value_start[self.column[g]];
            d.extend((0..m).map(|i| self.values[first + i * m + i]));
        }
        d
    }

    /// Returns the diagonal in the caller's numbering.
    pub fn diagonal_values(&self, symbolic: &Symbolic) -> Vec<f64> {
        let d = self.diagonal(symbolic);
        let mut out = vec![0.0; d.len()];
        for (new, &old) in symbolic.order.iter().enumerate() {
            let (from, to) = (symbolic.start[new], symbolic.start[new + 1]);
            let at = symbolic.old_start[old as usize];
            out[at..at + to - from].copy_from_slice(&d[from..to]);
        }
        out
    }

    /// Returns the product with a vector, both in the caller's numbering.
    pub fn times(&self, symbolic: &Symbolic, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for g in 0..symbolic.order.len() {
            let mg = symbolic.start[g + 1] - symbolic.start[g];
            let xg = symbolic.old_start[symbolic.order[g] as usize];
            for b in self.column[g]..self.column[g + 1] {
                let h = self.row[b] as usize;
                let mh = symbolic.start[h + 1] - symbolic.start[h];
                let xh = symbolic.old_start[symbolic.order[h] as usize];
                for j in 0..mg {
                    for i in 0..mh {
                        let v = self.values[self.value_start[b] + j * mh + i];
                        y[xh + i] += v * x[xg + j];
                        if h != g {
                            y[xg + j] += v * x[xh + i];
                        }
                    }
                }
            }
        }
        y
    }

    /// Returns the lower triangle in the caller's numbering (rows, columns, values), for files and comparisons.
    pub fn lower_triplets(&self, symbolic: &Symbolic) -> Vec<(usize, usize, f64)> {
        let mut all = Vec::new();
        for g in 0..symbolic.order.len() {
            let mg = symbolic.start[g + 1] - symbolic.start[g];
            let xg = symbolic.old_start[symbolic.order[g] as usize];
            for b in self.column[g]..self.column[g + 1] {
                let h = self.row[b] as usize;
                let mh = symbolic.start[h + 1] - symbolic.start[h];
                let xh = symbolic.old_start[symbolic.order[h] as usize];
                for j in 0..mg {
                    for i in if h == g { j } else { 0 }..mh {
                        let (r, c) = (xh + i, xg + j);
                        all.push((
                            r.max(c),
                            r.min(c),
                            self.values[self.value_start[b] + j * mh + i],
                        ));
                    }
                }
            }
        }
        all
    }
}

impl BlockMatrix {
    /// Returns the diagonal block of a group (caller's numbering), row by row.
    pub fn diagonal_block(&self, symbolic: &Symbolic, group: usize) -> &[f64] {
        let g = symbolic.position[group] as usize;
        let b = self.column[g];
        &self.values[self.value_start[b]..self.value_start[b + 1]]
    }

    /// Adds to the diagonal at an unknown (caller's numbering).
    pub fn add_to_diagonal(&mut self, symbolic: &Symbolic, unknown: usize, value: f64) {
        let group = symbolic.old_start.partition_point(|&s| s <= unknown) - 1;
        let m = symbolic.old_start[group + 1] - symbolic.old_start[group];
        let i = unknown - symbolic.old_start[group];
        let b = self.column[symbolic.position[group] as usize];
        self.values[self.value_start[b] + i * m + i] += value;
    }
}
