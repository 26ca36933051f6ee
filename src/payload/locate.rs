//! Weight and place of a payload from gauges of which some are wrong, and from wheel forces: expectation and maximisation.
//!
//! Unknowns of a run: wheel forces `R` (where they are measured), `p = (F, F dx, F dy)` (`F` alone where the place is known), and the
//! error `c` of the model as a whole. Every gauge has one noise level in all runs: as stated, or up to 10^4 times that.

use super::evidence::{PayloadModel, PayloadRun, Place, WeighSpec};
use crate::linalg::Matrix;
use crate::recovery::fit;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Noise levels of a gauge.
const N_LEVELS: usize = 25;
/// The largest.
const LARGEST_FACTOR: f64 = 1.0e4;
/// Prior probability that the stated noise is right.
const PRIOR_AS_STATED: f64 = 0.6;
/// A gauge counts as good up to this factor on its stated noise.
const GOOD_FACTOR: f64 = 3.0;
/// Random starts: gauges believed at first, all others doubted.
const STARTS: usize = 24;
/// Steps of a start, and of the best of them.
const STEPS: [usize; 2] = [8, 60];
/// Weight of a doubted gauge at a start.
const DOUBTED: f64 = 1e-6;
/// Equilibrium is exact: its standard deviation as a share of that of a wheel force.
const EXACT: f64 = 1e-3;
/// Standard deviation of the place where only the region is known, in half widths.
const REGION_SD: f64 = 1.0;

/// One run as found.
#[derive(Clone, Debug)]
pub struct Located {
    /// `(F, F dx, F dy)`.
    pub p: [f64; 3],
    /// Covariance of it by rows, 3 x 3.
    pub covariance: [f64; 9],
    /// Wheel forces as fitted or as the floor gives them.
    pub reactions: Vec<f64>,
}

/// All runs and what became of the gauges.
#[derive(Clone, Debug)]
pub struct Location {
    /// By run.
    pub runs: Vec<Located>,
    /// Probability that a gauge is as good as stated.
    pub good: Vec<f64>,
}

/// Whether equilibrium ties measured wheel forces to the payload.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Balance {
    /// It does.
    Kept,
    /// It is left open: what strain says of the payload, the wheel forces as measured.
    Open,
}

struct State {
    runs: Vec<Located>,
    weights: Vec<f64>,
    good: Vec<f64>,
    log_likelihood: f64,
}

/// The most probable answer over many starts; `None` where the readings leave the weight open.
pub fn locate(
    model: &PayloadModel,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    balance: Balance,
) -> Option<Location> {
    let n = model.gauges.len();
    let unknown = if spec.place == Place::Free { 3 } else { 1 };
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let readable: Vec<usize> = (0..n)
        .filter(|g| {
            runs.iter()
                .any(|r| r.strain.get(*g).is_some_and(|v| v.is_finite()))
        })
        .collect();
    let mut starts: Vec<Vec<f64>> = vec![vec![1.0; n]];
    if runs.iter().any(|r| !r.reactions.is_empty()) {
        starts.push(vec![DOUBTED; n]);
    }
    for _ in 0..STARTS {
        let mut w = vec![DOUBTED; n];
        for _ in 0..unknown + 2 {
            if let Some(g) = readable.get(random.random_range(0..readable.len().max(1))) {
                w[*g] = 1.0;
            }
        }
        starts.push(w);
    }
    let states: Vec<(Vec<f64>, f64)> = starts
        .into_par_iter()
        .filter_map(|w| expectation_maximisation(model, runs, spec, balance, w, STEPS[0]))
        .map(|s| (s.weights, s.log_likelihood))
        .collect();
    let (weights, _) = states
        .into_iter()
        .fold(None::<(Vec<f64>, f64)>, |best, s| match best {
            Some(b) if b.1 >= s.1 => Some(b),
            _ => Some(s),
        })?;
    let end = expectation_maximisation(model, runs, spec, balance, weights, STEPS[1])?;
    Some(Location {
        runs: end.runs,
        good: end.good,
    })
}

/// Whether a run by itself leaves no unknown open.
pub fn tells(model: &PayloadModel, run: &PayloadRun, spec: &WeighSpec) -> bool {
    let weights = vec![1.0; model.gauges.len()];
    let nothing = Located {
        p: [0.0; 3],
        covariance: [0.0; 9],
        reactions: Vec::new(),
    };
    solve_run(model, run, spec, Balance::Kept, &weights, &nothing).is_some()
}

