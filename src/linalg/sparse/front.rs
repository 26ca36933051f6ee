//! The frontal matrix of a supernode: its columns of the matrix with what its children leave, eliminated.
//!
//! # Reference
//! I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric linear equations, ACM Trans. Math. Softw. 9 (1983) 302.

use super::block_matrix::BlockMatrix;
use super::eliminate::{Tiles, eliminate, take_out};
use super::error::FactorError;
use super::symbolic::Symbolic;
use faer::{Accum, MatMut, MatRef};
use rayon::prelude::*;

/// Pivots of the scaled matrix below this are lost to rounding: nothing supports the unknown. Rounding leaves as much in a mechanism that moves other
/// unknowns a thousand times as far. Any support at all is a thousand times stiffer (Nastran stops at a ratio of 1e7).
const TINY_PIVOT: f64 = 1e-12;
/// Largest number of lost pivots of a front that springs hold one by one. If more pivots are lost, springs hold all unknowns of the front.
pub(super) const MOST_LOST: usize = 12;

/// Contribution of a supernode to its parent: the lower triangle of a matrix over its rows, by columns.
#[derive(Debug)]
pub(super) struct Update {
    pub(super) node: usize,
    values: Vec<f64>,
}

/// Memory for reuse: of updates, and of the columns of a front.
#[derive(Debug, Default)]
pub(super) struct Spare {
    updates: Vec<Vec<f64>>,
    columns: Vec<f64>,
}

impl Spare {
    pub(super) fn take_back(&mut self, update: Update) {
        self.updates.push(update.values);
    }

    /// An update of `n` values or more, whatever they were.
    fn update(&mut self, n: usize) -> Vec<f64> {
        let mut values = self.updates.pop().unwrap_or_default();
        if values.len() < n {
            values.resize(n, 0.0);
        }
        values
    }

    /// Columns of a front, zero.
    fn columns(&mut self, n: usize) -> Vec<f64> {
        let mut values = std::mem::take(&mut self.columns);
        values.clear();
        values.resize(n, 0.0);
        values
    }
}

/// Result of the elimination of a supernode.
#[derive(Debug)]
pub(super) struct EliminatedSupernode {
    pub(super) update: Update,
    /// Unknowns whose pivot was lost, elimination order.
    pub(super) lost: Vec<usize>,
    /// Smallest pivot that was not lost.
    pub(super) smallest_pivot: f64,
}

/// A run of unknowns that lie side by side in a child's rows and in its parent's front.
#[derive(Clone, Copy)]
struct Run {
    from: usize,
    to: usize,
    n: usize,
}

/// A supernode's front.
pub(super) struct Front<'a> {
    symbolic: &'a Symbolic,
    matrix: &'a BlockMatrix,
    node: usize,
    own: usize,
    below: usize,
    /// First place of each group of its rows in the front.
    places: Vec<usize>,
}

impl<'a> Front<'a> {
    pub(super) fn new(symbolic: &'a Symbolic, matrix: &'a BlockMatrix, node: usize) -> Self {
        let own = symbolic.unknowns(node).len();
        let mut at = own;
        let place = |g: &u32| {
            at += symbolic.of_group(*g).len();
            at - symbolic.of_group(*g).len()
        };
        let places = symbolic.nodes.rows(node).iter().map(place).collect();
        Self {
            symbolic,
            matrix,
            node,
            own,
            below: symbolic.nodes.n_below(node),
            places,
        }
    }

    /// Eliminates the supernode. The columns of the factor, each from the diagonal down, are written to `packed`. The result is the contribution to
    /// the parent.
    ///
    /// A lost pivot is held by a spring, and the front is formed again: only for structures that are refused anyway.
    ///
    /// # Errors
    /// A pivot that is not a number, or stays negative though a spring holds it.
    pub(super) fn eliminate_supernode(
        &self,
        packed: &mut [f64],
        children: &[Update],
        spare: &mut Spare,
        tiles: Tiles,
    ) -> Result<EliminatedSupernode, FactorError> {
        let (own, rows) = (self.own, self.own + self.below);
        let mut columns = spare.columns(own * rows);
        let panel = columns.as_mut_slice();
        let first = self.symbolic.unknowns(self.node).start;
        let runs: Vec<Vec<Run>> = children.iter().map(|c| self.runs(c.node)).collect();
        let mut lost: Vec<usize> = Vec::new();
        let mut all_held = false;
        let smallest_pivot = loop {
            self.put_matrix(panel);
            for (child, runs) in children.iter().zip(&runs) {
                self.add_to_panel(panel, child, runs);
            }
            for i in 0..own {
                if all_held || lost.contains(&i) {
                    panel[i * rows + i] += 1.0;
                }
            }
            let matrix = MatMut::from_column_major_slice_mut(&mut *panel, rows, own);
            let done = eliminate(matrix, tiles);
            let pivot = |i: usize| panel[i * rows + i].powi(2);
            let bad = match done {
                Ok(()) => (0..own).find(|&i| !(pivot(i) > TINY_PIVOT)),
                Err(i) => Some(i),
            };
            let Some(bad) = bad else {
                break (0..own).map(pivot).fold(f64::INFINITY, f64::min);
            };
            if all_held || lost.contains(&bad) {
                return Err(FactorError::NotANumber {
                    unknown: self.symbolic.old_unknown(first + bad),
                });
            }
            lost.push(bad);
            all_held = lost.len() > MOST_LOST;
            panel.fill(0.0);
        };
        let mut left = spare.update(self.below * self.below);
        let square = &mut left[..self.below * self.below];
        let begin = if children.is_empty() {
            Accum::Replace
        } else {
            self.collect(square, children, &runs, tiles);
            Accum::Add
        };
        if self.below > 0 {
            let factor = MatRef::from_column_major_slice(&*panel, rows, own);
            let update = MatMut::from_column_major_slice_mut(square, self.below, self.below);
            take_out(update, begin, factor.subrows(own, self.below), tiles);
        }
        pack(panel, rows, packed);
        spare.columns = columns;
        Ok(EliminatedSupernode {
            update: Update {
                node: self.node,
                values: left,
            },
            lost: lost.into_iter().map(|i| first + i).collect(),
            smallest_pivot,
        })
    }

