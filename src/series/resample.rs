//! Another sample rate.

use super::detrend::line;
use std::f64::consts::PI;

/// x at `to_hz` instead of `from_hz`, over the same span, by band-limited interpolation.
///
/// Downwards, a low-pass at 0.45 of the new rate goes first. Kernel: sinc under a Kaiser window, 32 zero crossings a side, whose
/// error is below 1e-6 of the signal for content under 0.4 of the lower rate. Ends are extended by the record's own line.
pub fn resampled(x: &[f64], from_hz: f64, to_hz: f64) -> Vec<f64> {
    const CROSSINGS: f64 = 32.0;
    if x.is_empty() || from_hz == to_hz {
        return x.to_vec();
    }
    let ratio = to_hz / from_hz;
    let n_out = ((x.len() - 1) as f64 * ratio + 1e-9).floor() as usize + 1;
    let (offset, slope) = line(x);
    let at = |i: isize| {
        if i < 0 || i as usize >= x.len() {
            0.0
        } else {
            x[i as usize] - offset - slope * i as f64
        }
    };
    let cut = ratio.min(1.0) * 0.92;
    let half = CROSSINGS / cut;
    (0..n_out)
        .map(|k| {
            let t = k as f64 / ratio;
            let (first, last) = ((t - half).ceil() as isize, (t + half).floor() as isize);
            let (mut sum, mut weight) = (0.0, 0.0);
            for i in first..=last {
                let u = t - i as f64;
                let w = sinc(cut * u) * kaiser(u / half);
                sum += w * at(i);
                weight += w;
            }
            offset + slope * t + sum / weight
        })
        .collect()
}

fn sinc(u: f64) -> f64 {
    if u.abs() < 1e-12 {
        1.0
    } else {
        (PI * u).sin() / (PI * u)
    }
}

/// Kaiser window (beta 10) over -1 .. 1.
fn kaiser(u: f64) -> f64 {
    const BETA: f64 = 10.0;
    if u.abs() >= 1.0 {
        0.0
    } else {
        bessel_i0(BETA * (1.0 - u * u).sqrt()) / bessel_i0(BETA)
    }
}

fn bessel_i0(x: f64) -> f64 {
    let (mut term, mut sum, q) = (1.0, 1.0, x * x / 4.0);
    for k in 1..60 {
        term *= q / (k * k) as f64;
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    sum
}

/// x with `factor - 1` samples put between neighbours by band-limited interpolation; length (n - 1) factor + 1.
///
/// The line through first and last sample is taken off first, so the zero-padded transform sees no step at the ends.
pub fn upsampled(x: &[f64], factor: usize) -> Vec<f64> {
    let n = x.len();
    let factor = factor.max(1);
    let (Some(first), Some(last)) = (x.first(), x.last()) else {
        return vec![];
    };
    if n < 3 || factor == 1 {
        return (0..(n - 1) * factor + 1)
            .map(|i| first + (last - first) * i as f64 / ((n - 1) * factor).max(1) as f64)
            .collect();
    }
    let slope = (last - first) / (n - 1) as f64;
    let flat: Vec<f64> = x
        .iter()
        .enumerate()
        .map(|(i, v)| v - first - slope * i as f64)
        .collect();
    let mut fourier = super::spectrum::Fourier::default();
    let spectrum = fourier.spectrum(&flat, 1.0);
    let dense = fourier.denser_samples(&spectrum, factor);
    dense
        .into_iter()
        .take((n - 1) * factor + 1)
        .enumerate()
        .map(|(i, v)| v + first + slope * i as f64 / factor as f64)
        .collect()
}
