//! A channel shifted in time.

use super::spectrum::Fourier;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Returns x without a delay that changes with time: out(t) = x(t + late(t)), `late` in s by sample. Values between samples are interpolated by a
/// sinc under a Lanczos window. Beyond the ends, the end samples are repeated.
pub fn remove_lateness(x: &[f64], rate_hz: f64, late: impl Fn(usize) -> f64) -> Vec<f64> {
    /// Samples to either side: signals up to three quarters of half the rate pass to better than a per mille.
    const SIDE: isize = 12;
    let last = x.len() as isize - 1;
    // sin(pi (share - k)) is sin(pi share) with alternating sign. The factor sin(pi share) cancels when the weights are normalized, the sign stays.
    // The sine of the window follows from one sine and one cosine of pi share / SIDE.
    let turns: Vec<(f64, f64, f64)> = (1 - SIDE..=SIDE)
        .map(|k| {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            let (sin, cos) = (PI * k as f64 / SIDE as f64).sin_cos();
            (k as f64, sign * cos, sign * sin)
        })
        .collect();
    (0..x.len())
        .map(|i| {
            let at = (i as f64 + late(i) * rate_hz).clamp(0.0, last.max(0) as f64);
            let base = at.floor();
            let share = at - base;
            if share == 0.0 {
                return x[base as usize];
            }
            let (sin, cos) = (PI * share / SIDE as f64).sin_cos();
            let (mut sum, mut weights) = (0.0, 0.0);
            for ((k, c, s), at) in turns.iter().zip(base as isize + 1 - SIDE..) {
                let u = share - k;
                let w = (sin * c - cos * s) / (u * u);
                sum += w * x[at.clamp(0, last) as usize];
                weights += w;
            }
            sum / weights
        })
        .collect()
}

/// Returns x delayed by a time that need not be a whole number of samples (negative: advanced). The signal is zero-padded about its mean.
///
/// # Example
/// A smooth pulse, delayed by 3.4 samples:
/// ```
/// use strainbridge::series::align::delay;
///
/// let pulse = |t: f64| (-0.5 * ((t - 50.0) / 4.0).powi(2)).exp();
/// let x: Vec<f64> = (0..128).map(|i| pulse(f64::from(i))).collect();
/// let late = delay(&x, 100.0, 0.034);
/// assert_eq!(late.len(), x.len());
/// for (i, v) in (20..100).zip(&late[20..100]) {
///     assert!((v - pulse(f64::from(i) - 3.4)).abs() < 2e-3);
/// }
/// ```
pub fn delay(x: &[f64], rate_hz: f64, seconds: f64) -> Vec<f64> {
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
