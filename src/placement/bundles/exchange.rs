//! Whole bundles within the budget: filled in by gain over cost, then exchanged one by one.

use super::relaxation::BundleRelaxation;
use super::set::{BundleSpec, Bundles, CENT, fits};
use crate::linalg::spd;
use crate::placement::coordinate_exchange::LEAST_GAIN;

/// Number of exchange candidates that are evaluated exactly.
const EVALUATED_EXCHANGES: usize = 24;

/// Fills the budget, then exchanges single bundles until no exchange improves the criterion.
pub(super) fn improve(
    bundles: &Bundles,
    spec: &BundleSpec,
    list: &[usize],
    relaxed: &BundleRelaxation,
    mut chosen: Vec<usize>,
) -> Option<(Vec<usize>, f64)> {
    let information = |chosen: &[usize], base: &[f64]| {
        let mut m = base.to_vec();
        chosen.iter().for_each(|&u| bundles.add_to(&mut m, u, 1.0));
        m
    };
    let value = |chosen: &[usize], base: &[f64]| {
        spec.criterion
            .evaluate_at(&information(chosen, base), bundles.k)
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
            for u in rank_bundles(bundles, spec, list, &relaxed.ridge, &rest, cost) {
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

/// Returns the bundles that fit with `rest`, the most promising first: by `ln det(1 + R M^-1 R')`, or its first term if the criterion is not D.
fn rank_bundles(
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
    let Some(here) = spec.criterion.evaluate_at(&m, k) else {
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
    keyed.truncate(EVALUATED_EXCHANGES);
    keyed.into_iter().map(|x| x.1).collect()
}

/// Adds the bundle with the largest gain per cost, again and again, until no bundle fits.
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
    while let Some(here) = spec.criterion.evaluate_at(&m, k) {
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
