//! Forward and backward substitution for many right-hand sides.

use super::factor::{Factor, FactorError};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::LltRef;
use faer::{Conj, MatMut, Par};
use rayon::prelude::*;

/// How well a solution satisfies its equation: Nastran's epsilon before and after refinement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// As substituted.
    pub first: f64,
    /// As given back.
    pub last: f64,
}

/// |x'r| / |x'b|; zero for no load.
fn epsilon(x: &[f64], r: &[f64], b: &[f64]) -> f64 {
    let dot = |v: &[f64]| x.iter().zip(v).map(|(x, v)| x * v).sum::<f64>().abs();
    let work = dot(b);
    if work > 0.0 { dot(r) / work } else { 0.0 }
}

/// Columns for each thread.
fn share_of(columns: usize) -> usize {
    let threads = rayon::current_num_threads().max(1);
    columns.div_ceil(threads).max(1)
}

impl Factor<'_> {
    /// Replaces right-hand sides by solutions: `x` holds columns of `n_unknowns` each, caller's numbering.
    ///
    /// # Errors
    /// Scratch space that memory doesn't hold.
    pub fn solve(&self, x: &mut [f64]) -> Result<(), FactorError> {
        let n = self.symbolic.n_unknowns();
        if n == 0 || x.is_empty() {
            return Ok(());
        }
        x.par_chunks_mut(share_of(x.len() / n) * n)
            .try_for_each(|part| self.solve_part(part, n))
    }

    fn solve_part(&self, x: &mut [f64], n: usize) -> Result<(), FactorError> {
        let mut y = self.scaled(x, n);
        self.substitute(&mut y, n)?;
        self.unscale(&y, x, n);
        Ok(())
    }

    /// As [`Factor::solve`], and tells how well each column satisfies its equation; a column that does so badly is corrected by
    /// one step of iterative refinement.
    ///
    /// The measure is Nastran's epsilon, |x'(b - A x)| / |x'b|: the share of the work of the loads that rounding lost.
    /// Columns above `limit` are refined, x + A^-1 (b - A x), and the correction kept where it helps.
    ///
    /// # Errors
    /// Scratch space that memory doesn't hold.
    pub fn solve_refined(&self, x: &mut [f64], limit: f64) -> Result<Vec<Refined>, FactorError> {
        let n = self.symbolic.n_unknowns();
        if n == 0 || x.is_empty() {
            return Ok(Vec::new());
        }
        let parts: Vec<Vec<Refined>> = x
            .par_chunks_mut(share_of(x.len() / n) * n)
            .map(|part| self.refine_part(part, n, limit))
            .collect::<Result<_, _>>()?;
        Ok(parts.concat())
    }

    fn refine_part(
        &self,
        x: &mut [f64],
        n: usize,
        limit: f64,
    ) -> Result<Vec<Refined>, FactorError> {
        let mut y = self.scaled(x, n);
        self.substitute(&mut y, n)?;
        let mut told = Vec::with_capacity(x.len() / n);
        for (x, y) in x.chunks_exact(n).zip(y.chunks_exact_mut(n)) {
            let b = self.scaled(x, n);
            let mut r = b.clone();
            self.matrix.subtract_product(y, &mut r);
            let first = epsilon(y, &r, &b);
            let mut last = first;
            if !(first <= limit) {
                self.substitute(&mut r, n)?;
                let better: Vec<f64> = y.iter().zip(&r).map(|(y, d)| y + d).collect();
                let mut rest = b.clone();
                self.matrix.subtract_product(&better, &mut rest);
                let after = epsilon(&better, &rest, &b);
                if after < first {
                    y.copy_from_slice(&better);
                    last = after;
                }
            }
            told.push(Refined { first, last });
        }
        self.unscale(&y, x, n);
        Ok(told)
    }

    /// Columns in elimination order, scaled as the right-hand side of the scaled matrix.
    fn scaled(&self, x: &[f64], n: usize) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (x, y) in x.chunks_exact(n).zip(y.chunks_exact_mut(n)) {
            self.each_group(|new, old| {
                for i in 0..new.len() {
                    y[new.start + i] = x[old + i] * self.scale[new.start + i];
                }
            });
        }
        y
    }

    /// Solutions of the scaled matrix in the caller's numbering.
    fn unscale(&self, y: &[f64], x: &mut [f64], n: usize) {
        for (x, y) in x.chunks_exact_mut(n).zip(y.chunks_exact(n)) {
            self.each_group(|new, old| {
                for i in 0..new.len() {
                    x[old + i] = y[new.start + i] * self.scale[new.start + i];
                }
            });
        }
    }

    fn substitute(&self, y: &mut [f64], n: usize) -> Result<(), FactorError> {
        let (symbolic, columns) = (self.symbolic, y.len() / n);
        let scratch = symbolic
            .cholesky
            .solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::TooLarge)?;
        LltRef::new(&symbolic.cholesky, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(y, n, columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        Ok(())
    }

    /// Calls with the unknowns of each group in elimination order and its first unknown in the caller's numbering.
    fn each_group(&self, mut call: impl FnMut(std::ops::Range<usize>, usize)) {
        let symbolic = self.symbolic;
        for (new, &old) in symbolic.order.iter().enumerate() {
            call(
                symbolic.start[new]..symbolic.start[new + 1],
                symbolic.old_start[old as usize],
            );
        }
    }
}
