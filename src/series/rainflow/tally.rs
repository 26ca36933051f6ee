//! What is kept of one load over a record: its cycles by class, its residue, the sums its damage needs. Tallies of parts join to that of
//! the whole.

use super::count::{Cycle, Point, Rainflow, Reversal, half_cycles};
use super::law::Law;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Standard deviations of the noise that histories are counted with, in units of the noise that is in them: as they are, and with as
/// much noise added as makes it twice and three times.
pub const NOISE: [f64; 3] = [1.0, 2.0, 3.0];

/// An extreme value.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Extreme {
    /// The value.
    pub value: f64,
    /// Its sample.
    pub at: usize,
}

/// A reversal of a residue: its sample, its value, all loads at that time (empty where they don't matter).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Left {
    /// Sample.
    pub at: usize,
    /// Value.
    pub value: f64,
    /// All loads then.
    #[serde(deserialize_with = "super::absent::numbers")]
    pub loads: Vec<f64>,
}

/// Sums over closed cycles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sums {
    /// Damage, by [`NOISE`].
    pub damage: [f64; 3],
    /// Change of the damage with each scale error: `sum of d'(R) sign(dF) dF_m`, by load m.
    #[serde(deserialize_with = "super::absent::numbers")]
    pub by_load: Vec<f64>,
    /// Variance of the damage for noise of variance one in each sample: `sum of 2 d'(R)^2`.
    pub scatter: f64,
}

/// Cycles, levels, extremes and damage of one load over a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tally {
    /// Width of a class, in the unit of the load. Class i reaches from i to i + 1 widths.
    pub width: f64,
    /// Harm of a cycle.
    pub law: Law,
    /// Closed cycles by class of their first and second reversal, in order.
    pub cycles: Vec<(i32, i32, u64)>,
    /// How often the load rose through the lower border of a class.
    pub levels: Vec<(i32, u64)>,
    /// Largest value.
    pub max: Option<Extreme>,
    /// Smallest value.
    pub min: Option<Extreme>,
    /// Samples, those without a value among them.
    pub samples: usize,
    /// Samples without a value.
    pub missing: usize,
    /// Reversals that no cycle has closed, by [`NOISE`].
    pub residues: [Vec<Left>; 3],
    /// Sums over closed cycles.
    pub sums: Sums,
}

/// A tally under way.
pub struct Counter {
    load: usize,
    seed: u64,
    /// Standard deviation of the noise in a sample.
    noise: f64,
    width: f64,
    law: Law,
    plain: Rainflow<Vec<f64>>,
    noisy: [Rainflow; 2],
    /// Loads of the latest sample of the plain count.
    carried: Vec<f64>,
    cycles: BTreeMap<(i32, i32), u64>,
    levels: BTreeMap<i32, u64>,
    max: Option<Extreme>,
    min: Option<Extreme>,
    next: usize,
    missing: usize,
    sums: Sums,
}

impl Counter {
    /// A count of load number `load` of `n_loads`, whose samples carry white noise of standard deviation `noise`.
    pub fn new(load: usize, n_loads: usize, noise: f64, width: f64, law: Law) -> Self {
        Self {
            load,
            seed: mixed(load as u64 + 1),
            noise: if noise.is_finite() { noise } else { 0.0 },
            width,
            law,
            plain: Rainflow::default(),
            noisy: [Rainflow::default(), Rainflow::default()],
            carried: vec![f64::NAN; n_loads],
            cycles: BTreeMap::new(),
            levels: BTreeMap::new(),
            max: None,
            min: None,
            next: 0,
            missing: 0,
            sums: Sums {
                damage: [0.0; 3],
                by_load: vec![0.0; n_loads],
                scatter: 0.0,
            },
        }
    }

