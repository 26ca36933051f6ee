//! Forward and backward substitution for many right-hand sides.
//!
//! Right-hand sides are kept row by row (all values of an unknown side by side) in elimination order. Branches of the elimination tree are
//! substituted side by side, each by one thread; what they take from the unknowns of the crown is summed before the crown is.

use super::branches::{Branch, Branches};
use super::factor::{Factor, FactorError};
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::{SupernodalLltRef, SupernodeRef};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;
use std::ops::Range;

/// Right-hand sides substituted together: the factor is read once for all of them.
const TOGETHER: usize = 12;
/// Entries of a supernode above which one substitution is shared by all threads.
const SHARED: usize = 1 << 18;

/// Groups that a task brings into elimination order.
const GROUPS: usize = 4096;

/// How well a solution satisfies its equation: Nastran's epsilon before and after refinement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// As substituted.
    pub first: f64,
    /// As given back.
    pub last: f64,
}

/// Working columns of a substitution.
#[derive(Default)]
struct Work {
    /// The unknowns of a supernode, column by column.
    own: Vec<f64>,
    /// Those of the rows below it.
    below: Vec<f64>,
}

/// What is left of some right-hand sides.
struct Remainder {
    /// The first of its columns.
    first: usize,
    /// By column.
    epsilon: Vec<f64>,
    /// Row by row, elimination order.
    rows: Vec<f64>,
}

