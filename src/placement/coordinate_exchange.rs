//! Coordinate exchange: exchanges of single rows until none gains, and perturbations out of the optimum it ends in.
//!
//! Exchanging gauge `j` for row `i` multiplies `det M` by `(1 + d_i)(1 - d_j) + d_ij^2` (Fedorov, Theory of Optimal Experiments, 1972,
//! eq. 3.2.4).

use super::criterion::Criterion;
use super::relaxation_solution::Active;
use super::variance_table::{PackedRows, Table};
use crate::linalg::spd;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use std::sync::OnceLock;

/// Gain in `det`, or in its logarithm, below which an exchange is rounding error.
pub(super) const LEAST_GAIN: f64 = 1e-9;
/// Share of its determinant under which a block counts as lost by an exchange.
const LEAST_PART: f64 = 1e-9;
/// Number of sweeps after which the search gives up; it converges long before.
const MAX_SWEEPS: usize = 200;
/// Number of exchanges after which the tables are recomputed to remove rounding.
const FRESH: usize = 400;
/// Rounding in the sum of the chosen rows' variances from which the tables are recomputed.
const DRIFT: f64 = 1e-7;
/// Largest share of the determinant that a perturbing exchange may cost.
const ROUGH: f64 = 0.05;
/// Number of random rows that a perturbation tries for a slot.
const DRAWS: usize = 12;

/// Rows to choose from, with their exclusions.
pub(super) struct List<'a, E> {
    pub active: &'a Active,
    pub packed: PackedRows,
    pub prior: &'a [f64],
    /// True for two rows that can't both be chosen, and for a row with itself.
    excludes: &'a E,
    /// Rows that each row excludes, itself included; filled on first use.
    partners: Vec<OnceLock<Vec<u32>>>,
}

impl<'a, E: Fn(usize, usize) -> bool> List<'a, E> {
    pub fn new(active: &'a Active, prior: &'a [f64], excludes: &'a E) -> Self {
        Self {
            active,
            packed: PackedRows::from_active(active),
            prior,
            excludes,
            partners: vec![OnceLock::new(); active.len()],
        }
    }

    fn partners(&self, row: usize) -> &[u32] {
        self.partners[row].get_or_init(|| {
            (0..self.active.len())
                .filter(|&i| (self.excludes)(i, row))
                .map(|i| i as u32)
                .collect()
        })
    }
}

/// A layout with the data for its exchanges.
#[derive(Clone)]
pub(super) struct CoordinateExchange {
    pub rows: Vec<usize>,
    /// Value of the criterion with the base of the start.
    pub value: f64,
    /// `tr(L M^-1)` of a linear criterion.
    spread: f64,
    /// Under `M^-1`.
    full: Table,
    /// Under the inverse of the nuisance block (Ds) or `M^-1 L M^-1` (linear).
    second: Option<Table>,
    /// Number of chosen rows that exclude a row, for each row.
    blocked: Vec<u32>,
    /// 0 for a row that no chosen row excludes, otherwise minus infinity.
    mask: Vec<f64>,
    swaps: usize,
}

impl CoordinateExchange {
    /// Creates a layout from these rows with `base` as prior information. `None` if the information matrix is singular.
    pub fn from_rows<E: Fn(usize, usize) -> bool>(
        list: &List<E>,
        base: &[f64],
        rows: Vec<usize>,
    ) -> Option<Self> {
        let (active, n) = (list.active, list.packed.len());
        let mut c = Self {
            rows,
            value: 0.0,
            spread: 0.0,
            full: Table::default(),
            second: None,
            blocked: vec![0; n],
            mask: vec![0.0; n],
            swaps: 0,
        };
        // Padding rows of the last block are never chosen.
        c.blocked[active.len()..].fill(2);
        c.mask[active.len()..].fill(f64::NEG_INFINITY);
        for slot in 0..c.rows.len() {
            c.block(list, c.rows[slot], 1);
        }
        c.measure(list, base).then_some(c)
    }

    fn block<E: Fn(usize, usize) -> bool>(&mut self, list: &List<E>, row: usize, by: i32) {
        for &i in list.partners(row) {
            let i = i as usize;
            self.blocked[i] = self.blocked[i].saturating_add_signed(by);
            self.mask[i] = if self.blocked[i] == 0 {
                0.0
            } else {
                f64::NEG_INFINITY
            };
        }
    }

    /// Tables and value from the rows; false where singular.
    fn measure<E>(&mut self, list: &List<E>, base: &[f64]) -> bool {
        let (active, packed) = (list.active, &list.packed);
        let mut m = base.to_vec();
        for &i in &self.rows {
            spd::add_outer(&mut m, active.row(i), 1.0);
        }
        let Some(point) = active.criterion.evaluate_at(&m, active.k) else {
            return false;
        };
        self.value = point.value;
        self.spread = point.spread;
        self.second = (!point.second.is_empty())
            .then(|| Table::new(active, packed, point.second, &self.rows));
        self.full = Table::new(active, packed, point.inverse, &self.rows);
        self.swaps = 0;
        true
    }

