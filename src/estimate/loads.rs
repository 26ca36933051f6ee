//! Recovered loads, whichever path they came from.

use crate::finding::Finding;

/// Loads of one run (a static state or the mean of a record), in job units, with their covariance.
///
/// # Example
/// The sum of two loads whose errors are opposite is certain:
/// ```
/// use strainbridge::estimate::{LoadEstimate, NORMAL_95};
///
/// let mut loads = LoadEstimate {
///     run: "R1".to_owned(),
///     names: vec!["left".to_owned(), "right".to_owned()],
///     values: vec![30.0, 50.0],
///     covariance: vec![4.0, -4.0, -4.0, 4.0],
///     coverage_factor: NORMAL_95,
///     findings: Vec::new(),
/// };
/// loads.add_sums(&["axle".to_owned()], &[vec![(0, 1.0), (1, 1.0)]]);
/// assert_eq!((loads.values[2], loads.sigma(2)), (80.0, 0.0));
/// let [low, high] = loads.interval(0);
/// assert!((high - low - 2.0 * NORMAL_95 * 2.0).abs() < 1e-12);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct LoadEstimate {
    /// Run name.
    pub run: String,
    /// Load names, one per value.
    pub names: Vec<String>,
    /// Estimates.
    pub values: Vec<f64>,
    /// Covariance, `n_loads x n_loads` by rows.
    pub covariance: Vec<f64>,
    /// Factor on sigma that gives the 95 % interval (normal or Student t).
    pub coverage_factor: f64,
    /// Findings on the estimate.
    pub findings: Vec<Finding>,
}

impl LoadEstimate {
    /// Returns one standard deviation of load `i`.
    pub fn sigma(&self, i: usize) -> f64 {
        let n = self.values.len();
        self.covariance
            .get(i * n + i)
            .copied()
            .unwrap_or(f64::NAN)
            .max(0.0)
            .sqrt()
    }

    /// Multiplies every sigma by a factor.
    pub fn widen(&mut self, factor: f64) {
        let covariance = self.covariance.iter_mut();
        covariance.for_each(|c| *c *= factor * factor);
    }

    /// Appends sums of loads, each a list of loads and factors: `c' f` with the variance `c' C c`.
    pub fn add_sums(&mut self, names: &[String], sums: &[Vec<(usize, f64)>]) {
        let k = self.values.len();
        let own = (0..k).map(|l| vec![(l, 1.0)]);
        let rows: Vec<Vec<(usize, f64)>> = own.chain(sums.iter().cloned()).collect();
        let values = rows
            .iter()
            .map(|row| row.iter().map(|(l, c)| c * self.values[*l]).sum())
            .collect();
        let between = |a: &[(usize, f64)], b: &[(usize, f64)]| -> f64 {
            let pairs = a.iter().flat_map(|x| b.iter().map(move |y| (x, y)));
            pairs
                .map(|((i, c), (j, d))| c * d * self.covariance[i * k + j])
                .sum()
        };
        let covariance = rows
            .iter()
            .flat_map(|a| rows.iter().map(move |b| (a, b)))
            .map(|(a, b)| between(a, b))
            .collect();
        self.values = values;
        self.covariance = covariance;
        self.names.extend_from_slice(names);
    }

    /// Returns the 95 % interval of load `i`.
    pub fn interval(&self, i: usize) -> [f64; 2] {
        let half = self.coverage_factor * self.sigma(i);
        let v = self.values.get(i).copied().unwrap_or(f64::NAN);
        [v - half, v + half]
    }
}