    /// First place of a group in the front.
    fn place(&self, group: u32) -> usize {
        let groups = self.symbolic.nodes.groups(self.node);
        if (group as usize) < groups.end {
            return self.symbolic.start[group as usize] - self.symbolic.start[groups.start];
        }
        let rows = self.symbolic.nodes.rows(self.node);
        rows.binary_search(&group).map_or(0, |i| self.places[i])
    }

    /// The matrix's own columns.
    fn put_matrix(&self, panel: &mut [f64]) {
        let rows = self.own + self.below;
        for g in self.symbolic.nodes.groups(self.node) {
            let at = self.place(g as u32);
            for (h, block) in self.matrix.column_of(g) {
                let (to, n) = (self.place(h), self.symbolic.of_group(h).len());
                for (j, column) in block.chunks_exact(n.max(1)).enumerate() {
                    let skip = if h as usize == g { j } else { 0 };
                    panel[(at + j) * rows + to + skip..][..n - skip]
                        .copy_from_slice(&column[skip..]);
                }
            }
        }
    }

    /// Returns the places of the rows of a child in this front. No run of rows contains both own rows of the front and rows below.
    fn runs(&self, child: usize) -> Vec<Run> {
        let mut runs: Vec<Run> = Vec::new();
        let groups = self.symbolic.nodes.groups(self.node);
        let rows = self.symbolic.nodes.rows(self.node);
        let (mut from, mut next) = (0, 0);
        for &g in self.symbolic.nodes.rows(child) {
            let n = self.symbolic.of_group(g).len();
            let to = if (g as usize) < groups.end {
                self.symbolic.start[g as usize] - self.symbolic.start[groups.start]
            } else {
                next += rows[next..].partition_point(|r| *r < g);
                self.places[next]
            };
            match runs.last_mut() {
                Some(run) if run.to + run.n == to && to != self.own => run.n += n,
                _ => runs.push(Run { from, to, n }),
            }
            from += n;
        }
        runs
    }

    /// Adds the contribution of a child to the supernode's own columns.
    fn add_to_panel(&self, panel: &mut [f64], child: &Update, runs: &[Run]) {
        let (rows, order) = (self.own + self.below, order(runs));
        for (r, run) in runs.iter().enumerate().take_while(|r| r.1.to < self.own) {
            for i in 0..run.n {
                let from = &child.values[(run.from + i) * order..][..order];
                let to = &mut panel[(run.to + i) * rows..][..rows];
                add_column(to, 0, from, &runs[r..], i);
            }
        }
    }

    /// Sums the contributions of children to the rows below.
    fn collect(&self, left: &mut [f64], children: &[Update], runs: &[Vec<Run>], tiles: Tiles) {
        let n = self.below;
        // Sums the contributions of all children to one column.
        let add = |(column, to): (usize, &mut [f64])| {
            to[column..].fill(0.0);
            for (child, runs) in children.iter().zip(runs) {
                let at = self.own + column;
                let r = runs.partition_point(|r| r.to + r.n <= at);
                let Some(run) = runs.get(r).filter(|r| r.to <= at) else {
                    continue;
                };
                let order = order(runs);
                let i = at - run.to;
                let from = &child.values[(run.from + i) * order..][..order];
                add_column(to, self.own, from, &runs[r..], i);
            }
        };
        match tiles {
            Tiles::Own => left.chunks_exact_mut(n.max(1)).enumerate().for_each(add),
            Tiles::Shared => {
                let columns = left.par_chunks_exact_mut(n.max(1));
                columns.enumerate().for_each(add);
            }
        }
    }
}

/// The columns of a front, each from its diagonal down.
fn pack(panel: &[f64], rows: usize, packed: &mut [f64]) {
    let mut rest = packed;
    for (j, column) in panel.chunks_exact(rows.max(1)).enumerate() {
        let (to, tail) = rest.split_at_mut(rows - j);
        to.copy_from_slice(&column[j..]);
        rest = tail;
    }
}

/// Unknowns of a child's rows.
fn order(runs: &[Run]) -> usize {
    runs.last().map_or(0, |r| r.from + r.n)
}

/// Adds a child's column, from the `i`th unknown of the first run down; `to` begins at row `first` of the front.
fn add_column(to: &mut [f64], first: usize, from: &[f64], runs: &[Run], mut i: usize) {
    for run in runs {
        let n = run.n - i;
        let to = &mut to[run.to + i - first..][..n];
        let from = &from[run.from + i..][..n];
        to.iter_mut().zip(from).for_each(|(t, f)| *t += f);
        i = 0;
    }
}
