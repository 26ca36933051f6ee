//! Fits parameters by weighted least squares over all equations, with known values fixed and bounds applied.

use super::equations::Equation;
use crate::linalg::tall::{Solution, Triangle, solve, triangle};

/// Range of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterRange {
    /// Any value.
    Free,
    /// A value within limits.
    Within(f64, f64),
    /// Exactly this value.
    Known(f64),
}

/// A fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// Value of each parameter; NaN if no equation contains it.
    pub values: Vec<f64>,
    /// Weight of each equation: the reciprocal of its residual RMS.
    pub weights: Vec<f64>,
    /// Residual RMS of each equation, in the unit of the equation.
    pub residual_rms: Vec<f64>,
    /// Estimated parameters, in the order of `solution`.
    pub free: Vec<usize>,
    /// Parameters at a bound.
    pub active: Vec<usize>,
    /// The weighted problem in the free parameters.
    pub solution: Solution,
}

/// Rounds of weighting by residuals; the weights settle to a per cent in two.
const ROUNDS: usize = 5;
/// A residual counts for at least this share of an equation's largest term: noise-free records must not divide by zero.
const RESIDUAL_FLOOR: f64 = 1e-6;

/// Returns the parameters that minimise the weighted squared residuals of all equations.
///
/// Each equation is weighted by one over its residual RMS, found by repeating the fit. Equations without outside force can't set a scale. If the
/// equations with outside force are sufficient, the first round uses only these.
pub fn fit(equations: &[Equation], allowed: &[ParameterRange]) -> Fit {
    let n = allowed.len();
    let triangles: Vec<Triangle> = equations
        .iter()
        .map(|e| {
            let mut columns: Vec<(usize, &[f64])> =
                e.columns.iter().map(|(i, c)| (*i, c.as_slice())).collect();
            columns.push((n, &e.target));
            triangle(&columns)
        })
        .collect();
    let scale: Vec<f64> = triangles
        .iter()
        .map(|t| t.norm(&unit(n + 1, n)) / (t.n_rows.max(1) as f64).sqrt())
        .collect();
    let largest = scale.iter().fold(0.0f64, |a, b| a.max(*b));
    let mut weights: Vec<f64> = scale
        .iter()
        .map(|s| if *s > 1e-9 * largest { 1.0 / s } else { 0.0 })
        .collect();
    let held = |i: usize| matches!(allowed[i], ParameterRange::Known(v) if v != 0.0);
    if largest == 0.0 || weights.contains(&0.0) && !suffices(&triangles, &weights, allowed) {
        // Scale equations without outside force by the terms of known parameters, or by their columns.
        for (w, t) in weights
            .iter_mut()
            .zip(&triangles)
            .filter(|(w, _)| **w == 0.0)
        {
            let known: Vec<f64> = (0..=n)
                .map(|i| {
                    if i < n && held(i) {
                        known_value(allowed[i])
                    } else {
                        0.0
                    }
                })
                .collect();
            let size = t.norm(&known) / (t.n_rows.max(1) as f64).sqrt();
            *w = if size > 0.0 { 1.0 / size } else { 0.0 };
        }
        if weights.iter().all(|w| *w == 0.0) {
            weights.fill(1.0);
        }
    }
    let mut result = solve_bounded(&triangles, &weights, allowed);
    let mut residual_rms = vec![0.0; equations.len()];
    for round in 0..ROUNDS {
        for ((r, w), t) in residual_rms.iter_mut().zip(&mut weights).zip(&triangles) {
            let rows = (t.n_rows.max(1) as f64).sqrt();
            let mut x: Vec<f64> = result
                .0
                .iter()
                .map(|v| if v.is_finite() { *v } else { 0.0 })
                .collect();
            x.push(-1.0);
            *r = t.norm(&x) / rows;
            let term = (0..=n)
                .map(|i| t.norm(&unit_times(n + 1, i, x[i])) / rows)
                .fold(0.0, f64::max);
            *w = 1.0 / r.max(RESIDUAL_FLOOR * term).max(f64::MIN_POSITIVE);
        }
        if round + 1 < ROUNDS {
            result = solve_bounded(&triangles, &weights, allowed);
        }
    }
    let (values, free, active, solution) = result;
    Fit {
        values,
        weights,
        residual_rms,
        free,
        active,
        solution,
    }
}

fn unit(n: usize, i: usize) -> Vec<f64> {
    unit_times(n, i, 1.0)
}

fn unit_times(n: usize, i: usize, v: f64) -> Vec<f64> {
    let mut x = vec![0.0; n];
    x[i] = v;
    x
}

