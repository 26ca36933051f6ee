//! Removing what does not vary.

/// Arithmetic mean; 0 for an empty slice.
pub fn mean(x: &[f64]) -> f64 {
    if x.is_empty() {
        0.0
    } else {
        x.iter().sum::<f64>() / x.len() as f64
    }
}

/// Root of the mean square; 0 for an empty slice.
pub fn rms(x: &[f64]) -> f64 {
    if x.is_empty() {
        0.0
    } else {
        (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt()
    }
}

/// x less its mean.
pub fn without_mean(x: &[f64]) -> Vec<f64> {
    let m = mean(x);
    x.iter().map(|v| v - m).collect()
}

/// Offset and slope per sample of the least-squares line through x over 0, 1, 2 ..
pub fn line(x: &[f64]) -> (f64, f64) {
    let n = x.len() as f64;
    if x.len() < 2 {
        return (mean(x), 0.0);
    }
    let middle = (n - 1.0) / 2.0;
    let m = mean(x);
    let (mut sxy, mut sxx) = (0.0, 0.0);
    for (i, v) in x.iter().enumerate() {
        let d = i as f64 - middle;
        sxy += d * (v - m);
        sxx += d * d;
    }
    let slope = sxy / sxx;
    (m - slope * middle, slope)
}

/// x less the mean of a zero record of the same channel.
pub fn subtract_zero(x: &[f64], zero_record: &[f64]) -> Vec<f64> {
    let m = mean(zero_record);
    x.iter().map(|v| v - m).collect()
}
