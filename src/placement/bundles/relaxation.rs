//! The relaxation: weights between 0 and 1 that use the whole budget, and the bound that follows from the prices of the bundles.

use super::set::{BundleSpec, Bundles};
use crate::linalg::spd;
use crate::placement::criterion::{Criterion, Point};
use rayon::prelude::*;

/// Passes over all bundles at most.
const PASSES: usize = 25;
/// Steps of a relaxation between two passes at most.
const STEPS: usize = 400;
/// Bundles the relaxation begins with, at least.
const FIRST: usize = 400;
/// Bundles an exchange looks at.
const LIST: usize = 500;

/// Weights of the bundles in use, and the bound.
pub(super) struct BundleRelaxation {
    active: Vec<usize>,
    weights: Vec<f64>,
    /// Price over cost of every bundle.
    worth: Vec<f64>,
    /// Prior plus a small weight of every bundle in use. It is regular for all combinations of their rows.
    pub(super) ridge: Vec<f64>,
    /// Upper bound of the criterion of any layout within the budget.
    pub(super) upper: f64,
}

impl BundleRelaxation {
    /// Returns the bundles with weight, the heaviest first.
    pub(super) fn by_weight(&self) -> Vec<usize> {
        let mut order: Vec<usize> = (0..self.active.len())
            .filter(|&i| self.weights[i] > 1e-6)
            .collect();
        order.sort_by(|&a, &b| self.weights[b].total_cmp(&self.weights[a]).then(a.cmp(&b)));
        order.into_iter().map(|i| self.active[i]).collect()
    }

    /// Returns the bundles with the largest worth, and the bundles with weight.
    pub(super) fn list(&self, bundles: &Bundles) -> Vec<usize> {
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

/// The criterion at weights of the active bundles.
fn point(bundles: &Bundles, spec: &BundleSpec, active: &[usize], weights: &[f64]) -> Option<Point> {
    let mut m = spec.prior.clone();
    for (&u, &w) in active.iter().zip(weights) {
        if w > 0.0 {
            bundles.add_to(&mut m, u, w);
        }
    }
    spec.criterion.evaluate_at(&m, bundles.k)
}

/// Returns weights that use the whole budget, over as many bundles as the bound requires. `None` if all bundles together give a singular matrix.
pub(super) fn relax(bundles: &Bundles, spec: &BundleSpec) -> Option<BundleRelaxation> {
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
        // An expensive bundle among the best leaves room for fewer bundles, so the list contains enough of the cheapest ones.
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
        // New bundles start with a small share of the weight of all other bundles.
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
    Some(BundleRelaxation {
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
