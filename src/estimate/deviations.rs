//! Test whether differences from true values exceed their stated intervals.

use super::tails::chi_square_tail;
use statrs::distribution::{ContinuousCDF, Normal};

/// Chance under which differences count as larger than their intervals allow.
const SIGNIFICANT: f64 = 1e-3;

/// Square of a normal error in sigmas that is exceeded with that chance.
fn largest_square() -> f64 {
    Normal::standard()
        .inverse_cdf(1.0 - SIGNIFICANT / 2.0)
        .powi(2)
}

/// Differences of many samples from the true values, in units of their stated standard deviation. [`Deviations::is_significant`] tests the stated
/// intervals.
///
/// # Example
/// Two records of 10 independent samples, one with mean squares as stated and one three times as large:
/// ```
/// use strainbridge::estimate::{Deviations, chi_square_tail};
///
/// let as_stated = Deviations { mean_square: 1.0, effective: 10.0, common: 0.0 };
/// assert!(!as_stated.is_significant());
/// // Chi-square with 10 degrees of freedom exceeds 29.59 with the probability 0.001 (Abramowitz and Stegun, table 26.8).
/// assert!((chi_square_tail(29.588, 10.0) - 1e-3).abs() < 1e-6);
/// assert!(Deviations { mean_square: 3.0, ..as_stated }.is_significant());
/// // A common error of all samples can be as large by chance.
/// assert!(!Deviations { mean_square: 3.0, common: 1.0, ..as_stated }.is_significant());
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviations {
    /// Mean of the squares; 1 is expected.
    pub mean_square: f64,
    /// Number of independent samples.
    pub effective: f64,
    /// Share of the variance that all samples have in common, such as the error of S.
    pub common: f64,
}

impl Deviations {
    /// Returns whether the differences are larger than the intervals allow. The first limit is a common error alone that has a chance of 0.001. The
    /// second limit is independent errors of that chance, together with a common error of that chance.
    pub fn is_significant(&self) -> bool {
        let common = self.common.clamp(0.0, 1.0);
        let inflated = 1.0 - common + common * largest_square();
        let n = self.effective.max(1.0);
        let independent = chi_square_tail(n * self.mean_square / inflated, n);
        chi_square_tail(self.mean_square, 1.0) < SIGNIFICANT || independent < SIGNIFICANT
    }

    /// Returns the number of independent squares in all `blocks`, each of which is a mean of squares. The variance of a mean of `n` squares of normal
    /// errors is `2 / n` of its square.
    pub fn effective_count(blocks: &[f64]) -> f64 {
        let n = blocks.len() as f64;
        let mean = blocks.iter().sum::<f64>() / n;
        let variance = blocks.iter().map(|b| (b - mean) * (b - mean)).sum::<f64>() / (n - 1.0);
        match variance > 0.0 {
            true => n * 2.0 * mean * mean / variance,
            false => n,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Chi-square exceeds 29.59 with probability 0.001 for 10 degrees of freedom, and 10.83 for one (Abramowitz and Stegun, table 26.8).
    #[test]
    fn independent_and_common_errors_have_limits_of_their_own() {
        let exceed = |mean_square, effective, common| {
            Deviations {
                mean_square,
                effective,
                common,
            }
            .is_significant()
        };
        assert!(!exceed(2.95, 10.0, 0.0) && exceed(2.97, 10.0, 0.0));
        assert!(!exceed(10.8, 1e6, 1.0) && exceed(10.9, 1e6, 1.0));
        assert!(!exceed(1.001, 1e4, 0.0) && exceed(1.1, 1e4, 0.0));
    }

    #[test]
    fn blocks_of_ten_independent_squares_count_ten_each() {
        // The mean of ten squares has a variance of 2 / 10. The values are one standard deviation to either side of 1.
        let sd = (0.2_f64 * 3.0 / 4.0).sqrt();
        let blocks = [1.0 - sd, 1.0 + sd, 1.0 - sd, 1.0 + sd];
        assert!((Deviations::effective_count(&blocks) - 40.0).abs() < 1e-9);
    }
}
