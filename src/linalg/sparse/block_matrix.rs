//! A symmetric matrix in blocks, stored in elimination order, ready to be assembled in parallel.

use super::graph::BlockGraph;
use super::symbolic::Symbolic;
use rayon::prelude::*;

/// Lower triangle of a symmetric matrix by block columns; a block is stored by columns, diagonal blocks in full.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix {
    /// First block of each block column, and the total.
    pub(super) column: Vec<usize>,
    /// Block row, ascending in a column; the first is the diagonal block.
    pub(super) row: Vec<u32>,
    /// First value of each block, and the total.
    pub(super) value_start: Vec<usize>,
    pub(super) values: Vec<f64>,
}

/// A dense symmetric matrix to be added: groups (caller's numbering), first row of each group, the matrix by rows.
#[derive(Clone, Copy, Debug)]
pub struct DenseTerm<'a> {
    /// Groups, each once.
    pub groups: &'a [u32],
    /// First row of each group in `matrix`.
    pub offsets: &'a [usize],
    /// Order of the matrix.
    pub n: usize,
    /// Entries, row by row.
    pub matrix: &'a [f64],
}

impl BlockMatrix {
    /// A zero matrix with a block wherever the graph has an edge.
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

    /// Adds dense terms in parallel; a term's groups must all be joined in the graph.
    pub fn add(&mut self, symbolic: &Symbolic, terms: &[DenseTerm<'_>]) {
        let n = self.column.len() - 1;
        let parts = rayon::current_num_threads().clamp(1, n.max(1));
        let total = self.values.len();
        let mut bounds = vec![0];
        for p in 1..parts {
            let wanted = total * p / parts;
            bounds.push(self.column[..n].partition_point(|&b| self.value_start[b] < wanted));
        }
        bounds.push(n);
        let mut rest = self.values.as_mut_slice();
        let mut pieces = Vec::with_capacity(parts);
        for w in bounds.windows(2) {
            let (from, to) = (
                self.value_start[self.column[w[0]]],
                self.value_start[self.column[w[1]]],
            );
            let (piece, tail) = rest.split_at_mut(to - from);
            pieces.push((w[0]..w[1], from, piece));
            rest = tail;
        }
        let (column, row, value_start) = (&self.column, &self.row, &self.value_start);
        pieces.into_par_iter().for_each(|(range, base, values)| {
            for term in terms {
                for (b, &gb) in term.groups.iter().enumerate() {
                    let pb = symbolic.position[gb as usize];
                    if !range.contains(&(pb as usize)) {
                        continue;
                    }
                    let mb = symbolic.start[pb as usize + 1] - symbolic.start[pb as usize];
                    let (from, to) = (column[pb as usize], column[pb as usize + 1]);
                    for (a, &ga) in term.groups.iter().enumerate() {
                        let pa = symbolic.position[ga as usize];
                        if pa < pb {
                            continue;
                        }
                        let Ok(at) = row[from..to].binary_search(&pa) else {
                            continue;
                        };
                        let ma = symbolic.start[pa as usize + 1] - symbolic.start[pa as usize];
                        let block = &mut values[value_start[from + at] - base..][..ma * mb];
                        for (j, col) in block.chunks_exact_mut(ma.max(1)).enumerate() {
                            let source = &term.matrix
                                [(term.offsets[b] + j) * term.n + term.offsets[a]..][..ma];
                            for (v, s) in col.iter_mut().zip(source) {
                                *v += s;
                            }
                        }
                    }
                }
            }
        });
    }

    /// Column starts, rows and values of the lower triangle by unknowns in elimination order, rows and columns scaled.
    pub(super) fn lower_columns(
        &self,
        symbolic: &Symbolic,
        scale: &[f64],
    ) -> (Vec<u32>, Vec<u32>, Vec<f64>) {
        let n_groups = symbolic.order.len();
        let mut columns = Vec::with_capacity(symbolic.n_unknowns() + 1);
        let mut total = 0_u32;
        columns.push(total);
        for g in 0..n_groups {
            let m = symbolic.start[g + 1] - symbolic.start[g];
            let all = self.value_start[self.column[g + 1]] - self.value_start[self.column[g]];
            for j in 0..m {
                // The symbolic factor of the same pattern was counted with 32-bit indices before.
                total += (all / m - j) as u32;
                columns.push(total);
            }
        }
        let (mut rows, mut values) = (vec![0_u32; total as usize], vec![0.0; total as usize]);
        let (mut rest_rows, mut rest_values) = (rows.as_mut_slice(), values.as_mut_slice());
        let mut pieces = Vec::with_capacity(n_groups);
        for g in 0..n_groups {
            let (from, to) = (symbolic.start[g], symbolic.start[g + 1]);
            let length = (columns[to] - columns[from]) as usize;
            let (r, tail_rows) = rest_rows.split_at_mut(length);
            let (v, tail_values) = rest_values.split_at_mut(length);
            pieces.push((g, r, v));
            (rest_rows, rest_values) = (tail_rows, tail_values);
        }
        pieces.into_par_iter().for_each(|(g, rows, values)| {
            let (from, to) = (symbolic.start[g], symbolic.start[g + 1]);
            let mut at = 0;
            for j in 0..to - from {
                for b in self.column[g]..self.column[g + 1] {
                    let h = self.row[b] as usize;
                    let (first, m) = (symbolic.start[h], symbolic.start[h + 1] - symbolic.start[h]);
                    for i in if h == g { j } else { 0 }..m {
                        rows[at] = (first + i) as u32;
                        values[at] = self.values[self.value_start[b] + j * m + i]
                            * scale[first + i]
                            * scale[from + j];
                        at += 1;
                    }
                }
            }
        });
        (columns, rows, values)
    }

    /// The diagonal in elimination order.
    pub(super) fn diagonal(&self, symbolic: &Symbolic) -> Vec<f64> {
        let mut d = Vec::with_capacity(symbolic.n_unknowns());
        for g in 0..symbolic.order.len() {
            let m = symbolic.start[g + 1] - symbolic.start[g];
            let first = self.value_start[self.column[g]];
            d.extend((0..m).map(|i| self.values[first + i * m + i]));
        }
        d
    }

    /// The diagonal in the caller's numbering.
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

    /// The product with a vector, both in the caller's numbering.
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

    /// The lower triangle in the caller's numbering: rows, columns, values; for files and comparisons.
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
    /// The diagonal block of a group (caller's numbering), row by row.
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
