//! Pseudo-damage of counted cycles.

use super::count::Cycle;
use crate::estimate::NORMAL_95;

/// Ranges are counted in this many bins.
const BINS: usize = 64;

/// Cycles of ranges between two limits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bin {
    /// Number of cycles. A half cycle counts 0.5.
    pub cycles: f64,
    /// Sum of the means of the cycles, each times its count.
    pub sum_of_means: f64,
    /// Damage of these cycles.
    pub damage: f64,
}

/// Pseudo-damage `sum of n R^m` over the cycles. It is proportional to the damage of a part whose life falls with the power `m` of the range. The
/// factor depends on the part, so that only ratios of two records are meaningful.
#[derive(Clone, Debug, PartialEq)]
pub struct Damage {
    /// The power m.
    pub slope: f64,
    /// Cycles by range, `BINS` of equal width up to [`Damage::limit`].
    pub bins: Vec<Bin>,
    /// Largest range of the bins.
    pub limit: f64,
    /// Cycles counted.
    pub cycles: f64,
    /// The largest range.
    pub largest: f64,
    /// Damage of the ranges without change.
    pub value: f64,
    /// Damage with all ranges at the lower ends of their 95 % intervals. No range is below zero.
    pub low: f64,
    /// Damage with all ranges at the upper ends of their 95 % intervals.
    pub high: f64,
}

impl Damage {
    /// Returns an empty damage sum; `limit` is the difference of the record's extremes.
    pub fn new(slope: f64, limit: f64) -> Self {
        Self {
            slope,
            bins: vec![Bin::default(); BINS],
            limit,
            cycles: 0.0,
            largest: 0.0,
            value: 0.0,
            low: 0.0,
            high: 0.0,
        }
    }

    /// Adds a cycle; `sigma` is one standard deviation of its range.
    ///
    /// At an end of the interval, all ranges change in the same direction. This is right for errors of the model, which are constant over the record.
    /// For noise, the interval is too wide.
    pub fn add(&mut self, cycle: &Cycle, sigma: f64) {
        let range = cycle.range();
        let half = NORMAL_95 * sigma;
        let of = |r: f64| cycle.count * r.max(0.0).powf(self.slope);
        let damage = of(range);
        self.value += damage;
        self.low += of(range - half);
        self.high += of(range + half);
        self.cycles += cycle.count;
        self.largest = self.largest.max(range);
        let share = if self.limit > 0.0 {
            range / self.limit
        } else {
            0.0
        };
        let at = ((share * BINS as f64) as usize).min(BINS - 1);
        if let Some(bin) = self.bins.get_mut(at) {
            bin.cycles += cycle.count;
            bin.sum_of_means += cycle.count * cycle.mean();
            bin.damage += damage;
        }
    }

    /// Returns the range of a single cycle with the damage `d`, in the unit of the ranges.
    pub fn one_cycle(&self, d: f64) -> f64 {
        d.powf(1.0 / self.slope)
    }
}
