//! Damage with an interval that holds over one day and over many.

use super::tally::{NOISE, Tally};

/// Half width of a 95 % interval over one standard deviation.
const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Damage of one load over a time, and the errors that make its interval, each by its own law: the error of S is one and the same in every
/// cycle and stays what it is however long one measures; the scatter of noise averages out; its bias (noise widens every range) does
/// not, and is taken off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DamageInterval {
    /// Damage, the bias of noise taken off.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Damage as counted.
    pub counted: f64,
    /// What noise added to it, in the mean.
    pub noise_bias: f64,
    /// Standard deviation from errors of S, of the damage.
    pub sigma_s: f64,
    /// Standard deviation from the scatter of noise.
    pub sigma_noise: f64,
    /// Standard deviation of the bias that was taken off.
    pub sigma_bias: f64,
}

/// The damage of a tally with its interval; `scale` is the covariance of the errors of this load's row of the gain,
/// `f = (1 + C) f_true`, row-major, `n_loads x n_loads`; `noise` is the standard deviation of a sample.
///
/// The bias is found by counting with more noise: damage at one, two and three times the noise, a parabola through them, and its value at
/// none (Cook and Stefanski's simulation extrapolation). The straight line through the first two bounds what the parabola may err.
/// The ends are those of the logarithm: errors of scale multiply the damage.
///
/// # Reference
/// J.R. Cook, L.A. Stefanski, Simulation-extrapolation estimation in parametric measurement error models, JASA 89 (1994) 1314-1328.
pub fn damage_interval(tally: &Tally, scale: &[f64], noise: f64) -> DamageInterval {
    let sums = tally.sums_with_residue();
    let [once, twice, thrice] = sums.damage;
    debug_assert_eq!(NOISE, [1.0, 2.0, 3.0]);
    let (value, line) = if noise > 0.0 {
        // Lagrange's polynomials of the points 1, 2, 3 (and 1, 2) at 0.
        (3.0 * once - 3.0 * twice + thrice, 2.0 * once - twice)
    } else {
        (once, once)
    };
    let g = &sums.by_load;
    let of_s: f64 = scale
        .chunks_exact(g.len().max(1))
        .zip(g)
        .map(|(row, a)| a * row.iter().zip(g).map(|(c, b)| c * b).sum::<f64>())
        .sum();
    // The added noise is the same at both levels but for its size, sqrt(3) and sqrt(8) of the noise there is; in the parabola it
    // counts (-3 sqrt(3) + sqrt(8))^2 times the scatter that the noise itself makes.
    let added = (8.0_f64.sqrt() - 3.0 * 3.0_f64.sqrt()).powi(2);
    let of_noise = noise * noise * sums.scatter * (1.0 + if noise > 0.0 { added } else { 0.0 });
    let sigma_bias = (value - line).abs();
    let mut out = DamageInterval {
        value: value.max(0.0),
        low: 0.0,
        high: 0.0,
        counted: once,
        noise_bias: once - value,
        sigma_s: of_s.max(0.0).sqrt(),
        sigma_noise: of_noise.sqrt(),
        sigma_bias,
    };
    let sigma = (of_s.max(0.0) + of_noise + sigma_bias * sigma_bias).sqrt();
    if value > 0.0 {
        let factor = (NORMAL_95 * sigma / value).exp();
        out.low = value / factor;
        out.high = value * factor;
    } else {
        // Noise makes all of it: no more is known than that it is less than was counted, but for the error of scale.
        let share = if once > 0.0 {
            of_s.max(0.0).sqrt() / once
        } else {
            0.0
        };
        out.high = once * (NORMAL_95 * share).exp();
    }
    out
}
