//! Solutions for many right-hand sides, and how well they satisfy their equations.
//!
//! Right-hand sides are kept row by row (all values of an unknown side by side) in elimination order.

use super::block_matrix::GROUPS;
use super::factor::Factor;
use rayon::prelude::*;
use std::ops::Range;

/// Right-hand sides substituted together: the factor is read once for all of them, and a row of them stays in registers.
const TOGETHER: usize = 12;

/// Accuracy of a solution: Nastran's epsilon before and after refinement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolutionAccuracy {
    /// Epsilon after substitution.
    pub first: f64,
    /// Epsilon of the returned solution.
    pub last: f64,
}

/// Residuals of some right-hand sides.
struct Remainder {
    /// First column of these right-hand sides.
    first: usize,
    /// Epsilon by column.
    epsilon: Vec<f64>,
    /// Residuals, row by row, in elimination order.
    rows: Vec<f64>,
}

impl Factor<'_> {
    /// Replaces right-hand sides by solutions: `x` contains columns of `n_unknowns` each, caller's numbering.
    pub fn solve(&self, x: &mut [f64]) {
        self.each_part(x, |part, k| {
            let mut y = self.scale_columns(part, k);
            self.substitute(&mut y, k);
            self.unscale(&y, part, k);
        });
    }

    /// Solves like [`Factor::solve`], and returns how well each column satisfies its equation. One step of iterative refinement corrects
    /// inaccurate columns.
    ///
    /// The measure is Nastran's epsilon, |x'(b - A x)| / |x'b|: the share of the work of the loads that rounding lost.
    /// Columns above `limit` are refined, x + A^-1 (b - A x), and the correction is kept if it improves them.
    pub fn solve_refined(&self, x: &mut [f64], limit: f64) -> Vec<SolutionAccuracy> {
        let mut accuracies = Vec::new();
        self.each_part(x, |part, k| {
            let mut y = self.scale_columns(part, k);
            self.substitute(&mut y, k);
            accuracies.extend(self.refine(&mut y, part, k, limit));
            self.unscale(&y, part, k);
        });
        accuracies
    }

    /// Calls `call` with groups of columns and the number of columns in each.
    fn each_part(&self, x: &mut [f64], mut call: impl FnMut(&mut [f64], usize)) {
        let n = self.symbolic.n_unknowns();
        if n == 0 || x.is_empty() {
            return;
        }
        for part in x.chunks_mut(TOGETHER * n) {
            let k = part.len() / n;
            call(part, k);
        }
    }

    /// Returns epsilon of each of `k` solutions `y` for right-hand sides `x`. If epsilon is above `limit`, a better refinement replaces the solution.
    fn refine(&self, y: &mut [f64], x: &[f64], k: usize, limit: f64) -> Vec<SolutionAccuracy> {
        let found = self.remainders(y, x, k);
        let mut accuracies = Vec::with_capacity(k);
        for f in &found {
            let epsilons = f.epsilon.iter();
            accuracies.extend(epsilons.map(|&first| SolutionAccuracy { first, last: first }));
        }
        let poor: Vec<usize> = (0..k)
            .filter(|&c| !(accuracies[c].first <= limit))
            .collect();
        if poor.is_empty() {
            return accuracies;
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
            if after[i] < accuracies[c].first {
                accuracies[c].last = after[i];
                let rows = y.chunks_exact_mut(k).zip(better.chunks_exact(m));
                rows.for_each(|(to, from)| to[c] = from[i]);
            }
        }
        accuracies
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
        self.matrix
            .subtract_product(self.symbolic, y, (k, c), &mut r);
        let lost = dots(&r);
        let share = |(l, w): (&f64, &f64)| if w.abs() > 0.0 { (l / w).abs() } else { 0.0 };
        Remainder {
            first: c,
            epsilon: lost.iter().zip(&work).map(share).collect(),
            rows: r.into_flattened(),
        }
    }

    /// Columns in elimination order, row by row, scaled as the right-hand side of the scaled matrix.
    fn scale_columns(&self, x: &[f64], k: usize) -> Vec<f64> {
        let (n, symbolic) = (x.len() / k, self.symbolic);
        let mut y = vec![0.0; x.len()];
        // Groups of each parallel task.
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
}
