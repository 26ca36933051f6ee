//! Expected difference between the reading of a validation gauge and its prediction.

use super::errors::ErrorModel;
use super::gain::Gain;
use super::types::Widening;

/// Returns the variance, strain^2, of the difference between the reading and the prediction `row f`, for a gauge that the estimate does not use. It
/// is `N + M(f) + row Cov(f) row'`. `N` is the noise of its reading and `M(f)` the errors of its coefficients. `Cov(f)` is the covariance of the
/// loads without the errors of whole columns, which shift the loads but not the prediction.
pub fn prediction_variance(
    (gain, row): (&Gain, &[f64]),
    errors: ErrorModel,
    f: &[f64],
    noise_factor: f64,
) -> f64 {
    let n = gain.n_loads();
    let covariance = gain.covariance(f, &Widening::none());
    let mut of_loads = 0.0;
    for (a, s_a) in row.iter().enumerate() {
        of_loads -= s_a * s_a * errors.column_variance(f[a]);
        for (b, s_b) in row.iter().enumerate() {
            of_loads += s_a * s_b * covariance[a * n + b];
        }
    }
    let own = errors.model_error_covariance(row.iter().copied(), f, f);
    errors.noise_variance(noise_factor) + own + of_loads.max(0.0)
}
