//! Noise that differs between gauges or is common to them.

use crate::linalg::Matrix;

/// Covariance of the noise over gauges, in units of the square of the stated noise.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeNoise {
    /// `n x n`, in the order of the rows of S.
    covariance: Matrix,
}

impl GaugeNoise {
    /// Returns the noise with this covariance, `n x n`, in units of the square of the stated noise.
    pub fn of_covariance(covariance: Matrix) -> Self {
        Self { covariance }
    }

    /// Returns the noise of gauges with standard deviations `sd`, in units of the stated noise, any two of which have the same `correlation`.
    pub fn with_correlation(sd: &[f64], correlation: f64) -> Self {
        let n = sd.len();
        Self::of_covariance(Matrix::from_fn(n, n, |g, h| match g == h {
            true => sd[g] * sd[g],
            false => correlation * sd[g] * sd[h],
        }))
    }

    /// Returns the noise of these gauges, by number and in this order.
    pub fn of_gauges(&self, gauges: &[usize]) -> Self {
        let n = gauges.len();
        let entry = |i: usize, j: usize| self.covariance[(gauges[i], gauges[j])];
        Self::of_covariance(Matrix::from_fn(n, n, entry))
    }

    /// Returns the covariance, `n x n`.
    pub fn covariance(&self) -> &Matrix {
        &self.covariance
    }

    /// Returns the variance of gauge `g`.
    pub fn variance(&self, g: usize) -> f64 {
        self.covariance[(g, g)]
    }

    /// Returns the covariance of gauges `g` and `h`.
    pub fn covariance_between(&self, g: usize, h: usize) -> f64 {
        self.covariance[(g, h)]
    }

    /// Returns the standard deviations of all gauges.
    pub fn sd(&self) -> Vec<f64> {
        let n = self.covariance.nrows();
        (0..n).map(|g| self.variance(g).sqrt()).collect()
    }

    /// Returns the correlation of gauges `g` and `h`.
    pub fn correlation(&self, g: usize, h: usize) -> f64 {
        self.covariance_between(g, h) / (self.variance(g) * self.variance(h)).sqrt()
    }

    /// Returns whether any two gauges are correlated.
    pub fn is_correlated(&self) -> bool {
        let n = self.covariance.nrows();
        (0..n).any(|g| (0..g).any(|h| self.covariance[(g, h)] != 0.0))
    }

    /// Returns the mean correlation of two gauges; 0 with one gauge.
    pub fn mean_correlation(&self) -> f64 {
        let n = self.covariance.nrows();
        let pairs = (0..n).flat_map(|g| (0..g).map(move |h| (g, h)));
        let each = pairs.map(|(g, h)| self.correlation(g, h));
        each.sum::<f64>() / (n * n.saturating_sub(1) / 2).max(1) as f64
    }
}
