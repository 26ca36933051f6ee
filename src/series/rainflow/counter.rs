//! Counter of a load's samples in their order. It counts them unchanged and with added noise.

use super::count::{Listener, Point, Rainflow, Reversal};
use super::counts::Counts;
use super::law::Law;
use super::tally::{Extreme, NOISE, ResidueReversal, Sums, Tally, class, extremes, risen_borders};

/// Samples handled together: their numbers stay in the processor's first cache.
const BLOCK: usize = 512;

/// A tally in progress.
pub struct Counter {
    load: usize,
    seed: u64,
    /// Standard deviation of the noise in a sample.
    noise: f64,
    plain: Rainflow<Tag>,
    noisy: [Rainflow; 2],
    /// Loads of the latest sample of the plain count.
    carried: Vec<f64>,
    /// Sums over the cycles that the plain count has closed.
    closed: ClosedCycles,
    levels: Counts<i32>,
    max: Option<Extreme>,
    min: Option<Extreme>,
    next: usize,
    missing: usize,
}

/// Tag of a reversal of the plain count: its class, and the slot of all loads at that time.
#[derive(Clone, Copy)]
struct Tag {
    class: i32,
    slot: u32,
}

/// Sums over the closed cycles of the plain count.
struct ClosedCycles {
    width: f64,
    law: Law,
    kept: Slots,
    cycles: Counts<(i32, i32)>,
    sums: Sums,
}

/// Rows of loads, stored while their reversals are open.
struct Slots {
    values: Vec<f64>,
    free: Vec<u32>,
}

/// Listener of the plain count during a push.
struct PlainCountListener<'a> {
    closed: &'a mut ClosedCycles,
    rows: &'a [f64],
    /// Number of the first row.
    first: usize,
    carried: &'a [f64],
}

/// Hears of a count with noise added: damage alone.
struct NoisyCountListener {
    law: Law,
    damage: f64,
}

/// Samples on their way into a count.
struct Push<'a> {
    counter: &'a mut Counter,
    rows: &'a [f64],
    marks: &'a [u64],
}

impl pulp::WithSimd for Push<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        let k = self.counter.carried.len();
        self.counter.push_rows(self.rows, self.marks, k);
    }
}

/// Room for a block.
struct Room {
    values: [f64; BLOCK],
    white: [f64; BLOCK],
    noisy: [f64; BLOCK],
    classes: [i32; BLOCK],
    turns: [u32; BLOCK],
}

impl Counter {
    /// Creates a count of load number `load` of `n_loads`, whose samples carry white noise of standard deviation `noise`.
    pub fn new(load: usize, n_loads: usize, noise: f64, width: f64, law: Law) -> Self {
        Self {
            load,
            seed: mix_bits(load as u64 + 1),
            noise: if noise.is_finite() { noise } else { 0.0 },
            plain: Rainflow::default(),
            noisy: [Rainflow::default(), Rainflow::default()],
            carried: vec![f64::NAN; n_loads],
            closed: ClosedCycles {
                width,
                law,
                kept: Slots {
                    values: Vec::new(),
                    free: Vec::new(),
                },
                cycles: Counts::new(),
                sums: Sums {
                    damage: [0.0; 3],
                    by_load: vec![0.0; n_loads],
                    scatter: 0.0,
                },
            },
            levels: Counts::new(),
            max: None,
            min: None,
            next: 0,
            missing: 0,
        }
    }

    /// Takes the next samples row by row, each with all loads, and the marks of these samples (`Marks`).
    pub fn push(&mut self, rows: &[f64], marks: &[u64]) {
        let k = self.carried.len();
        if self.load < k {
            pulp::Arch::new().dispatch(Push {
                counter: self,
                rows,
                marks,
            });
        }
        self.next += rows.len() / k.max(1);
    }