    /// A number above 1 where row `i` in place of `j` in `slot` is better, and the larger the better.
    fn gain(&self, criterion: &Criterion, slot: usize, i: usize, j: usize) -> f64 {
        let ratio = self.full.ratio(slot, i, j);
        match (&self.second, criterion) {
            (Some(g), Criterion::Linear(_)) => {
                if ratio < LEAST_PART {
                    return 0.0;
                }
                let (x, y) = (self.full.cross_variance(slot, i), g.cross_variance(slot, i));
                let fall = g.d[i] - g.d[j] + 2.0 * x * y
                    - g.d[i] * self.full.d[j]
                    - g.d[j] * self.full.d[i];
                self.spread / (self.spread - fall / ratio).max(f64::MIN_POSITIVE)
            }
            (Some(part), _) => ratio / part.ratio(slot, i, j).max(LEAST_PART),
            (None, _) => ratio,
        }
    }

    /// The row that gains most in a slot, with its gain.
    fn find_best_exchange<E: Fn(usize, usize) -> bool>(
        &self,
        list: &List<E>,
        slot: usize,
    ) -> Option<(f64, usize)> {
        let j = self.rows[slot];
        let criterion = &list.active.criterion;
        let mut best = None;
        let least = 1.0 + LEAST_GAIN;
        let better = |best: &Option<(f64, usize)>, g: f64| g > best.map_or(least, |b| b.0);
        if self.second.is_none() {
            best = self
                .full
                .find_best_row(&list.packed, slot, j, &self.mask, least);
        } else {
            for i in 0..list.active.len() {
                let g = self.gain(criterion, slot, i, j);
                if self.blocked[i] == 0 && better(&best, g) {
                    best = Some((g, i));
                }
            }
        }
        // Rows that only the removed gauge excludes.
        for &i in list.partners(j) {
            let i = i as usize;
            if self.blocked[i] == 1 && i != j {
                let g = self.gain(criterion, slot, i, j);
                if better(&best, g) {
                    best = Some((g, i));
                }
            }
        }
        best
    }

    /// Row `i` in place of the gauge in `slot`; false where that leaves nothing regular.
    fn swap<E: Fn(usize, usize) -> bool>(
        &mut self,
        list: &List<E>,
        base: &[f64],
        slot: usize,
        i: usize,
    ) -> bool {
        let linear = matches!(list.active.criterion, Criterion::Linear(_));
        let j = self.rows[slot];
        if !linear {
            let g = self.gain(&list.active.criterion, slot, i, j);
            for t in std::iter::once(&mut self.full).chain(&mut self.second) {
                t.swap(list.active, &list.packed, &self.rows, slot, i);
            }
            self.value += g.ln();
        }
        self.block(list, j, -1);
        self.block(list, i, 1);
        self.rows[slot] = i;
        self.swaps += 1;
        if linear || self.swaps > FRESH || self.drift(list, base) > DRIFT {
            return self.measure(list, base);
        }
        true
    }

    /// Returns the rounding error: the difference of the variances of the chosen rows from `tr(M^-1 (M - P)) = k - tr(M^-1 P)`.
    fn drift<E>(&self, list: &List<E>, base: &[f64]) -> f64 {
        let sum: f64 = self.rows.iter().map(|&j| self.full.d[j]).sum();
        (sum + spd::trace_of_product(&self.full.inverse, base) - list.active.k as f64).abs()
    }

    /// Exchanges single rows until no exchange improves the layout. Returns false if a layout is singular.
    pub fn improve<E: Fn(usize, usize) -> bool>(&mut self, list: &List<E>, base: &[f64]) -> bool {
        for _ in 0..MAX_SWEEPS {
            let mut gained = false;
            for slot in 0..self.rows.len() {
                if let Some((_, i)) = self.find_best_exchange(list, slot) {
                    if !self.swap(list, base, slot, i) {
                        return false;
                    }
                    gained = true;
                }
            }
            if !gained {
                break;
            }
        }
        true
    }

    /// Replaces `count` gauges by random rows.
    pub fn perturb<E: Fn(usize, usize) -> bool>(
        &mut self,
        list: &List<E>,
        count: usize,
        rng: &mut ChaCha8Rng,
    ) -> bool {
        for _ in 0..count {
            let slot = rng.random_range(0..self.rows.len());
            let j = self.rows[slot];
            for _ in 0..DRAWS {
                let i = rng.random_range(0..list.active.len());
                let free =
                    self.blocked[i] == 0 || self.blocked[i] == 1 && i != j && (list.excludes)(i, j);
                if free && self.gain(&list.active.criterion, slot, i, j) > ROUGH {
                    if !self.swap(list, list.prior, slot, i) {
                        return false;
                    }
                    break;
                }
            }
        }
        true
    }

    /// Copies `other` into the existing memory.
    pub fn copy(&mut self, other: &Self) {
        self.rows.copy_from_slice(&other.rows);
        self.blocked.copy_from_slice(&other.blocked);
        self.mask.copy_from_slice(&other.mask);
        self.full.copy(&other.full);
        if let (Some(a), Some(b)) = (&mut self.second, &other.second) {
            a.copy(b);
        }
        (self.value, self.spread, self.swaps) = (other.value, other.spread, other.swaps);
    }
}
