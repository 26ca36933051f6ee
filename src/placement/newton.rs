//! A Newton step of the relaxation for D.
//!
//! Near the optimum `ln det M(w)` has the slopes `d_i` and the second derivatives `-d_ij^2`. This quadratic model is maximised within the bounds of
//! the weights by moving weight between pairs of rows. Each move costs one row of the matrix. The Newton step goes towards the resulting weights.

use super::criterion::Criterion;
use super::relaxation_solution::{Active, FULL, RelaxationSolution, pulls};
use crate::linalg::spd;

/// Rows without weight that join a step at most, by loads.
const JOIN: usize = 3;
/// Halvings of a step.
const HALVINGS: usize = 6;
/// Moves of weight, by rows of the model, after which it is left as it is.
const MOVES: usize = 20;
/// Share of the first difference of slopes at which the model counts as solved.
const SOLVED: f64 = 5e-3;

/// Returns better weights than `weights`, at which `state` was computed. `None` if the step gains nothing.
pub(super) fn step(
    active: &Active,
    prior: &[f64],
    weights: &[f64],
    state: &RelaxationSolution,
) -> Option<Vec<f64>> {
    let mut rows: Vec<usize> = (0..active.len()).filter(|&i| weights[i] > 0.0).collect();
    let mut out: Vec<usize> = (0..active.len()).filter(|&i| weights[i] <= 0.0).collect();
    let pull = pulls(active, weights, &state.d);
    let dear = |a: &usize, b: &usize| pull[*b].total_cmp(&pull[*a]).then(a.cmp(b));
    let join = (JOIN * active.k).min(out.len());
    if join < out.len() && join > 0 {
        out.select_nth_unstable_by(join - 1, dear);
    }
    rows.extend(&out[..join]);
    rows.sort_unstable();
    let model = Model::from_rows(active, state, &rows);
    let mut aim = weights.to_vec();
    model.solve(active, &rows, &mut aim);
    let mut size = 1.0;
    for _ in 0..HALVINGS {
        let next: Vec<f64> = weights
            .iter()
            .zip(&aim)
            .map(|(w, a)| w + size * (a - w))
            .collect();
        if value(active, prior, &next).is_some_and(|v| v > state.value()) {
            return Some(if size < 1.0 { next } else { aim });
        }
        size *= 0.4;
    }
    None
}

/// Slopes and second derivatives of the criterion on some rows.
struct Model {
    slope: Vec<f64>,
    /// `d_ij^2`, by rows.
    curve: Vec<f64>,
}

impl Model {
    fn from_rows(active: &Active, state: &RelaxationSolution, rows: &[usize]) -> Self {
        let (k, f) = (active.k, rows.len());
        let mut v = vec![0.0; f * k];
        for (&i, out) in rows.iter().zip(v.chunks_exact_mut(k)) {
            spd::times(&state.point.root, active.row(i), out);
        }
        let mut curve = vec![0.0; f * f];
        pulp::Arch::new().dispatch(|| {
            for p in 0..f {
                for q in 0..=p {
                    let x = spd::dot(&v[p * k..(p + 1) * k], &v[q * k..(q + 1) * k]);
                    curve[p * f + q] = x * x;
                    curve[q * f + p] = x * x;
                }
            }
        });
        Self {
            slope: rows.iter().map(|&i| state.d[i]).collect(),
            curve,
        }
    }

    /// Moves weight to where the model is largest.
    fn solve(&self, active: &Active, rows: &[usize], weights: &mut [f64]) {
        let f = rows.len();
        let mut slope = self.slope.clone();
        let mut slack = vec![1.0; active.n_groups];
        for (&g, &w) in active.group.iter().zip(&*weights) {
            slack[g as usize] -= w;
        }
        let group: Vec<usize> = rows.iter().map(|&i| active.group[i] as usize).collect();
        let mut w: Vec<f64> = rows.iter().map(|&i| weights[i]).collect();
        let mut shared = vec![0u32; active.n_groups];
        group.iter().for_each(|&g| shared[g] += 1);
        let mut first = None;
        for _ in 0..MOVES * f {
            let Some((i, j)) = self.pair(&slope, &w, &group, &slack, &shared) else {
                break;
            };
            let pull = slope[i] - slope[j];
            if pull <= SOLVED * *first.get_or_insert(pull) {
                break;
            }
            let cap = if group[i] == group[j] {
                w[j]
            } else {
                w[j].min(slack[group[i]])
            };
            let bend = self.bend(i, j);
            let t = if bend > 0.0 {
                (pull / bend).min(cap)
            } else {
                cap
            };
            w[i] += t;
            w[j] = if t >= w[j] { 0.0 } else { w[j] - t };
            slack[group[i]] -= t;
            slack[group[j]] += t;
            let (a, b) = (
                &self.curve[i * f..(i + 1) * f],
                &self.curve[j * f..(j + 1) * f],
            );
            for ((s, x), y) in slope.iter_mut().zip(a).zip(b) {
                *s -= t * (x - y);
            }
        }
        for (&i, &w) in rows.iter().zip(&w) {
            weights[i] = w;
        }
    }

    fn bend(&self, i: usize, j: usize) -> f64 {
        let f = self.slope.len();
        self.curve[i * f + i] + self.curve[j * f + j] - 2.0 * self.curve[i * f + j]
    }

    /// Returns the pair of rows whose transfer of weight raises the model most. The receiving row has the largest slope of all rows that can take
    /// weight. Alternatively, both rows are in one full group.
    fn pair(
        &self,
        slope: &[f64],
        w: &[f64],
        group: &[usize],
        slack: &[f64],
        shared: &[u32],
    ) -> Option<(usize, usize)> {
        let f = slope.len();
        let mut best = (0.0, None);
        let mut judge = |i: usize, among: &dyn Fn(usize) -> bool| {
            for j in 0..f {
                let pull = slope[i] - slope[j];
                if w[j] > 0.0 && pull > 0.0 && among(j) {
                    let gain = pull * pull / self.bend(i, j).max(f64::MIN_POSITIVE);
                    if gain > best.0 {
                        best = (gain, Some((i, j)));
                    }
                }
            }
        };
        let dear = |a: &usize, b: &usize| slope[*a].total_cmp(&slope[*b]).then(b.cmp(a));
        if let Some(i) = (0..f).filter(|&i| slack[group[i]] > FULL).max_by(dear) {
            judge(i, &|_| true);
        }
        // In the full groups, find the largest difference of slopes between a row and a row with weight.
        let full = |i: &usize| slack[group[*i]] <= FULL && shared[group[*i]] > 1;
        if !(0..f).any(|i| full(&i)) {
            return best.1;
        }
        let mut least = vec![f64::INFINITY; slack.len()];
        (0..f)
            .filter(full)
            .filter(|&i| w[i] > 0.0)
            .for_each(|i| least[group[i]] = least[group[i]].min(slope[i]));
        let spread = |i: usize| slope[i] - least[group[i]];
        if let Some(i) = (0..f)
            .filter(full)
            .max_by(|&a, &b| spread(a).total_cmp(&spread(b)))
        {
            judge(i, &|j| group[j] == group[i]);
        }
        best.1
    }
}

fn value(active: &Active, prior: &[f64], weights: &[f64]) -> Option<f64> {
    let mut m = prior.to_vec();
    for (i, &w) in weights.iter().enumerate() {
        if w > 0.0 {
            spd::add_outer(&mut m, active.row(i), w);
        }
    }
    Criterion::D.evaluate_at(&m, active.k).map(|p| p.value)
}
