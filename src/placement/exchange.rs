//! From weights to gauges: rounding, then exchange of single gauges until none improves.
//!
//! Several starts and perturbations, all from a fixed seed.

use super::coordinate_exchange::{CoordinateExchange, List};
use super::relaxation_solution::Active;
use super::variance_table::PackedRows;
use crate::linalg::spd;
use crate::stop::Stop;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Effort of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Number of independent starts.
    pub starts: usize,
    /// Perturbations of the best layout (a few gauges replaced at random, then exchange) for each start.
    pub perturbations: usize,
    /// Seed.
    pub seed: u64,
}

/// Chosen rows in ascending order, with the criterion of this choice.
#[derive(Clone, Debug, PartialEq)]
pub struct RowSelection {
    /// Indices into the rows.
    pub rows: Vec<usize>,
    /// The criterion: `log det` for D.
    pub log_det: f64,
}

/// Returns the best layout of `s` rows found. `excludes(i, j)` is true if rows `i` and `j` can't both be chosen, and for `i == j`. `None` if fewer
/// than `s` compatible rows exist or all layouts tried are singular.
pub fn search(
    active: &Active,
    s: usize,
    prior: &[f64],
    weights: &[f64],
    known: Option<&[usize]>,
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
    effort: Effort,
    stop: &Stop,
) -> Option<RowSelection> {
    let ridge = ridge(active, prior, weights);
    let list = List::new(active, prior, excludes);
    let results: Vec<Option<RowSelection>> = (0..effort.starts.max(1))
        .into_par_iter()
        .map(|start| {
            let mut rng = ChaCha8Rng::seed_from_u64(
                effort
                    .seed
                    .wrapping_mul(1_000_003)
                    .wrapping_add(start as u64),
            );
            let order = match start {
                0 => by_weight(weights),
                _ => by_lot(weights, &mut rng),
            };
            let first = match (start, known) {
                (0, Some(rows)) => rows.to_vec(),
                (1, _) => Vec::new(),
                _ => choose_compatible_rows(&order, s, excludes),
            };
            let first = complete_layout(active, &list.packed, s, &ridge, first, excludes).or_else(
                || {
                    (0..REPAIRS)
                        .find_map(|_| draw_loosest_rows(active.len(), s, excludes, &mut rng))
                },
            )?;
            let mut at = improve(&list, &ridge, first)?;
            let mut best = (at.value, at.rows.clone());
            let mut now = at.clone();
            for _ in 0..effort.perturbations {
                if stop.is_asked() {
                    break;
                }
                let count = if s < MANY {
                    1 + rng.random_range(0..3.min(s))
                } else {
                    3 + rng.random_range(0..2)
                };
                // Accept a slightly worse layout, which may lead to a better one. The accepted loss is random.
                let worse = -LENIENT * rng.random_range(f64::MIN_POSITIVE..1.0).ln();
                if now.perturb(&list, count, &mut rng)
                    && now.improve(&list, prior)
                    && now.value > at.value - worse
                {
                    at.copy(&now);
                    if at.value > best.0 {
                        best = (at.value, at.rows.clone());
                    }
                } else {
                    now.copy(&at);
                }
            }
            let log_det = value(active, prior, &best.1)?;
            Some(RowSelection {
                rows: best.1,
                log_det,
            })
        })
        .collect();
    let mut best: Option<RowSelection> = None;
    for r in results.into_iter().flatten() {
        if best.as_ref().is_none_or(|b| r.log_det > b.log_det) {
            best = Some(r);
        }
    }
    best.map(|mut b| {
        b.rows.sort_unstable();
        b
    })
}

/// A thousandth of the relaxed information: makes a start with fewer rows than loads regular.
fn ridge(active: &Active, prior: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut m = prior.to_vec();
    for (i, &w) in weights.iter().enumerate() {
        if w > 0.0 {
            spd::add_outer(&mut m, active.row(i), 1e-3 * w);
        }
    }
    m
}

fn by_weight(weights: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..weights.len()).filter(|&i| weights[i] > 0.0).collect();
    order.sort_by(|&a, &b| weights[b].total_cmp(&weights[a]).then(a.cmp(&b)));
    order
}

/// Returns rows sampled without replacement, with probabilities proportional to the odds of their weights (exponential race).
fn by_lot(weights: &[f64], rng: &mut ChaCha8Rng) -> Vec<usize> {
    let mut keyed: Vec<(f64, usize)> = weights
        .iter()
        .enumerate()
        .filter(|(_, w)| **w > 0.0)
        .map(|(i, &w)| {
            let u: f64 = rng.random_range(f64::MIN_POSITIVE..1.0);
            (-u.ln() * (1.0 - w.min(1.0 - 1e-9)) / w, i)
        })
        .collect();
    keyed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    keyed.into_iter().map(|(_, i)| i).collect()
}