    #[inline(always)]
    fn push_rows(&mut self, rows: &[f64], marks: &[u64], k: usize) {
        let first = self.next;
        let mut room = Room {
            values: [0.0; BLOCK],
            white: [0.0; BLOCK],
            noisy: [0.0; BLOCK],
            classes: [0; BLOCK],
            turns: [0; BLOCK],
        };
        let mut listener = PlainCountListener {
            closed: &mut self.closed,
            rows,
            first,
            carried: &self.carried,
        };
        let mut damage = [0.0; NOISE.len()];
        let mut at = first;
        for block in rows.chunks(BLOCK * k) {
            let count = block.len() / k;
            let Some(values) = room.values.get_mut(..count) else {
                continue;
            };
            for (v, row) in values.iter_mut().zip(block.chunks_exact(k)) {
                *v = row.get(self.load).copied().unwrap_or(f64::NAN);
            }
            let latest = self.plain.latest_sample();
            self.missing += values.iter().filter(|v| !v.is_finite()).count();
            widen_extremes(&mut self.max, &mut self.min, at, values);
            let width = listener.closed.width;
            let (classes, turns) = (&mut room.classes, &mut room.turns);
            rises(&mut self.levels, width, latest, values, classes, turns);
            self.plain
                .push_block(at, values, &mut room.turns, &mut listener);
            if self.noise > 0.0 {
                let marks = marks.get(at - first..).unwrap_or_default();
                for (w, mark) in room.white.iter_mut().zip(marks).take(count) {
                    *w = white_noise(self.seed ^ mark);
                }
                let [one, ..] = NOISE;
                let levels = NOISE.iter().zip(&mut damage).skip(1);
                for ((total, damage), count) in levels.zip(&mut self.noisy) {
                    let added = self.noise * (total * total - one * one).sqrt();
                    let numbers = values.iter().zip(&room.white);
                    for (y, (v, w)) in room.noisy.iter_mut().zip(numbers) {
                        *y = v + added * w;
                    }
                    let noisy = room.noisy.get(..values.len()).unwrap_or_default();
                    let mut listener = NoisyCountListener {
                        law: listener.closed.law,
                        damage: *damage,
                    };
                    count.push_block(at, noisy, &mut room.turns, &mut listener);
                    *damage = listener.damage;
                }
            }
            at += count;
        }
        for (sum, more) in listener.closed.sums.damage.iter_mut().zip(damage).skip(1) {
            *sum += more;
        }
        let latest = self
            .plain
            .latest_sample()
            .and_then(|p| p.at.checked_sub(first));
        if let Some(row) = latest.and_then(|i| rows.get(i * k..(i + 1) * k)) {
            self.carried.clear();
            self.carried.extend_from_slice(row);
        }
    }

    /// Returns the tally.
    pub fn finish(self) -> Tally {
        let ClosedCycles {
            width,
            law,
            mut kept,
            cycles,
            sums,
        } = self.closed;
        let carried = self.carried;
        let bare = |count: Rainflow| -> Vec<ResidueReversal> {
            let residue = count.residue(&mut |_| ());
            let left = |r: Reversal<()>| ResidueReversal {
                at: r.point.at,
                value: r.point.value,
                loads: Vec::new(),
            };
            residue.into_iter().map(left).collect()
        };
        let residue = self.plain.residue(&mut |p| Tag {
            class: class(p.value, width),
            slot: kept.keep(&carried),
        });
        let left = |r: Reversal<Tag>| ResidueReversal {
            at: r.point.at,
            value: r.point.value,
            loads: kept.row(r.tag.slot, carried.len()).to_vec(),
        };
        let [twice, thrice] = self.noisy;
        let cycles = cycles.sort_classes().into_iter();
        Tally {
            width,
            law,
            cycles: cycles.map(|((a, b), n)| (a, b, n)).collect(),
            levels: self.levels.sort_classes().into_iter().collect(),
            max: self.max,
            min: self.min,
            samples: self.next,
            missing: self.missing,
            residues: [
                residue.into_iter().map(left).collect(),
                bare(twice),
                bare(thrice),
            ],
            sums,
        }
    }
}

impl Listener<Tag> for PlainCountListener<'_> {
    #[inline(always)]
    fn tag(&mut self, p: Point) -> Tag {
        let k = self.carried.len();
        let row =
            p.at.checked_sub(self.first)
                .and_then(|i| self.rows.get(i * k..(i + 1) * k));
        Tag {
            class: class(p.value, self.closed.width),
            slot: self.closed.kept.keep(row.unwrap_or(self.carried)),
        }
    }

    #[inline(always)]
    fn add_cycle(&mut self, a: &Reversal<Tag>, b: &Reversal<Tag>) {
        let k = self.carried.len();
        let closed = &mut *self.closed;
        closed.cycles.add((a.tag.class, b.tag.class));
        let (from, to) = (
            closed.kept.row(a.tag.slot, k),
            closed.kept.row(b.tag.slot, k),
        );
        let change = b.point.value - a.point.value;
        closed.sums.add(&closed.law, 1.0, change, from, to);
        closed.kept.free.extend([a.tag.slot, b.tag.slot]);
    }
}

impl Listener<()> for NoisyCountListener {
    #[inline(always)]
    fn tag(&mut self, _: Point) {}