    /// Takes the next samples, all loads of each, row by row.
    pub fn push(&mut self, rows: &[f64]) {
        let k = self.sums.by_load.len().max(1);
        let first = self.next;
        let Self {
            plain,
            carried,
            cycles,
            levels,
            sums,
            ..
        } = self;
        let (law, width, load) = (self.law, self.width, self.load);
        let mut latest = None;
        let mut borders = Borders { width, levels };
        for (i, row) in rows.chunks_exact(k).enumerate() {
            let Some(&value) = row.get(load) else {
                continue;
            };
            if !value.is_finite() {
                self.missing += 1;
                continue;
            }
            let point = Point {
                at: first + i,
                value,
            };
            extremes(&mut self.max, &mut self.min, point);
            if let Some(before) = plain.latest() {
                borders.rise(before.value, value);
            }
            let mut tag = |p: Point| {
                let row =
                    p.at.checked_sub(first)
                        .and_then(|i| rows.get(i * k..(i + 1) * k));
                row.map_or_else(|| carried.clone(), <[f64]>::to_vec)
            };
            plain.push_tagged(point, &mut tag, &mut |a, b| {
                let cell = (class(a.point.value, width), class(b.point.value, width));
                *cycles.entry(cell).or_insert(0) += 1;
                sums.add(&law, 1.0, a, b);
            });
            if plain.latest() == Some(point) {
                latest = Some(row);
            }
        }
        if let Some(row) = latest {
            carried.clear();
            carried.extend_from_slice(row);
        }
        if self.noise > 0.0 {
            self.push_noisy(rows, k, first);
        }
        self.next += rows.len() / k;
    }

    fn push_noisy(&mut self, rows: &[f64], k: usize, first: usize) {
        let [one, ..] = NOISE;
        for (level, count) in (1..).zip(&mut self.noisy) {
            let total: f64 = NOISE.get(level).copied().unwrap_or(one);
            let added = self.noise * (total * total - one * one).sqrt();
            let (law, mut damage) = (self.law, 0.0);
            for (i, row) in rows.chunks_exact(k).enumerate() {
                let Some(&value) = row.get(self.load) else {
                    continue;
                };
                let at = first + i;
                let value = value + added * white(self.seed, at as u64);
                count.push(Point { at, value }, &mut |c: Cycle| {
                    damage += law.damage(c.range())
                });
            }
            if let Some(sum) = self.sums.damage.get_mut(level) {
                *sum += damage;
            }
        }
    }

    /// The tally.
    pub fn finish(self) -> Tally {
        let carried = self.carried;
        let left = |r: Reversal<Vec<f64>>| Left {
            at: r.point.at,
            value: r.point.value,
            loads: r.tag,
        };
        let bare = |count: Rainflow| -> Vec<Left> {
            let residue = count.residue(&mut |_| ());
            let left = |r: Reversal<()>| Left {
                at: r.point.at,
                value: r.point.value,
                loads: Vec::new(),
            };
            residue.into_iter().map(left).collect()
        };
        let residue = self.plain.residue(&mut |_| carried.clone());
        let [twice, thrice] = self.noisy;
        Tally {
            width: self.width,
            law: self.law,
            cycles: self
                .cycles
                .into_iter()
                .map(|((a, b), n)| (a, b, n))
                .collect(),
            levels: self.levels.into_iter().collect(),
            max: self.max,
            min: self.min,
            samples: self.next,
            missing: self.missing,
            residues: [
                residue.into_iter().map(left).collect(),
                bare(twice),
                bare(thrice),
            ],
            sums: self.sums,
        }
    }
}

impl Sums {
    fn add(&mut self, law: &Law, count: f64, a: &Reversal<Vec<f64>>, b: &Reversal<Vec<f64>>) {
        let change = b.point.value - a.point.value;
        let range = change.abs();
        let [plain, ..] = &mut self.damage;
        *plain += count * law.damage(range);
        let slope = count * law.derivative(range);
        self.scatter += 2.0 * slope * slope;
        for ((sum, from), to) in self.by_load.iter_mut().zip(&a.tag).zip(&b.tag) {
            *sum += slope * change.signum() * (to - from);
        }
    }
}