fn choose_compatible_rows(
    order: &[usize],
    s: usize,
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
) -> Vec<usize> {
    let mut chosen: Vec<usize> = Vec::new();
    for &i in order {
        if chosen.len() == s {
            break;
        }
        if chosen.iter().all(|&j| !excludes(i, j)) {
            chosen.push(i);
        }
    }
    chosen
}

/// Attempts to fit gauges in where the best-priced rows leave no room.
const REPAIRS: usize = 200;

/// Draws `s` compatible rows. Rows that exclude the fewest other rows come first. Ties and one row in eight are chosen at random.
fn draw_loosest_rows(
    n: usize,
    s: usize,
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
    rng: &mut ChaCha8Rng,
) -> Option<Vec<usize>> {
    let mut free: Vec<usize> = (0..n).collect();
    let mut chosen = Vec::new();
    while chosen.len() < s {
        let pick = if rng.random_range(0..8) == 0 {
            *free.get(rng.random_range(0..free.len().max(1)))?
        } else {
            let sample = free.len().min(200);
            let keyed = (0..sample).map(|_| free[rng.random_range(0..free.len())]);
            keyed.min_by_key(|&i| free.iter().filter(|&&j| excludes(i, j)).count())?
        };
        chosen.push(pick);
        free.retain(|&j| !excludes(pick, j));
    }
    Some(chosen)
}

/// Adds the row of largest variance until there are `s`.
fn complete_layout(
    active: &Active,
    packed: &PackedRows,
    s: usize,
    ridge: &[f64],
    mut chosen: Vec<usize>,
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
) -> Option<Vec<usize>> {
    let k = active.k;
    if chosen.len() >= s {
        return Some(chosen);
    }
    let mut m = ridge.to_vec();
    for &i in &chosen {
        spd::add_outer(&mut m, active.row(i), 1.0);
    }
    let linv = spd::inverse_lower(&spd::cholesky(&m, k)?, k);
    let mut minv = spd::gram_of_lower(&linv, k);
    let mut u = vec![0.0; k];
    let (mut d, mut x) = (vec![0.0; packed.len()], vec![0.0; packed.len()]);
    packed.variances(&minv, &mut d);
    d[active.len()..].fill(f64::NEG_INFINITY);
    for (i, v) in d.iter_mut().enumerate().take(active.len()) {
        if chosen.iter().any(|&j| excludes(i, j)) {
            *v = f64::NEG_INFINITY;
        }
    }
    while chosen.len() < s {
        let best = (0..active.len()).max_by(|&a, &b| d[a].total_cmp(&d[b]).then(b.cmp(&a)))?;
        if d[best] == f64::NEG_INFINITY {
            return None;
        }
        spd::times(&minv, active.row(best), &mut u);
        let factor = 1.0 / (1.0 + d[best]);
        packed.products(&u, &mut x);
        for (i, (v, &x)) in d.iter_mut().zip(&x).enumerate().take(active.len()) {
            if *v > f64::NEG_INFINITY {
                *v = if excludes(i, best) {
                    f64::NEG_INFINITY
                } else {
                    *v - factor * x * x
                };
            }
        }
        spd::add_outer(&mut minv, &u, -factor);
        chosen.push(best);
    }
    Some(chosen)
}

/// Exchange from these rows, regularised by `ridge` first where they alone are singular; `None` where the rows it ends with are.
fn improve<E: Fn(usize, usize) -> bool + Sync>(
    list: &List<E>,
    ridge: &[f64],
    chosen: Vec<usize>,
) -> Option<CoordinateExchange> {
    let mut found = match CoordinateExchange::from_rows(list, list.prior, chosen.clone()) {
        Some(found) => found,
        None => {
            let mut found = CoordinateExchange::from_rows(list, ridge, chosen)?;
            found.improve(list, ridge).then_some(())?;
            CoordinateExchange::from_rows(list, list.prior, found.rows)?
        }
    };
    found.improve(list, list.prior).then_some(found)
}

/// The criterion of these rows.
fn value(active: &Active, prior: &[f64], rows: &[usize]) -> Option<f64> {
    let mut m = prior.to_vec();
    rows.iter()
        .for_each(|&i| spd::add_outer(&mut m, active.row(i), 1.0));
    active.criterion.evaluate_at(&m, active.k).map(|p| p.value)
}

/// Number of gauges from which a perturbation moves more gauges.
const MANY: usize = 20;
/// Largest accepted mean loss of the criterion after a perturbation.
const LENIENT: f64 = 0.05;
