//! Relaxation of the layout problem with weights in place of gauges: `max criterion(P + sum w_i a_i a_i')` with `sum w = s`, `w >= 0` and at most 1
//! in each group.
//!
//! The D criterion uses Newton steps (`super::newton`). If they do not close the gap, and for the other criteria, weight moves between pairs of rows
//! by exact line search (vertex exchange). The order is the order of the randomised exchange of Harman, Filova and Richtarik, J. Am. Stat. Assoc. 115
//! (2020), without randomness.
//!
//! The rows of a group share a weight of at most 1. A group is one distinct gauge, all angles of a place, or all places within a spacing. Every
//! exchange direction of this set is a pair of rows, so the search can only end at the optimum.

use super::criterion::Criterion;
use super::newton;
use super::relaxation_solution::{Active, FULL, RelaxationSolution, pulls};
use crate::linalg::spd;

/// Returns the sum of the `s` largest group maxima, and the smallest of these maxima. `d` yields pairs of group and value.
pub fn top_sum(d: impl Iterator<Item = (u32, f64)>, n_groups: usize, s: usize) -> (f64, f64) {
    let mut best = vec![f64::NEG_INFINITY; n_groups];
    for (g, v) in d {
        let b = &mut best[g as usize];
        *b = b.max(v);
    }
    best.retain(|v| v.is_finite());
    if s == 0 || best.is_empty() {
        return (0.0, 0.0);
    }
    let s = s.min(best.len());
    best.select_nth_unstable_by(s - 1, |a, b| b.total_cmp(a));
    (best[..s].iter().sum(), best[s - 1])
}

/// Solves the relaxation from `weights` to a gap (per load) of `tolerance`. `None` if the information matrix is singular.
pub fn relax(
    active: &Active,
    s: usize,
    prior: &[f64],
    mut weights: Vec<f64>,
    tolerance: f64,
    sweeps: usize,
) -> Option<RelaxationSolution> {
    let (k, n) = (active.k, active.len());
    let mut state = measure(active, s, prior, &weights)?;
    let mut slack = vec![1.0; active.n_groups];
    let mut u = vec![0.0; k];
    let mut v = vec![0.0; k];
    let (mut nu, mut nv) = (vec![0.0; k], vec![0.0; k]);
    let mut done = 0;
    while done < sweeps {
        if state.gap <= tolerance {
            break;
        }
        done += 1;
        if active.criterion == Criterion::D
            && let Some(next) = newton::step(active, prior, &weights, &state)
            && let Some(after) = measure(active, s, prior, &next)
            && after.gap < FALL * state.gap
        {
            weights = next;
            state = after;
            continue;
        }
        slack.fill(1.0);
        for (&g, &w) in active.group.iter().zip(&weights) {
            slack[g as usize] -= w;
        }
        let mut incoming: Vec<u32> = (0..n as u32).collect();
        let d = &state.d;
        let by_d = |a: &u32, b: &u32| d[*b as usize].total_cmp(&d[*a as usize]).then(a.cmp(b));
        let keep = (4 * k + s / 2).max(32).min(n);
        let pull = pulls(active, &weights, d);
        incoming.retain(|&i| weights[i as usize] < 1.0 - FULL && pull[i as usize] > 0.0);
        if incoming.len() > keep {
            incoming.select_nth_unstable_by(keep - 1, |&a, &b| {
                pull[b as usize]
                    .total_cmp(&pull[a as usize])
                    .then(a.cmp(&b))
            });
            incoming.truncate(keep);
        }
        incoming.sort_unstable_by(by_d);
        let mut outgoing: Vec<u32> = (0..n as u32)
            .filter(|&i| weights[i as usize] > 0.0)
            .collect();
        outgoing.sort_unstable_by(|a, b| by_d(b, a));
        let mut minv = std::mem::take(&mut state.point.inverse);
        let mut second = std::mem::take(&mut state.point.second);
        let linear = matches!(active.criterion, Criterion::Linear(_));
        if active.criterion == Criterion::D {
            let lists = Lists {
                d: &state.d,
                incoming: &incoming,
                outgoing: &outgoing,
            };
            sweep_d(active, &lists, &mut minv, &mut weights, &mut slack);
            incoming.clear();
        }
        for &i in &incoming {
            let (i, gi) = (i as usize, active.group[i as usize] as usize);
            let ai = active.row(i);
            let mut tried = 0;
            for &j in &outgoing {
                let (j, gj) = (j as usize, active.group[j as usize] as usize);
                if i == j || weights[j] <= 0.0 {
                    continue;
                }
                let cap = if gi == gj {
                    weights[j]
                } else {
                    weights[j].min(slack[gi])
                };
                if cap <= 0.0 {
                    continue;
                }
                if state.d[j] >= state.d[i] || tried > MAX_TRIES {
                    break;
                }
                tried += 1;
                let aj = active.row(j);
                let full = Pair::new(&minv, ai, aj, &mut u, &mut v);
                let part =
                    (!second.is_empty()).then(|| Pair::new(&second, ai, aj, &mut nu, &mut nv));
                let step = match &part {
                    Some(spread) if linear => linear_step(&full, spread, cap),
                    part => best_step(&full, part.as_ref(), cap),
                };
                if step <= 0.0 || full.det(step) <= 0.0 {
                    continue;
                }
                if let Some(part) = part {
                    if linear {
                        full.apply_between(&mut second, step, &part, [&u, &v], [&nu, &nv]);
                    } else {
                        part.apply(&mut second, step, &nu, &nv);
                    }
                }
                full.apply(&mut minv, step, &u, &v);
                weights[i] += step;
                weights[j] = if step >= weights[j] {
                    0.0
                } else {
                    weights[j] - step
                };
                slack[gi] -= step;
                slack[gj] += step;
            }
        }
        state = measure(active, s, prior, &weights)?;
    }
    state.weights = weights;
    state.sweeps = done;
    Some(state)
}