fn expectation_maximisation(
    model: &PayloadModel,
    runs: &[PayloadRun],
    spec: &WeighSpec,
    balance: Balance,
    mut weights: Vec<f64>,
    steps: usize,
) -> Option<State> {
    let mut found: Vec<Located> = runs
        .iter()
        .map(|_| Located {
            p: [0.0; 3],
            covariance: [0.0; 9],
            reactions: Vec::new(),
        })
        .collect();
    let mut before = f64::NEG_INFINITY;
    let mut end = None;
    for _ in 0..steps {
        let mut terms: Vec<[f64; N_LEVELS]> = vec![prior(); model.gauges.len()];
        let mut wheels = 0.0;
        for (run, old) in runs.iter().zip(found.iter_mut()) {
            let solved = solve_run(model, run, spec, balance, &weights, old)?;
            wheels += solved.wheels;
            for (g, variance, square) in solved.gauges {
                for (k, t) in terms[g].iter_mut().enumerate() {
                    let v = variance * level(k).powi(2);
                    *t -= 0.5 * (square / v + (TAU * v).ln());
                }
            }
            *old = solved.found;
        }
        let log_likelihood = wheels + terms.iter().map(|t| log_sum(t)).sum::<f64>();
        let good_levels = (0..N_LEVELS)
            .take_while(|k| level(*k) <= GOOD_FACTOR)
            .count();
        let mut good = Vec::with_capacity(terms.len());
        for (w, t) in weights.iter_mut().zip(&terms) {
            let total = log_sum(t);
            *w = t
                .iter()
                .enumerate()
                .map(|(k, t)| (t - total).exp() / level(k).powi(2))
                .sum();
            good.push((log_sum(&t[..good_levels]) - total).exp());
        }
        let settled = (log_likelihood - before).abs() < 1e-9 * log_likelihood.abs().max(1.0);
        before = log_likelihood;
        end = Some(State {
            runs: found.clone(),
            weights: weights.clone(),
            good,
            log_likelihood,
        });
        if settled {
            break;
        }
    }
    end
}

fn level(k: usize) -> f64 {
    LARGEST_FACTOR.powf(k as f64 / (N_LEVELS - 1) as f64)
}

fn prior() -> [f64; N_LEVELS] {
    std::array::from_fn(|k| {
        if k == 0 {
            PRIOR_AS_STATED.ln()
        } else {
            ((1.0 - PRIOR_AS_STATED) / (N_LEVELS - 1) as f64).ln()
        }
    })
}

fn log_sum(t: &[f64]) -> f64 {
    let top = t.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    top + t.iter().map(|v| (v - top).exp()).sum::<f64>().ln()
}

/// Standard deviation of a wheel force that stays as the floor gives it.
const SHUT: f64 = 1e-9;

/// Patterns of wheel forces of unit length without resultant force and moments: what equilibrium leaves open.
fn balanced_patterns(arms: &[[f64; 2]]) -> Vec<Vec<f64>> {
    let n = arms.len();
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let rigid = [
        vec![1.0; n],
        arms.iter().map(|a| a[0]).collect(),
        arms.iter().map(|a| a[1]).collect(),
    ];
    let units = (0..n).map(|i| (0..n).map(|w| f64::from(u8::from(w == i))).collect());
    for (i, mut v) in rigid.into_iter().chain(units).enumerate() {
        let size = v.iter().map(|x: &f64| x * x).sum::<f64>().sqrt();
        for _ in 0..2 {
            for b in &basis {
                let along: f64 = v.iter().zip(b).map(|(x, y)| x * y).sum();
                v.iter_mut().zip(b).for_each(|(x, y)| *x -= along * y);
            }
        }
        let left = v.iter().map(|x| x * x).sum::<f64>().sqrt();
        if left > 1e-6 * size && left > 0.0 {
            basis.push(v.iter().map(|x| x / left).collect());
        } else if i < 3 {
            return Vec::new();
        }
    }
    basis.split_off(3.min(basis.len()))
}

struct Solved {
    found: Located,
    /// Gauge, stated variance, expected square of its residual.
    gauges: Vec<(usize, f64, f64)>,
    /// Log-likelihood of the wheel forces.
    wheels: f64,
}

