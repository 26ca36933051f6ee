//! Forward and backward substitution by branches of the elimination tree.
//!
//! Branches are substituted side by side, some to a task; what they take from the unknowns of the top is summed before the top is
//! solved, with all threads on its large supernodes.

use super::branches::{Branch, Branches};
use super::factor::Factor;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLltRef, SupernodeRef};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

/// Entries of a supernode above which one substitution is shared by all threads.
const SHARED: usize = 1 << 18;

/// Working columns of a substitution.
#[derive(Default)]
struct Work {
    /// The unknowns of a supernode, column by column.
    own: Vec<f64>,
    /// Those of the rows below it.
    below: Vec<f64>,
}

impl Factor<'_> {
    /// Replaces `k` right-hand sides of L L' by solutions.
    pub(super) fn substitute(&self, y: &mut [f64], k: usize) {
        let SymbolicCholeskyRaw::Supernodal(nodes) = self.symbolic.cholesky.raw() else {
            return;
        };
        let factor = SupernodalLltRef::new(nodes, &self.values);
        let branches = &self.symbolic.branches;
        let mut top = Top::taken(branches, factor, y, k);
        let mut bins = slices(branches, y, k);
        let sums: Vec<Vec<f64>> = bins
            .par_iter_mut()
            .map(|bin| {
                let mut sum = vec![0.0; top.rows.len()];
                let mut work = Work::default();
                for (branch, rows) in bin {
                    forward_branch(branches, branch, factor, (rows, &mut sum), k, &mut work);
                }
                sum
            })
            .collect();
        top.add(&sums);
        drop(sums);
        top.solve();
        let above = &top.rows;
        bins.par_iter_mut().for_each(|bin| {
            let mut work = Work::default();
            for (branch, rows) in bin {
                backward_branch(branches, branch, factor, (rows, above), k, &mut work);
            }
        });
        drop(bins);
        top.given_back(y);
    }
}

/// The rows of each branch, by task.
fn slices<'a>(
    branches: &'a Branches,
    y: &'a mut [f64],
    k: usize,
) -> Vec<Vec<(&'a Branch, &'a mut [f64])>> {
    let mut taken = 0;
    let mut rest = y;
    let mut by_branch: Vec<Option<(&Branch, &mut [f64])>> = Vec::new();
    for branch in &branches.list {
        let (_, tail) = rest.split_at_mut((branch.unknowns.start - taken) * k);
        let (own, tail) = tail.split_at_mut(branch.unknowns.len() * k);
        by_branch.push(Some((branch, own)));
        taken = branch.unknowns.end;
        rest = tail;
    }
    let bins = branches.shared_out();
    bins.into_iter()
        .map(|bin| {
            let mut own: Vec<_> = bin
                .into_iter()
                .filter_map(|i| by_branch[i].take())
                .collect();
            own.sort_by_key(|(b, _)| b.supernodes.start);
            own
        })
        .collect()
}

/// Solves with the branch's supernodes upwards; what they take from rows of the top goes into `sum`.
fn forward_branch(
    branches: &Branches,
    branch: &Branch,
    factor: SupernodalLltRef<'_, u32, f64>,
    (rows, sum): (&mut [f64], &mut [f64]),
    k: usize,
    work: &mut Work,
) {
    let (first, end) = (branch.unknowns.start, branch.unknowns.end);
    for s in branch.supernodes.clone() {
        let node = factor.supernode(s);
        let at = (node.start() - first) * k;
        forward(node, &mut rows[at..], k, work, Par::Seq);
        let n = node.pattern().len();
        for (i, &row) in node.pattern().iter().enumerate() {
            let row = row as usize;
            let to = if row < end {
                &mut rows[(row - first) * k..][..k]
            } else {
                &mut sum[branches.in_top[row] as usize * k..][..k]
            };
            subtract(to, &work.below, i, n);
        }
    }
}

/// Solves with the branch's supernodes downwards, the top's unknowns being known.
fn backward_branch(
    branches: &Branches,
    branch: &Branch,
    factor: SupernodalLltRef<'_, u32, f64>,
    (rows, above): (&mut [f64], &[f64]),
    k: usize,
    work: &mut Work,
) {
    let (first, end) = (branch.unknowns.start, branch.unknowns.end);
    for s in branch.supernodes.clone().rev() {
        let node = factor.supernode(s);
        let n = node.pattern().len();
        work.below.resize(n * k, 0.0);
        for (i, &row) in node.pattern().iter().enumerate() {
            let row = row as usize;
            let from = if row < end {
                &rows[(row - first) * k..][..k]
            } else {
                &above[branches.in_top[row] as usize * k..][..k]
            };
            put(&mut work.below, from, i, n);
        }
        let at = (node.start() - first) * k;
        backward(node, &mut rows[at..], k, work, Par::Seq);
    }
}

/// The unknowns above all branches.
struct Top<'a> {
    branches: &'a Branches,
    factor: SupernodalLltRef<'a, u32, f64>,
    rows: Vec<f64>,
    k: usize,
}

