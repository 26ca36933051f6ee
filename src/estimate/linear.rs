//! Loads, amplitudes or positions from readings that depend on them linearly, with Gaussian errors and Gaussian priors.

use crate::linalg::dense::{self, RANK_TOLERANCE};
use crate::linalg::{Matrix, Vector, spd};

/// Errors of readings, in the square of their unit.
#[derive(Clone, Copy, Debug)]
pub enum ReadingErrors<'a> {
    /// Variance of each reading; the readings err independently.
    Variances(&'a [f64]),
    /// Covariance of all readings, `n x n` by rows.
    Covariance(&'a [f64]),
}

/// Linear model `y = A f + e` with Gaussian errors `e` and priors `f_l ~ N(0, prior_sd_l^2)`. [`LinearGaussian::estimate`] solves it.
///
/// # Example
/// The mean of three readings of one quantity is the estimate of least squares, with the variance `sigma^2 / 3`:
/// ```
/// use strainbridge::estimate::{LinearGaussian, ReadingErrors};
/// use strainbridge::linalg::Matrix;
///
/// let rows = Matrix::from_element(3, 1, 1.0);
/// let model = LinearGaussian {
///     rows: &rows,
///     errors: ReadingErrors::Variances(&[4.0, 4.0, 4.0]),
///     prior_sd: &[None],
///     scales: &[1.0],
/// };
/// let estimate = model.estimate(&[9.0, 10.0, 14.0]).unwrap();
/// assert!((estimate.value[0] - 11.0).abs() < 1e-12);
/// assert!((estimate.covariance[(0, 0)] - 4.0 / 3.0).abs() < 1e-12);
/// assert!((estimate.chi2 - (4.0 + 1.0 + 9.0) / 4.0).abs() < 1e-12);
///
/// // A prior of N(0, 4/3) has the weight of the three readings and halves the value.
/// let with_prior = LinearGaussian { prior_sd: &[Some((4.0_f64 / 3.0).sqrt())], ..model };
/// assert!((with_prior.estimate(&[9.0, 10.0, 14.0]).unwrap().value[0] - 5.5).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct LinearGaussian<'a> {
    /// `A`, `n` readings by `k` parameters.
    pub rows: &'a Matrix,
    /// Errors `e`.
    pub errors: ReadingErrors<'a>,
    /// Standard deviation of each parameter before the measurement (mean 0); `None` if unknown.
    pub prior_sd: &'a [Option<f64>],
    /// Factors that bring the columns of `A` to comparable size.
    pub scales: &'a [f64],
}

/// Estimate of the parameters of a [`LinearGaussian`] model.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearEstimate {
    /// Parameters `f`.
    pub value: Vec<f64>,
    /// Covariance of `f`, `k x k`; infinite on the diagonal for a parameter that the readings do not determine.
    pub covariance: Matrix,
    /// `f = gain y`, `k x n`.
    pub gain: Matrix,
    /// Diagonal of the hat matrix `A gain`, by reading.
    pub leverage: Vec<f64>,
    /// Rank of the weighted system. Below `k` many solutions fit equally, and `f` is the smallest one.
    pub rank: usize,
    /// `(y - A f)' C^-1 (y - A f)`, priors left out.
    pub chi2: f64,
}

