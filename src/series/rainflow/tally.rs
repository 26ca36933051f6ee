//! Tally of one load over a record: its cycles by class, its residue, and the sums that its damage needs. Tallies of parts join to the
//! tally of the whole record.

use super::count::{Point, Rainflow, Reversal, half_cycles};
use super::law::Law;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Standard deviations of the noise in the counted histories, in units of the noise of the loads. The first history has no added noise. In the
/// others, added noise doubles and triples the noise.
pub const NOISE: [f64; 3] = [1.0, 2.0, 3.0];

/// Extreme value of a history, and its sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// Extreme value.
    pub value: f64,
    /// Sample of the extreme value.
    pub at: usize,
}

/// A reversal of a residue: its sample, its value, and all loads at that sample (empty if not needed).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResidueReversal {
    /// Sample.
    pub at: usize,
    /// Value.
    pub value: f64,
    /// All loads at that time.
    #[serde(deserialize_with = "super::nullable_numbers::numbers")]
    pub loads: Vec<f64>,
}

/// Sums over closed cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    /// Damage of each history of [`NOISE`].
    pub damage: [f64; 3],
    /// Change of the damage with each scale error: `sum of d'(R) sign(dF) dF_m`, by load m.
    #[serde(deserialize_with = "super::nullable_numbers::numbers")]
    pub by_load: Vec<f64>,
    /// Variance of the damage for noise of variance one in each sample: `sum of 2 d'(R)^2`.
    pub scatter: f64,
}

/// Cycles, levels, extremes and damage of one load over a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Width of a class, in the unit of the load. Class i reaches from i to i + 1 widths.
    pub width: f64,
    /// Law of the damage of a cycle.
    pub law: Law,
    /// Closed cycles by class of their first and second reversal, in order.
    pub cycles: Vec<(i32, i32, u64)>,
    /// Number of times that the load rose through the lower border of each class.
    pub levels: Vec<(i32, u64)>,
    /// Largest value.
    pub max: Option<Extreme>,
    /// Smallest value.
    pub min: Option<Extreme>,
    /// Number of samples, including samples without a value.
    pub samples: usize,
    /// Samples without a value.
    pub missing: usize,
    /// Reversals that no cycle has closed, for each history of [`NOISE`].
    pub residues: [Vec<ResidueReversal>; 3],
    /// Sums over closed cycles.
    pub sums: Sums,
}

impl Sums {
    /// Adds a cycle, or a share of a cycle, between two values. `from` and `to` contain all loads at both times.
    #[inline(always)]
    pub(super) fn add(&mut self, law: &Law, count: f64, change: f64, from: &[f64], to: &[f64]) {
        let range = change.abs();
        let [plain, ..] = &mut self.damage;
        *plain += count * law.damage(range);
        let slope = count * law.derivative(range);
        self.scatter += 2.0 * slope * slope;
        for ((sum, from), to) in self.by_load.iter_mut().zip(from).zip(to) {
            let of_load = to - from;
            // A load without a value at these times adds no known error.
            *sum += slope * change.signum() * if of_load.is_finite() { of_load } else { 0.0 };
        }
    }
}