fn known_value(a: ParameterRange) -> f64 {
    match a {
        ParameterRange::Known(v) => v,
        _ => 0.0,
    }
}

/// Returns whether the equations with a weight determine every parameter that occurs at all.
fn suffices(triangles: &[Triangle], weights: &[f64], allowed: &[ParameterRange]) -> bool {
    let holds = |t: &Triangle, i: usize| {
        t.columns.contains(&i) && t.norm(&unit(allowed.len() + 1, i)) > 0.0
    };
    let free: Vec<usize> = (0..allowed.len())
        .filter(|&i| !matches!(allowed[i], ParameterRange::Known(_)))
        .collect();
    let all_held = free.iter().all(|&i| {
        triangles
            .iter()
            .zip(weights)
            .any(|(t, w)| *w > 0.0 && holds(t, i))
            || !triangles.iter().any(|t| holds(t, i))
    });
    all_held && {
        let s = solve_free(triangles, weights, &free, &vec![0.0; allowed.len()]);
        s.singular_values.last().copied().unwrap_or(0.0)
            > 1e-6 * s.singular_values.first().copied().unwrap_or(0.0)
    }
}

/// Solves for the free parameters. All other parameters are held at `fixed`.
fn solve_free(triangles: &[Triangle], weights: &[f64], free: &[usize], fixed: &[f64]) -> Solution {
    let n = fixed.len();
    let reduced: Vec<(f64, Triangle)> = triangles
        .iter()
        .zip(weights)
        .filter(|(_, w)| **w > 0.0)
        .map(|(t, w)| {
            let mut columns: Vec<usize> = (0..free.len()).collect();
            columns.push(free.len());
            let rows = t
                .rows
                .iter()
                .map(|row| {
                    let mut out = vec![0.0; free.len() + 1];
                    for (v, &c) in row.iter().zip(&t.columns) {
                        if let Some(k) = free.iter().position(|f| *f == c) {
                            out[k] += v;
                        } else if c == n {
                            out[free.len()] += v;
                        } else {
                            out[free.len()] -= v * fixed[c];
                        }
                    }
                    out
                })
                .collect();
            (
                *w,
                Triangle {
                    columns,
                    rows,
                    n_rows: t.n_rows,
                },
            )
        })
        .collect();
    let blocks: Vec<(f64, &Triangle)> = reduced.iter().map(|(w, t)| (*w, t)).collect();
    solve(&blocks, free.len())
}

/// Active-set solution: values, free and active parameters, and the problem in the free ones.
fn solve_bounded(
    triangles: &[Triangle],
    weights: &[f64],
    allowed: &[ParameterRange],
) -> (Vec<f64>, Vec<usize>, Vec<usize>, Solution) {
    let n = allowed.len();
    let occurs = |i: usize| {
        triangles
            .iter()
            .zip(weights)
            .any(|(t, w)| *w > 0.0 && t.columns.contains(&i) && t.norm(&unit(n + 1, i)) > 0.0)
    };
    let mut fixed: Vec<f64> = allowed.iter().map(|a| known_value(*a)).collect();
    let mut free: Vec<usize> = (0..n)
        .filter(|&i| !matches!(allowed[i], ParameterRange::Known(_)) && occurs(i))
        .collect();
    let mut active: Vec<usize> = Vec::new();
    for _ in 0..=n {
        let solution = solve_free(triangles, weights, &free, &fixed);
        let worst = free
            .iter()
            .zip(&solution.x)
            .filter_map(|(&i, &x)| match allowed[i] {
                ParameterRange::Within(lo, _) if x < lo => {
                    Some((i, lo, (lo - x) / lo.abs().max(x.abs())))
                }
                ParameterRange::Within(_, hi) if x > hi => {
                    Some((i, hi, (x - hi) / hi.abs().max(x.abs())))
                }
                _ => None,
            })
            .max_by(|a, b| a.2.total_cmp(&b.2));
        let Some((i, bound, _)) = worst else {
            let mut values: Vec<f64> = (0..n)
                .map(|i| {
                    if matches!(allowed[i], ParameterRange::Known(_)) || active.contains(&i) {
                        fixed[i]
                    } else {
                        f64::NAN
                    }
                })
                .collect();
            free.iter()
                .zip(&solution.x)
                .for_each(|(&i, &x)| values[i] = x);
            return (values, free, active, solution);
        };
        fixed[i] = bound;
        active.push(i);
        free.retain(|f| *f != i);
    }
    (
        vec![f64::NAN; n],
        vec![],
        active,
        solve_free(triangles, weights, &[], &fixed),
    )
}
