//! From weights to gauges: rounding, then exchange of single gauges until none improves.
//!
//! Exchanging gauge `j` for row `i` multiplies `det M` by `(1 + d_i)(1 - d_j) + d_ij^2` (Fedorov, Theory of Optimal Experiments, 1972,
//! eq. 3.2.4). Several starts and kicks, all from a fixed seed.

use super::criterion::Criterion;
use super::relax::Active;
use crate::linalg::spd;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

/// How hard to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Effort {
    /// Independent starts.
    pub starts: usize,
    /// Kicks of the best layout (a few gauges replaced at random, then exchange) for each start.
    pub kicks: usize,
    /// Seed.
    pub seed: u64,
}

/// Rows chosen (ascending) and their criterion.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// Indices into the rows.
    pub rows: Vec<usize>,
    /// The criterion: `log det` for D.
    pub log_det: f64,
}

/// The best layout of `s` rows found, `excludes(i, j)` being true where rows `i` and `j` can't both be chosen (and for `i == j`); `None` where fewer than `s` compatible rows exist or all layouts tried are singular.
pub fn search(
    active: &Active,
    s: usize,
    prior: &[f64],
    weights: &[f64],
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
    effort: Effort,
) -> Option<Chosen> {
    let ridge = ridge(active, prior, weights);
    let results: Vec<Option<Chosen>> = (0..effort.starts.max(1))
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
            let first = if start == 1 {
                Vec::new()
            } else {
                compatible(&order, s, excludes)
            };
            let first = complete(active, s, &ridge, first, excludes).or_else(|| {
                (0..REPAIRS).find_map(|_| loosest(active.len(), s, excludes, &mut rng))
            })?;
            let mut best = improve(active, prior, &ridge, first, excludes)?;
            for _ in 0..effort.kicks {
                let q = 1 + rng.random_range(0..3.min(s));
                let mut kept = best.rows.clone();
                for _ in 0..q.min(kept.len()) {
                    kept.swap_remove(rng.random_range(0..kept.len()));
                }
                for _ in 0..50 {
                    if kept.len() == s {
                        break;
                    }
                    let i = rng.random_range(0..active.len());
                    if kept.iter().all(|&j| !excludes(i, j)) {
                        kept.push(i);
                    }
                }
                let Some(next) = complete(active, s, &ridge, kept, excludes)
                    .and_then(|f| improve(active, prior, &ridge, f, excludes))
                else {
                    continue;
                };
                if next.log_det > best.log_det {
                    best = next;
                }
            }
            Some(best)
        })
        .collect();
    let mut best: Option<Chosen> = None;
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

/// Rows drawn without replacement with chances proportional to their weight odds (exponential race).
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

