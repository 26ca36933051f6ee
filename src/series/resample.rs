//! Samples between samples.

/// Returns x with `factor - 1` samples between neighbours by band-limited interpolation; length (n - 1) factor + 1.
///
/// The method subtracts the line through first and last sample first, so the zero-padded transform has no step at the ends.
///
/// # Example
/// ```
/// use strainbridge::series::resample::upsample;
///
/// let pulse = |t: f64| 3.0 + 0.1 * t + (-0.5 * ((t - 32.0) / 4.0).powi(2)).exp();
/// let x: Vec<f64> = (0..65).map(|i| pulse(f64::from(i))).collect();
/// let dense = upsample(&x, 4);
/// assert_eq!(dense.len(), 64 * 4 + 1);
/// for (i, v) in dense.iter().enumerate() {
///     assert!((v - pulse(i as f64 / 4.0)).abs() < 1e-6);
/// }
/// ```
pub fn upsample(x: &[f64], factor: usize) -> Vec<f64> {
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
