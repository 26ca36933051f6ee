//! The best layout of several starts, with its certificate.

use super::exchange::improve;
use super::relaxation::relax;
use super::set::{BundleSpec, Bundles, fits};
use crate::placement::layout::PlaceError;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A layout of chosen bundles.
#[derive(Clone, Debug)]
pub struct BundleLayout {
    /// Chosen bundles, ascending.
    pub bundles: Vec<usize>,
    /// The criterion.
    pub log_det: f64,
    /// Upper bound of the criterion of all layouts within the budget.
    pub upper_bound: f64,
    /// Lower bound on the efficiency, relative to the best possible layout.
    pub efficiency_bound: f64,
}

/// Returns the best layout found within the budget, with its bound.
///
/// # Errors
/// An error if no layout within the budget separates the loads, or if there is no bundle.
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
            // Random order with probabilities from the weights.
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
