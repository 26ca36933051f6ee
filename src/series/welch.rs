//! Power and cross spectra by Welch's method.

use super::detrend::mean;
use realfft::RealFftPlanner;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

impl CrossSpectra {
    /// Share of the density of y that is linear in x, |xy|^2 / (xx yy) by frequency; NaN where a density is 0.
    pub fn coherence(&self) -> Vec<f64> {
        let powers = self.xx.iter().zip(&self.yy);
        let cross = self.xy.iter().map(|c| c.norm_sqr());
        cross.zip(powers).map(|(c, (x, y))| c / (x * y)).collect()
    }
}

/// Spectra of two signals, with one value for each frequency.
#[derive(Clone, Debug)]
pub struct CrossSpectra {
    /// Frequencies, Hz.
    pub f_hz: Vec<f64>,
    /// One-sided density of x, unit^2/Hz.
    pub xx: Vec<f64>,
    /// One-sided density of y, unit^2/Hz.
    pub yy: Vec<f64>,
    /// One-sided cross density conj(X) Y. Its phase is the phase of y relative to x.
    pub xy: Vec<Complex64>,
    /// Number of averaged segments.
    pub n_segments: usize,
}

/// Returns the densities of x and y from Hann segments of `n_segment` samples with 50 % overlap. The mean of each segment is removed.
/// Segments with a value that is not finite are left out.
///
/// The conventions are as in `scipy.signal.csd`.
///
/// # Reference
/// Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70.
///
/// # Example
/// For a sine and its delayed copy, the density sums to the variance 1/2, and the phase equals the phase of the delay.
/// ```
/// use std::f64::consts::{FRAC_PI_4, TAU};
/// use strainbridge::series::welch::cross_spectra;
///
/// let signal = |late: f64| -> Vec<f64> {
///     (0..4096).map(|i| (TAU * f64::from(i) / 16.0 - late).sin()).collect()
/// };
/// let found = cross_spectra(&signal(0.0), &signal(FRAC_PI_4), 1600.0, 512);
/// let step_hz = found.f_hz[1] - found.f_hz[0];
/// assert!((found.xx.iter().sum::<f64>() * step_hz - 0.5).abs() < 1e-6);
/// let peak = found.f_hz.iter().position(|f| (f - 100.0).abs() < 0.5 * step_hz).unwrap();
/// assert!((found.xy[peak].arg() + FRAC_PI_4).abs() < 1e-6);
/// ```
pub fn cross_spectra(x: &[f64], y: &[f64], rate_hz: f64, n_segment: usize) -> CrossSpectra {
    let n = n_segment.clamp(2, x.len().min(y.len()).max(2));
    let window: Vec<f64> = (0..n)
        .map(|i| 0.5 - 0.5 * (2.0 * PI * i as f64 / n as f64).cos())
        .collect();
    let scale = 1.0 / (rate_hz * window.iter().map(|w| w * w).sum::<f64>());
    let plan = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let bins = n / 2 + 1;
    let mut out = CrossSpectra {
        f_hz: (0..bins).map(|k| k as f64 * rate_hz / n as f64).collect(),
        xx: vec![0.0; bins],
        yy: vec![0.0; bins],
        xy: vec![Complex64::default(); bins],
        n_segments: 0,
    };
    let transform = |part: &[f64]| {
        let m = mean(part);
        let mut input: Vec<f64> = part.iter().zip(&window).map(|(v, w)| (v - m) * w).collect();
        let mut bins = plan.make_output_vec();
        let done = plan.process(&mut input, &mut bins);
        debug_assert!(done.is_ok());
        bins
    };
    for (px, py) in x
        .windows(n)
        .step_by((n / 2).max(1))
        .zip(y.windows(n).step_by((n / 2).max(1)))
    {
        if px.iter().chain(py).any(|v| !v.is_finite()) {
            continue;
        }
        let (fx, fy) = (transform(px), transform(py));
        for k in 0..bins {
            out.xx[k] += fx[k].norm_sqr();
            out.yy[k] += fy[k].norm_sqr();
            out.xy[k] += fx[k].conj() * fy[k];
        }
        out.n_segments += 1;
    }
    for k in 0..bins {
        let sided = if k == 0 || (n.is_multiple_of(2) && k == n / 2) {
            1.0
        } else {
            2.0
        };
        let s = sided * scale / out.n_segments.max(1) as f64;
        out.xx[k] *= s;
        out.yy[k] *= s;
        out.xy[k] *= s;
    }
    out
}