impl Factor<'_> {
    /// Replaces right-hand sides by solutions: `x` holds columns of `n_unknowns` each, caller's numbering.
    ///
    /// # Errors
    /// A right-hand side that is no whole number of columns gives none.
    pub fn solve(&self, x: &mut [f64]) -> Result<(), FactorError> {
        self.each_part(x, |part, k| {
            let mut y = self.scaled(part, k);
            self.substitute(&mut y, k);
            self.unscale(&y, part, k);
        });
        Ok(())
    }

    /// As [`Factor::solve`], and tells how well each column satisfies its equation; a column that does so badly is corrected by
    /// one step of iterative refinement.
    ///
    /// The measure is Nastran's epsilon, |x'(b - A x)| / |x'b|: the share of the work of the loads that rounding lost.
    /// Columns above `limit` are refined, x + A^-1 (b - A x), and the correction kept where it helps.
    ///
    /// # Errors
    /// As [`Factor::solve`].
    pub fn solve_refined(&self, x: &mut [f64], limit: f64) -> Result<Vec<Refined>, FactorError> {
        let mut told = Vec::new();
        self.each_part(x, |part, k| {
            let mut y = self.scaled(part, k);
            self.substitute(&mut y, k);
            told.extend(self.refine(&mut y, part, k, limit));
            self.unscale(&y, part, k);
        });
        Ok(told)
    }

    /// Calls with columns that go together and their number.
    fn each_part(&self, x: &mut [f64], mut call: impl FnMut(&mut [f64], usize)) {
        let n = self.symbolic.n_unknowns();
        if n == 0 || x.is_empty() {
            return;
        }
        let columns = x.len() / n;
        let together = columns.div_ceil(columns.div_ceil(TOGETHER).max(1)).max(1);
        for part in x.chunks_mut(together * n) {
            let k = part.len() / n;
            call(part, k);
        }
    }

    /// Epsilon of each of `k` solutions `y` for right-hand sides `x`; where it is above `limit`, a solution is replaced by its refinement
    /// if that is better.
    fn refine(&self, y: &mut [f64], x: &[f64], k: usize, limit: f64) -> Vec<Refined> {
        let found = self.remainders(y, x, k);
        let mut told = Vec::with_capacity(k);
        for f in &found {
            let as_told = f.epsilon.iter();
            told.extend(as_told.map(|&first| Refined { first, last: first }));
        }
        let poor: Vec<usize> = (0..k).filter(|&c| !(told[c].first <= limit)).collect();
        if poor.is_empty() {
            return told;
        }
        let (n, m) = (x.len() / k, poor.len());
        let mut better = Vec::with_capacity(n * m);
        for row in 0..n {
            better.extend(poor.iter().map(|&c| {
                let f = &found[found.partition_point(|f| f.first <= c) - 1];
                f.rows[row * f.epsilon.len() + c - f.first]
            }));
        }
        drop(found);
        self.substitute(&mut better, m);
        for (to, from) in better.chunks_exact_mut(m).zip(y.chunks_exact(k)) {
            to.iter_mut().zip(&poor).for_each(|(t, &c)| *t += from[c]);
        }
        let loads: Vec<f64> = poor
            .iter()
            .flat_map(|&c| x[c * n..(c + 1) * n].iter().copied())
            .collect();
        let after = self.remainders(&better, &loads, m);
        let after: Vec<f64> = after.into_iter().flat_map(|f| f.epsilon).collect();
        for (i, &c) in poor.iter().enumerate() {
            if after[i] < told[c].first {
                told[c].last = after[i];
                let rows = y.chunks_exact_mut(k).zip(better.chunks_exact(m));
                rows.for_each(|(to, from)| to[c] = from[i]);
            }
        }
        told
    }

    /// r = b - A y and |y'r| / |y'b| (zero for no load) of solutions `y` for right-hand sides `x`, a share of the columns a thread.
    fn remainders(&self, y: &[f64], x: &[f64], k: usize) -> Vec<Remainder> {
        let threads = rayon::current_num_threads().max(1);
        let share = k.div_ceil(threads).clamp(1, 6);
        let firsts: Vec<usize> = (0..k).step_by(share).collect();
        firsts
            .into_par_iter()
            .map(|c| match share.min(k - c) {
                1 => self.remainder::<1>(y, x, k, c),
                2 => self.remainder::<2>(y, x, k, c),
                3 => self.remainder::<3>(y, x, k, c),
                4 => self.remainder::<4>(y, x, k, c),
                5 => self.remainder::<5>(y, x, k, c),
                _ => self.remainder::<6>(y, x, k, c),
            })
            .collect()
    }

    fn remainder<const M: usize>(&self, y: &[f64], x: &[f64], k: usize, c: usize) -> Remainder {
        let n = x.len() / k;
        let mut r = vec![[0.0; M]; n];
        self.each_group(|new, old| {
            for i in 0..new.len() {
                let scale = self.scale[new.start + i];
                r[new.start + i] = std::array::from_fn(|m| x[(c + m) * n + old + i] * scale);
            }
        });
        let dots = |r: &[[f64; M]]| -> [f64; M] {
            let mut sums = [0.0; M];
            for (r, y) in r.iter().zip(y.chunks_exact(k)) {
                (0..M).for_each(|m| sums[m] += r[m] * y[c + m]);
            }
            sums
        };
        let work = dots(&r);
        self.matrix.subtract_product(y, (k, c), &mut r);
        let lost = dots(&r);
        let share = |(l, w): (&f64, &f64)| if w.abs() > 0.0 { (l / w).abs() } else { 0.0 };
        Remainder {
            first: c,
            epsilon: lost.iter().zip(&work).map(share).collect(),
            rows: r.into_flattened(),
        }
    }

    /// Columns in elimination order, row by row, scaled as the right-hand side of the scaled matrix.
    fn scaled(&self, x: &[f64], k: usize) -> Vec<f64> {
        let (n, symbolic) = (x.len() / k, self.symbolic);
        let mut y = vec![0.0; x.len()];
        // Groups of a task.
        let groups: Vec<&[u32]> = symbolic.order.chunks(GROUPS).collect();
        let mut rest = y.as_mut_slice();
        let mut pieces = Vec::with_capacity(groups.len());
        for (i, old) in groups.into_iter().enumerate() {
            let starts = &symbolic.start[i * GROUPS..][..=old.len()];
            let (own, tail) = rest.split_at_mut((starts[old.len()] - starts[0]) * k);
            pieces.push((old, starts, own));
            rest = tail;
        }
        pieces.into_par_iter().for_each(|(old, starts, y)| {
            let mut rows = y.chunks_exact_mut(k);
            for (&old, new) in old.iter().zip(starts.windows(2)) {
                let from = symbolic.old_start[old as usize];
                for (i, row) in (new[0]..new[1]).zip(&mut rows) {
                    let (scale, from) = (self.scale[i], from + i - new[0]);
                    for (c, y) in row.iter_mut().enumerate() {
                        *y = x[c * n + from] * scale;
                    }
                }
            }
        });
        y
    }

    /// Solutions of the scaled matrix in the caller's numbering.
    fn unscale(&self, y: &[f64], x: &mut [f64], k: usize) {
        let n = x.len() / k;
        x.par_chunks_exact_mut(n).enumerate().for_each(|(c, x)| {
            self.each_group(|new, old| {
                for i in 0..new.len() {
                    let at = new.start + i;
                    x[old + i] = y[at * k + c] * self.scale[at];
                }
            });
        });
    }

    /// Calls with the unknowns of each group in elimination order and its first unknown in the caller's numbering.
    fn each_group(&self, mut call: impl FnMut(Range<usize>, usize)) {
        let symbolic = self.symbolic;
        for (new, &old) in symbolic.order.iter().enumerate() {
            call(
                symbolic.start[new]..symbolic.start[new + 1],
                symbolic.old_start[old as usize],
            );
        }
    }

    /// Replaces `k` right-hand sides of L L' by solutions.
    fn substitute(&self, y: &mut [f64], k: usize) {
        let SymbolicCholeskyRaw::Supernodal(nodes) = self.symbolic.cholesky.raw() else {
            return;
        };
        let factor = SupernodalLltRef::new(nodes, &self.values);
        let branches = &self.symbolic.branches;
        let mut crown = Crown::taken(branches, factor, y, k);
        let mut bins = slices(branches, y, k);
        let sums: Vec<Vec<f64>> = bins
            .par_iter_mut()
            .map(|bin| {
                let mut sum = vec![0.0; crown.rows.len()];
                let mut work = Work::default();
                for (branch, rows) in bin {
                    forward_branch(branches, branch, factor, (rows, &mut sum), k, &mut work);
                }
                sum
            })
            .collect();
        crown.add(&sums);
        drop(sums);
        crown.solve();
        let above = &crown.rows;
        bins.par_iter_mut().for_each(|bin| {
            let mut work = Work::default();
            for (branch, rows) in bin {
                backward_branch(branches, branch, factor, (rows, above), k, &mut work);
            }
        });
        drop(bins);
        crown.given_back(y);
    }
}

