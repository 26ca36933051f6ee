//! Statistics of samples.

use crate::linalg::Matrix;

/// Returns the median. For an even number of values, it is the larger of the two middle values. `None` for an empty list.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    if values.is_empty() {
        return None;
    }
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Returns the value at which half of the weight is reached, and sorts the pairs of value and weight. `None` without values.
///
/// # Example
/// ```
/// use strainbridge::estimate::{median, weighted_median};
///
/// let mut values = [(10.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
/// assert_eq!(weighted_median(&mut values), median(vec![10.0, 1.0, 2.0]));
/// // More than half of the weight is at 10.
/// assert_eq!(weighted_median(&mut [(1.0, 1.0), (2.0, 1.0), (10.0, 3.0)]), Some(10.0));
/// assert_eq!(weighted_median(&mut []), None);
/// ```
pub fn weighted_median(values: &mut [(f64, f64)]) -> Option<f64> {
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|v| v.1).sum();
    let mut sum = 0.0;
    let found = values.iter().find(|v| {
        sum += v.1;
        sum >= total / 2.0
    });
    found.map(|v| v.0)
}

/// Returns the correlations of rows with the rows `k` later, over all columns. Each row is a sample, in order of time. `k` goes from 1 up to the
/// first correlation that is no larger than `sigmas` standard deviations of white noise.
fn correlations(rows: &Matrix, sigmas: f64) -> impl Iterator<Item = f64> {
    let (n, m) = rows.shape();
    let white = rows.norm_squared();
    let significant = sigmas / ((n * m).max(1) as f64).sqrt();
    let correlation = move |lag: usize| {
        let (before, after) = (rows.rows(0, n - lag), rows.rows(lag, n - lag));
        before.dot(&after) / white
    };
    (1..n)
        .map(correlation)
        .take_while(move |r| *r > significant)
}

/// Returns the number of rows of white noise whose covariance scatters as much as the covariance of these rows. Each row is a sample, in order of
/// time: `n / (1 + 2 sum_k r_k^2)`.
///
/// # Reference
/// M. S. Bartlett, J. R. Stat. Soc. Suppl. 8 (1946) 27: variance of the covariance of series.
pub fn effective_rows(rows: &Matrix) -> f64 {
    let squares: f64 = correlations(rows, 2.0).map(|r| r * r).sum();
    rows.nrows() as f64 / (1.0 + 2.0 * squares)
}

/// Returns the number of independent rows divided by the number of rows. Each row is a sample, in order of time: `1 / (1 + 2 sum_k r_k)`. White noise
/// has 1: its correlations reach four standard deviations once in 30,000 records.
///
/// # Reference
/// G. V. Bayley and J. M. Hammersley, J. R. Stat. Soc. Suppl. 8 (1946) 184.
pub fn independent_share(rows: &Matrix) -> f64 {
    let least = 1.0 / rows.nrows().max(1) as f64;
    (1.0 / (1.0 + 2.0 * correlations(rows, 4.0).sum::<f64>())).max(least)
}

/// Returns the root mean square of the finite values. It is 0 if there are no finite values.
pub fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (mut sum, mut n) = (0.0, 0usize);
    for v in values.filter(|v| v.is_finite()) {
        sum += v * v;
        n += 1;
    }
    if n == 0 { 0.0 } else { (sum / n as f64).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_the_values_are_smaller() {
        assert_eq!(median(Vec::new()), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 3.0, 2.0]), Some(3.0));
    }

    #[test]
    fn half_of_the_weight_lies_on_either_side() {
        assert_eq!(weighted_median(&mut []), None);
        let mut even = [(3.0, 1.0), (1.0, 1.0), (2.0, 1.0)];
        assert_eq!(weighted_median(&mut even), Some(2.0));
        let mut heavy = [(3.0, 5.0), (1.0, 1.0), (2.0, 1.0)];
        assert_eq!(weighted_median(&mut heavy), Some(3.0));
    }
}
