//! Sums over a record.

use super::missing_readings::MissingReadings;

/// Sums over a record.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums {
    /// Counts of samples and gaps. In a sample with a missing reading, only the loads that the other gauges determine are known.
    pub missing: MissingReadings,
    /// Smallest value of each load.
    pub min: Vec<f64>,
    /// Largest value of each load.
    pub max: Vec<f64>,
    /// Sum of the values of each load.
    pub sum: Vec<f64>,
    /// Sum of the squared values of each load.
    pub sum_of_squares: Vec<f64>,
    /// Sum of squared residuals by gauge, strain^2.
    pub residual: Vec<f64>,
    /// Sum of squared readings by gauge, strain^2.
    pub reading: Vec<f64>,
    /// Readings of each gauge in samples with a gap.
    pub read_in_gaps: Vec<u64>,
}

impl Sums {
    /// Creates empty sums for `n` gauges and `k` loads.
    pub fn new(n: usize, k: usize) -> Self {
        Self {
            missing: MissingReadings::new(k),
            min: vec![f64::INFINITY; k],
            max: vec![f64::NEG_INFINITY; k],
            sum: vec![0.0; k],
            sum_of_squares: vec![0.0; k],
            residual: vec![0.0; n],
            reading: vec![0.0; n],
            read_in_gaps: vec![0; n],
        }
    }

    /// Returns the samples in which load `l` is known.
    pub fn known_samples(&self, l: usize) -> u64 {
        let in_gaps = self.missing.known_in_gaps.get(l);
        self.missing.whole + in_gaps.copied().unwrap_or(0)
    }

    /// Returns the number of samples in which gauge `g` has a reading.
    pub fn read(&self, g: usize) -> u64 {
        self.missing.whole + self.read_in_gaps.get(g).copied().unwrap_or(0)
    }

    /// Adds the sums and counts of `other`, and extends the extremes by the extremes of `other`.
    pub fn merge(&mut self, other: &Self) {
        self.missing.merge(&other.missing);
        let add = |a: &mut Vec<f64>, b: &[f64]| a.iter_mut().zip(b).for_each(|(x, y)| *x += y);
        let count = |a: &mut Vec<u64>, b: &[u64]| a.iter_mut().zip(b).for_each(|(x, y)| *x += y);
        let fold = |a: &mut Vec<f64>, b: &[f64], pick: fn(f64, f64) -> f64| {
            a.iter_mut().zip(b).for_each(|(x, y)| *x = pick(*x, *y));
        };
        fold(&mut self.min, &other.min, f64::min);
        fold(&mut self.max, &other.max, f64::max);
        add(&mut self.sum, &other.sum);
        add(&mut self.sum_of_squares, &other.sum_of_squares);
        add(&mut self.residual, &other.residual);
        add(&mut self.reading, &other.reading);
        count(&mut self.read_in_gaps, &other.read_in_gaps);
    }
}
