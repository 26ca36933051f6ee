//! Spectra limited to the band, thinned and trimmed.

use super::layout::Vehicle;
use super::treatment::{Treatment, VehicleError};
use crate::series::detrend::without_mean;
use crate::series::spectrum::{Band, Fourier, Spectrum};
use crate::series::{Channels, SeriesError};

/// Limits spectra to the band, and thins and trims the resulting signals.
pub(super) struct Limiter {
    pub fourier: Fourier,
    pub band: Band,
    pub rate_hz: f64,
    pub keep: usize,
    pub trim: usize,
    /// Mains lines that are left out.
    lines_hz: Vec<f64>,
    n_kept: usize,
}

impl Limiter {
    /// # Errors
    /// A band that is too high for the sample rate, or a record that is too short for the band.
    pub fn new(
        vehicle: &Vehicle,
        record: &Channels,
        treatment: &Treatment,
    ) -> Result<Self, VehicleError> {
        let band = treatment.band;
        let rate_hz = record.rate_hz;
        if !(band.low_hz >= 0.0 && band.low_hz < band.high_hz && band.high_hz < rate_hz / 2.0) {
            return Err(SeriesError::Band {
                low_hz: band.low_hz,
                high_hz: band.high_hz,
                rate_hz,
            }
            .into());
        }
        let mut terms = vehicle.links.iter().flat_map(|l| &l.terms);
        let settle_s = match treatment.settle_s {
            Some(s) => s,
            None if terms.any(|t| !t.is_linear()) => 1.5 * band.settling_s(),
            None => band.settling_s(),
        };
        let needed_s = 2.0 * settle_s + 5.0 / band.low_hz.max(0.1);
        if record.duration_s() < needed_s {
            return Err(SeriesError::TooShort {
                found_s: record.duration_s(),
                needed_s,
                low_hz: band.low_hz,
            }
            .into());
        }
        let mut keep = treatment.keep_every.max(1);
        if treatment.keep_every == 0 {
            while rate_hz / (2 * keep) as f64 >= 5.0 * band.high_hz {
                keep *= 2;
            }
        }
        Ok(Self {
            fourier: Fourier::default(),
            band,
            rate_hz,
            keep,
            trim: ((settle_s * rate_hz).ceil() as usize).div_ceil(keep),
            n_kept: record.n_samples().div_ceil(keep),
            lines_hz: (treatment.adjust.iter())
                .flat_map(|a| a.lines_hz.iter().copied())
                .collect(),
        })
    }

    /// Returns the samples of a spectrum in the band, integrated the given number of times.
    pub fn samples_in_band(&mut self, s: &Spectrum, times: i32) -> Vec<f64> {
        /// Width of the omitted band about a line, one sd of its bell: mains wander by less, and its echo dies within a second.
        const WIDTH_HZ: f64 = 0.15;
        let mut in_band = s.band_integrated_for(self.band, times, self.keep);
        if !self.lines_hz.is_empty() {
            in_band = in_band.times(|f| {
                let kept = |line: &f64| 1.0 - (-0.5 * ((f - line) / WIDTH_HZ).powi(2)).exp();
                self.lines_hz.iter().map(kept).product::<f64>().into()
            });
        }
        let x = self.fourier.samples(&in_band, self.keep);
        let trim = self.trim;
        x[trim.min(x.len())..self.n_kept.saturating_sub(trim).max(trim).min(x.len())].to_vec()
    }

    /// Returns a signal at the rate of the record, without its mean, limited to the band.
    pub fn limited_samples(&mut self, x: &[f64]) -> Vec<f64> {
        let s = self.fourier.spectrum(&without_mean(x), self.rate_hz);
        self.samples_in_band(&s, 0)
    }
}
