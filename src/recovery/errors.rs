//! How wrong readings and model are, as stated by the user.

use crate::linalg::Matrix;

/// Stated errors.
///
/// The model's error has two parts, because models err both ways: each influence coefficient by itself (mesh, gradient at the gauge),
/// `sd = model_rel |S_gl f_l|`, which the residual shows, and each load's column as a whole (stiffness, thickness),
/// `sd = model_rel |f_l|` on the load itself, which no residual can show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorModel {
    /// Noise of one reading, strain, 1 sd.
    pub noise: f64,
    /// Model uncertainty, of the predicted strain, 1 sd.
    pub model_rel: f64,
}

impl ErrorModel {
    /// Variance of each reading at loads `f`; `noise_factor` multiplies the noise variance (1 for a single reading less a long zero).
    pub fn variances(&self, s: &Matrix, f: &[f64], noise_factor: f64) -> Vec<f64> {
        let own = self.noise * self.noise * noise_factor;
        s.row_iter()
            .map(|row| {
                let model: f64 = row.iter().zip(f).map(|(a, b)| (a * b).powi(2)).sum();
                own + self.model_rel * self.model_rel * model
            })
            .collect()
    }

    /// Variance added to load `f_l` for the error of its column as a whole.
    pub fn column_variance(&self, f_l: f64) -> f64 {
        (self.model_rel * f_l).powi(2)
    }
}
