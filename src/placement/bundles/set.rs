//! Bundles, and the requirements on a layout of bundles.

use crate::linalg::spd;
use crate::placement::criterion::Criterion;
use crate::placement::exchange::Effort;
use crate::placement::spacing;

/// All bundles.
#[derive(Clone, Debug, Default)]
pub struct Bundles {
    /// Number of columns.
    pub k: usize,
    /// Rows divided by their standard deviations, bundle after bundle.
    pub rows: Vec<f64>,
    /// First row of each bundle, followed by the number of rows.
    pub start: Vec<u32>,
    /// Cost of each bundle.
    pub cost: Vec<f64>,
    /// Places of each bundle. A bundle with one place lists it twice.
    pub seats: Vec<[u32; 2]>,
    /// Positions of the places.
    pub positions: Vec<[f64; 3]>,
}

impl Bundles {
    /// Returns an empty set, for `k` columns and these places.
    pub fn new(k: usize, positions: Vec<[f64; 3]>) -> Self {
        Self {
            k,
            start: vec![0],
            positions,
            ..Self::default()
        }
    }

    /// Adds a bundle.
    pub fn add(&mut self, rows: &[Vec<f64>], cost: f64, seats: [u32; 2]) {
        rows.iter().for_each(|r| self.rows.extend_from_slice(r));
        let last = self.start.last().copied().unwrap_or(0);
        self.start.push(last + rows.len() as u32);
        self.cost.push(cost);
        self.seats.push(seats);
    }

    /// Returns the number of bundles.
    pub fn len(&self) -> usize {
        self.cost.len()
    }

    /// Returns whether there are no bundles.
    pub fn is_empty(&self) -> bool {
        self.cost.is_empty()
    }

    /// Returns the rows of a bundle.
    pub fn rows_of(&self, u: usize) -> impl Iterator<Item = &[f64]> {
        let (a, b) = (self.start[u] as usize, self.start[u + 1] as usize);
        self.rows[a * self.k..b * self.k].chunks_exact(self.k)
    }

    /// Computes `m += weight R_u' R_u`.
    pub(super) fn add_to(&self, m: &mut [f64], u: usize, weight: f64) {
        self.rows_of(u).for_each(|r| spd::add_outer(m, r, weight));
    }

    /// Returns `tr(R_u G R_u')`, with `G` the slope of the criterion.
    pub(super) fn price(&self, u: usize, slope: &[f64], work: &mut [f64]) -> f64 {
        self.rows_of(u)
            .map(|r| {
                spd::times(slope, r, work);
                spd::dot(r, work)
            })
            .sum()
    }

    /// Returns whether two bundles exclude each other: they share a place, or two of their places are closer than `apart`.
    pub(super) fn exclude(&self, a: usize, b: usize, apart: f64) -> bool {
        a == b
            || self.seats[a].iter().any(|&x| {
                self.seats[b].iter().any(|&y| {
                    x == y
                        || apart > 0.0
                            && spacing::too_close(
                                self.positions[x as usize],
                                self.positions[y as usize],
                                apart,
                            )
                })
            })
    }
}

/// Requirements of a layout of bundles.
#[derive(Clone, Debug)]
pub struct BundleSpec {
    /// Largest sum of the costs of a layout.
    pub budget: f64,
    /// Least distance between places of two bundles. 0 means no limit.
    pub spacing: f64,
    /// Prior information.
    pub prior: Vec<f64>,
    /// Criterion of the layout.
    pub criterion: Criterion,
    /// Gap to which the relaxation is solved.
    pub tolerance: f64,
    /// Effort of the search.
    pub effort: Effort,
}

/// Excess over a budget that counts as rounding.
pub(super) const CENT: f64 = 1e-9;

/// Returns whether bundle `u` fits in addition to the chosen bundles, at a cost of `spent` so far.
pub(super) fn fits(
    bundles: &Bundles,
    spec: &BundleSpec,
    chosen: &[usize],
    spent: f64,
    u: usize,
) -> bool {
    spent + bundles.cost[u] <= spec.budget + CENT
        && chosen.iter().all(|&c| !bundles.exclude(c, u, spec.spacing))
}