fn compatible(
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

/// Any `s` compatible rows, those that exclude the fewest others first; ties and one row in eight by lot.
fn loosest(
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
fn complete(
    active: &Active,
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
    let mut d: Vec<f64> = (0..active.len())
        .map(|i| {
            spd::times(&minv, active.row(i), &mut u);
            if chosen.iter().any(|&j| excludes(i, j)) {
                f64::NEG_INFINITY
            } else {
                spd::dot(active.row(i), &u)
            }
        })
        .collect();
    while chosen.len() < s {
        let best = (0..active.len()).max_by(|&a, &b| d[a].total_cmp(&d[b]).then(b.cmp(&a)))?;
        if d[best] == f64::NEG_INFINITY {
            return None;
        }
        spd::times(&minv, active.row(best), &mut u);
        let factor = 1.0 / (1.0 + d[best]);
        for (i, v) in d.iter_mut().enumerate() {
            if *v > f64::NEG_INFINITY {
                let x = spd::dot(active.row(i), &u);
                *v = if excludes(i, best) {
                    f64::NEG_INFINITY
                } else {
                    *v - factor * x * x
                };
            }
        }
        let column = u.clone();
        spd::add_outer(&mut minv, &column, -factor);
        chosen.push(best);
    }
    Some(chosen)
}

/// Gain in `det` under which an exchange is rounding error.
const LEAST_GAIN: f64 = 1e-9;

/// An inverse with the variances of all rows, and their cross variances with the chosen ones (by slot).
struct Table {
    inverse: Vec<f64>,
    d: Vec<f64>,
    cross: Vec<f64>,
}

impl Table {
    fn new(active: &Active, inverse: Vec<f64>, chosen: &[usize]) -> Self {
        let n = active.len();
        let mut u = vec![0.0; active.k];
        let mut t = Self {
            inverse,
            d: vec![0.0; n],
            cross: vec![0.0; n * chosen.len()],
        };
        for i in 0..n {
            let ai = active.row(i);
            spd::times(&t.inverse, ai, &mut u);
            t.d[i] = spd::dot(ai, &u);
            for (c, &j) in chosen.iter().enumerate() {
                t.cross[c * n + i] = spd::dot(active.row(j), &u);
            }
        }
        t
    }

    /// Factor on the determinant when row `i` takes the place of row `j` in `slot`.
    fn ratio(&self, slot: usize, i: usize, j: usize) -> f64 {
        let cross = self.cross[slot * self.d.len() + i];
        (1.0 + self.d[i]) * (1.0 - self.d[j]) + cross * cross
    }
}

/// A choice with what its exchanges need.
struct State {
    value: f64,
    /// `tr(L M^-1)` of a linear criterion.
    spread: f64,
    /// Under `M^-1`.
    full: Table,
    /// Under the inverse of the nuisance block (Ds) or `M^-1 L M^-1` (linear).
    second: Option<Table>,
}

impl State {
    fn of(active: &Active, prior: &[f64], chosen: &[usize]) -> Option<Self> {
        let mut m = prior.to_vec();
        for &i in chosen {
            spd::add_outer(&mut m, active.row(i), 1.0);
        }
        let point = active.criterion.at(&m, active.k)?;
        let second = (!point.second.is_empty()).then(|| Table::new(active, point.second, chosen));
        Some(Self {
            value: point.value,
            spread: point.spread,
            full: Table::new(active, point.inverse, chosen),
            second,
        })
    }

    /// A number above 1 where row `i` in place of `j` in `slot` is better, and the larger the better.
    fn gain(&self, criterion: &Criterion, slot: usize, i: usize, j: usize) -> f64 {
        let ratio = self.full.ratio(slot, i, j);
        match (&self.second, criterion) {
            (Some(g), Criterion::Linear(_)) => {
                if ratio < LEAST_PART {
                    return 0.0;
                }
                let at = slot * self.full.d.len() + i;
                let (x, y) = (self.full.cross[at], g.cross[at]);
                let fall = g.d[i] - g.d[j] + 2.0 * x * y
                    - g.d[i] * self.full.d[j]
                    - g.d[j] * self.full.d[i];
                self.spread / (self.spread - fall / ratio).max(f64::MIN_POSITIVE)
            }
            (Some(part), _) => ratio / part.ratio(slot, i, j).max(LEAST_PART),
            (None, _) => ratio,
        }
    }
}

/// Exchanges single rows until none gains. Starts regularised by `ridge` where the rows alone are singular.
fn improve(
    active: &Active,
    prior: &[f64],
    ridge: &[f64],
    mut chosen: Vec<usize>,
    excludes: &(impl Fn(usize, usize) -> bool + Sync),
) -> Option<Chosen> {
    let (n, s) = (active.len(), chosen.len());
    let mut blocked = vec![0u32; n];
    for (i, b) in blocked.iter_mut().enumerate() {
        *b = chosen.iter().filter(|&&j| excludes(i, j)).count() as u32;
    }
    let mut base = prior;
    let mut state = match State::of(active, base, &chosen) {
        Some(state) => state,
        None => {
            base = ridge;
            State::of(active, base, &chosen)?
        }
    };
    for _ in 0..MAX_SWEEPS {
        let mut gained = false;
        for slot in 0..s {
            let j = chosen[slot];
            let mut best = (1.0 + LEAST_GAIN, usize::MAX);
            for i in 0..n {
                let ratio = state.gain(&active.criterion, slot, i, j);
                if ratio > best.0
                    && (blocked[i] == 0 || (blocked[i] == 1 && excludes(i, j) && i != j))
                {
                    best = (ratio, i);
                }
            }
            let i = best.1;
            if i == usize::MAX {
                continue;
            }
            gained = true;
            let linear = matches!(active.criterion, Criterion::Linear(_));
            if !linear {
                for t in std::iter::once(&mut state.full).chain(&mut state.second) {
                    swap(active, t, &chosen, slot, i);
                }
            }
            for (x, b) in blocked.iter_mut().enumerate() {
                *b += u32::from(excludes(x, i));
                *b -= u32::from(excludes(x, j));
            }
            chosen[slot] = i;
            if linear {
                state = State::of(active, base, &chosen)?;
            }
        }
        if !gained && !std::ptr::eq(base, prior) {
            base = prior;
            gained = true;
        }
        if !gained {
            break;
        }
        state = State::of(active, base, &chosen)?;
    }
    if !std::ptr::eq(base, prior) {
        state = State::of(active, prior, &chosen)?;
    }
    Some(Chosen {
        rows: chosen,
        log_det: state.value,
    })
}

/// Share of its determinant under which a block counts as lost by an exchange.
const LEAST_PART: f64 = 1e-9;

/// Sweeps after which the search gives up; it stops by itself long before.
const MAX_SWEEPS: usize = 200;

/// Brings a table up to date for row `i` in place of the gauge in `slot`.
fn swap(active: &Active, t: &mut Table, chosen: &[usize], slot: usize, i: usize) {
    let (n, k) = (active.len(), active.k);
    let mut ui = vec![0.0; k];
    spd::times(&t.inverse, active.row(i), &mut ui);
    let x: Vec<f64> = (0..n).map(|p| spd::dot(active.row(p), &ui)).collect();
    let add = 1.0 / (1.0 + t.d[i]);
    let j = chosen[slot];
    let xj = x[j];
    let y: Vec<f64> = (0..n)
        .map(|p| t.cross[slot * n + p] - add * x[p] * xj)
        .collect();
    let drop = 1.0 / (1.0 - y[j]);
    let mut uj = vec![0.0; k];
    spd::times(&t.inverse, active.row(j), &mut uj);
    for (a, b) in uj.iter_mut().zip(&ui) {
        *a -= add * xj * b;
    }
    spd::add_outer(&mut t.inverse, &ui, -add);
    spd::add_outer(&mut t.inverse, &uj, drop);
    for p in 0..n {
        t.d[p] += drop * y[p] * y[p] - add * x[p] * x[p];
    }
    for (c, &q) in chosen.iter().enumerate() {
        let (xq, yq) = (x[q], y[q]);
        let column = &mut t.cross[c * n..(c + 1) * n];
        if c == slot {
            for (p, v) in column.iter_mut().enumerate() {
                *v = x[p] - add * x[p] * x[i] + drop * y[p] * y[i];
            }
        } else {
            for (p, v) in column.iter_mut().enumerate() {
                *v += drop * y[p] * yq - add * x[p] * xq;
            }
        }
    }
}
