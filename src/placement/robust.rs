//! Layouts that survive the loss of any one gauge: exchange that raises the determinant left after the worst loss.
//!
//! With `h_q` the leverages, losing gauge `q` multiplies `det M` by `1 - h_q`; the search raises `ln det M + ln(1 - max h)`.

use super::coordinate_exchange::LEAST_GAIN;
use super::exchange::Effort;
use super::perturbation::move_gauges;
use super::relaxation_solution::Active;
use crate::linalg::spd;
use crate::stop::Stop;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// Leverage that counts as 1: that gauge may not be lost.
const WHOLE: f64 = 1.0 - 1e-9;

/// Returns `ln det` after the worst loss of one of these rows. `None` if the remaining matrix is singular.
pub fn after_worst_loss(active: &Active, prior: &[f64], rows: &[usize]) -> Option<f64> {
    let k = active.k;
    let mut m = prior.to_vec();
    rows.iter()
        .for_each(|&i| spd::add_outer(&mut m, active.row(i), 1.0));
    let l = spd::cholesky(&m, k)?;
    let inverse = spd::gram_of_lower(&spd::inverse_lower(&l, k), k);
    let mut u = vec![0.0; k];
    let worst = rows.iter().fold(0.0_f64, |h, &i| {
        spd::times(&inverse, active.row(i), &mut u);
        h.max(spd::dot(active.row(i), &u))
    });
    (worst < WHOLE).then(|| spd::log_det(&l, k) + (1.0 - worst).ln())
}

/// Returns the best rows found from `start`, with their criterion after the worst loss. `None` if every layout has an indispensable gauge. If a stop
/// is requested, it returns the best rows found so far.
pub fn search(
    active: &Active,
    prior: &[f64],
    start: &[usize],
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
    effort: Effort,
    stop: &Stop,
) -> Option<(Vec<usize>, f64)> {
    let (starts, perturbations) = if active.k > MANY_LOADS {
        (2, 2)
    } else {
        (
            effort.starts.max(1),
            effort.perturbations.min(MOST_PERTURBATIONS),
        )
    };
    // Each start is a separate search, followed by perturbations of its result.
    let found: Vec<Option<(Vec<usize>, f64)>> = (0..starts)
        .into_par_iter()
        .map(|n| {
            let mut rng = ChaCha8Rng::seed_from_u64(effort.seed.wrapping_add(n as u64));
            let first = if n == 0 {
                start.to_vec()
            } else {
                move_gauges(start, start.len(), active.len(), excludes, &mut rng)
            };
            let mut best = improve(active, prior, first, excludes, stop);
            for _ in 0..perturbations {
                if stop.is_asked() {
                    break;
                }
                let from = best.as_ref().map_or(start, |b| &b.0);
                let count = 1 + rng.random_range(0..2);
                let rows = move_gauges(from, count, active.len(), excludes, &mut rng);
                let next = improve(active, prior, rows, excludes, stop);
                best = choose_better(best, next);
            }
            best
        })
        .collect();
    found.into_iter().fold(None, choose_better)
}

type ScoredRows = Option<(Vec<usize>, f64)>;

fn choose_better(a: ScoredRows, b: ScoredRows) -> ScoredRows {
    match (a, b) {
        (Some(a), Some(b)) => Some(if b.1 > a.1 { b } else { a }),
        (a, b) => a.or(b),
    }
}

/// Loads from which the search is short.
const MANY_LOADS: usize = 12;

/// Perturbations of a search; each costs a few sweeps.
const MOST_PERTURBATIONS: usize = 20;

fn improve(
    active: &Active,
    prior: &[f64],
    mut rows: Vec<usize>,
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
    stop: &Stop,
) -> Option<(Vec<usize>, f64)> {
    let mut now = after_worst_loss(active, prior, &rows).unwrap_or(f64::NEG_INFINITY);
    for _ in 0..50 {
        let before = now;
        for slot in 0..rows.len() {
            if stop.is_asked() {
                break;
            }
            let rest: Vec<usize> = rows
                .iter()
                .enumerate()
                .filter(|(q, _)| *q != slot)
                .map(|(_, &r)| r)
                .collect();
            let Some((i, value)) = find_best_addition(active, prior, &rest, excludes) else {
                continue;
            };
            if value > now + LEAST_GAIN {
                (rows[slot], now) = (i, value);
            }
        }
        if !(now - before > LEAST_GAIN) {
            break;
        }
    }
    now.is_finite().then_some((rows, now))
}

/// The row that leaves most after the worst loss when it joins `rest`.
fn find_best_addition(
    active: &Active,
    prior: &[f64],
    rest: &[usize],
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
) -> Option<(usize, f64)> {
    let k = active.k;
    let mut m = prior.to_vec();
    rest.iter()
        .for_each(|&i| spd::add_outer(&mut m, active.row(i), 1.0));
    let l = spd::cholesky(&m, k)?;
    let inverse = spd::gram_of_lower(&spd::inverse_lower(&l, k), k);
    let base = spd::log_det(&l, k);
    let solved: Vec<Vec<f64>> = rest
        .iter()
        .map(|&q| {
            let mut u = vec![0.0; k];
            spd::times(&inverse, active.row(q), &mut u);
            u
        })
        .collect();
    let d: Vec<f64> = rest
        .iter()
        .zip(&solved)
        .map(|(&q, u)| spd::dot(active.row(q), u))
        .collect();
    let mut u = vec![0.0; k];
    let mut best = None;
    for i in 0..active.len() {
        if rest.iter().any(|&r| excludes(i, r)) {
            continue;
        }
        let row = active.row(i);
        spd::times(&inverse, row, &mut u);
        let own = spd::dot(row, &u);
        let add = 1.0 / (1.0 + own);
        let mut worst = own * add;
        for (v, d) in solved.iter().zip(&d) {
            let x = spd::dot(row, v);
            worst = worst.max(d - add * x * x);
        }
        if worst < WHOLE {
            let value = base + own.ln_1p() + (1.0 - worst).ln();
            if best.is_none_or(|(_, b)| value > b) {
                best = Some((i, value));
            }
        }
    }
    best
}
