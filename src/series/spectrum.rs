//! Zero-padded transforms: band limiting, integration and decimation in one pass.

use super::plans::{forward, inverse};
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Transforms and their inverses.
#[derive(Clone, Copy, Debug, Default)]
pub struct Fourier {}

/// Positive-frequency transform of a zero-padded signal.
#[derive(Clone, Debug)]
pub struct Spectrum {
    bins: Vec<Complex64>,
    n_padded: usize,
    n_samples: usize,
    rate_hz: f64,
}

/// A zero-phase band: Butterworth magnitude squared, order 2 at the lower edge and 4 at the upper.
///
/// |H|^2 = 1 / (1 + (low/f)^4) . 1 / (1 + (f/high)^8). The low order at the lower edge lets the ends settle within
/// `2 / low_hz` seconds. A lower edge of 0 or an infinite upper edge is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Lower edge, Hz.
    pub low_hz: f64,
    /// Upper edge, Hz.
    pub high_hz: f64,
}

impl Band {
    /// Returns the gain at a frequency, 0 to 1.
    pub fn gain(&self, f_hz: f64) -> f64 {
        let low = if self.low_hz > 0.0 {
            let r = f_hz / self.low_hz;
            let r4 = r * r * r * r;
            r4 / (1.0 + r4)
        } else {
            1.0
        };
        let h = f_hz / self.high_hz;
        let h2 = h * h;
        let h8 = h2 * h2 * h2 * h2;
        low / (1.0 + h8)
    }

    /// Returns the time at either end of a record that contains the end effect of the filter, s.
    pub fn settling_s(&self) -> f64 {
        if self.low_hz > 0.0 {
            2.0 / self.low_hz
        } else {
            2.0 / self.high_hz
        }
    }
}

impl Fourier {
    /// Returns the transform of x followed by zeros, to at least twice its length (a power of two).
    ///
    /// # Reference
    /// Brandt & Brincker, Integrating time signals in frequency domain, Measurement 58 (2014) 511; thesis equation 4.7.
    pub fn spectrum(&mut self, x: &[f64], rate_hz: f64) -> Spectrum {
        let n_padded = (2 * x.len()).next_power_of_two().max(4);
        let plan = forward(n_padded);
        let mut input = plan.make_input_vec();
        input[..x.len()].copy_from_slice(x);
        let mut bins = plan.make_output_vec();
        // The lengths come from the plan itself, so this can't fail.
        let done = plan.process(&mut input, &mut bins);
        debug_assert!(done.is_ok());
        Spectrum {
            bins,
            n_padded,
            n_samples: x.len(),
            rate_hz,
        }
    }

    /// Returns `sum of a(i + lag) b(i)` for the signals of two spectra of one length. Lags from 0 on are at the beginning, negative lags at the end.
    pub fn correlation(&mut self, a: &Spectrum, b: &Spectrum) -> Vec<f64> {
        let plan = inverse(a.n_padded);
        let mut bins: Vec<Complex64> = a
            .bins
            .iter()
            .zip(&b.bins)
            .map(|(a, b)| a * b.conj())
            .collect();
        for at in [0, a.n_padded / 2] {
            bins[at].im = 0.0;
        }
        let mut out = plan.make_output_vec();
        let done = plan.process(&mut bins, &mut out);
        debug_assert!(done.is_ok());
        let scale = 1.0 / a.n_padded as f64;
        out.iter_mut().for_each(|v| *v *= scale);
        out
    }

    /// Returns every `keep_every`-th sample of the signal of a spectrum. `keep_every` is a power of two. Frequencies above the new half rate are
    /// removed.
    pub fn samples(&mut self, s: &Spectrum, keep_every: usize) -> Vec<f64> {
        let n = s.n_thinned(keep_every);
        let step = s.n_padded / n;
        let plan = inverse(n);
        let mut bins: Vec<Complex64> = s.bins[..n / 2 + 1].to_vec();
        bins[0].im = 0.0;
        bins[n / 2].im = 0.0;
        if step > 1 {
            bins[n / 2] = Complex64::default();
        }
        let mut out = plan.make_output_vec();
        let done = plan.process(&mut bins, &mut out);
        debug_assert!(done.is_ok());
        let scale = 1.0 / s.n_padded as f64;
        out.truncate(s.n_samples.div_ceil(step));
        out.iter_mut().for_each(|v| *v *= scale);
        out
    }
}

impl Spectrum {
    /// Returns the spectrum with each bin multiplied by a response at its frequency (Hz).
    pub fn times(&self, response: impl Fn(f64) -> Complex64) -> Self {
        let step = self.rate_hz / self.n_padded as f64;
        let mut out = self.clone();
        out.bins
            .iter_mut()
            .enumerate()
            .for_each(|(k, b)| *b *= response(k as f64 * step));
        out
    }

    /// Returns the spectrum limited to a band and integrated `times` times over time (negative: differentiated); the mean is dropped.
    pub fn band_integrated(&self, band: Band, times: i32) -> Self {
        self.band_integrated_for(band, times, 1)
    }

    /// Returns the result of [`Self::band_integrated`] for every `keep_every`-th sample only: frequencies above half of the new rate are dropped.
    pub fn band_integrated_for(&self, band: Band, times: i32, keep_every: usize) -> Self {
        let step = self.rate_hz / self.n_padded as f64;
        let unit = Complex64::new(0.0, 1.0).powi(-times);
        let n = self.n_thinned(keep_every) / 2 + 1;
        let limited = |(k, b): (usize, &Complex64)| {
            let f = k as f64 * step;
            match k {
                0 => Complex64::default(),
                _ => b * unit * (band.gain(f) * (2.0 * PI * f).powi(-times)),
            }
        };
        Self {
            bins: self.bins.iter().take(n).enumerate().map(limited).collect(),
            ..*self
        }
    }

    /// Returns the number of kept samples, padding included, if every `keep_every`-th is kept.
    fn n_thinned(&self, keep_every: usize) -> usize {
        let step = keep_every.max(1).next_power_of_two();
        self.n_padded / step.min(self.n_padded / 4)
    }

    /// Returns the weighted sum of spectra of one length; `None` without any, or if lengths differ.
    pub fn sum(parts: &[(f64, &Spectrum)]) -> Option<Self> {
        let (_, first) = parts.first()?;
        let mut out = (*first).clone();
        out.bins.fill(Complex64::default());
        for (w, s) in parts {
            if s.n_padded != first.n_padded {
                return None;
            }
            out.bins
                .iter_mut()
                .zip(&s.bins)
                .for_each(|(o, b)| *o += b * *w);
        }
        Some(out)
    }
}

impl Fourier {
    /// Returns the padded signal of a spectrum at `factor` times its rate.
    pub fn denser_samples(&mut self, s: &Spectrum, factor: usize) -> Vec<f64> {
        let n = s.n_padded * factor.max(1);
        let plan = inverse(n);
        let mut bins = vec![Complex64::default(); n / 2 + 1];
        bins[..s.bins.len()].copy_from_slice(&s.bins);
        if factor > 1 {
            // The bin at the old half rate represents both signs of the frequency.
            bins[s.bins.len() - 1] *= 0.5;
        }
        bins[0].im = 0.0;
        bins[n / 2].im = 0.0;
        let mut out = plan.make_output_vec();
        let done = plan.process(&mut bins, &mut out);
        debug_assert!(done.is_ok());
        let scale = 1.0 / s.n_padded as f64;
        out.iter_mut().for_each(|v| *v *= scale);
        out
    }
}
