//! Forward and backward substitution for many right-hand sides.

use super::factor::Factor;
use faer::linalg::matmul::matmul;
use faer::linalg::triangular_solve::{
    solve_lower_triangular_in_place, solve_upper_triangular_in_place,
};
use faer::prelude::{Reborrow, ReborrowMut};
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

impl Factor<'_> {
    /// Replaces right-hand sides by solutions: `x` holds columns of `n_unknowns` each, caller's numbering.
    pub fn solve(&self, x: &mut [f64]) {
        let n = self.symbolic.n_unknowns();
        if n == 0 || x.is_empty() {
            return;
        }
        let columns = x.len() / n;
        let share = columns.div_ceil(rayon::current_num_threads().max(1)).max(1);
        x.par_chunks_mut(share * n)
            .for_each(|part| self.solve_part(part, n));
    }

    fn solve_part(&self, x: &mut [f64], n: usize) {
        let k = x.len() / n;
        let symbolic = self.symbolic;
        let mut y = vec![0.0; n * k];
        for (new, &old) in symbolic.order.iter().enumerate() {
            let (from, to, at) = (
                symbolic.start[new],
                symbolic.start[new + 1],
                symbolic.old_start[old as usize],
            );
            for c in 0..k {
                for i in 0..to - from {
                    y[c * n + from + i] = x[c * n + at + i] * self.scale[from + i];
                }
            }
        }
        let widest = symbolic
            .supernodes
            .iter()
            .map(|s| s.n_rows)
            .max()
            .unwrap_or(0);
        let mut below = vec![0.0; widest * k];
        let mut rows: Vec<usize> = Vec::with_capacity(widest);
        for (s, panel) in symbolic.supernodes.iter().zip(&self.panels) {
            let (nc, nb) = (s.n_cols, s.n_rows);
            if nc == 0 {
                continue;
            }
            let first = symbolic.start[s.first as usize];
            let (top, bottom) =
                MatRef::from_column_major_slice(panel, nc + nb, nc).split_at_row(nc);
            let mut pivots =
                MatMut::from_column_major_slice_mut(&mut y, n, k).subrows_mut(first, nc);
            solve_lower_triangular_in_place(top, pivots.rb_mut(), Par::Seq);
            if nb > 0 {
                let temporary = &mut below[..nb * k];
                matmul(
                    MatMut::from_column_major_slice_mut(temporary, nb, k),
                    Accum::Replace,
                    bottom,
                    pivots.rb(),
                    1.0,
                    Par::Seq,
                );
                expand(&mut rows, &s.rows, &symbolic.start);
                for (column, part) in y.chunks_exact_mut(n).zip(temporary.chunks_exact(nb)) {
                    for (&r, v) in rows.iter().zip(part) {
                        column[r] -= v;
                    }
                }
            }
        }
        for (s, panel) in symbolic.supernodes.iter().zip(&self.panels).rev() {
            let (nc, nb) = (s.n_cols, s.n_rows);
            if nc == 0 {
                continue;
            }
            let first = symbolic.start[s.first as usize];
            let (top, bottom) =
                MatRef::from_column_major_slice(panel, nc + nb, nc).split_at_row(nc);
            if nb > 0 {
                let temporary = &mut below[..nb * k];
                expand(&mut rows, &s.rows, &symbolic.start);
                for (column, part) in y.chunks_exact(n).zip(temporary.chunks_exact_mut(nb)) {
                    for (&r, v) in rows.iter().zip(part) {
                        *v = column[r];
                    }
                }
                matmul(
                    MatMut::from_column_major_slice_mut(&mut y, n, k).subrows_mut(first, nc),
                    Accum::Add,
                    bottom.transpose(),
                    MatRef::from_column_major_slice(temporary, nb, k),
                    -1.0,
                    Par::Seq,
                );
            }
            let pivots = MatMut::from_column_major_slice_mut(&mut y, n, k).subrows_mut(first, nc);
            solve_upper_triangular_in_place(top.transpose(), pivots, Par::Seq);
        }
        for (new, &old) in symbolic.order.iter().enumerate() {
            let (from, to, at) = (
                symbolic.start[new],
                symbolic.start[new + 1],
                symbolic.old_start[old as usize],
            );
            for c in 0..k {
                for i in 0..to - from {
                    x[c * n + at + i] = y[c * n + from + i] * self.scale[from + i];
                }
            }
        }
    }
}

/// Unknowns of groups, in order.
fn expand(rows: &mut Vec<usize>, groups: &[u32], start: &[usize]) {
    rows.clear();
    for &g in groups {
        rows.extend(start[g as usize]..start[g as usize + 1]);
    }
}
