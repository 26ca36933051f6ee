//! Layouts of things with several rows or unlike costs: rosettes, symmetric pairs, bridges that take more work than a single grid.
//!
//! A bundle `u` has rows `R_u` and a cost `c_u`; layouts spend at most a budget. For any regular `M` the criterion of such a layout is at most
//! `value + q ln((tr(G P) + T) / q)`, `T` the largest `sum t_u tr(R_u G R_u')` with `0 <= t_u <= 1` and `sum t_u c_u` within the budget (a
//! knapsack filled by price over cost, the last bundle in part).

use super::criterion::{Criterion, Point};
use super::exchange::Effort;
use super::layout::PlaceError;
use super::spacing;
use crate::linalg::spd;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// All bundles.
#[derive(Clone, Debug, Default)]
pub struct Bundles {
    /// Number of columns.
    pub k: usize,
    /// Rows over their standard deviations, bundle after bundle.
    pub rows: Vec<f64>,
    /// Where each bundle's rows begin, in rows; one more than there are bundles.
    pub start: Vec<u32>,
    /// What each costs.
    pub cost: Vec<f64>,
    /// The places it takes, one or two (twice the same: one).
    pub seats: Vec<[u32; 2]>,
    /// Positions of the places.
    pub positions: Vec<[f64; 3]>,
}

impl Bundles {
    /// None yet, for `k` columns and these places.
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

    /// How many.
    pub fn len(&self) -> usize {
        self.cost.len()
    }

    /// True without bundles.
    pub fn is_empty(&self) -> bool {
        self.cost.is_empty()
    }

    /// Rows of a bundle.
    pub fn rows_of(&self, u: usize) -> impl Iterator<Item = &[f64]> {
        let (a, b) = (self.start[u] as usize, self.start[u + 1] as usize);
        self.rows[a * self.k..b * self.k].chunks_exact(self.k)
    }

    fn add_to(&self, m: &mut [f64], u: usize, weight: f64) {
        self.rows_of(u).for_each(|r| spd::add_outer(m, r, weight));
    }

    fn price(&self, u: usize, slope: &[f64], work: &mut [f64]) -> f64 {
        self.rows_of(u)
            .map(|r| {
                spd::times(slope, r, work);
                spd::dot(r, work)
            })
            .sum()
    }

