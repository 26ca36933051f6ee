//! Recovered loads, whichever path they came from.

use crate::finding::Finding;

/// Loads of one run (a static state or the mean of a record), in job units, with their covariance.
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
    /// What the estimate says of itself.
    pub findings: Vec<Finding>,
}

impl LoadEstimate {
    /// One standard deviation of load `i`.
    pub fn sigma(&self, i: usize) -> f64 {
        let n = self.values.len();
        self.covariance
            .get(i * n + i)
            .copied()
            .unwrap_or(f64::NAN)
            .max(0.0)
            .sqrt()
    }

    /// The 95 % interval of load `i`.
    pub fn interval(&self, i: usize) -> [f64; 2] {
        let half = self.coverage_factor * self.sigma(i);
        let v = self.values.get(i).copied().unwrap_or(f64::NAN);
        [v - half, v + half]
    }
}
