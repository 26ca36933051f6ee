//! Velocity and displacement from acceleration.

use super::detrend::without_mean;
use super::spectrum::{Band, Fourier};

/// x limited to the band and integrated `times` times (0: only limited; negative: differentiated), same length and rate.
///
/// Division by i omega of the zero-padded transform. The high-pass in `band` is what keeps noise at low frequency, which double
/// integration multiplies by 1/omega^2, from swamping the answer. The first and last [`Band::settling_s`] are not to be trusted.
pub fn integrated(x: &[f64], rate_hz: f64, band: Band, times: i32) -> Vec<f64> {
    let mut fourier = Fourier::default();
    let spectrum = fourier.spectrum(&without_mean(x), rate_hz);
    fourier.samples(&spectrum.band_integrated(band, times), 1)
}
