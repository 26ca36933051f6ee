//! The inverse of a dense covariance with its log-determinant: what a Gaussian likelihood over a few hundred readings needs.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::{factor, inverse};
use faer::{Mat, Par};

/// Up to this order plain loops are quicker than blocked kernels and their buffers.
const SMALL: usize = 48;

/// Inverse and log-determinant of a symmetric positive definite `n x n` covariance.
#[derive(Clone, Debug)]
pub struct Precision {
    n: usize,
    inverse: Vec<f64>,
    log_det: f64,
}

impl Precision {
    /// The precision of `covariance` (`n x n` by rows, lower triangle read), or `None` where it is not positive definite.
    pub fn of(covariance: &[f64], n: usize) -> Option<Self> {
        if covariance.len() != n * n {
            return None;
        }
        if n <= SMALL {
            Self::of_small(covariance, n)
        } else {
            Self::of_large(covariance, n)
        }
    }

    /// One thread: callers judge many small problems side by side, and thread start-up costs more than it gains at a few hundred.
    fn of_large(covariance: &[f64], n: usize) -> Option<Self> {
        let mut lower = Mat::from_fn(
            n,
            n,
            |i, j| if j <= i { covariance[i * n + j] } else { 0.0 },
        );
        let scratch = factor::cholesky_in_place_scratch::<f64>(n, Par::Seq, Default::default());
        let mut buffer = MemBuffer::new(scratch);
        let stack = MemStack::new(&mut buffer);
        factor::cholesky_in_place(
            lower.as_mut(),
            Default::default(),
            Par::Seq,
            stack,
            Default::default(),
        )
        .ok()?;
        let log_det = (0..n).map(|i| 2.0 * lower[(i, i)].ln()).sum();
        let mut dense = Mat::<f64>::zeros(n, n);
        let mut buffer = MemBuffer::new(inverse::inverse_scratch::<f64>(n, Par::Seq));
        inverse::inverse(
            dense.as_mut(),
            lower.as_ref(),
            Par::Seq,
            MemStack::new(&mut buffer),
        );
        let mut entries = Vec::with_capacity(n * n);
        for i in 0..n {
            entries.extend((0..n).map(|j| if j <= i { dense[(i, j)] } else { dense[(j, i)] }));
        }
        Some(Self {
            n,
            inverse: entries,
            log_det,
        })
    }

    /// Cholesky and inverse by plain loops: P = L^-T L^-1.
    fn of_small(covariance: &[f64], n: usize) -> Option<Self> {
        let mut lower = covariance.to_vec();
        let mut log_det = 0.0;
        for i in 0..n {
            for j in 0..=i {
                let (row_i, row_j) = (&lower[i * n..i * n + j], &lower[j * n..j * n + j]);
                let rest =
                    lower[i * n + j] - row_i.iter().zip(row_j).map(|(a, b)| a * b).sum::<f64>();
                if i == j {
                    if rest.is_nan() || rest <= 0.0 {
                        return None;
                    }
                    log_det += rest.ln();
                    lower[i * n + i] = rest.sqrt();
                } else {
                    lower[i * n + j] = rest / lower[j * n + j];
                }
            }
        }
        // Columns of L^-1, stored as rows.
        let mut columns = vec![0.0; n * n];
        for c in 0..n {
            for i in c..n {
                let unit = if i == c { 1.0 } else { 0.0 };
                let known = &columns[c * n + c..c * n + i];
                let sum: f64 = lower[i * n + c..i * n + i]
                    .iter()
                    .zip(known)
                    .map(|(a, b)| a * b)
                    .sum();
                columns[c * n + i] = (unit - sum) / lower[i * n + i];
            }
        }
        let mut inverse = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let v: f64 = (i..n)
                    .map(|k| columns[i * n + k] * columns[j * n + k])
                    .sum();
                inverse[i * n + j] = v;
                inverse[j * n + i] = v;
            }
        }
        Some(Self {
            n,
            inverse,
            log_det,
        })
    }

    /// Order.
    pub fn n(&self) -> usize {
        self.n
    }

    /// Natural log of the determinant of the covariance.
    pub fn log_det(&self) -> f64 {
        self.log_det
    }

    /// Entry (`i`, `j`) of the inverse; zero outside.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        if i < self.n {
            self.inverse.get(i * self.n + j).copied().unwrap_or(0.0)
        } else {
            0.0
        }
    }

    /// `P x`.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        self.inverse
            .chunks_exact(self.n.max(1))
            .map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
            .collect()
    }

    /// `P x` for an `x` given by its few entries (index, value).
    pub fn apply_sparse(&self, x: &[(usize, f64)]) -> Vec<f64> {
        let mut out = vec![0.0; self.n];
        for &(j, v) in x {
            // The inverse is symmetric: its row j is its column j.
            if let Some(row) = self.inverse.get(j * self.n..(j + 1) * self.n) {
                for (o, a) in out.iter_mut().zip(row) {
                    *o += a * v;
                }
            }
        }
        out
    }

    /// `x' P x` for an `x` given by its few entries.
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
mod tests {
    use super::Precision;

    #[test]
    fn inverse_and_determinant_of_a_two_by_two_covariance_are_those_of_the_closed_form() {
        // [[4, 1], [1, 3]]: determinant 11, inverse [[3, -1], [-1, 4]] / 11.
        let p = Precision::of(&[4.0, 1.0, 1.0, 3.0], 2).expect("positive definite");
        assert!((p.log_det() - 11f64.ln()).abs() < 1e-12);
        assert!(
            (p.entry(0, 0) - 3.0 / 11.0).abs() < 1e-14
                && (p.entry(1, 0) + 1.0 / 11.0).abs() < 1e-14
        );
        assert!(
            (p.quadratic_sparse(&[(0, 2.0), (1, 1.0)]) - (12.0 - 4.0 + 4.0) / 11.0).abs() < 1e-14
        );
        assert_eq!(p.apply(&[2.0, 1.0]), p.apply_sparse(&[(0, 2.0), (1, 1.0)]));
    }

    #[test]
    fn small_and_large_paths_agree_and_invert() {
        let n = 60;
        let entry = |i: usize, j: usize| {
            (-(i.abs_diff(j) as f64) / 7.0).exp() + if i == j { 0.5 } else { 0.0 }
        };
        let a: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let (small, large) = (
            Precision::of_small(&a, n).expect("definite"),
            Precision::of_large(&a, n).expect("definite"),
        );
        assert!((small.log_det() - large.log_det()).abs() < 1e-10);
        for i in 0..n {
            for j in 0..n {
                assert!((small.entry(i, j) - large.entry(i, j)).abs() < 1e-11);
                let product: f64 = (0..n).map(|k| entry(i, k) * large.entry(k, j)).sum();
                assert!((product - if i == j { 1.0 } else { 0.0 }).abs() < 1e-10);
            }
        }
    }

    #[test]
    fn a_covariance_that_is_not_positive_definite_has_no_precision() {
        assert!(Precision::of(&[1.0, 2.0, 2.0, 1.0], 2).is_none());
    }
}