impl Tally {
    /// The tally of times that follow each other; samples are counted through. `None` without parts, or where classes or laws
    /// differ.
    pub fn joined(parts: &[&Self]) -> Option<Self> {
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
                let reversal = |l: &Left| Reversal {
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
        let mut borders = Borders {
            width,
            levels: &mut levels,
        };
        let [plain, ..] = &residues;
        let whole: Vec<_> = plain.iter().filter(|r| !r.is_empty()).collect();
        for w in whole.windows(2) {
            if let [a, b] = w
                && let (Some(a), Some(b)) = (a.last(), b.first())
            {
                borders.rise(a.point.value, b.point.value);
            }
        }
        for (level, parts) in residues.iter().enumerate() {
            let sums = &mut all.sums;
            let residue = Rainflow::joined(parts, &mut |a, b| {
                if level == 0 {
                    let cell = (class(a.point.value, width), class(b.point.value, width));
                    *cycles.entry(cell).or_insert(0) += 1;
                    sums.add(&law, 1.0, a, b);
                } else if let Some(sum) = sums.damage.get_mut(level) {
                    *sum += law.damage((b.point.value - a.point.value).abs());
                }
            });
            if let Some(slot) = all.residues.get_mut(level) {
                *slot = residue
                    .into_iter()
                    .map(|r| Left {
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

    /// Sums over closed cycles and, as half cycles, the ranges of the residue.
    pub fn sums_with_residue(&self) -> Sums {
        let mut sums = self.sums.clone();
        for (level, residue) in self.residues.iter().enumerate() {
            let reversals: Vec<Reversal<Vec<f64>>> = residue.iter().map(reversal).collect();
            for w in reversals.windows(2) {
                let [a, b] = w else { continue };
                if level == 0 {
                    sums.add(&self.law, 0.5, a, b);
                } else if let Some(sum) = sums.damage.get_mut(level) {
                    *sum += 0.5 * self.law.damage((b.point.value - a.point.value).abs());
                }
            }
        }
        sums
    }

    /// Range-pair counts: cycles by range in class widths (class i: ranges whose ends lie i classes apart), residue as half cycles.
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

    /// Cycles, those of the residue as half ones.
    pub fn n_cycles(&self) -> f64 {
        let closed: u64 = self.cycles.iter().map(|c| c.2).sum();
        let open = self
            .residues
            .first()
            .map_or(0, |r| r.len().saturating_sub(1));
        closed as f64 + 0.5 * open as f64
    }
}

fn reversal(l: &Left) -> Reversal<Vec<f64>> {
    Reversal {
        point: Point {
            at: l.at,
            value: l.value,
        },
        tag: l.loads.clone(),
    }
}

/// The class of a value.
pub fn class(value: f64, width: f64) -> i32 {
    (value / width).floor() as i32
}

fn extremes(max: &mut Option<Extreme>, min: &mut Option<Extreme>, p: Point) {
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

/// Counts rises through borders of classes.
struct Borders<'a> {
    width: f64,
    levels: &'a mut BTreeMap<i32, u64>,
}

impl Borders<'_> {
    #[inline]
    fn rise(&mut self, from: f64, to: f64) {
        if to > from {
            let (a, b) = (class(from, self.width), class(to, self.width));
            // A step through more borders than this is no load.
            for border in (a.saturating_add(1)..=b).take(1 << 20) {
                *self.levels.entry(border).or_insert(0) += 1;
            }
        }
    }
}

/// A number of mean 0 and variance 1 that belongs to a sample: the sum of four even ones, much like a normal one up to three standard
/// deviations. The same wherever a record is cut.
fn white(seed: u64, at: u64) -> f64 {
    let bits = mixed(seed ^ at.wrapping_mul(0x9E37_79B9_7F4A_7C15));
    let sum: u32 = (0..4).map(|i| (bits >> (16 * i)) as u32 & 0xffff).sum();
    // Four whole numbers of 0 to 65535: mean 2 x 65535, variance (65536^2 - 1) / 3.
    (f64::from(sum) - 131_070.0) / 37_837.227_237
}

/// A number without likeness to its neighbours (splitmix64).
fn mixed(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