/// Share of the gap that a Newton step must leave at most, or a sweep is made instead.
const FALL: f64 = 0.9;

/// Rows that may gain and lose weight in a sweep, by their slopes `d` at its start.
struct Lists<'a> {
    d: &'a [f64],
    incoming: &'a [u32],
    outgoing: &'a [u32],
}

/// A sweep for D: the slopes of the outgoing rows follow every step, so that a pair that takes none costs one scalar product.
fn sweep_d(
    active: &Active,
    lists: &Lists,
    minv: &mut [f64],
    weights: &mut [f64],
    slack: &mut [f64],
) {
    let k = active.k;
    let (mut u, mut v) = (vec![0.0; k], vec![0.0; k]);
    let mut now: Vec<f64> = lists
        .outgoing
        .iter()
        .map(|&j| lists.d[j as usize])
        .collect();
    for &i in lists.incoming {
        let (i, gi) = (i as usize, active.group[i as usize] as usize);
        let ai = active.row(i);
        spd::times(minv, ai, &mut u);
        let mut di = spd::dot(ai, &u);
        let mut tried = 0;
        for (at, &j) in lists.outgoing.iter().enumerate() {
            let (j, gj) = (j as usize, active.group[j as usize] as usize);
            if i == j || weights[j] <= 0.0 {
                continue;
            }
            let cap = if gi == gj {
                weights[j]
            } else {
                weights[j].min(slack[gi])
            };
            if cap <= 0.0 {
                continue;
            }
            if lists.d[j] >= lists.d[i] || tried > MAX_TRIES {
                break;
            }
            tried += 1;
            if di <= now[at] {
                continue;
            }
            let pair = Pair {
                di,
                dj: now[at],
                dij: spd::dot(active.row(j), &u),
            };
            let step = best_step(&pair, None, cap);
            if step <= 0.0 || pair.det(step) <= 0.0 {
                continue;
            }
            spd::times(minv, active.row(j), &mut v);
            let [cu, cx, cv] = pair.change(step);
            pair.apply(minv, step, &u, &v);
            for (d, &q) in now.iter_mut().zip(lists.outgoing) {
                let row = active.row(q as usize);
                let (x, y) = (spd::dot(row, &u), spd::dot(row, &v));
                *d -= cu * x * x + 2.0 * cx * x * y + cv * y * y;
            }
            let (x, y) = (cu * pair.di + cx * pair.dij, cx * pair.di + cv * pair.dij);
            for (a, b) in u.iter_mut().zip(&v) {
                *a -= x * *a + y * b;
            }
            di = spd::dot(ai, &u);
            weights[i] += step;
            weights[j] = if step >= weights[j] {
                0.0
            } else {
                weights[j] - step
            };
            slack[gi] -= step;
            slack[gj] += step;
        }
    }
}

