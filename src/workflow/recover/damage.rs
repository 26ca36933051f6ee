//! Cycles and pseudo-damage of the loads of a record. Its samples are read piece by piece, and the samples at the ends of cycles are read again.

use super::sink::{RecordHead, Samples};
use crate::estimate::NORMAL_95;
use crate::finding::{Finding, Severity};
use crate::host::outcome::finite_or_none;
use crate::recovery::Sums;
use crate::series::rainflow::{Cycle, Damage, Point, Rainflow};
use rayon::prelude::*;
use serde::Serialize;
use std::ops::Range;

/// Number of samples that are read at a time.
pub(super) const PIECE: usize = 16_384;

/// Cycles of a load, report unit.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoadDamage {
    /// Load or combination.
    pub name: String,
    /// Report unit.
    pub unit: String,
    /// Power of the range in pseudo-damage.
    pub slope: f64,
    /// Number of cycles. An open range counts half.
    pub cycles: f64,
    /// The largest range.
    pub largest_range: f64,
    /// Sum of cycles times range to the power of the slope.
    pub damage: f64,
    /// Lower end of its 95 % interval.
    pub damage_low: Option<f64>,
    /// Upper end of this interval.
    pub damage_high: Option<f64>,
    /// Range of a single cycle with the same damage.
    pub one_cycle_range: Option<f64>,
    /// Lower end of its 95 % interval.
    pub one_cycle_range_low: Option<f64>,
    /// Upper end of this interval.
    pub one_cycle_range_high: Option<f64>,
    /// Cycles by range.
    #[serde(skip)]
    pub count: Damage,
}

/// Returns the cycles of every load.
pub(super) fn damage(
    head: &RecordHead,
    sums: &Sums,
    samples: &dyn Samples,
    slope: f64,
) -> Vec<LoadDamage> {
    (0..head.n_loads())
        .into_par_iter()
        .map(|l| {
            let [min, max] = extremes(head, sums, l);
            let d = CycleCountInput {
                head,
                samples,
                slope,
            }
            .damage(l, max - min, 0..samples.n_samples());
            LoadDamage {
                name: head.names[l].clone(),
                unit: head.units[l].name.clone(),
                slope,
                cycles: d.cycles,
                largest_range: d.largest,
                damage: d.value,
                damage_low: finite_or_none(d.low),
                damage_high: finite_or_none(d.high),
                one_cycle_range: finite_or_none(d.one_cycle(d.value)),
                one_cycle_range_low: finite_or_none(d.one_cycle(d.low)),
                one_cycle_range_high: finite_or_none(d.one_cycle(d.high)),
                count: d,
            }
        })
        .collect()
}

/// Returns the text on the counting of cycles and the meaning of pseudo-damage.
pub(super) fn about_damage(slope: f64) -> Finding {
    Finding::new(
        Severity::Info,
        "pseudo-damage",
        "damage",
        format!(
            "rainflow counts by ASTM E1049-85, open ranges as half cycles. Pseudo-damage is the sum of cycles times range to the power \
             {slope}, without a fatigue limit. It compares records and is not a life. Its interval shifts all ranges together by their own \
             95 % interval"
        ),
        "state the slope of the part's S-N curve: [recover] slope",
    )
}

/// Returns the smallest and largest sample of load `l`, report unit. Both are zero without samples.
pub(super) fn extremes(head: &RecordHead, sums: &Sums, l: usize) -> [f64; 2] {
    [sums.min[l], sums.max[l]].map(|v| {
        let v = v * head.units[l].factor;
        if v.is_finite() { v } else { 0.0 }
    })
}

/// Samples of a record whose cycles are counted, with the slope of the S-N line.
#[derive(Clone, Copy)]
pub(super) struct CycleCountInput<'a> {
    pub head: &'a RecordHead,
    pub samples: &'a dyn Samples,
    pub slope: f64,
}

impl CycleCountInput<'_> {
    /// Counts the cycles of load `l` over some of the samples, report unit. Ranges are at most `limit`.
    pub fn damage(self, l: usize, limit: f64, range: Range<usize>) -> Damage {
        let Self {
            head,
            samples,
            slope,
        } = self;
        let mut damage = Damage::new(slope, limit);
        let mut ends = [Vec::new(), Vec::new()];
        let columns: Vec<usize> = (0..head.n_loads()).collect();
        // The interval of the damage uses the factor of the normal distribution.
        let wider = head.filter.coverage_factor() / NORMAL_95;
        let mut add = |cycle: Cycle| {
            for (end, point) in ends.iter_mut().zip([cycle.from, cycle.to]) {
                end.clear();
                samples.read(point.at, point.at + 1, &columns, end);
            }
            let [from, to] = &ends;
            let change: Vec<f64> = from
                .iter()
                .zip(to)
                .zip(&head.units)
                .map(|((a, b), u)| (b - a) / u.factor)
                .collect();
            // The error of the change is computed twice, with the active gauges at the begin and with those at the end. The larger error is used.
            let by_end = [cycle.from, cycle.to].map(|point| {
                let gain = head.estimate_at(point.at);
                let ends = [cycle.from.at, cycle.to.at];
                head.filter.sigma_of_change(gain, l, &change, ends)
            });
            let sigma = wider * by_end[0].max(by_end[1]) * head.units[l].factor;
            damage.add(&cycle, sigma);
        };
        let mut count = Rainflow::default();
        let mut values = Vec::with_capacity(PIECE);
        for from in range.clone().step_by(PIECE) {
            values.clear();
            samples.read(from, (from + PIECE).min(range.end), &[l], &mut values);
            for (at, &value) in (from..).zip(&values) {
                count.push(Point { at, value }, &mut add);
            }
        }
        count.finish(&mut add);
        damage
    }
}

/// Counts the cycles of a recorded load whose samples have this noise, 1 sd, in the unit of its values.
pub(super) fn damage_of_recorded(
    values: impl Iterator<Item = f64>,
    noise: f64,
    slope: f64,
) -> Damage {
    let mut damage = Damage::new(slope, 0.0);
    let of_range = std::f64::consts::SQRT_2 * noise;
    let mut add = |cycle: Cycle| damage.add(&cycle, of_range);
    let mut count = Rainflow::default();
    for (at, value) in values.enumerate() {
        count.push(Point { at, value }, &mut add);
    }
    count.finish(&mut add);
    damage
}
