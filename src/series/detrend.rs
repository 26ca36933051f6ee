//! Removing what does not vary.

/// Returns the arithmetic mean. It is 0 for an empty slice.
pub fn mean(x: &[f64]) -> f64 {
    if x.is_empty() {
        0.0
    } else {
        x.iter().sum::<f64>() / x.len() as f64
    }
}

/// Returns the root of the mean square. It is 0 for an empty slice.
pub fn rms(x: &[f64]) -> f64 {
    if x.is_empty() {
        0.0
    } else {
        (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt()
    }
}

/// Returns x minus its mean.
pub fn without_mean(x: &[f64]) -> Vec<f64> {
    let m = mean(x);
    x.iter().map(|v| v - m).collect()
}

/// Returns the mean of the finite values; 0 without any.
pub fn finite_mean(x: &[f64]) -> f64 {
    let read = || x.iter().filter(|v| v.is_finite());
    read().sum::<f64>() / read().count().max(1) as f64
}

/// Returns offset and slope per sample of the least-squares line through the finite samples of x over 0, 1, 2 .. The slope is 0 with fewer than two
/// finite samples.
pub fn line(x: &[f64]) -> (f64, f64) {
    let read = || x.iter().enumerate().filter(|(_, v)| v.is_finite());
    let n = read().count() as f64;
    let m = finite_mean(x);
    if n < 2.0 {
        return (m, 0.0);
    }
    let middle = read().map(|(i, _)| i as f64).sum::<f64>() / n;
    let (mut sxy, mut sxx) = (0.0, 0.0);
    for (i, v) in read() {
        let d = i as f64 - middle;
        sxy += d * (v - m);
        sxx += d * d;
    }
    let slope = sxy / sxx;
    (m - slope * middle, slope)
}

/// Returns x minus the mean of a zero record of the same channel.
pub fn subtract_zero(x: &[f64], zero_record: &[f64]) -> Vec<f64> {
    let m = mean(zero_record);
    x.iter().map(|v| v - m).collect()
}
