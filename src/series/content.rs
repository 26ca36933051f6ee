//! Up to which frequency a signal has content.

use super::welch::cross_spectra;

/// Share of the power above the noise that is below the returned frequency.
const SHARE: f64 = 0.99;
/// A bin counts when its density is this many times the noise: averaged spectra of noise alone stay below.
const ABOVE_NOISE: f64 = 3.0;
/// Samples a segment.
const SEGMENT: usize = 4096;

/// Returns the frequency below which 99 % of a signal's power is, without its mean and without noise. The result is `None` if nothing exceeds the
/// noise, or if the signal is shorter than a segment of 16 samples.
///
/// `pieces` are stretches of one signal. The noise density is the larger of `noise_density` (one-sided, unit^2/Hz) and the lower quartile of the
/// spectrum. A quarter of all frequencies is thus assumed to contain only noise.
pub fn content_hz(pieces: &[Vec<f64>], rate_hz: f64, noise_density: f64) -> Option<f64> {
    let longest = pieces.iter().map(Vec::len).max()?;
    let segment = SEGMENT.min(longest);
    if segment < 16 || !(rate_hz > 0.0) {
        return None;
    }
    let mut density: Vec<f64> = Vec::new();
    let mut f_hz = Vec::new();
    let mut segments = 0.0;
    for piece in pieces.iter().filter(|p| p.len() >= segment) {
        let spectrum = cross_spectra(piece, piece, rate_hz, segment);
        density.resize(spectrum.xx.len(), 0.0);
        let weight = spectrum.n_segments as f64;
        for (d, x) in density.iter_mut().zip(&spectrum.xx) {
            *d += x * weight;
        }
        segments += weight;
        f_hz = spectrum.f_hz;
    }
    density.iter_mut().for_each(|d| *d /= segments);
    let mut sorted = density.clone();
    sorted.sort_by(f64::total_cmp);
    let quartile = sorted.get(sorted.len() / 4).copied().unwrap_or(0.0);
    let floor = ABOVE_NOISE * noise_density.max(quartile);
    let above = |d: f64| if d > floor { d } else { 0.0 };
    let total: f64 = density.iter().map(|d| above(*d)).sum();
    if !(total > 0.0) {
        return None;
    }
    let mut sum = 0.0;
    f_hz.iter()
        .zip(&density)
        .find(|(_, d)| {
            sum += above(**d);
            sum >= SHARE * total
        })
        .map(|(f, _)| *f)
}

#[cfg(test)]
mod tests;
