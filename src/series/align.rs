//! A channel shifted in time.

use super::spectrum::Fourier;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// x delayed by a time that need not be a whole number of samples (negative: advanced); ends repeat zero-padding.
pub fn delayed(x: &[f64], rate_hz: f64, seconds: f64) -> Vec<f64> {
    let offset = super::detrend::mean(x);
    let zero_mean: Vec<f64> = x.iter().map(|v| v - offset).collect();
    let mut fourier = Fourier::default();
    let shifted = fourier
        .spectrum(&zero_mean, rate_hz)
        .times(|f| Complex64::from_polar(1.0, -2.0 * PI * f * seconds));
    fourier
        .samples(&shifted, 1)
        .into_iter()
        .map(|v| v + offset)
        .collect()
}