/// Partners a row tries in one sweep; the next sweep sorts again.
const MAX_TRIES: usize = 48;

/// Two rows under an inverse: what moving weight from `j` to `i` does to the determinant.
struct Pair {
    di: f64,
    dj: f64,
    dij: f64,
}

impl Pair {
    /// Fills `u = inverse a_i`, `v = inverse a_j`.
    fn new(inverse: &[f64], ai: &[f64], aj: &[f64], u: &mut [f64], v: &mut [f64]) -> Self {
        spd::times(inverse, ai, u);
        spd::times(inverse, aj, v);
        Self {
            di: spd::dot(ai, u),
            dj: spd::dot(aj, v),
            dij: spd::dot(aj, u),
        }
    }

    /// `det(M + t (a_i a_i' - a_j a_j')) / det M`.
    fn det(&self, t: f64) -> f64 {
        (1.0 + t * self.di) * (1.0 - t * self.dj) + t * t * self.dij * self.dij
    }

    /// Derivative of its logarithm.
    fn slope(&self, t: f64) -> f64 {
        let curvature = self.di * self.dj - self.dij * self.dij;
        (self.di - self.dj - 2.0 * t * curvature) / self.det(t)
    }

    /// `Q` of `inverse after = inverse - [u v] Q [u v]'`, by the formula of Sherman, Morrison and Woodbury for two columns: its entries
    /// uu, uv, vv.
    fn change(&self, t: f64) -> [f64; 3] {
        let det = self.det(t);
        [
            t * (1.0 - t * self.dj) / det,
            t * t * self.dij / det,
            -t * (1.0 + t * self.di) / det,
        ]
    }

    /// The inverse after the move.
    fn apply(&self, inverse: &mut [f64], t: f64, u: &[f64], v: &[f64]) {
        let k = u.len();
        let [cu, cx, cv] = self.change(t);
        for r in 0..k {
            let (x, y) = (cu * u[r] + cx * v[r], cv * v[r] + cx * u[r]);
            for (c, m) in inverse[r * k..(r + 1) * k].iter_mut().enumerate() {
                *m -= x * u[c] + y * v[c];
            }
        }
    }

    /// `M^-1 L M^-1` after the move: with `U = [u v]`, `P = M^-1 L M^-1 [a_i a_j]` and `Gamma` the products of the two rows under it (`spread`),
    /// it changes by `-U Q P' - P Q U' + U Q Gamma Q U'`.
    fn apply_between(
        &self,
        second: &mut [f64],
        t: f64,
        spread: &Pair,
        [u, v]: [&[f64]; 2],
        [p, q]: [&[f64]; 2],
    ) {
        let k = u.len();
        let [a, b, c] = self.change(t);
        let (gi, gx, gj) = (spread.di, spread.dij, spread.dj);
        // Q Gamma Q.
        let (h00, h01) = (a * gi + b * gx, a * gx + b * gj);
        let (h10, h11) = (b * gi + c * gx, b * gx + c * gj);
        let (e00, e01, e11) = (h00 * a + h01 * b, h00 * b + h01 * c, h10 * b + h11 * c);
        for r in 0..k {
            // Rows of U Q and of U Q Gamma Q.
            let (x, y) = (a * u[r] + b * v[r], b * u[r] + c * v[r]);
            let (f, g) = (e00 * u[r] + e01 * v[r], e01 * u[r] + e11 * v[r]);
            for (n, m) in second[r * k..(r + 1) * k].iter_mut().enumerate() {
                let (xn, yn) = (a * u[n] + b * v[n], b * u[n] + c * v[n]);
                *m += f * u[n] + g * v[n] - x * p[n] - y * q[n] - p[r] * xn - q[r] * yn;
            }
        }
    }
}