impl<'a> Top<'a> {
    fn taken(
        branches: &'a Branches,
        factor: SupernodalLltRef<'a, u32, f64>,
        y: &[f64],
        k: usize,
    ) -> Self {
        let mut rows = Vec::with_capacity(branches.n_top * k);
        for &s in &branches.top {
            let node = factor.supernode(s);
            rows.extend(&y[node.start() * k..(node.start() + node.val().ncols()) * k]);
        }
        Self {
            branches,
            factor,
            rows,
            k,
        }
    }

    fn given_back(&self, y: &mut [f64]) {
        let mut rest = self.rows.as_slice();
        for &s in &self.branches.top {
            let node = self.factor.supernode(s);
            let (own, tail) = rest.split_at(node.val().ncols() * self.k);
            y[node.start() * self.k..][..own.len()].copy_from_slice(own);
            rest = tail;
        }
    }

    fn add(&mut self, sums: &[Vec<f64>]) {
        for sum in sums {
            let rows = self.rows.iter_mut();
            rows.zip(sum).for_each(|(r, s)| *r += s);
        }
    }

    fn solve(&mut self) {
        let (k, in_top) = (self.k, &self.branches.in_top);
        let rows = &mut self.rows;
        let mut work = Work::default();
        let par = |node: &SupernodeRef<'_, u32, f64>| {
            let large = node.val().nrows() * node.val().ncols() > SHARED;
            if large { Par::rayon(0) } else { Par::Seq }
        };
        for &s in &self.branches.top {
            let node = self.factor.supernode(s);
            let at = in_top[node.start()] as usize * k;
            forward(node, &mut rows[at..], k, &mut work, par(&node));
            let n = node.pattern().len();
            for (i, &row) in node.pattern().iter().enumerate() {
                let to = &mut rows[in_top[row as usize] as usize * k..][..k];
                subtract(to, &work.below, i, n);
            }
        }
        for &s in self.branches.top.iter().rev() {
            let node = self.factor.supernode(s);
            let n = node.pattern().len();
            work.below.resize(n * k, 0.0);
            for (i, &row) in node.pattern().iter().enumerate() {
                let from = &rows[in_top[row as usize] as usize * k..][..k];
                put(&mut work.below, from, i, n);
            }
            let at = in_top[node.start()] as usize * k;
            backward(node, &mut rows[at..], k, &mut work, par(&node));
        }
    }
}

/// `to -= ` row `i` of `n` rows kept column by column.
fn subtract(to: &mut [f64], columns: &[f64], i: usize, n: usize) {
    let from = columns[i..].iter().step_by(n);
    to.iter_mut().zip(from).for_each(|(t, f)| *t -= f);
}

/// Row `i` of `n` rows kept column by column `= from`.
fn put(columns: &mut [f64], from: &[f64], i: usize, n: usize) {
    let to = columns[i..].iter_mut().step_by(n);
    to.zip(from).for_each(|(t, f)| *t = *f);
}

/// L11 x = b on the supernode's own rows, the first of `rows`; `below` becomes L21 x.
fn forward(
    node: SupernodeRef<'_, u32, f64>,
    rows: &mut [f64],
    k: usize,
    work: &mut Work,
    par: Par,
) {
    let (w, m) = (node.val().ncols(), node.pattern().len());
    let (top, bottom) = node.val().split_at_row(w);
    columns_of(&rows[..w * k], w, &mut work.own);
    let mut own = MatMut::from_column_major_slice_mut(&mut work.own, w, k);
    solve_lower_triangular_in_place(top, own.rb_mut(), par);
    work.below.resize(m * k, 0.0);
    let below = MatMut::from_column_major_slice_mut(&mut work.below, m, k);
    matmul(below, Accum::Replace, bottom, own.rb(), 1.0, par);
    rows_of(&work.own, w, &mut rows[..w * k]);
}

/// L11' x = b - L21' below on the supernode's own rows, the first of `rows`.
fn backward(
    node: SupernodeRef<'_, u32, f64>,
    rows: &mut [f64],
    k: usize,
    work: &mut Work,
    par: Par,
) {
    let (w, m) = (node.val().ncols(), node.pattern().len());
    let (top, bottom) = node.val().split_at_row(w);
    columns_of(&rows[..w * k], w, &mut work.own);
    let mut own = MatMut::from_column_major_slice_mut(&mut work.own, w, k);
    let below = MatRef::from_column_major_slice(&work.below[..m * k], m, k);
    matmul(
        own.rb_mut(),
        Accum::Add,
        bottom.transpose(),
        below,
        -1.0,
        par,
    );
    solve_upper_triangular_in_place(top.transpose(), own.rb_mut(), par);
    rows_of(&work.own, w, &mut rows[..w * k]);
}

fn columns_of(rows: &[f64], n: usize, columns: &mut Vec<f64>) {
    columns.resize(rows.len(), 0.0);
    for (i, row) in rows.chunks_exact(rows.len() / n.max(1)).enumerate() {
        put(columns, row, i, n);
    }
}

fn rows_of(columns: &[f64], n: usize, rows: &mut [f64]) {
    let k = rows.len() / n.max(1);
    for (i, row) in rows.chunks_exact_mut(k).enumerate() {
        let from = columns[i..].iter().step_by(n);
        row.iter_mut().zip(from).for_each(|(t, f)| *t = *f);
    }
}
