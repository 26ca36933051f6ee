//! Samples between samples.

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
