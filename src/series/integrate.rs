//! Velocity and displacement from acceleration.

use super::detrend::without_mean;
use super::spectrum::{Band, Fourier};

/// Returns x limited to the band and integrated `times` times (0: only limited; negative: differentiated), same length and rate.
///
/// The method is division by i omega of the zero-padded transform. Double integration multiplies noise at low frequency by 1/omega^2, and the
/// high-pass in `band` limits it. Do not use the first and last [`Band::settling_s`] of the result.
///
/// # Example
/// The displacement of a sine is its acceleration over `-omega^2`:
/// ```
/// use std::f64::consts::TAU;
/// use strainbridge::series::integrate::integrate_in_band;
/// use strainbridge::series::spectrum::Band;
///
/// let (rate_hz, omega) = (200.0, TAU * 5.0);
/// let acceleration: Vec<f64> = (0..4000).map(|i| (omega * f64::from(i) / rate_hz).sin()).collect();
/// let band = Band { low_hz: 0.5, high_hz: f64::INFINITY };
/// let displacement = integrate_in_band(&acceleration, rate_hz, band, 2);
/// for (a, d) in acceleration.iter().zip(&displacement).skip(1000).take(2000) {
///     assert!((d * omega * omega + a).abs() < 2e-3);
/// }
/// ```
pub fn integrate_in_band(x: &[f64], rate_hz: f64, band: Band, times: i32) -> Vec<f64> {
    let mut fourier = Fourier::default();
    let spectrum = fourier.spectrum(&without_mean(x), rate_hz);
    fourier.samples(&spectrum.band_integrated(band, times), 1)
}
