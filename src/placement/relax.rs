//! The relaxation: weights in place of gauges, `max log det(P + sum w_i a_i a_i')` with `sum w = s`, `w >= 0` and at most 1 in each group.
//!
//! Weight moves between pairs of rows by exact line search (vertex exchange, visited in the order of the randomised exchange of
//! Harman, Filova and Richtarik, J. Am. Stat. Assoc. 115 (2020), without the chance). Rows of a group share a weight of at most 1: one
//! row for each distinct gauge, or all the angles of a place, or all the places within a spacing. Every exchange direction of that set is
//! a pair, so the search cannot stop short of the optimum.

use crate::linalg::spd;

/// The rows a relaxation works on.
#[derive(Clone, Debug, Default)]
pub struct Active {
    /// Number of columns.
    pub k: usize,
    /// `n x k` by rows.
    pub rows: Vec<f64>,
    /// Group of each row, `0 .. n_groups`.
    pub group: Vec<u32>,
    /// Number of groups.
    pub n_groups: usize,
}

impl Active {
    /// Number of rows.
    pub fn len(&self) -> usize {
        self.group.len()
    }

    /// True without rows.
    pub fn is_empty(&self) -> bool {
        self.group.is_empty()
    }

    /// Row `i`.
    pub fn row(&self, i: usize) -> &[f64] {
        &self.rows[i * self.k..(i + 1) * self.k]
    }
}

/// A solution of the relaxation on its rows.
#[derive(Clone, Debug)]
pub struct Relaxed {
    /// Weights.
    pub weights: Vec<f64>,
    /// Inverse of the lower Cholesky factor of `M`.
    pub linv: Vec<f64>,
    /// `M^-1`.
    pub minv: Vec<f64>,
    /// `log det M`.
    pub log_det: f64,
    /// `tr(M^-1 P)`.
    pub prior_trace: f64,
    /// Variances of the rows.
    pub d: Vec<f64>,
    /// Upper bound of `log det` over these rows, less `log_det`, per load.
    pub gap: f64,
}

/// Sum of the `s` largest group maxima, and the least of those `s`.
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

/// Solves the relaxation from `weights` to a gap (per load) of `tolerance`; `None` where the information matrix is singular.
pub fn relax(
    active: &Active,
    s: usize,
    prior: &[f64],
    mut weights: Vec<f64>,
    tolerance: f64,
    sweeps: usize,
) -> Option<Relaxed> {
    let (k, n) = (active.k, active.len());
    let mut state = measure(active, s, prior, &weights)?;
    let mut slack = vec![1.0; active.n_groups];
    let mut u = vec![0.0; k];
    let mut v = vec![0.0; k];
    for _ in 0..sweeps {
        if state.gap <= tolerance {
            break;
        }
        slack.fill(1.0);
        for (&g, &w) in active.group.iter().zip(&weights) {
            slack[g as usize] -= w;
        }
        let mut incoming: Vec<u32> = (0..n as u32).collect();
        let d = &state.d;
        let by_d = |a: &u32, b: &u32| d[*b as usize].total_cmp(&d[*a as usize]).then(a.cmp(b));
        let keep = (4 * k + s / 2).max(32).min(n);
        incoming.retain(|&i| {
            let i = i as usize;
            weights[i] < 1.0 - FULL
                && (slack[active.group[i] as usize] > FULL || active.n_groups < n)
        });
        if incoming.len() > keep {
            incoming.select_nth_unstable_by(keep - 1, by_d);
            incoming.truncate(keep);
        }
        incoming.sort_unstable_by(by_d);
        let mut outgoing: Vec<u32> = (0..n as u32)
            .filter(|&i| weights[i as usize] > 0.0)
            .collect();
        outgoing.sort_unstable_by(|a, b| by_d(b, a));
        let mut minv = std::mem::take(&mut state.minv);
        for &i in &incoming {
            let (i, gi) = (i as usize, active.group[i as usize] as usize);
            let ai = active.row(i);
            spd::times(&minv, ai, &mut u);
            let mut di = spd::dot(ai, &u);
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
                spd::times(&minv, aj, &mut v);
                let (dj, dij) = (spd::dot(aj, &v), spd::dot(aj, &u));
                if di <= dj {
                    continue;
                }
                let curvature = di * dj - dij * dij;
                let step = if curvature > 0.0 {
                    ((di - dj) / (2.0 * curvature)).min(cap)
                } else {
                    cap
                };
                // (M + step (a_i a_i' - a_j a_j'))^-1 by the formula of Sherman, Morrison and Woodbury for two columns.
                let (p, q) = (1.0 + step * di, 1.0 - step * dj);
                let det = p * q + step * step * dij * dij;
                if det <= 0.0 {
                    continue;
                }
                let (cu, cv, cx) = (step * q / det, -step * p / det, step * step * dij / det);
                for r in 0..k {
                    let (ur, vr) = (u[r], v[r]);
                    let (x, y) = (cu * ur + cx * vr, cv * vr + cx * ur);
                    for (c, m) in minv[r * k..(r + 1) * k].iter_mut().enumerate() {
                        *m -= x * u[c] + y * v[c];
                    }
                }
                weights[i] += step;
                weights[j] = if step >= weights[j] {
                    0.0
                } else {
                    weights[j] - step
                };
                slack[gi] -= step;
                slack[gj] += step;
                spd::times(&minv, ai, &mut u);
                di = spd::dot(ai, &u);
            }
        }
        state = measure(active, s, prior, &weights)?;
    }
    state.weights = weights;
    Some(state)
}

/// Weight under which a row or a group counts as full.
const FULL: f64 = 1e-12;
/// Partners a row tries in one sweep; the next sweep sorts again.
const MAX_TRIES: usize = 48;

fn measure(active: &Active, s: usize, prior: &[f64], weights: &[f64]) -> Option<Relaxed> {
    let k = active.k;
    let mut m = prior.to_vec();
    for (i, &w) in weights.iter().enumerate() {
        if w > 0.0 {
            spd::add_outer(&mut m, active.row(i), w);
        }
    }
    let l = spd::cholesky(&m, k)?;
    let linv = spd::inverse_lower(&l, k);
    let minv = spd::gram_of_lower(&linv, k);
    let mut u = vec![0.0; k];
    let d: Vec<f64> = (0..active.len())
        .map(|i| {
            spd::times(&minv, active.row(i), &mut u);
            spd::dot(active.row(i), &u)
        })
        .collect();
    let prior_trace = spd::trace_of_product(&minv, prior);
    let (top, _) = top_sum(
        active.group.iter().copied().zip(d.iter().copied()),
        active.n_groups,
        s,
    );
    let gap = ((prior_trace + top) / k as f64).ln();
    Some(Relaxed {
        weights: Vec::new(),
        linv,
        minv,
        log_det: spd::log_det(&l, k),
        prior_trace,
        d,
        gap,
    })
}
