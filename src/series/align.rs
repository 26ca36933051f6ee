//! Delay between two channels.

use super::spectrum::Fourier;
use super::welch::cross_spectra;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Delay of y behind x, with its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delay {
    /// Seconds; positive when y is late.
    pub seconds: f64,
    /// One standard deviation from the scatter of the phase.
    pub sigma_s: f64,
    /// Mean coherence in the band, 0 to 1: the delay means little below about 0.5.
    pub coherence: f64,
}

/// Delay of y behind x, s, from the slope of the cross-spectrum phase within the band, weighted by coherence.
///
/// A coarse delay from the cross-correlation is taken out first, so whole cycles are no matter. `None` when the band holds no
/// coherent bins.
///
/// # Reference
/// Piersol, Time delay estimation using phase data, IEEE Trans. Acoust. Speech Signal Proc. 29 (1981) 471.
pub fn delay_between(
    x: &[f64],
    y: &[f64],
    rate_hz: f64,
    low_hz: f64,
    high_hz: f64,
) -> Option<Delay> {
    let n = x.len().min(y.len());
    let segment = ((8.0 * rate_hz / low_hz.max(rate_hz / n.max(1) as f64)) as usize)
        .next_power_of_two()
        .min(n / 4);
    if segment < 8 {
        return None;
    }
    let coarse = coarse_lag(&x[..n], &y[..n], rate_hz, low_hz, high_hz);
    let (xs, ys) = if coarse >= 0 {
        (&x[..n - coarse as usize], &y[coarse as usize..n])
    } else {
        (&x[-coarse as usize..n], &y[..n - -coarse as usize])
    };
    let spectra = cross_spectra(xs, ys, rate_hz, segment);
    let coherence = spectra.coherence();
    let (mut sww, mut swp, mut count, mut coh) = (0.0, 0.0, 0, 0.0);
    for (k, &f) in spectra.f_hz.iter().enumerate() {
        if f < low_hz || f > high_hz || f == 0.0 {
            continue;
        }
        let c = coherence[k].min(1.0 - 1e-9);
        // Variance of the phase of one averaged bin: (1 - c) / (2 n c).
        let weight = c / (1.0 - c);
        let omega = 2.0 * PI * f;
        sww += weight * omega * omega;
        swp += weight * omega * -spectra.xy[k].arg();
        coh += c;
        count += 1;
    }
    if count == 0 || sww <= 0.0 {
        return None;
    }
    let sigma_s = (1.0 / (2.0 * spectra.n_segments.max(1) as f64 * sww)).sqrt();
    Some(Delay {
        seconds: coarse as f64 / rate_hz + swp / sww,
        sigma_s,
        coherence: coh / count as f64,
    })
}

/// Whole samples by which y is late: the largest absolute cross-correlation of the band-limited signals.
fn coarse_lag(x: &[f64], y: &[f64], rate_hz: f64, low_hz: f64, high_hz: f64) -> isize {
    let mut fourier = Fourier::default();
    let band = |f: f64| {
        Complex64::from(if f >= low_hz && f <= high_hz {
            1.0
        } else {
            0.0
        })
    };
    let (fx, fy) = (
        fourier.spectrum(x, rate_hz).times(band),
        fourier.spectrum(y, rate_hz),
    );
    let product = fx.conjugate_times(&fy);
    let c = fourier.padded_samples(&product);
    let n = c.len();
    let best = (0..n)
        .max_by(|&i, &j| c[i].abs().total_cmp(&c[j].abs()))
        .unwrap_or(0);
    let lag = if best > n / 2 {
        best as isize - n as isize
    } else {
        best as isize
    };
    // More than a quarter of the record is no delay but chance.
    if lag.unsigned_abs() > x.len() / 4 {
        0
    } else {
        lag
    }
}

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
