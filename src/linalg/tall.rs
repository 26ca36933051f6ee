//! Least squares with many rows and few columns.

use super::dense::bounded_svd;
use nalgebra::{DMatrix, DVector};

/// Triangular factor of tall rows. It contains all information that least squares needs about the rows.
#[derive(Clone, Debug, PartialEq)]
pub struct Triangle {
    /// Columns of the problem that the factor contains, ascending.
    pub columns: Vec<usize>,
    /// Rows of the factor, each as long as `columns`.
    pub rows: Vec<Vec<f64>>,
    /// Number of rows that were reduced to the factor.
    pub n_rows: usize,
}

/// A least-squares solution with its quality.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Value for each column. It is 0 along directions that the rows do not determine.
    pub x: Vec<f64>,
    /// (A'A)^-1 by rows, undetermined directions left out.
    pub inverse: Vec<Vec<f64>>,
    /// Singular values of A with columns of unit norm, descending.
    pub singular_values: Vec<f64>,
    /// Right singular vectors in the order of the singular values, in unit-norm columns.
    pub directions: Vec<Vec<f64>>,
}

/// Singular values below this share of the largest (columns of unit norm) are taken as zero: rounding of sums of 1e5 terms.
const RANK_TOLERANCE: f64 = 1e-10;

/// Returns the triangular factor of the matrix whose given columns are `values`, by Householder reflections.
pub fn triangle(columns: &[(usize, &[f64])]) -> Triangle {
    let n = columns.first().map_or(0, |c| c.1.len());
    let a = DMatrix::from_fn(n, columns.len(), |i, j| columns[j].1[i]);
    let r = a.qr().r();
    Triangle {
        columns: columns.iter().map(|c| c.0).collect(),
        rows: (0..r.nrows())
            .map(|i| r.row(i).iter().copied().collect())
            .collect(),
        n_rows: n,
    }
}

impl Triangle {
    /// Returns the norm of A x over the original rows, for x over all columns of the problem.
    pub fn norm(&self, x: &[f64]) -> f64 {
        let dot = |row: &Vec<f64>| {
            row.iter()
                .zip(&self.columns)
                .map(|(r, &c)| r * x.get(c).copied().unwrap_or(0.0))
                .sum::<f64>()
        };
        self.rows.iter().map(|r| dot(r).powi(2)).sum::<f64>().sqrt()
    }
}

/// Returns the `x` that minimises the sum over blocks of `weight^2 |A x - y|^2`. Column `n` of the triangles is `y`.
pub fn solve(blocks: &[(f64, &Triangle)], n: usize) -> Solution {
    let m: usize = blocks.iter().map(|(_, t)| t.rows.len()).sum();
    let mut a = DMatrix::zeros(m.max(n), n);
    let mut y = DVector::zeros(m.max(n));
    let mut i = 0;
    for (w, t) in blocks {
        for row in &t.rows {
            for (v, &c) in row.iter().zip(&t.columns) {
                if c < n {
                    a[(i, c)] += w * v;
                } else if c == n {
                    y[i] += w * v;
                }
            }
            i += 1;
        }
    }
    solve_dense(a, &y)
}

/// The answer to numbers that are none.
fn undetermined_solution(n: usize) -> Solution {
    Solution {
        x: vec![f64::NAN; n],
        inverse: vec![vec![f64::NAN; n]; n],
        singular_values: vec![],
        directions: vec![],
    }
}

fn solve_dense(mut a: DMatrix<f64>, y: &DVector<f64>) -> Solution {
    let n = a.ncols();
    if a.iter().chain(y.iter()).any(|v| !v.is_finite()) {
        return undetermined_solution(n);
    }
    if a.is_empty() {
        return Solution {
            x: vec![0.0; n],
            inverse: vec![vec![0.0; n]; n],
            singular_values: vec![],
            directions: vec![],
        };
    }
    let norms: Vec<f64> = (0..n)
        .map(|j| a.column(j).norm())
        .map(|v| if v > 0.0 { v } else { 1.0 })
        .collect();
    for (j, norm) in norms.iter().enumerate() {
        a.column_mut(j).scale_mut(1.0 / norm);
    }
    let Some(svd) = bounded_svd(a) else {
        return undetermined_solution(n);
    };
    let (Some(u), Some(vt)) = (&svd.u, &svd.v_t) else {
        return undetermined_solution(n);
    };
    let mut order: Vec<usize> = (0..svd.singular_values.len()).collect();
    order.sort_by(|&i, &j| svd.singular_values[j].total_cmp(&svd.singular_values[i]));
    let largest = order.first().map_or(0.0, |&i| svd.singular_values[i]);
    let mut x = vec![0.0; n];
    let mut inverse = vec![vec![0.0; n]; n];
    for &k in order
        .iter()
        .filter(|&&k| svd.singular_values[k] > RANK_TOLERANCE * largest)
    {
        let s = svd.singular_values[k];
        let along = u.column(k).dot(y) / s;
        for i in 0..n {
            x[i] += along * vt[(k, i)] / norms[i];
            for j in 0..n {
                inverse[i][j] += vt[(k, i)] * vt[(k, j)] / (s * s * norms[i] * norms[j]);
            }
        }
    }
    Solution {
        x,
        inverse,
        singular_values: order.iter().map(|&k| svd.singular_values[k]).collect(),
        directions: order
            .iter()
            .map(|&k| vt.row(k).iter().copied().collect())
            .collect(),
    }
}

/// Returns the least-squares solution of a small dense system `A x = y` by rows. `None` if the rows are ragged or empty.
///
/// # Example
/// The line `y = 1 + 2 t` through three points:
/// ```
/// use strainbridge::linalg::tall::solve_rows;
///
/// let rows = [0.0, 1.0, 2.0].map(|t| vec![1.0, t]);
/// let line = solve_rows(&rows, &[1.0, 3.0, 5.0]).unwrap();
/// assert!((line.x[0] - 1.0).abs() < 1e-12 && (line.x[1] - 2.0).abs() < 1e-12);
/// // (A'A)^-1 = [[5, -3], [-3, 3]] / 6
/// assert!((line.inverse[0][0] - 5.0 / 6.0).abs() < 1e-12);
/// assert!((line.inverse[0][1] + 0.5).abs() < 1e-12);
/// assert!(solve_rows(&rows, &[1.0]).is_none());
/// ```
pub fn solve_rows(a: &[Vec<f64>], y: &[f64]) -> Option<Solution> {
    let n = a.first()?.len();
    if a.len() != y.len() || a.iter().any(|r| r.len() != n) || n == 0 {
        return None;
    }
    let m = a.len().max(n);
    let matrix = DMatrix::from_fn(m, n, |i, j| a.get(i).map_or(0.0, |r| r[j]));
    Some(solve_dense(
        matrix,
        &DVector::from_fn(m, |i, _| y.get(i).copied().unwrap_or(0.0)),
    ))
}

/// Returns the pseudo-inverse (n x m by rows) of a small m x n matrix given by rows. `None` if the matrix does not have full column rank.
pub fn left_inverse(a: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = a.first()?.len();
    let mut columns = Vec::new();
    for k in 0..a.len() {
        let unit: Vec<f64> = (0..a.len()).map(|i| f64::from(u8::from(i == k))).collect();
        let s = solve_rows(a, &unit)?;
        let (first, last) = (s.singular_values.first()?, s.singular_values.last()?);
        if s.singular_values.len() < n || a.len() < n || *last <= 1e-9 * first {
            return None;
        }
        columns.push(s.x);
    }
    Some(
        (0..n)
            .map(|i| columns.iter().map(|c| c[i]).collect())
            .collect(),
    )
}
