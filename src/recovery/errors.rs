//! How wrong readings and model are, as stated by the user.

use crate::linalg::Matrix;
use crate::sensitivity::Sensitivity;

/// Stated errors.
///
/// The model error has two parts. Each influence coefficient has a separate error (mesh, gradient at the gauge), `sd = model_rel |S_gl f_l|`, which
/// the residual shows. Each load's column has a common error (stiffness, thickness), `sd = model_rel |f_l|` on the load itself, which no residual can
/// show. Both errors are the same in every run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorModel {
    /// Noise of one reading, strain, 1 sd.
    pub noise: f64,
    /// Model uncertainty, of the predicted strain, 1 sd.
    pub model_rel: f64,
}

impl ErrorModel {
    /// Returns the variance of the noise of a reading. `noise_factor` is 1 for a single reading with a long zero subtracted.
    pub fn noise_variance(&self, noise_factor: f64) -> f64 {
        (self.noise * self.noise * noise_factor).max(f64::MIN_POSITIVE)
    }

    /// Returns the variance of the noise of gauge `g` of S.
    pub fn noise_of(&self, s: &Sensitivity, g: usize, noise_factor: f64) -> f64 {
        let own = s.noise.as_ref().map_or(1.0, |n| n.variance(g));
        self.noise_variance(noise_factor) * own
    }

    /// Returns the covariance of the noise of the gauges `used`, by number. `None` if all gauges have the stated noise, independent of each other.
    pub fn noise_covariance(
        &self,
        s: &Sensitivity,
        used: &[usize],
        noise_factor: f64,
    ) -> Option<Matrix> {
        let noise = s.noise.as_ref()?.of_gauges(used);
        Some(noise.covariance() * self.noise_variance(noise_factor))
    }

    /// Returns the covariance of the model error of one gauge between loads `f` and loads `g`. `row` is the row of the gauge in S: `model_rel^2 sum_l
    /// S_l^2 f_l g_l`.
    pub fn model_error_covariance(
        &self,
        row: impl Iterator<Item = f64>,
        f: &[f64],
        g: &[f64],
    ) -> f64 {
        let sum: f64 = row
            .zip(f.iter().zip(g))
            .map(|(s, (a, b))| s * s * a * b)
            .sum();
        self.model_rel * self.model_rel * sum
    }

    /// Returns the variance of each reading at loads `f`. `noise_factor` multiplies the noise variance (1 for a single reading with a long zero
    /// subtracted).
    pub fn variances(&self, s: &Matrix, f: &[f64], noise_factor: f64) -> Vec<f64> {
        let own = self.noise_variance(noise_factor);
        s.row_iter()
            .map(|row| own + self.model_error_covariance(row.iter().copied(), f, f))
            .collect()
    }

    /// Returns the variance added to load `f_l` for the common error of its column.
    pub fn column_variance(&self, f_l: f64) -> f64 {
        (self.model_rel * f_l).powi(2)
    }
}
