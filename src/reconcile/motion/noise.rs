//! Covariance of the equations' residuals from sensor noise and unexplained background, and whitening by it.

use super::design::{Bins, Design};
use super::frame::MotionFrame;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Noise of a channel without a declared noise, as a share of its root mean square. It avoids a division by zero in the weights.
pub(super) const UNDECLARED: f64 = 1e-4;

/// Power that no effect explains, by equation and frequency band, in addition to sensor noise.
#[derive(Clone, Debug, Default)]
pub struct Background {
    /// `[equation][band]`; empty: none.
    pub power: Vec<Vec<f64>>,
}

/// Number of bands in which the background is assumed to be constant.
pub const BANDS: usize = 10;

/// Returns the band of a frequency. Bands are even in the logarithm of frequency.
pub fn band_of(frame: &MotionFrame, f_hz: f64) -> usize {
    let low = frame.band.low_hz.max(1e-3 * frame.band.high_hz);
    let share = (f_hz / low).ln() / (frame.band.high_hz / low).ln();
    ((share * BANDS as f64) as usize).min(BANDS - 1)
}

/// Lower Cholesky factors of the covariance of the equations, bin by bin: `[bin][i * n + j]`.
#[derive(Clone, Debug)]
pub struct Whitener {
    n: usize,
    factors: Vec<Vec<Complex64>>,
}

/// Returns the covariance of the equations at every bin: sum over channels of H H' S, plus background; rows of `n x n` values.
pub fn covariance(
    frame: &MotionFrame,
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    background: &Background,
) -> Vec<Vec<Complex64>> {
    let n = design.equations.len();
    let powers: Vec<f64> = design
        .channels
        .iter()
        .map(|c| match c.noise {
            Some(s) => s * s / design.thinning,
            None => {
                let mean =
                    c.bins.iter().map(|b| b.norm_sqr()).sum::<f64>() / c.bins.len().max(1) as f64;
                UNDECLARED * UNDECLARED * mean
            }
        })
        .collect();
    design
        .f_hz
        .iter()
        .enumerate()
        .map(|(k, f)| {
            let gain = frame.band.gain(*f);
            let mut s = vec![Complex64::default(); n * n];
            for i in 0..n {
                for j in 0..n {
                    s[i * n + j] = (0..design.channels.len())
                        .map(|c| {
                            let lags = &design.channels[c].lags;
                            let louder: f64 = lags
                                .iter()
                                .map(|l| l.inverse_response(2.0 * PI * f).norm_sqr())
                                .product();
                            responses[i][c][k] * responses[j][c][k].conj() * powers[c] * louder
                        })
                        .sum::<Complex64>()
                        * (gain * gain);
                }
                let band = band_of(frame, *f);
                let extra = background
                    .power
                    .get(i)
                    .and_then(|p| p.get(band))
                    .copied()
                    .unwrap_or(0.0);
                // The last term avoids a division by zero for an equation without noise.
                s[i * n + i] = s[i * n + i] * (1.0 + 1e-9) + extra + f64::MIN_POSITIVE;
            }
            s
        })
        .collect()
}

/// Returns the sum over bins of ln |S| - ln |S0|, with S the covariance and S0 the covariance of sensor noise alone.
///
/// Let x be the true channels and y = x + n the readings. The equations are G x = b, with the background b of covariance B. If b and the unobserved
/// part of x are integrated out, the density of y in every bin is `exp(-r' S^-1 r) |S0| / |S|`. Here r = G y, S0 = G N G' and S = S0 + B. The scale
/// of the equations is therefore arbitrary, and models that differ only by a scale are indistinguishable.
pub fn log_determinant(
    frame: &MotionFrame,
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    background: &Background,
    covariances: &[Vec<Complex64>],
) -> f64 {
    if background.power.is_empty() {
        return 0.0;
    }
    let n = design.equations.len();
    let sensors = covariance(frame, design, responses, &Background::default());
    let log = |s: &[Complex64]| -> f64 {
        let l = cholesky(s, n);
        (0..n).map(|i| 2.0 * l[i * n + i].re.ln()).sum()
    };
    covariances
        .iter()
        .zip(&sensors)
        .map(|(s, s0)| log(s) - log(s0))
        .sum()
}

impl Whitener {
    /// Creates the whitener from covariances, one for each bin.
    pub fn from_covariance(covariance: &[Vec<Complex64>], n: usize) -> Self {
        Self {
            n,
            factors: covariance.iter().map(|s| cholesky(s, n)).collect(),
        }
    }

    /// Returns real rows of unit variance from a residual or column `[equation][bin]` (empty equations are zero).
    pub fn rows(&self, x: &[&[Complex64]]) -> Vec<f64> {
        let n = self.n;
        let mut out = Vec::with_capacity(2 * n * self.factors.len());
        let mut y = vec![Complex64::default(); n];
        for (k, l) in self.factors.iter().enumerate() {
            for i in 0..n {
                let mut v = x[i].get(k).copied().unwrap_or_default();
                for j in 0..i {
                    v -= l[i * n + j] * y[j];
                }
                y[i] = v / l[i * n + i].re;
                // Real and imaginary part share the power equally.
                out.push(y[i].re * std::f64::consts::SQRT_2);
                out.push(y[i].im * std::f64::consts::SQRT_2);
            }
        }
        out
    }
}

impl Whitener {
    /// Returns residuals `[equation][bin]` from unit-variance rows: the inverse of [`Whitener::rows`].
    pub fn colour_rows(&self, rows: &[f64]) -> Vec<Bins> {
        let n = self.n;
        let mut out = vec![Vec::with_capacity(self.factors.len()); n];
        for (k, l) in self.factors.iter().enumerate() {
            let y = |i: usize| {
                let at = 2 * (k * n + i);
                let part = |j: usize| rows.get(at + j).copied().unwrap_or(0.0);
                Complex64::new(part(0), part(1)) / std::f64::consts::SQRT_2
            };
            for (i, o) in out.iter_mut().enumerate() {
                o.push((0..=i).map(|j| l[i * n + j] * y(j)).sum());
            }
        }
        out
    }
}

/// Returns the lower Cholesky factor of a Hermitian matrix. Pivots below rounding are set to the rounding level.
fn cholesky(s: &[Complex64], n: usize) -> Vec<Complex64> {
    let mut l = vec![Complex64::default(); n * n];
    for i in 0..n {
        for j in 0..=i {
            let mut v = s[i * n + j];
            for p in 0..j {
                v -= l[i * n + p] * l[j * n + p].conj();
            }
            l[i * n + j] = if i == j {
                let least = 1e-12 * s[i * n + i].re;
                Complex64::new(v.re.max(least).max(f64::MIN_POSITIVE).sqrt(), 0.0)
            } else {
                v / l[j * n + j].re
            };
        }
    }
    l
}

/// Returns the background in a residual above the noise of the sensors.
pub fn background(
    frame: &MotionFrame,
    design: &Design,
    residual: &[Bins],
    sensor: &[Vec<Complex64>],
) -> Background {
    let n = design.equations.len();
    let mut power = vec![vec![0.0; BANDS]; n];
    for (i, r) in residual.iter().enumerate() {
        let mut sums = vec![(0.0, 0.0); BANDS];
        for (k, v) in r.iter().enumerate() {
            let b = band_of(frame, design.f_hz[k]);
            sums[b].0 += v.norm_sqr() - sensor[k][i * n + i].re;
            sums[b].1 += 1.0;
        }
        for (p, (sum, count)) in power[i].iter_mut().zip(sums) {
            if count > 0.0 {
                *p = (sum / count).max(0.0);
            }
        }
    }
    Background { power }
}