impl Tally {
    /// Returns the tally of consecutive times, with consecutive sample numbers. `None` without parts, or if classes or laws differ.
    pub fn join_parts(parts: &[&Self]) -> Option<Self> {
        let first = parts.first()?;
        let same = |t: &&&Self| {
            t.width == first.width
                && t.law == first.law
                && t.sums.by_load.len() == first.sums.by_load.len()
        };
        if !parts.iter().all(|t| same(&t)) {
            return None;
        }
        let (mut cycles, mut levels) = (BTreeMap::new(), BTreeMap::new());
        let mut all = Self {
            max: None,
            min: None,
            samples: 0,
            missing: 0,
            cycles: Vec::new(),
            levels: Vec::new(),
            residues: Default::default(),
            sums: Sums {
                damage: [0.0; 3],
                by_load: vec![0.0; first.sums.by_load.len()],
                scatter: 0.0,
            },
            ..**first
        };
        let mut residues: [Vec<Vec<Reversal<Vec<f64>>>>; 3] = Default::default();
        for part in parts {
            for (a, b, n) in &part.cycles {
                *cycles.entry((*a, *b)).or_insert(0) += n;
            }
            for (i, n) in &part.levels {
                *levels.entry(*i).or_insert(0) += n;
            }
            let later = |e: Extreme| Point {
                at: all.samples + e.at,
                value: e.value,
            };
            for e in [part.max, part.min].into_iter().flatten() {
                extremes(&mut all.max, &mut all.min, later(e));
            }
            let before = all.samples;
            for (list, residue) in residues.iter_mut().zip(&part.residues) {
                let reversal = |l: &ResidueReversal| Reversal {
                    point: Point {
                        at: before + l.at,
                        value: l.value,
                    },
                    tag: l.loads.clone(),
                };
                list.push(residue.iter().map(reversal).collect());
            }
            all.samples += part.samples;
            all.missing += part.missing;
            all.sums.scatter += part.sums.scatter;
            for (sum, v) in all.sums.damage.iter_mut().zip(part.sums.damage) {
                *sum += v;
            }
            for (sum, v) in all.sums.by_load.iter_mut().zip(&part.sums.by_load) {
                *sum += v;
            }
        }
        let (law, width) = (all.law, all.width);
        let [plain, ..] = &residues;
        let whole: Vec<_> = plain.iter().filter(|r| !r.is_empty()).collect();
        for w in whole.windows(2) {
            if let [a, b] = w
                && let (Some(a), Some(b)) = (a.last(), b.first())
            {
                let (from, to) = (class(a.point.value, width), class(b.point.value, width));
                for border in risen_borders(from, to) {
                    *levels.entry(border).or_insert(0) += 1;
                }
            }
        }
        for (level, parts) in residues.iter().enumerate() {
            let sums = &mut all.sums;
            let residue = Rainflow::join_residues(parts, &mut |a, b| {
                let change = b.point.value - a.point.value;
                if level == 0 {
                    let cell = (class(a.point.value, width), class(b.point.value, width));
                    *cycles.entry(cell).or_insert(0) += 1;
                    sums.add(&law, 1.0, change, &a.tag, &b.tag);
                } else if let Some(sum) = sums.damage.get_mut(level) {
                    *sum += law.damage(change.abs());
                }
            });
            if let Some(slot) = all.residues.get_mut(level) {
                *slot = residue
                    .into_iter()
                    .map(|r| ResidueReversal {
                        at: r.point.at,
                        value: r.point.value,
                        loads: r.tag,
                    })
                    .collect();
            }
        }
        all.cycles = cycles.into_iter().map(|((a, b), n)| (a, b, n)).collect();
        all.levels = levels.into_iter().collect();
        Some(all)
    }

    /// Returns the sums over closed cycles and over the ranges of the residue, which count as half cycles.
    pub fn sums_with_residue(&self) -> Sums {
        let mut sums = self.sums.clone();
        for (level, residue) in self.residues.iter().enumerate() {
            let reversals: Vec<Reversal<Vec<f64>>> = residue.iter().map(reversal).collect();
            for w in reversals.windows(2) {
                let [a, b] = w else { continue };
                let change = b.point.value - a.point.value;
                if level == 0 {
                    sums.add(&self.law, 0.5, change, &a.tag, &b.tag);
                } else if let Some(sum) = sums.damage.get_mut(level) {
                    *sum += 0.5 * self.law.damage(change.abs());
                }
            }
        }
        sums
    }

    /// Returns the range-pair counts: cycles by range in class widths (class i: ranges whose ends lie i classes apart), residue as half cycles.
    pub fn range_pairs(&self) -> Vec<(u32, f64)> {
        let mut out: BTreeMap<u32, f64> = BTreeMap::new();
        for (a, b, n) in &self.cycles {
            *out.entry(a.abs_diff(*b)).or_insert(0.0) += *n as f64;
        }
        let reversals: Vec<Reversal<Vec<f64>>> = self
            .residues
            .first()
            .into_iter()
            .flatten()
            .map(reversal)
            .collect();
        for c in half_cycles(&reversals) {
            let apart = class(c.from.value, self.width).abs_diff(class(c.to.value, self.width));
            *out.entry(apart).or_insert(0.0) += c.count;
        }
        out.into_iter().collect()
    }

    /// Returns the number of cycles. Cycles of the residue count as half cycles.
    pub fn n_cycles(&self) -> f64 {
        let closed: u64 = self.cycles.iter().map(|c| c.2).sum();
        let open = self
            .residues
            .first()
            .map_or(0, |r| r.len().saturating_sub(1));
        closed as f64 + 0.5 * open as f64
    }
}

fn reversal(l: &ResidueReversal) -> Reversal<Vec<f64>> {
    Reversal {
        point: Point {
            at: l.at,
            value: l.value,
        },
        tag: l.loads.clone(),
    }
}

/// Returns the class of a value.
#[inline(always)]
pub fn class(value: f64, width: f64) -> i32 {
    (value / width).floor() as i32
}

pub(super) fn extremes(max: &mut Option<Extreme>, min: &mut Option<Extreme>, p: Point) {
    let here = Extreme {
        value: p.value,
        at: p.at,
    };
    if max.is_none_or(|m| p.value > m.value) {
        *max = Some(here);
    }
    if min.is_none_or(|m| p.value < m.value) {
        *min = Some(here);
    }
}

/// Returns the borders that a rise from one class to another crosses, each by the class above it.
pub(super) fn risen_borders(from: i32, to: i32) -> impl Iterator<Item = i32> {
    // A step through more borders than this is not a real load.
    (from.saturating_add(1)..=to).take(1 << 20)
}
