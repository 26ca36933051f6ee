//! Factors of blocks so narrow that they stay in registers: the six unknowns of a grid.

use faer::prelude::ReborrowMut;
use faer::{MatMut, MatRef};

/// Largest number of unknowns of a block.
pub(super) const MOST: usize = 6;
/// Rows handled at a time.
const ROWS: usize = 8;

/// Computes the lower triangle of the factor of a block with at most [`MOST`] unknowns.
///
/// # Errors
/// The column whose pivot is not positive.
pub(super) fn cholesky(mut a: MatMut<'_, f64>) -> Result<(), usize> {
    let n = a.nrows();
    for j in 0..n {
        let mut pivot = a[(j, j)];
        for k in 0..j {
            pivot -= a[(j, k)] * a[(j, k)];
        }
        if !(pivot > 0.0) {
            return Err(j);
        }
        let root = pivot.sqrt();
        a[(j, j)] = root;
        for i in j + 1..n {
            let mut v = a[(i, j)];
            for k in 0..j {
                v -= a[(i, k)] * a[(j, k)];
            }
            a[(i, j)] = v / root;
        }
    }
    Ok(())
}

/// Solves `x l' = b` for `x` in place. `x` contains `b` by columns. `l` has at most [`MOST`] unknowns.
pub(super) fn solve(l: MatRef<'_, f64>, x: MatMut<'_, f64>) {
    match l.nrows() {
        1 => solve_columns::<1>(l, x),
        2 => solve_columns::<2>(l, x),
        3 => solve_columns::<3>(l, x),
        4 => solve_columns::<4>(l, x),
        5 => solve_columns::<5>(l, x),
        6 => solve_columns::<6>(l, x),
        _ => {}
    }
}

fn solve_columns<const N: usize>(l: MatRef<'_, f64>, mut x: MatMut<'_, f64>) {
    let factors = std::array::from_fn(|j| std::array::from_fn(|k| l[(j, k)]));
    let inverse = std::array::from_fn(|j| 1.0 / l[(j, j)]);
    let mut all = x.rb_mut().col_iter_mut();
    let columns: [&mut [f64]; N] = std::array::from_fn(|_| {
        let column = all.next().and_then(|c| c.try_as_col_major_mut());
        column.map(|c| c.as_slice_mut()).unwrap_or_default()
    });
    pulp::Arch::new().dispatch(SolveRows {
        l: &factors,
        inverse: &inverse,
        columns,
    });
}

/// x in x l' = b, which `columns` hold, with the inverse of the diagonal of `l`.
struct SolveRows<'a, 'b, const N: usize> {
    l: &'a [[f64; N]; N],
    inverse: &'a [f64; N],
    columns: [&'b mut [f64]; N],
}

impl<const N: usize> pulp::WithSimd for SolveRows<'_, '_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let Self {
            l,
            inverse,
            mut columns,
        } = self;
        let n = columns[0].len();
        let whole = n - n % ROWS;
        for at in (0..whole).step_by(ROWS) {
            let mut x = [[0.0; ROWS]; N];
            for (x, column) in x.iter_mut().zip(&columns) {
                x.copy_from_slice(&column[at..at + ROWS]);
            }
            solve_block(l, inverse, &mut x);
            for (x, column) in x.iter().zip(&mut columns) {
                column[at..at + ROWS].copy_from_slice(x);
            }
        }
        if whole < n {
            let mut x = [[0.0; ROWS]; N];
            for (x, column) in x.iter_mut().zip(&columns) {
                x[..n - whole].copy_from_slice(&column[whole..]);
            }
            solve_block(l, inverse, &mut x);
            for (x, column) in x.iter().zip(&mut columns) {
                column[whole..].copy_from_slice(&x[..n - whole]);
            }
        }
    }
}

#[inline(always)]
fn solve_block<const N: usize>(l: &[[f64; N]; N], inverse: &[f64; N], x: &mut [[f64; ROWS]; N]) {
    for j in 0..N {
        let mut own = x[j];
        for k in 0..j {
            for i in 0..ROWS {
                own[i] -= l[j][k] * x[k][i];
            }
        }
        for v in &mut own {
            *v *= inverse[j];
        }
        x[j] = own;
    }
}
