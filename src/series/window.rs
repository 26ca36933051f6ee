//! Tapered transforms of a stretch of a record: bins that are independent where noise is.

use super::plans::forward;
use super::spectrum::Band;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Share of the record that the taper takes, both ends together.
const TAPER: f64 = 0.15;

/// Windowed transforms of one length.
pub struct WindowedTransform {
    window: Vec<f64>,
    /// Frequencies of the bins in the band, Hz.
    pub f_hz: Vec<f64>,
    first: usize,
    step_hz: f64,
}

impl WindowedTransform {
    /// Creates the transform for signals of `n` samples at `rate_hz`, with the bins within the band.
    ///
    /// The last samples are left out if this makes the transform fast (a length with only the factors 2, 3 and 5).
    pub fn new(n: usize, rate_hz: f64, band: Band) -> Self {
        let mut length = n;
        while length > 1 && !is_smooth(length) {
            length -= 1;
        }
        let ramp = (TAPER * length as f64 / 2.0) as usize;
        let edge = |i: usize| {
            let i = i.min(length - 1 - i);
            if i < ramp {
                0.5 * (1.0 - (PI * i as f64 / ramp as f64).cos())
            } else {
                1.0
            }
        };
        let mut window: Vec<f64> = (0..length).map(edge).collect();
        let power: f64 = window.iter().map(|w| w * w).sum();
        // A white signal of variance s^2 then has E|X|^2 = s^2 in every bin.
        window
            .iter_mut()
            .for_each(|w| *w /= power.max(f64::MIN_POSITIVE).sqrt());
        let step = rate_hz / length.max(1) as f64;
        let inside: Vec<usize> = (1..length / 2)
            .filter(|k| {
                let f = *k as f64 * step;
                f >= band.low_hz && f <= band.high_hz
            })
            .collect();
        Self {
            window,
            f_hz: inside.iter().map(|k| *k as f64 * step).collect(),
            first: inside.first().copied().unwrap_or(0),
            step_hz: step,
        }
    }

    /// Returns the window. Its power is one and its length is the length of the transform.
    pub fn taper(&self) -> &[f64] {
        &self.window
    }

    /// Returns the number of the first bin in the band.
    pub fn first_bin(&self) -> usize {
        self.first
    }

    /// Returns the distance between bins, Hz.
    pub fn step_hz(&self) -> f64 {
        self.step_hz
    }

    /// Returns the transform at any frequency f, Hz, of a signal at `rate_hz`: sum of x w exp(-2 pi i f t).
    pub fn transform_at(&self, x: &[f64], rate_hz: f64, f_hz: f64) -> Complex64 {
        let turn = Complex64::from_polar(1.0, -2.0 * PI * f_hz / rate_hz);
        let mut now = Complex64::new(1.0, 0.0);
        let mut sum = Complex64::default();
        for (x, w) in x.iter().zip(&self.window) {
            sum += now * (x * w);
            now *= turn;
        }
        sum
    }

    /// Returns the bins of a signal within the band. For white noise, E|X|^2 is the variance of the noise.
    pub fn bins(&mut self, x: &[f64]) -> Vec<Complex64> {
        let plan = forward(self.window.len());
        let mut input = plan.make_input_vec();
        input
            .iter_mut()
            .zip(x)
            .zip(&self.window)
            .for_each(|((i, x), w)| *i = x * w);
        let mut out = plan.make_output_vec();
        // The lengths come from the plan itself, so this can't fail.
        let done = plan.process(&mut input, &mut out);
        debug_assert!(done.is_ok());
        let last = (self.first + self.f_hz.len()).min(out.len());
        out[self.first.min(last)..last].to_vec()
    }
}

fn is_smooth(mut n: usize) -> bool {
    for p in [2, 3, 5] {
        while n.is_multiple_of(p) {
            n /= p;
        }
    }
    n == 1
}