/// Rows of one run, weighted, solved.
fn solve_run(
    model: &PayloadModel,
    run: &PayloadRun,
    spec: &WeighSpec,
    balance: Balance,
    weights: &[f64],
    old: &Located,
) -> Option<Solved> {
    let n_wheels = if run.reactions.is_empty() {
        0
    } else {
        run.reactions.len()
    };
    let q = if spec.place == Place::Free { 3 } else { 1 };
    let (at_p, at_c) = (n_wheels, n_wheels + q);
    // How a floor shares the payload is the model's word: patterns that balance among themselves stay open to its uncertainty.
    let patterns = match &model.arms {
        Some(arms) if n_wheels == 0 && spec.model_rel > 0.0 => balanced_patterns(arms),
        _ => Vec::new(),
    };
    // What all gauges share: the model as a whole where the floor gives the wheel forces, else every wheel's and part's column of it.
    let n_common = if n_wheels > 0 { n_wheels + 3 } else { 1 };
    let at_z = at_c + n_common;
    let width = at_z + patterns.len();
    let known = [1.0, run.shift[0], run.shift[1]];
    // Entry of `(F, F dx, F dy)` columns for the unknowns in use.
    let fold = |c: [f64; 3]| -> Vec<f64> {
        if q == 3 {
            c.to_vec()
        } else {
            vec![(0..3).map(|k| c[k] * known[k]).sum()]
        }
    };
    let mut rows: Vec<(Vec<f64>, f64, f64, Option<usize>)> = Vec::new();
    for g in 0..model.gauges.len() {
        let Some(y) = run.strain.get(g).copied().filter(|v| v.is_finite()) else {
            continue;
        };
        let mut row = vec![0.0; width];
        let mut column: [f64; 3] = std::array::from_fn(|k| model.payload[(g, k)]);
        let mut parts: f64 = (0..3)
            .map(|k| (model.payload[(g, k)] * old.p[k]).powi(2))
            .sum();
        for (w, r) in old.reactions.iter().enumerate() {
            parts += (model.wheels[(g, w)] * r).powi(2);
        }
        if n_wheels > 0 {
            for w in 0..n_wheels {
                row[w] = model.wheels[(g, w)];
            }
        } else {
            let floor = model.floor.as_ref()?;
            for (k, c) in column.iter_mut().enumerate() {
                *c += (0..floor.nrows())
                    .map(|w| model.wheels[(g, w)] * floor[(w, k)])
                    .sum::<f64>();
            }
        }
        for (k, c) in fold(column).into_iter().enumerate() {
            row[at_p + k] = c;
        }
        if n_wheels > 0 {
            for (w, r) in old.reactions.iter().enumerate().take(n_wheels) {
                row[at_c + w] = model.wheels[(g, w)] * r;
            }
            for k in 0..3 {
                row[at_c + n_wheels + k] = column[k] * old.p[k];
            }
        } else {
            row[at_c] = (0..3).map(|k| column[k] * old.p[k]).sum();
        }
        for (z, pattern) in patterns.iter().enumerate() {
            row[at_z + z] = pattern
                .iter()
                .enumerate()
                .map(|(w, share)| model.wheels[(g, w)] * share)
                .sum();
        }
        let own = run.sigma.get(g).copied().unwrap_or(0.0);
        let variance = own * own + spec.model_rel.powi(2) * parts;
        if variance > 0.0 {
            rows.push((row, y, variance, Some(g)));
        }
    }
    let wheel_variance = spec.reaction_sigma.powi(2);
    for (w, y) in run.reactions.iter().enumerate().filter(|r| r.1.is_finite()) {
        let mut row = vec![0.0; width];
        row[w] = 1.0;
        rows.push((row, *y, wheel_variance, None));
    }
    if n_wheels > 0 && balance == Balance::Kept {
        let exact = wheel_variance * EXACT * EXACT;
        let mut equations: Vec<([f64; 3], Vec<f64>, f64)> =
            vec![([-1.0, 0.0, 0.0], vec![1.0; n_wheels], 1.0)];
        // Known places check the moments instead of bending the forces to them.
        if let (Some(arms), Place::Free) = (&model.arms, spec.place) {
            for axis in 0..2 {
                let mut c = [0.0; 3];
                c[1 + axis] = -1.0;
                let arm: Vec<f64> = arms.iter().map(|a| a[axis]).collect();
                let size = arm.iter().fold(0.0_f64, |s, a| s.max(a.abs())).max(1e-12);
                equations.push((c, arm, size));
            }
        }
        for (c, arm, size) in equations {
            let mut row = vec![0.0; width];
            row[..n_wheels].copy_from_slice(&arm);
            for (k, c) in fold(c).into_iter().enumerate() {
                row[at_p + k] = c;
            }
            rows.push((row, 0.0, exact * size * size, None));
        }
    }
    let share = spec.model_rel * old.p[0].abs().max(f64::MIN_POSITIVE);
    for z in 0..patterns.len() {
        let mut row = vec![0.0; width];
        row[at_z + z] = 1.0;
        // Before the first answer there is no size to compare with: the patterns stay shut.
        let sd = if old.p[0] == 0.0 { SHUT } else { share };
        rows.push((row, 0.0, sd * sd, None));
    }
    if let (Some(region), 3) = (spec.region, q) {
        let size = old.p[0].abs();
        for (axis, [low, high]) in region.into_iter().enumerate() {
            let half = (high - low) / 2.0;
            if size > 0.0 && half > 0.0 {
                let mut row = vec![0.0; width];
                row[at_p + 1 + axis] = 1.0;
                row[at_p] = -(low + high) / 2.0;
                rows.push((row, 0.0, (size * half * REGION_SD).powi(2), None));
            }
        }
    }
    if spec.model_rel == 0.0 {
        for r in &mut rows {
            r.0[at_c..at_z].fill(0.0);
        }
    }
    for c in at_c..at_z {
        let mut row = vec![0.0; width];
        row[c] = 1.0;
        let sd = if spec.model_rel > 0.0 {
            spec.model_rel
        } else {
            1.0
        };
        rows.push((row, 0.0, sd * sd, None));
    }
    let a = Matrix::from_fn(rows.len(), width, |i, l| rows[i].0[l]);
    let y: Vec<f64> = rows.iter().map(|r| r.1).collect();
    let variances: Vec<f64> = rows
        .iter()
        .map(|r| r.2 / r.3.map_or(1.0, |g| weights[g]))
        .collect();
    let scales: Vec<f64> = (0..width)
        .map(|l| {
            let size = (0..rows.len())
                .map(|i| a[(i, l)].powi(2) / variances[i])
                .sum::<f64>()
                .sqrt();
            if size > 0.0 { 1.0 / size } else { 1.0 }
        })
        .collect();
    let solved = fit(&a, &y, &variances, &vec![None; width], &scales)?;
    let mut gauges = Vec::new();
    let mut wheels = 0.0;
    for (i, (row, y, variance, gauge)) in rows.iter().enumerate() {
        let residual = y - row.iter().zip(&solved.f).map(|(a, f)| a * f).sum::<f64>();
        match gauge {
            Some(g) => {
                let spread = solved.leverage[i] * variances[i];
                gauges.push((*g, *variance, residual * residual + spread));
            }
            None => wheels -= 0.5 * residual * residual / variance,
        }
    }
    // Back to (F, F dx, F dy).
    let back = |k: usize| -> Vec<(usize, f64)> {
        if q == 3 {
            vec![(at_p + k, 1.0)]
        } else {
            vec![(at_p, known[k])]
        }
    };
    let value = |k: usize| back(k).iter().map(|(i, c)| c * solved.f[*i]).sum::<f64>();
    let p: [f64; 3] = std::array::from_fn(value);
    let mut covariance = [0.0; 9];
    for i in 0..3 {
        for j in 0..3 {
            for (a, ca) in back(i) {
                for (b, cb) in back(j) {
                    covariance[3 * i + j] += ca * cb * solved.covariance[(a, b)];
                }
            }
        }
    }
    let reactions = if n_wheels > 0 {
        solved.f[..n_wheels].to_vec()
    } else {
        model.floor.as_ref().map_or_else(Vec::new, |floor| {
            (0..floor.nrows())
                .map(|w| (0..3).map(|k| floor[(w, k)] * p[k]).sum())
                .collect()
        })
    };
    Some(Solved {
        found: Located {
            p,
            covariance,
            reactions,
        },
        gauges,
        wheels,
    })
}