/// `(alpha, beta)` of `tr(L M^-1)` before the move less after it, `(alpha t + beta t^2) / det(t)`; `spread` holds the products under `M^-1 L M^-1`.
fn fall(full: &Pair, spread: &Pair) -> (f64, f64) {
    (
        spread.di - spread.dj,
        2.0 * full.dij * spread.dij - spread.di * full.dj - spread.dj * full.di,
    )
}

/// The weight in `0 .. cap` whose move lowers `tr(L M^-1)` most: the first zero of the derivative, a quadratic.
fn linear_step(full: &Pair, spread: &Pair, cap: f64) -> f64 {
    let (alpha, beta) = fall(full, spread);
    if !(alpha > 0.0) {
        return 0.0;
    }
    let (gamma, delta) = (full.di - full.dj, full.dij * full.dij - full.di * full.dj);
    let (a, b, c) = (beta * gamma - alpha * delta, 2.0 * beta, alpha);
    let disc = b * b - 4.0 * a * c;
    if disc < 0.0 {
        return cap;
    }
    // Both roots without cancellation.
    let w = -0.5 * (b + disc.sqrt().copysign(b));
    [w / a, c / w]
        .into_iter()
        .filter(|t| t.is_finite() && *t > 0.0)
        .fold(cap, f64::min)
}

/// The weight in `0 .. cap` whose move raises the criterion most.
fn best_step(full: &Pair, nuisance: Option<&Pair>, cap: f64) -> f64 {
    let Some(part) = nuisance else {
        let curvature = full.di * full.dj - full.dij * full.dij;
        if full.di <= full.dj {
            return 0.0;
        }
        return if curvature > 0.0 {
            ((full.di - full.dj) / (2.0 * curvature)).min(cap)
        } else {
            cap
        };
    };
    let slope = |t: f64| full.slope(t) - part.slope(t);
    if slope(0.0) <= 0.0 {
        return 0.0;
    }
    // The determinants stay positive below this step.
    let safe = cap.min(0.999 / full.dj.max(f64::MIN_POSITIVE));
    if slope(safe) >= 0.0 {
        return safe;
    }
    let (mut low, mut high) = (0.0, safe);
    for _ in 0..40 {
        let mid = 0.5 * (low + high);
        if slope(mid) > 0.0 {
            low = mid;
        } else {
            high = mid;
        }
    }
    low
}

fn measure(
    active: &Active,
    s: usize,
    prior: &[f64],
    weights: &[f64],
) -> Option<RelaxationSolution> {
    let k = active.k;
    let mut m = prior.to_vec();
    for (i, &w) in weights.iter().enumerate() {
        if w > 0.0 {
            spd::add_outer(&mut m, active.row(i), w);
        }
    }
    let point = active.criterion.evaluate_at(&m, k)?;
    let slope = if active.criterion == Criterion::D {
        point.inverse.clone()
    } else {
        point.slope(k)
    };
    let mut u = vec![0.0; k];
    let d: Vec<f64> = (0..active.len())
        .map(|i| {
            spd::times(&slope, active.row(i), &mut u);
            spd::dot(active.row(i), &u)
        })
        .collect();
    let prior_trace = spd::trace_of_product(&slope, prior);
    let (top, _) = top_sum(
        active.group.iter().copied().zip(d.iter().copied()),
        active.n_groups,
        s,
    );
    let gap = ((prior_trace + top) / active.criterion.degree(k) as f64).ln();
    Some(RelaxationSolution {
        weights: Vec::new(),
        point,
        prior_trace,
        d,
        gap,
        sweeps: 0,
    })
}
