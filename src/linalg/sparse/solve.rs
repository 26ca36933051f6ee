//! Forward and backward substitution for many right-hand sides.

use super::factor::{Factor, FactorError};
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::LltRef;
use faer::{Conj, MatMut, Par};
use rayon::prelude::*;

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
        let columns = x.len() / n;
        let share = columns.div_ceil(rayon::current_num_threads().max(1)).max(1);
        x.par_chunks_mut(share * n)
            .try_for_each(|part| self.solve_part(part, n))
    }

    fn solve_part(&self, x: &mut [f64], n: usize) -> Result<(), FactorError> {
        let (symbolic, columns) = (self.symbolic, x.len() / n);
        let mut y = vec![0.0; x.len()];
        for (x, y) in x.chunks_exact(n).zip(y.chunks_exact_mut(n)) {
            self.each_group(|new, old| {
                for i in 0..new.len() {
                    y[new.start + i] = x[old + i] * self.scale[new.start + i];
                }
            });
        }
        let scratch = symbolic
            .cholesky
            .solve_in_place_scratch::<f64>(columns, Par::Seq);
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| FactorError::TooLarge)?;
        LltRef::new(&symbolic.cholesky, &self.values).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut y, n, columns),
            Par::Seq,
            MemStack::new(&mut memory),
        );
        for (x, y) in x.chunks_exact_mut(n).zip(y.chunks_exact(n)) {
            self.each_group(|new, old| {
                for i in 0..new.len() {
                    x[old + i] = y[new.start + i] * self.scale[new.start + i];
                }
            });
        }
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
