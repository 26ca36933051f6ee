//! The inverse of a dense covariance with its log-determinant: what a Gaussian likelihood over a few hundred readings needs.

use super::cholesky::Cholesky;
use std::sync::OnceLock;

/// Inverse and log-determinant of a symmetric positive definite `n x n` covariance. The entries of the inverse are computed on the first request for
/// an entry. Solutions alone do not need them.
#[derive(Clone, Debug)]
pub struct Precision {
    factor: Cholesky,
    inverse: OnceLock<Vec<f64>>,
}

impl Precision {
    /// Returns the precision of `covariance` (`n x n` by rows, lower triangle read). `None` if it is not positive definite.
    pub fn from_covariance(covariance: &[f64], n: usize) -> Option<Self> {
        Some(Self {
            factor: Cholesky::from_covariance(covariance, n)?,
            inverse: OnceLock::new(),
        })
    }

    /// Returns the order of the matrix.
    pub fn n(&self) -> usize {
        self.factor.n()
    }

    /// Returns the natural log of the determinant of the covariance.
    pub fn log_det(&self) -> f64 {
        self.factor.log_det()
    }

    /// Returns the entry (`i`, `j`) of the inverse. It is zero outside of the matrix.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let n = self.n();
        let at = (i < n && j < n).then(|| self.inverse().get(i * n + j));
        at.flatten().copied().unwrap_or(0.0)
    }

    /// Returns the inverse, by rows.
    fn inverse(&self) -> &[f64] {
        self.inverse.get_or_init(|| self.factor.inverse())
    }

    /// Returns `P x`.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.factor.solve(x)
    }

    /// Returns `P x` for a sparse `x`, given by its non-zero entries (index, value).
    pub fn apply_sparse(&self, x: &[(usize, f64)]) -> Vec<f64> {
        let n = self.n();
        let mut out = vec![0.0; n];
        for &(j, v) in x {
            // The inverse is symmetric, so that its row j is its column j.
            if let Some(row) = self.inverse().get(j * n..(j + 1) * n) {
                for (o, a) in out.iter_mut().zip(row) {
                    *o += a * v;
                }
            }
        }
        out
    }

    /// Returns `x' P x` for a sparse `x`, given by its non-zero entries.
    pub fn quadratic_sparse(&self, x: &[(usize, f64)]) -> f64 {
        let mut sum = 0.0;
        for &(i, a) in x {
            for &(j, b) in x {
                sum += a * b * self.entry(i, j);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests;
