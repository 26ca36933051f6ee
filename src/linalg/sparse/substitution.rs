//! Substitution with many right-hand sides: branches of the elimination tree side by side, then the top.
//!
//! Right-hand sides are kept row by row, all values of an unknown side by side.

use super::branches::{Branch, Branches};
use super::factor::Factor;
use super::panel::Panel;
use super::symbolic::Symbolic;
use rayon::prelude::*;

/// Triangle of the substitution.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Forward,
    Backward,
}

/// Rows that a substitution reads and writes: rows of a branch and of the top, or of the top alone.
struct Rows<'a> {
    branch: &'a mut [f64],
    top: &'a mut [f64],
    /// The branch's unknowns.
    unknowns: std::ops::Range<usize>,
    /// Columns.
    k: usize,
}

impl Rows<'_> {
    /// The rows from a group's unknowns on.
    fn rows_from_group(&mut self, symbolic: &Symbolic, g: u32) -> &mut [f64] {
        let first = symbolic.start[g as usize];
        if self.unknowns.contains(&first) {
            &mut self.branch[(first - self.unknowns.start) * self.k..]
        } else {
            &mut self.top[symbolic.branches.in_top[g as usize] as usize * self.k..]
        }
    }
}

impl Factor<'_> {
    /// Replaces `k` right-hand sides of `L L'` by solutions.
    pub(super) fn substitute(&self, y: &mut [f64], k: usize) {
        let branches = &self.symbolic.branches;
        let mut above = self.take_top_rows(y, k);
        let mut bins = slices(branches, y, k);
        let sums: Vec<Vec<f64>> = bins
            .par_iter_mut()
            .with_max_len(1)
            .map(|bin| {
                let mut sum = vec![0.0; above.len()];
                self.substitute_branches(bin, Way::Forward, &mut sum, k);
                sum
            })
            .collect();
        for sum in &sums {
            let rows = above.iter_mut();
            rows.zip(sum).for_each(|(r, s)| *r += s);
        }
        drop(sums);
        self.through_top(&mut above, k);
        bins.par_iter_mut().with_max_len(1).for_each(|bin| {
            let mut above = above.clone();
            self.substitute_branches(bin, Way::Backward, &mut above, k);
        });
        drop(bins);
        self.give_back(&above, y, k);
    }

    /// The rows of the top.
    fn take_top_rows(&self, y: &[f64], k: usize) -> Vec<f64> {
        let branches = &self.symbolic.branches;
        let mut rows = Vec::with_capacity(branches.n_top * k);
        for &s in &branches.top {
            let own = self.symbolic.unknowns(s);
            rows.extend(&y[own.start * k..own.end * k]);
        }
        rows
    }

    fn give_back(&self, mut above: &[f64], y: &mut [f64], k: usize) {
        for &s in &self.symbolic.branches.top {
            let own = self.symbolic.unknowns(s);
            let (rows, rest) = above.split_at(own.len() * k);
            y[own.start * k..own.end * k].copy_from_slice(rows);
            above = rest;
        }
    }

    /// Substitutes in branches with all their supernodes.
    fn substitute_branches(
        &self,
        bin: &mut [(&Branch, &mut [f64])],
        way: Way,
        top: &mut [f64],
        k: usize,
    ) {
        let mut work = Vec::new();
        for (branch, rows) in bin {
            let mut rows = Rows {
                branch: rows,
                top,
                unknowns: branch.unknowns.clone(),
                k,
            };
            let nodes = branch.supernodes.clone();
            match way {
                Way::Forward => nodes.for_each(|s| self.node(s, way, &mut rows, &mut work)),
                Way::Backward => nodes
                    .rev()
                    .for_each(|s| self.node(s, way, &mut rows, &mut work)),
            }
        }
    }

    fn through_top(&self, above: &mut [f64], k: usize) {
        let mut work = Vec::new();
        let mut rows = Rows {
            branch: &mut [],
            top: above,
            unknowns: 0..0,
            k,
        };
        let top = &self.symbolic.branches.top;
        for s in top {
            self.node(*s, Way::Forward, &mut rows, &mut work);
        }
        for s in top.iter().rev() {
            self.node(*s, Way::Backward, &mut rows, &mut work);
        }
    }

    /// Substitutes in a supernode, as many columns at a time as stay in registers.
    fn node(&self, s: usize, way: Way, rows: &mut Rows<'_>, work: &mut Vec<f64>) {
        let mut c = 0;
        while c < rows.k {
            match rows.k - c {
                1..=4 => self.columns::<4>(s, way, rows, c, work),
                5..=8 => self.columns::<8>(s, way, rows, c, work),
                _ => self.columns::<12>(s, way, rows, c, work),
            }
            c += 12;
        }
    }

    /// Substitutes in a supernode for `K` columns from the `c`th, or as many as there are.
    fn columns<const K: usize>(
        &self,
        s: usize,
        way: Way,
        rows: &mut Rows<'_>,
        c: usize,
        work: &mut Vec<f64>,
    ) {
        let (symbolic, nodes) = (self.symbolic, &self.symbolic.nodes);
        let own = symbolic.unknowns(s).len();
        let panel = Panel {
            values: &self.values[nodes.values(s..s + 1)],
            rows: own + nodes.n_below(s),
            own,
        };
        let (k, n) = (rows.k, K.min(rows.k - c));
        work.clear();
        work.resize(panel.rows * K, 0.0);
        let (work, _) = work.as_chunks_mut::<K>();
        let (mine, below) = work.split_at_mut(own);
        let first = nodes.first[s];
        let from = rows.rows_from_group(symbolic, first).chunks_exact(k);
        mine.iter_mut()
            .zip(from)
            .for_each(|(to, from)| to[..n].copy_from_slice(&from[c..c + n]));
        if way == Way::Backward {
            let mut below = below.iter_mut();
            for &g in nodes.rows(s) {
                let size = symbolic.of_group(g).len();
                let from = rows.rows_from_group(symbolic, g).chunks_exact(k).take(size);
                for (from, to) in from.zip(&mut below) {
                    to[..n].copy_from_slice(&from[c..c + n]);
                }
            }
            panel.backward(work);
        } else {
            panel.forward(work);
            let mut below = work[own..].iter();
            for &g in nodes.rows(s) {
                let size = symbolic.of_group(g).len();
                let to = rows
                    .rows_from_group(symbolic, g)
                    .chunks_exact_mut(k)
                    .take(size);
                for (to, from) in to.zip(&mut below) {
                    let to = to[c..c + n].iter_mut();
                    to.zip(from).for_each(|(t, f)| *t += f);
                }
            }
        }
        let to = rows.rows_from_group(symbolic, first).chunks_exact_mut(k);
        work[..own]
            .iter()
            .zip(to)
            .for_each(|(from, to)| to[c..c + n].copy_from_slice(&from[..n]));
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
