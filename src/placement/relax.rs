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
    /// Leading columns that are nuisance loads: the criterion is `log det M - log det M_nn` (Ds); 0: `log det M` (D).
    pub nuisance: usize,
    /// `n x k` by rows.
    pub rows: Vec<f64>,
    /// Group of each row, `0 .. n_groups`.
    pub group: Vec<u32>,
    /// Number of groups.
    pub n_groups: usize,
}

impl Active {
    /// Number of columns asked for: the degree of the criterion.
    pub fn wanted(&self) -> usize {
        self.k - self.nuisance
    }

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
    /// Inverse of the lower Cholesky factor of `M`, rows of nuisance columns zeroed: `d = |linv a|^2` is the slope of the criterion.
    pub linv: Vec<f64>,
    /// `M^-1`.
    pub minv: Vec<f64>,
    /// `M_nn^-1`, padded with zeros to `k x k`; empty without nuisance columns.
    pub ninv: Vec<f64>,
    /// The criterion.
    pub log_det: f64,
    /// `tr(G P)`, `G = linv' linv`.
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
    let (mut nu, mut nv) = (vec![0.0; k], vec![0.0; k]);
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
        let mut ninv = std::mem::take(&mut state.ninv);
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
                let part = (!ninv.is_empty()).then(|| Pair::new(&ninv, ai, aj, &mut nu, &mut nv));
                let step = best_step(&full, part.as_ref(), cap);
                if step <= 0.0 || full.det(step) <= 0.0 {
                    continue;
                }
                full.apply(&mut minv, step, &u, &v);
                if let Some(part) = part {
                    part.apply(&mut ninv, step, &nu, &nv);
                }
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
    Some(state)
}

/// Weight under which a row or a group counts as full.
const FULL: f64 = 1e-12;
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

    /// The inverse after the move, by the formula of Sherman, Morrison and Woodbury for two columns.
    fn apply(&self, inverse: &mut [f64], t: f64, u: &[f64], v: &[f64]) {
        let k = u.len();
        let det = self.det(t);
        let (cu, cv) = (
            t * (1.0 - t * self.dj) / det,
            -t * (1.0 + t * self.di) / det,
        );
        let cx = t * t * self.dij / det;
        for r in 0..k {
            let (x, y) = (cu * u[r] + cx * v[r], cv * v[r] + cx * u[r]);
            for (c, m) in inverse[r * k..(r + 1) * k].iter_mut().enumerate() {
                *m -= x * u[c] + y * v[c];
            }
        }
    }
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

/// `log det M - log det M_nn` with the factors it takes: `linv` (nuisance rows zeroed), `M^-1`, `M_nn^-1` padded.
pub fn criterion(
    m: &[f64],
    k: usize,
    nuisance: usize,
) -> Option<(f64, Vec<f64>, Vec<f64>, Vec<f64>)> {
    let l = spd::cholesky(m, k)?;
    let mut linv = spd::inverse_lower(&l, k);
    let minv = spd::gram_of_lower(&linv, k);
    if nuisance == 0 {
        return Some((spd::log_det(&l, k), linv, minv, Vec::new()));
    }
    // The leading block of the factor is the factor of the leading block.
    let mut head = linv.clone();
    head[nuisance * k..].fill(0.0);
    let ninv = spd::gram_of_lower(&head, k);
    linv[..nuisance * k].fill(0.0);
    let value = 2.0 * (nuisance..k).map(|i| l[i * k + i].ln()).sum::<f64>();
    Some((value, linv, minv, ninv))
}

fn measure(active: &Active, s: usize, prior: &[f64], weights: &[f64]) -> Option<Relaxed> {
    let k = active.k;
    let mut m = prior.to_vec();
    for (i, &w) in weights.iter().enumerate() {
        if w > 0.0 {
            spd::add_outer(&mut m, active.row(i), w);
        }
    }
    let (value, linv, minv, ninv) = criterion(&m, k, active.nuisance)?;
    let slope = if active.nuisance > 0 {
        spd::gram_of_lower(&linv, k)
    } else {
        minv.clone()
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
    let gap = ((prior_trace + top) / active.wanted() as f64).ln();
    Some(Relaxed {
        weights: Vec::new(),
        linv,
        minv,
        ninv,
        log_det: value,
        prior_trace,
        d,
        gap,
    })
}