impl LinearGaussian<'_> {
    /// Estimates `f` from the readings `y` by singular value decomposition of the whitened rows `L^-1 A diag(scales)`, `C = L L'`. Each parameter
    /// with a prior adds a row `scale / prior_sd`. Returns `None` if a number is not finite or the covariance is not positive definite.
    pub fn estimate(&self, y: &[f64]) -> Option<LinearEstimate> {
        match self.errors {
            ReadingErrors::Variances(variances) => self.estimate_independent(y, variances),
            ReadingErrors::Covariance(covariance) => self.estimate_correlated(y, covariance),
        }
    }

    fn estimate_correlated(&self, y: &[f64], covariance: &[f64]) -> Option<LinearEstimate> {
        let s = self.rows;
        let (n, k) = s.shape();
        let root = spd::inverse_lower(&spd::cholesky(covariance, n)?, n);
        let white = |v: &dyn Fn(usize) -> f64| -> Vec<f64> {
            (0..n)
                .map(|i| (0..=i).map(|j| root[i * n + j] * v(j)).sum())
                .collect()
        };
        let columns: Vec<Vec<f64>> = (0..k).map(|l| white(&|g| s[(g, l)])).collect();
        let rows = Matrix::from_fn(n, k, |g, l| columns[l][g]);
        let whitened = LinearGaussian {
            rows: &rows,
            ..*self
        };
        let mut out = whitened.estimate_independent(&white(&|g| y[g]), &vec![1.0; n])?;
        let gain = out.gain.clone();
        for l in 0..k {
            for g in 0..n {
                out.gain[(l, g)] = (g..n).map(|i| gain[(l, i)] * root[i * n + g]).sum();
            }
        }
        for (g, h) in out.leverage.iter_mut().enumerate() {
            *h = (0..k).map(|l| s[(g, l)] * out.gain[(l, g)]).sum();
        }
        Some(out)
    }

    fn estimate_independent(&self, y: &[f64], variances: &[f64]) -> Option<LinearEstimate> {
        let (s, scales) = (self.rows, self.scales);
        let (n, k) = s.shape();
        let priors: Vec<(usize, f64)> = (self.prior_sd.iter().enumerate())
            .filter_map(|(l, p)| p.map(|p| (l, p)))
            .collect();
        let rows = (n + priors.len()).max(k);
        let mut a = Matrix::zeros(rows, k);
        for g in 0..n {
            let w = 1.0 / variances[g].sqrt();
            for l in 0..k {
                a[(g, l)] = w * s[(g, l)] * scales[l];
            }
        }
        for (i, &(l, sd)) in priors.iter().enumerate() {
            a[(n + i, l)] = scales[l] / sd;
        }
        let d = dense::svd(&a)?;
        let limit = d.s.first().copied().unwrap_or(0.0) * RANK_TOLERANCE;
        let rank = d.s.iter().filter(|&&v| v > limit && v > 0.0).count();
        // gain = scale V S^-1 U' W
        let mut gain = Matrix::zeros(k, n);
        let mut covariance = Matrix::zeros(k, k);
        let mut leverage = vec![0.0; n];
        for i in 0..rank {
            for g in 0..n {
                leverage[g] += d.u[(g, i)] * d.u[(g, i)];
                let u = d.u[(g, i)] / (d.s[i] * variances[g].sqrt());
                for l in 0..k {
                    gain[(l, g)] += scales[l] * d.v[(l, i)] * u;
                }
            }
            for l in 0..k {
                for m in 0..k {
                    covariance[(l, m)] +=
                        scales[l] * scales[m] * d.v[(l, i)] * d.v[(m, i)] / (d.s[i] * d.s[i]);
                }
            }
        }
        // Parameters in directions that the readings do not determine have no finite standard deviation.
        for i in rank..d.s.len() {
            for l in 0..k {
                if d.v[(l, i)].abs() > UNSEEN {
                    covariance[(l, l)] = f64::INFINITY;
                }
            }
        }
        let readings = Vector::from_column_slice(y);
        let f = &gain * &readings;
        let residual = readings - s * &f;
        let chi2 = (residual.iter().zip(variances))
            .map(|(r, v)| r * r / v)
            .sum();
        Some(LinearEstimate {
            value: f.iter().copied().collect(),
            covariance,
            gain,
            leverage,
            rank,
            chi2,
        })
    }
}

/// Share of a parameter in a combination that the readings do not determine, from which the parameter counts as undetermined.
const UNSEEN: f64 = 1e-6;

#[cfg(test)]
mod tests {
    use super::*;

    /// Generalised least squares in closed form for two readings of one quantity with variances 1 and 3 and correlation c.
    ///
    /// `f = (1' C^-1 y) / (1' C^-1 1)`, variance `1 / (1' C^-1 1)`.
    #[test]
    fn correlated_readings_have_the_closed_form_of_generalised_least_squares() {
        let (v1, v2, c) = (1.0, 3.0, 0.8);
        let det: f64 = v1 * v2 - c * c;
        let (w1, w2) = ((v2 - c) / det, (v1 - c) / det);
        let y = [2.0, 5.0];
        let model = LinearGaussian {
            rows: &Matrix::from_element(2, 1, 1.0),
            errors: ReadingErrors::Covariance(&[v1, c, c, v2]),
            prior_sd: &[None],
            scales: &[1.0],
        };
        let out = model.estimate(&y).unwrap();
        let f = (w1 * y[0] + w2 * y[1]) / (w1 + w2);
        let (a, b) = (y[0] - f, y[1] - f);
        let chi2 = (a * a * v2 - 2.0 * a * b * c + b * b * v1) / det;
        // Each value comes from a Cholesky factor and a division, with a few rounding errors.
        for (got, wanted) in [
            (out.value[0], f),
            (out.covariance[(0, 0)], 1.0 / (w1 + w2)),
            (out.gain[(0, 0)], w1 / (w1 + w2)),
            (out.leverage.iter().sum(), 1.0),
            (out.chi2, chi2),
        ] {
            assert!(
                (got - wanted).abs() < 1e-14 * wanted.abs().max(1.0),
                "{got} {wanted}"
            );
        }
    }

    /// For a reading y of variance v with a prior of variance p, the posterior mean is `y p / (p + v)` and the variance `p v / (p + v)`.
    #[test]
    fn a_prior_weighs_as_one_more_reading() {
        let (y, v, p) = (3.0, 0.5, 2.0_f64);
        let model = LinearGaussian {
            rows: &Matrix::from_element(1, 1, 1.0),
            errors: ReadingErrors::Variances(&[v]),
            prior_sd: &[Some(p.sqrt())],
            scales: &[1.0],
        };
        let out = model.estimate(&[y]).unwrap();
        assert!((out.value[0] - y * p / (p + v)).abs() < 1e-15);
        assert!((out.covariance[(0, 0)] - p * v / (p + v)).abs() < 1e-15);
    }

    #[test]
    fn a_parameter_that_no_reading_depends_on_has_no_finite_variance() {
        let model = LinearGaussian {
            rows: &Matrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, 0.0]),
            errors: ReadingErrors::Variances(&[1.0, 1.0]),
            prior_sd: &[None, None],
            scales: &[1.0, 1.0],
        };
        let out = model.estimate(&[1.0, 1.0]).unwrap();
        assert_eq!(out.rank, 1);
        assert!(out.covariance[(1, 1)].is_infinite());
        assert!((out.covariance[(0, 0)] - 0.5).abs() < 1e-15);
    }
}
