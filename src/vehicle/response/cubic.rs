//! Cubic curves through samples: inputs between samples.

/// Returns the change per sample of a curve through samples at sample `i`, of order 4: central inside, one-sided at both ends.
pub(super) fn slope(x: &[f64], i: usize) -> f64 {
    let n = x.len();
    if n < 5 {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(n.saturating_sub(1)));
        return (x[b] - x[a]) / (b - a).max(1) as f64;
    }
    let weighted = |from: usize, weights: [f64; 5]| -> f64 {
        let part = x[from..from + 5].iter();
        part.zip(weights).map(|(x, w)| x * w).sum::<f64>() / 12.0
    };
    match (i, n - 1 - i) {
        (0, _) => weighted(0, [-25.0, 48.0, -36.0, 16.0, -3.0]),
        (1, _) => weighted(0, [-3.0, -10.0, 18.0, -6.0, 1.0]),
        (_, 0) => weighted(n - 5, [3.0, -16.0, 36.0, -48.0, 25.0]),
        (_, 1) => weighted(n - 5, [-1.0, 6.0, -18.0, 10.0, 3.0]),
        _ => weighted(i - 2, [1.0, -8.0, 0.0, 8.0, -1.0]),
    }
}

/// Returns the coefficients p of the curve p0 + p1 s + p2 s^2 + p3 s^3 from sample `i` (s = 0) to the next one (s = 1).
pub(super) fn coefficients(x: &[f64], i: usize) -> [f64; 4] {
    let (a, b) = (slope(x, i), slope(x, i + 1));
    let rise = x[i + 1] - x[i];
    [x[i], a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise]
}

/// Returns the coefficients of the derivative of a curve by time, for `rate_hz` samples per second.
pub(super) fn derivative(p: [f64; 4], rate_hz: f64) -> [f64; 4] {
    [p[1], 2.0 * p[2], 3.0 * p[3], 0.0].map(|v| rate_hz * v)
}

/// Returns the value of a curve at `s`.
pub(super) fn value_at(p: [f64; 4], s: f64) -> f64 {
    p[0] + s * (p[1] + s * (p[2] + s * p[3]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The scheme of order 4 reproduces every polynomial of degree 4 at samples, and every cubic between them.
    #[test]
    fn cubics_are_reproduced_and_slopes_of_degree_four_are_exact() {
        let f = |t: f64| 1.0 - 2.0 * t + 0.5 * t * t - 0.25 * t * t * t;
        let x: Vec<f64> = (0..9).map(f64::from).map(f).collect();
        for i in 0..8 {
            let p = coefficients(&x, i);
            for s in [0.25, 0.5, 0.9] {
                assert!((value_at(p, s) - f(i as f64 + s)).abs() < 1e-11);
            }
        }
        let x: Vec<f64> = (0..7).map(|i| f64::from(i).powi(4)).collect();
        for i in 0..7 {
            assert!((slope(&x, i) - 4.0 * (i as f64).powi(3)).abs() < 1e-9);
        }
    }

    /// Reason of the limit of ten samples a period: the largest error between samples of a sine is then below 0.1 % of its amplitude.
    #[test]
    fn ten_samples_a_period_follow_a_sine_to_a_thousandth() {
        let wave = |t: f64| (2.0 * PI * t / 10.0 + 0.3).sin();
        let x: Vec<f64> = (0..41).map(|i| wave(f64::from(i))).collect();
        let mut worst = 0.0f64;
        for i in 2..38 {
            let p = coefficients(&x, i);
            for k in 0..20 {
                let s = f64::from(k) / 20.0;
                worst = worst.max((value_at(p, s) - wave(i as f64 + s)).abs());
            }
        }
        assert!(worst < 1e-3, "{worst}");
    }
}