/// The rows of each branch, shared out among the threads.
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
    let bins = branches.shared_out(rayon::current_num_threads());
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

/// Solves with the branch's supernodes upwards; what they take from rows of the crown goes into `sum`.
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
                &mut sum[branches.in_crown[row] as usize * k..][..k]
            };
            subtract(to, &work.below, i, n);
        }
    }
}

/// Solves with the branch's supernodes downwards, the crown's unknowns being known.
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
                &above[branches.in_crown[row] as usize * k..][..k]
            };
            put(&mut work.below, from, i, n);
        }
        let at = (node.start() - first) * k;
        backward(node, &mut rows[at..], k, work, Par::Seq);
    }
}

/// The unknowns above all branches.
struct Crown<'a> {
    branches: &'a Branches,
    factor: SupernodalLltRef<'a, u32, f64>,
    rows: Vec<f64>,
    k: usize,
}

impl<'a> Crown<'a> {
    fn taken(
        branches: &'a Branches,
        factor: SupernodalLltRef<'a, u32, f64>,
        y: &[f64],
        k: usize,
    ) -> Self {
        let mut rows = Vec::with_capacity(branches.n_crown * k);
        for &s in &branches.crown {
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
        for &s in &self.branches.crown {
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
        let (k, in_crown) = (self.k, &self.branches.in_crown);
        let rows = &mut self.rows;
        let mut work = Work::default();
        let par = |node: &SupernodeRef<'_, u32, f64>| {
            let large = node.val().nrows() * node.val().ncols() > SHARED;
            if large { Par::rayon(0) } else { Par::Seq }
        };
        for &s in &self.branches.crown {
            let node = self.factor.supernode(s);
            let at = in_crown[node.start()] as usize * k;
            forward(node, &mut rows[at..], k, &mut work, par(&node));
            let n = node.pattern().len();
            for (i, &row) in node.pattern().iter().enumerate() {
                let to = &mut rows[in_crown[row as usize] as usize * k..][..k];
                subtract(to, &work.below, i, n);
            }
        }
        for &s in self.branches.crown.iter().rev() {
            let node = self.factor.supernode(s);
            let n = node.pattern().len();
            work.below.resize(n * k, 0.0);
            for (i, &row) in node.pattern().iter().enumerate() {
                let from = &rows[in_crown[row as usize] as usize * k..][..k];
                put(&mut work.below, from, i, n);
            }
            let at = in_crown[node.start()] as usize * k;
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
