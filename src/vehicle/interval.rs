//! Covariance of fitted parameters when residuals are coloured.

use super::equations::Equation;
use super::fit::Fit;
use crate::estimate::student_95;

/// Covariance of the free parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// Covariance by rows, in the order of `Fit::free`.
    pub covariance: Vec<Vec<f64>>,
    /// Factor on sigma for 95 % (Student t with blocks - 1 degrees of freedom).
    pub coverage_factor: f64,
    /// Number of blocks.
    pub n_blocks: usize,
    /// Number of independent samples to which the residual of each equation is equivalent.
    pub effective_samples: Vec<f64>,
}

/// Smallest number of blocks: fewer do not determine a variance.
const MIN_BLOCKS: usize = 8;

/// Returns the covariance B (sum over blocks of s s') B of the free parameters.
///
/// Here B = (A'W^2A)^-1, and s is the sum of w^2 a r over the samples of a block and all equations. The covariance is valid for residuals that are
/// correlated across equations, and in time up to the length of a block.
///
/// `memory_s` is the length of a block, about 1.5 periods of the lower band edge.
///
/// # Reference
/// Newey & West, Econometrica 55 (1987) 703; batch means: Carlstein, Ann. Statist. 14 (1986) 1171.
pub fn spread(equations: &[Equation], fit: &Fit, rate_hz: f64, memory_s: f64) -> Spread {
    let p = fit.free.len();
    let n = equations.first().map_or(0, |e| e.target.len());
    let length = ((memory_s * rate_hz).ceil() as usize).clamp(1, (n / MIN_BLOCKS).max(1));
    let n_blocks = (n / length).max(1);
    let mut sums = vec![vec![0.0; p]; n_blocks];
    let mut effective = Vec::new();
    for (e, w) in equations.iter().zip(&fit.weights) {
        let residual = residual(e, &fit.values);
        effective.push(effective_samples(&residual));
        for (i, column) in &e.columns {
            let Some(k) = fit.free.iter().position(|f| f == i) else {
                continue;
            };
            for (b, sum) in sums.iter_mut().enumerate() {
                let range = b * length..(b + 1) * length;
                sum[k] += w
                    * w
                    * column[range.clone()]
                        .iter()
                        .zip(&residual[range])
                        .map(|(a, r)| a * r)
                        .sum::<f64>();
            }
        }
    }
    let mut meat = vec![vec![0.0; p]; p];
    for s in &sums {
        for i in 0..p {
            for j in 0..p {
                meat[i][j] += s[i] * s[j];
            }
        }
    }
    // The factor corrects for samples outside the blocks, and for the degrees of freedom that the parameters use.
    let factor = n as f64 / (n_blocks * length) as f64 * n_blocks as f64
        / (n_blocks.saturating_sub(p)).max(1) as f64;
    let b = &fit.solution.inverse;
    let product = |x: &[Vec<f64>], y: &[Vec<f64>]| -> Vec<Vec<f64>> {
        (0..p)
            .map(|i| {
                (0..p)
                    .map(|j| (0..p).map(|k| x[i][k] * y[k][j]).sum())
                    .collect()
            })
            .collect()
    };
    let mut covariance = product(&product(b, &meat), b);
    covariance.iter_mut().flatten().for_each(|v| *v *= factor);
    let freedom = n_blocks.saturating_sub(p).max(1) as f64;
    let coverage_factor = student_95(freedom);
    Spread {
        covariance,
        coverage_factor,
        n_blocks,
        effective_samples: effective,
    }
}

/// Returns the sum of parameter times column, minus the target.
pub fn residual(e: &Equation, values: &[f64]) -> Vec<f64> {
    let mut r: Vec<f64> = e.target.iter().map(|t| -t).collect();
    for (i, column) in &e.columns {
        let v = values
            .get(*i)
            .copied()
            .filter(|v| v.is_finite())
            .unwrap_or(0.0);
        r.iter_mut().zip(column).for_each(|(r, c)| *r += v * c);
    }
    r
}

/// Returns the number of independent samples with the same information on power: n / sum of squared autocorrelations.
pub fn effective_samples(r: &[f64]) -> f64 {
    let n = r.len();
    let power: f64 = r.iter().map(|v| v * v).sum();
    if power <= 0.0 || n < 4 {
        return n as f64;
    }
    let mut sum = 1.0;
    for lag in 1..(n / 4).min(400) {
        let c = r[lag..].iter().zip(r).map(|(a, b)| a * b).sum::<f64>() / power;
        sum += 2.0 * c * c;
    }
    n as f64 / sum
}