    #[inline(always)]
    fn add_cycle(&mut self, a: &Reversal<()>, b: &Reversal<()>) {
        self.damage += self.law.damage((b.point.value - a.point.value).abs());
    }
}

impl Slots {
    /// Keeps a row; its place.
    #[inline(always)]
    fn keep(&mut self, row: &[f64]) -> u32 {
        let k = row.len();
        if let Some(slot) = self.free.pop()
            && let Some(place) = self
                .values
                .get_mut(slot as usize * k..(slot as usize + 1) * k)
        {
            place.copy_from_slice(row);
            return slot;
        }
        let slot = self.values.len() / k.max(1);
        self.values.extend_from_slice(row);
        slot as u32
    }

    /// The row at a place, `k` numbers.
    #[inline(always)]
    fn row(&self, slot: u32, k: usize) -> &[f64] {
        let at = slot as usize * k;
        self.values.get(at..at + k).unwrap_or_default()
    }
}

/// Widens the extremes by samples, the first being number `first`; of equal ones the earlier stays.
#[inline(always)]
fn widen_extremes(
    max: &mut Option<Extreme>,
    min: &mut Option<Extreme>,
    first: usize,
    values: &[f64],
) {
    /// Folded side by side, none waiting for the one before.
    const LANES: usize = 16;
    let (mut low, mut high) = ([f64::INFINITY; LANES], [f64::NEG_INFINITY; LANES]);
    // NaN compares neither less nor greater, so that the fold skips it.
    for values in values.chunks(LANES) {
        for ((low, high), v) in low.iter_mut().zip(&mut high).zip(values) {
            *low = if *v < *low { *v } else { *low };
            *high = if *v > *high { *v } else { *high };
        }
    }
    let lowest = low.into_iter().fold(f64::INFINITY, f64::min);
    let highest = high.into_iter().fold(f64::NEG_INFINITY, f64::max);
    let wider = max.is_none_or(|m| highest > m.value) || min.is_none_or(|m| lowest < m.value);
    if wider {
        for (at, &value) in (first..).zip(values).filter(|p| p.1.is_finite()) {
            extremes(max, min, Point { at, value });
        }
    }
}

/// Counts the rises of samples through borders of classes, that from the latest one before them included. `classes` and `turns` are room for as
/// many numbers.
#[inline(always)]
fn rises(
    levels: &mut Counts<i32>,
    width: f64,
    latest: Option<Point>,
    values: &[f64],
    classes: &mut [i32],
    turns: &mut [u32],
) {
    let mut began = latest.map(|p| class(p.value, width));
    let mut rise = |from: Option<i32>, to: i32| {
        if let Some(from) = from.filter(|from| to > *from) {
            risen_borders(from, to).for_each(|border| levels.add(border));
        }
    };
    if !values.iter().all(|v| v.is_finite()) {
        for &value in values.iter().filter(|v| v.is_finite()) {
            let here = class(value, width);
            rise(began, here);
            began = Some(here);
        }
        return;
    }
    for (c, v) in classes.iter_mut().zip(values) {
        *c = class(*v, width);
    }
    // Changes are listed first, in code without branches that depend on the samples.
    let classes = classes.get(..values.len()).unwrap_or_default();
    let (mut n, mut before) = (0, began.or(classes.first().copied()).unwrap_or(0));
    for (i, &here) in (0..).zip(classes) {
        if let Some(slot) = turns.get_mut(n) {
            *slot = i;
        }
        n += usize::from(here != before);
        before = here;
    }
    for &i in turns.iter().take(n) {
        let i = i as usize;
        let from = i.checked_sub(1).and_then(|b| classes.get(b).copied());
        rise(from.or(began), classes.get(i).copied().unwrap_or(0));
    }
}

/// Returns pseudo-random noise of mean 0 and variance 1 for a sample, seeded by its loads. The sum of four uniform numbers is close to normal up to
/// three standard deviations. The result depends neither on the cuts of a record nor on the samples before it.
#[inline(always)]
fn white_noise(mark: u64) -> f64 {
    let bits = mix_bits(mark);
    let sum: u32 = (0..4).map(|i| (bits >> (16 * i)) as u32 & 0xffff).sum();
    // Four whole numbers of 0 to 65535: mean 2 x 65535, variance (65536^2 - 1) / 3.
    (f64::from(sum) - 131_070.0) / 37_837.227_237
}

/// Returns a number that is independent of its neighbours (splitmix64).
#[inline(always)]
pub(super) fn mix_bits(x: u64) -> u64 {
    let mut z = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