    fn exclude(&self, a: usize, b: usize, apart: f64) -> bool {
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

/// What is asked for.
#[derive(Clone, Debug)]
pub struct BundleSpec {
    /// Costs of a layout add up to this at most.
    pub budget: f64,
    /// Least distance between places of two bundles; 0: none.
    pub spacing: f64,
    /// Prior information.
    pub prior: Vec<f64>,
    /// What the layout is chosen for.
    pub criterion: Criterion,
    /// Gap to which the relaxation is solved.
    pub tolerance: f64,
    /// How hard to search.
    pub effort: Effort,
}

/// Bundles chosen.
#[derive(Clone, Debug)]
pub struct BundleLayout {
    /// Which, ascending.
    pub bundles: Vec<usize>,
    /// The criterion.
    pub log_det: f64,
    /// No layout within the budget has a larger one.
    pub upper_bound: f64,
    /// At least this share of the best possible.
    pub efficiency_bound: f64,
}

/// Passes over all bundles at most.
const PASSES: usize = 25;
/// Steps of a relaxation between two passes at most.
const STEPS: usize = 400;
/// Bundles an exchange looks at.
const LIST: usize = 500;
/// Bundles the relaxation begins with, at least.
const FIRST: usize = 400;

/// The best layout found within the budget, with its bound.
///
/// # Errors
/// Where no layout within the budget separates the loads, or nothing fits.
pub fn place_bundles(bundles: &Bundles, spec: &BundleSpec) -> Result<BundleLayout, PlaceError> {
    let k = bundles.k;
    let singular = || PlaceError::Singular {
        gauges: spec.budget as usize,
        loads: k,
    };
    if bundles.is_empty() {
        return Err(PlaceError::TooFewPlaces {
            gauges: spec.budget as usize,
            places: 0,
        });
    }
    let relaxed = relax(bundles, spec).ok_or_else(singular)?;
    let list = relaxed.list(bundles);
    let mut best: Option<(Vec<usize>, f64)> = None;
    let mut rng = ChaCha8Rng::seed_from_u64(spec.effort.seed);
    let mut order = relaxed.by_weight();
    for start in 0..spec.effort.starts.max(1) {
        if start > 0 {
            // A random order that keeps to the weights.
            let mut keyed: Vec<(f64, usize)> = relaxed
                .by_weight()
                .into_iter()
                .enumerate()
                .map(|(n, u)| (n as f64 * rng.random_range(0.2..1.8), u))
                .collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
            order = keyed.into_iter().map(|x| x.1).collect();
        }
        let mut chosen = Vec::new();
        let mut spent = 0.0;
        for &u in &order {
            if fits(bundles, spec, &chosen, spent, u) {
                spent += bundles.cost[u];
                chosen.push(u);
            }
        }
        let Some(found) = improve(bundles, spec, &list, &relaxed, chosen) else {
            continue;
        };
        if best.as_ref().is_none_or(|b| found.1 > b.1) {
            best = Some(found);
        }
    }
    let (mut chosen, log_det) = best.ok_or_else(singular)?;
    chosen.sort_unstable();
    let upper_bound = relaxed.upper.max(log_det);
    let degree = spec.criterion.degree(k) as f64;
    Ok(BundleLayout {
        bundles: chosen,
        log_det,
        upper_bound,
        efficiency_bound: ((log_det - upper_bound) / degree).exp(),
    })
}

/// Room in a budget that is rounding.
const CENT: f64 = 1e-9;

fn fits(bundles: &Bundles, spec: &BundleSpec, chosen: &[usize], spent: f64, u: usize) -> bool {
    spent + bundles.cost[u] <= spec.budget + CENT
        && chosen.iter().all(|&c| !bundles.exclude(c, u, spec.spacing))
}

struct Relaxed {
    active: Vec<usize>,
    weights: Vec<f64>,
    /// Price over cost of every bundle.
    worth: Vec<f64>,
    ridge: Vec<f64>,
    upper: f64,
}

impl Relaxed {
    fn by_weight(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.active.len())
            .filter(|&i| self.weights[i] > 1e-6)
            .collect();
        order.sort_by(|&a, &b| self.weights[b].total_cmp(&self.weights[a]).then(a.cmp(&b)));
        order.into_iter().map(|i| self.active[i]).collect()
    }

    /// The bundles of the largest worth, and those with weight.
    fn list(&self, bundles: &Bundles) -> Vec<usize> {
        let mut order: Vec<usize> = (0..bundles.len()).collect();
        let by = |a: &usize, b: &usize| self.worth[*b].total_cmp(&self.worth[*a]).then(a.cmp(b));
        if order.len() > LIST {
            order.select_nth_unstable_by(LIST - 1, by);
            order.truncate(LIST);
        }
        order.extend(self.by_weight());
        order.sort_unstable();
        order.dedup();
        order
    }
}

/// `T`: prices filled in by worth until the budget is spent.
fn knapsack(items: &mut [(f64, f64)], budget: f64) -> f64 {
    items.sort_by(|a, b| (b.0 / b.1).total_cmp(&(a.0 / a.1)));
    let (mut left, mut sum) = (budget, 0.0);
    for &(price, cost) in items.iter() {
        let share = (left / cost).min(1.0);
        if share <= 0.0 {
            break;
        }
        sum += share * price;
        left -= share * cost;
    }
    sum
}

fn point(bundles: &Bundles, spec: &BundleSpec, active: &[usize], weights: &[f64]) -> Option<Point> {
    let mut m = spec.prior.clone();
    for (&u, &w) in active.iter().zip(weights) {
        if w > 0.0 {
            bundles.add_to(&mut m, u, w);
        }
    }
    spec.criterion.at(&m, bundles.k)
}

fn relax(bundles: &Bundles, spec: &BundleSpec) -> Option<Relaxed> {
    let k = bundles.k;
    let degree = spec.criterion.degree(k) as f64;
    let mut stride = (bundles.len() / FIRST).max(1);
    let mut active: Vec<usize>;
    let mut weights: Vec<f64>;
    loop {
        active = (0..bundles.len()).step_by(stride).collect();
        let all: f64 = active.iter().map(|&u| bundles.cost[u]).sum();
        weights = vec![(spec.budget / all).min(1.0); active.len()];
        if point(bundles, spec, &active, &weights).is_some() {
            break;
        }
        if stride == 1 {
            return None;
        }
        stride = (stride / 4).max(1);
    }
    let cheapest = bundles.cost.iter().copied().fold(f64::INFINITY, f64::min);
    let most = (spec.budget / cheapest).ceil() as usize + 1;
    let mut upper = f64::INFINITY;
    let mut inner = 0.02;
    let mut worth = Vec::new();
    for pass in 0..PASSES {
        solve(bundles, spec, &active, &mut weights, inner);
        let here = point(bundles, spec, &active, &weights)?;
        let slope = here.slope(k);
        worth = (0..bundles.len())
            .into_par_iter()
            .map_init(
                || vec![0.0; k],
                |w, u| bundles.price(u, &slope, w) / bundles.cost[u],
            )
            .collect::<Vec<f64>>();
        let mut order: Vec<usize> = (0..bundles.len()).collect();
        let by = |a: &usize, b: &usize| worth[*b].total_cmp(&worth[*a]).then(a.cmp(b));
        let keep = most.max(6 * k + 60).min(order.len());
        if keep < order.len() {
            order.select_nth_unstable_by(keep - 1, by);
            order.truncate(keep);
        }
        order.sort_by(by);
        // A dear bundle among the best leaves room for fewer: the list holds enough of the cheapest.
        let mut items: Vec<(f64, f64)> = order
            .iter()
            .map(|&u| (worth[u] * bundles.cost[u], bundles.cost[u]))
            .collect();
        let top = knapsack(&mut items, spec.budget);
        let trace = spd::trace_of_product(&slope, &spec.prior);
        let gap = ((trace + top) / degree).ln();
        upper = upper.min(here.value + degree * gap);
        if gap <= spec.tolerance || pass + 1 == PASSES {
            break;
        }
        let known: std::collections::HashSet<usize> = active.iter().copied().collect();
        let fresh: Vec<usize> = order.into_iter().filter(|u| !known.contains(u)).collect();
        inner = if fresh.is_empty() {
            0.2 * inner
        } else {
            (0.3 * gap).min(inner).max(0.2 * spec.tolerance)
        };
        // New ones begin with a little of everyone's weight.
        let share = 0.1;
        weights.iter_mut().for_each(|w| *w *= 1.0 - share);
        let cost: f64 = fresh.iter().map(|&u| bundles.cost[u]).sum();
        if cost > 0.0 {
            weights.extend(vec![(share * spec.budget / cost).min(1.0); fresh.len()]);
            active.extend(fresh);
        }
    }
    let mut ridge = spec.prior.clone();
    for (&u, &w) in active.iter().zip(&weights) {
        bundles.add_to(&mut ridge, u, 1e-3 * w);
    }
    Some(Relaxed {
        active,
        weights,
        worth,
        ridge,
        upper,
    })
}

/// Multiplies weights by worth (Titterington's algorithm), none above 1, until the gap over the active bundles is `tolerance`.
fn solve(
    bundles: &Bundles,
    spec: &BundleSpec,
    active: &[usize],
    weights: &mut [f64],
    tolerance: f64,
) {
    let k = bundles.k;
    let degree = spec.criterion.degree(k) as f64;
    let power = if matches!(spec.criterion, Criterion::Linear(_)) {
        0.5
    } else {
        1.0
    };
    let mut work = vec![0.0; k];
    for _ in 0..STEPS {
        let Some(here) = point(bundles, spec, active, weights) else {
            return;
        };
        let slope = here.slope(k);
        let prices: Vec<f64> = active
            .iter()
            .map(|&u| bundles.price(u, &slope, &mut work))
            .collect();
        let mut items: Vec<(f64, f64)> = active
            .iter()
            .zip(&prices)
            .map(|(&u, &p)| (p, bundles.cost[u]))
            .collect();
        let top = knapsack(&mut items, spec.budget);
        let trace = spd::trace_of_product(&slope, &spec.prior);
        if ((trace + top) / degree).ln() <= tolerance {
            return;
        }
        let target: Vec<f64> = active
            .iter()
            .zip(&prices)
            .zip(weights.iter())
            .map(|((&u, p), w)| w * (p / bundles.cost[u]).powf(power))
            .collect();
        let spent = |f: f64| -> f64 {
            active
                .iter()
                .zip(&target)
                .map(|(&u, t)| bundles.cost[u] * (f * t).min(1.0))
                .sum()
        };
        let (mut low, mut high) = (0.0, 1.0);
        while spent(high) < spec.budget && high < 1e30 {
            high *= 4.0;
        }
        for _ in 0..50 {
            let mid = 0.5 * (low + high);
            if spent(mid) < spec.budget {
                low = mid;
            } else {
                high = mid;
            }
        }
        for (w, t) in weights.iter_mut().zip(&target) {
            *w = (low * t).min(1.0);
        }
    }
}

/// Gain in the criterion under which an exchange is rounding error.
const LEAST_GAIN: f64 = 1e-9;
/// Of the candidates of an exchange, those judged exactly.
const JUDGED: usize = 24;

/// Fills the budget, then exchanges single bundles until none gains.
fn improve(
    bundles: &Bundles,
    spec: &BundleSpec,
    list: &[usize],
    relaxed: &Relaxed,
    mut chosen: Vec<usize>,
) -> Option<(Vec<usize>, f64)> {
    let information = |chosen: &[usize], base: &[f64]| {
        let mut m = base.to_vec();
        chosen.iter().for_each(|&u| bundles.add_to(&mut m, u, 1.0));
        m
    };
    let value = |chosen: &[usize], base: &[f64]| {
        spec.criterion
            .at(&information(chosen, base), bundles.k)
            .map(|p| p.value)
    };
    let spent = |chosen: &[usize]| -> f64 { chosen.iter().map(|&u| bundles.cost[u]).sum() };
    let mut base = &spec.prior;
    if value(&chosen, base).is_none() {
        base = &relaxed.ridge;
    }
    fill(bundles, spec, list, base, &mut chosen);
    if value(&chosen, &spec.prior).is_some() {
        base = &spec.prior;
    }
    let mut now = value(&chosen, base)?;
    for _ in 0..100 {
        let before = now;
        for slot in 0..chosen.len() {
            let mut rest = chosen.clone();
            rest.swap_remove(slot);
            let cost = spent(&rest);
            for u in promising(bundles, spec, list, &relaxed.ridge, &rest, cost) {
                let mut trial = rest.clone();
                trial.push(u);
                if let Some(v) = value(&trial, base)
                    && v > now + LEAST_GAIN
                {
                    now = v;
                    chosen = trial;
                }
            }
            if spent(&chosen) < spec.budget - CENT {
                let mut more = chosen.clone();
                fill(bundles, spec, list, base, &mut more);
                if let Some(v) = value(&more, base)
                    && v > now + LEAST_GAIN
                {
                    now = v;
                    chosen = more;
                }
            }
        }
        if !std::ptr::eq(base, &spec.prior) {
            base = &spec.prior;
            now = value(&chosen, base)?;
            continue;
        }
        if now - before < LEAST_GAIN {
            break;
        }
    }
    value(&chosen, &spec.prior).map(|v| (chosen, v))
}

/// Bundles that fit beside `rest`, the most promising first: by `ln det(1 + R M^-1 R')`, its first term where the criterion is not D.
fn promising(
    bundles: &Bundles,
    spec: &BundleSpec,
    list: &[usize],
    ridge: &[f64],
    rest: &[usize],
    spent: f64,
) -> Vec<usize> {
    let k = bundles.k;
    let mut m = ridge.to_vec();
    rest.iter().for_each(|&u| bundles.add_to(&mut m, u, 1.0));
    let Some(here) = spec.criterion.at(&m, k) else {
        return Vec::new();
    };
    let slope = here.slope(k);
    let mut u = vec![0.0; k];
    let mut keyed: Vec<(f64, usize)> = list
        .iter()
        .filter(|&&c| fits(bundles, spec, rest, spent, c))
        .map(|&c| {
            let rows: Vec<&[f64]> = bundles.rows_of(c).collect();
            let n = rows.len();
            let mut g = vec![0.0; n * n];
            for i in 0..n {
                spd::times(&slope, rows[i], &mut u);
                for j in 0..n {
                    g[i * n + j] = spd::dot(rows[j], &u) + f64::from(u8::from(i == j));
                }
            }
            (spd::cholesky(&g, n).map_or(0.0, |l| spd::log_det(&l, n)), c)
        })
        .collect();
    keyed.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    keyed.truncate(JUDGED);
    keyed.into_iter().map(|x| x.1).collect()
}

/// Adds the bundle that gains most for its cost while one fits.
fn fill(
    bundles: &Bundles,
    spec: &BundleSpec,
    list: &[usize],
    base: &[f64],
    chosen: &mut Vec<usize>,
) {
    let k = bundles.k;
    let mut m = base.to_vec();
    chosen.iter().for_each(|&u| bundles.add_to(&mut m, u, 1.0));
    let mut spent: f64 = chosen.iter().map(|&u| bundles.cost[u]).sum();
    let mut work = vec![0.0; k];
    while let Some(here) = spec.criterion.at(&m, k) {
        let slope = here.slope(k);
        let best = list
            .iter()
            .filter(|&&u| fits(bundles, spec, chosen, spent, u))
            .map(|&u| {
                (
                    bundles.price(u, &slope, &mut work).ln_1p() / bundles.cost[u],
                    u,
                )
            })
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        let Some((_, u)) = best else {
            return;
        };
        bundles.add_to(&mut m, u, 1.0);
        spent += bundles.cost[u];
        chosen.push(u);
    }
}
