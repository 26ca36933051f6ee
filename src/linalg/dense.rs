//! Dense matrices: singular values, condition, least squares.

use nalgebra::{DMatrix, DVector};

/// A dense matrix.
pub type Matrix = DMatrix<f64>;
/// A dense vector.
pub type Vector = DVector<f64>;

/// A thin singular value decomposition `a = u diag(s) v'`, `s` descending.
#[derive(Clone, Debug)]
pub struct Svd {
    /// Left vectors, `rows x r`.
    pub u: Matrix,
    /// Singular values, `r = min(rows, columns)`.
    pub s: Vec<f64>,
    /// Right vectors, `columns x r`.
    pub v: Matrix,
}

/// Relative size below which a singular value counts as zero. Single-precision result files do not distinguish smaller values from rounding.
pub const RANK_TOLERANCE: f64 = 1e-6;

/// Returns the thin singular value decomposition `a = u diag(s) v'`, `s` descending. `None` if an entry of `a` is not finite.
///
/// # Example
/// ```
/// use strainbridge::linalg::{Matrix, dense};
///
/// let a = Matrix::from_row_slice(3, 2, &[3.0, 0.0, 0.0, -2.0, 0.0, 0.0]);
/// let d = dense::svd(&a).unwrap();
/// assert!((d.s[0] - 3.0).abs() < 1e-12 && (d.s[1] - 2.0).abs() < 1e-12);
/// let again = &d.u * Matrix::from_diagonal(&d.s.clone().into()) * d.v.transpose();
/// assert!((again - &a).amax() < 1e-12);
/// assert!((dense::condition(&a) - 1.5).abs() < 1e-12);
/// assert_eq!(dense::rank(&a), 2);
/// ```
pub fn svd(a: &Matrix) -> Option<Svd> {
    if a.iter().any(|v| !v.is_finite()) {
        return None;
    }
    if a.is_empty() {
        return Some(Svd {
            u: Matrix::zeros(a.nrows(), 0),
            s: Vec::new(),
            v: Matrix::zeros(a.ncols(), 0),
        });
    }
    // For tall and wide matrices, the right vectors must only span the row space, which the thin form gives.
    let d = bounded_svd(a.clone())?;
    let (u, vt) = (d.u?, d.v_t?);
    let mut order: Vec<usize> = (0..d.singular_values.len()).collect();
    order.sort_by(|&i, &j| d.singular_values[j].total_cmp(&d.singular_values[i]));
    let s = order.iter().map(|&i| d.singular_values[i]).collect();
    let pick_u = Matrix::from_fn(u.nrows(), order.len(), |r, c| u[(r, order[c])]);
    let pick_v = Matrix::from_fn(vt.ncols(), order.len(), |r, c| vt[(order[c], r)]);
    Some(Svd {
        u: pick_u,
        s,
        v: pick_v,
    })
}

/// Returns the shortest of the vectors that minimise `|a x - b|`. Singular values below `tolerance` times the largest count as zero. `None` if `a`
/// contains numbers that are not finite.
pub fn shortest_solution(a: &Matrix, b: &[f64], tolerance: f64) -> Option<Vec<f64>> {
    let d = svd(a)?;
    let limit = tolerance * d.s.first().copied().unwrap_or(0.0);
    let mut x = vec![0.0; a.ncols()];
    for (k, s) in d.s.iter().enumerate().filter(|s| *s.1 > limit) {
        let along: f64 = d.u.column(k).iter().zip(b).map(|(u, b)| u * b).sum();
        let column = d.v.column(k);
        let share = along / s;
        x.iter_mut()
            .zip(column.iter())
            .for_each(|(x, v)| *x += share * v);
    }
    Some(x)
}

/// Returns nalgebra's decomposition of finite numbers with a limit of sweeps. Without a limit the iteration never stops on some matrices, because the
/// last bit does not converge.
pub(super) fn bounded_svd(a: Matrix) -> Option<nalgebra::SVD<f64, nalgebra::Dyn, nalgebra::Dyn>> {
    let sweeps = 200 * (a.nrows().min(a.ncols()) + 5);
    [5.0, 50.0, 5000.0]
        .into_iter()
        .find_map(|loose| a.clone().try_svd(true, true, loose * f64::EPSILON, sweeps))
}

/// Returns the largest divided by the smallest singular value of a matrix with at least as many rows as columns. It is infinite for fewer rows or a
/// singular matrix.
pub fn condition(a: &Matrix) -> f64 {
    if a.nrows() < a.ncols() {
        return f64::INFINITY;
    }
    match svd(a) {
        Some(d) => match (d.s.first(), d.s.last()) {
            (Some(&hi), Some(&lo)) if lo > 0.0 => hi / lo,
            _ => f64::INFINITY,
        },
        None => f64::NAN,
    }
}

/// Returns the number of singular values above [`RANK_TOLERANCE`] times the largest.
pub fn rank(a: &Matrix) -> usize {
    svd(a).map_or(0, |d| {
        let limit = d.s.first().copied().unwrap_or(0.0) * RANK_TOLERANCE;
        d.s.iter().filter(|&&s| s > limit && s > 0.0).count()
    })
}

/// Returns the columns divided by their norm. A zero column is not changed.
pub fn unit_columns(a: &Matrix) -> Matrix {
    let mut m = a.clone();
    for mut c in m.column_iter_mut() {
        let n = c.norm();
        if n > 0.0 {
            c /= n;
        }
    }
    m
}
