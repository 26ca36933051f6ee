//! The inverse of a dense covariance with its log-determinant: what a Gaussian likelihood over a few hundred readings needs.

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
        let mut lower = covariance.to_vec();
        let mut log_det = 0.0;
        for i in 0..n {
            for j in 0..=i {
                let (row_i, row_j) = (&lower[i * n..i * n + j], &lower[j * n..j * n + j]);
                let rest = lower[i * n + j] - dot(row_i, row_j);
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
        // Columns of L^-1, stored as rows; then P = L^-T L^-1.
        let mut columns = vec![0.0; n * n];
        for c in 0..n {
            for i in c..n {
                let unit = if i == c { 1.0 } else { 0.0 };
                let known = dot(&lower[i * n + c..i * n + i], &columns[c * n + c..c * n + i]);
                columns[c * n + i] = (unit - known) / lower[i * n + i];
            }
        }
        let mut inverse = vec![0.0; n * n];
        for i in 0..n {
            for j in 0..=i {
                let v = dot(
                    &columns[i * n + i..(i + 1) * n],
                    &columns[j * n + i..(j + 1) * n],
                );
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

/// Sum of products, in eight partial sums that the processor runs side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (whole_a, whole_b) = (a.chunks_exact(8), b.chunks_exact(8));
    let (rest_a, rest_b) = (whole_a.remainder(), whole_b.remainder());
    for (x, y) in whole_a.zip(whole_b) {
        for k in 0..8 {
            lanes[k] += x[k] * y[k];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(x, y)| x * y).sum();
    lanes.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests;
