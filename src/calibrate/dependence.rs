//! Dependence of recovered loads on a column of the runs, such as speed.

use super::fit::calibrate;
use super::types::{LeftOut, Task};
use crate::estimate::student_tail;
use crate::linalg::{Matrix, dense};

/// Change of the scale with a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dependence {
    /// Relative change of the loads' sum per unit of the column.
    pub slope_rel: f64,
    /// Standard deviation of `slope_rel`.
    pub sigma: f64,
    /// Chance of a slope at least as clear if the loads do not depend on the column.
    pub chance: f64,
    /// Degrees of freedom behind `sigma`.
    pub dof: f64,
}

/// Iterations between the slope and a calibration that includes it; they converge in three.
const ROUNDS: usize = 4;
/// Share of its sigma up to which a slope counts as settled.
const SETTLED: f64 = 0.1;

/// Returns the relative change of the loads with a column. `column` has a value for each run of the task (NaN: blank), and `left_out` comes from the
/// calibration of the task.
///
/// A calibration without the slope counts its effect as scatter of the runs, which is then several times as large. The calibration then includes
/// patterns of noise that go with the slope by chance. The slope of its left-out runs therefore has a larger error than their scatter. If there is a
/// slope, the known loads are replaced by `f (1 + slope (x - mean x))`, and the runs are calibrated again until no slope remains.
///
/// `None` if no degree of freedom remains, or if the column changes only together with the loads.
pub fn depends_on(task: &Task, left_out: &[LeftOut], column: &[f64]) -> Option<Dependence> {
    let mut found = slope(task, left_out, column)?;
    if found.slope_rel.abs() <= found.sigma {
        return Some(found);
    }
    for _ in 0..ROUNDS {
        let Some(sloped) = with_slope(task, column, found.slope_rel) else {
            break;
        };
        let again = calibrate(&sloped).ok();
        let Some(rest) = again.and_then(|c| slope(&sloped, &c.left_out, column)) else {
            break;
        };
        let slope_rel = found.slope_rel + rest.slope_rel;
        found = Dependence {
            slope_rel,
            sigma: rest.sigma,
            chance: chance(slope_rel, rest.sigma, rest.dof),
            dof: rest.dof,
        };
        if rest.slope_rel.abs() < SETTLED * rest.sigma {
            break;
        }
    }
    Some(found)
}

/// Returns the task with known loads times the effect of a slope; `None` if the effect changes the sign of a load.
fn with_slope(task: &Task, column: &[f64], slope_rel: f64) -> Option<Task> {
    let known: Vec<f64> = column.iter().copied().filter(|x| x.is_finite()).collect();
    let mean = known.iter().sum::<f64>() / known.len() as f64;
    let mut out = task.clone();
    for (run, x) in out.runs.iter_mut().zip(column) {
        let factor = match x.is_finite() {
            true => 1.0 + slope_rel * (x - mean),
            false => 1.0,
        };
        if !(factor > 0.0) {
            return None;
        }
        run.loads.mean.iter_mut().for_each(|f| *f *= factor);
        let covariance = run.loads.covariance.iter_mut();
        covariance.for_each(|c| *c *= factor * factor);
    }
    Some(out)
}

/// Returns the probability of a slope of this size if there is no dependence.
fn chance(slope_rel: f64, sigma: f64, dof: f64) -> f64 {
    (2.0 * student_tail((slope_rel / sigma).abs(), dof)).min(1.0)
}

/// Returns the slope of recovered over known sum of the left-out runs against the column.
///
/// S from the other runs contains the effect of the column too. `Z` are the known loads of each run over their sum, whose factors the calibration
/// fits; `H = Z (Z'Z)^-1 Z'` and `h = H_rr`. With a left-out run of ratio `u` included, S along its loads is `1 - h + h u` times S of the other runs.
/// Then `(u - 1) (1 - h) / (1 - h + h u)` is a least-squares residual with the run included. The result is the slope of these residuals against
/// `(I - H) x`, with `R - rank Z - 1` degrees of freedom.
///
/// # Reference
/// R. D. Cook, S. Weisberg, Residuals and Influence in Regression (1982), section 2.2 (left-out residuals), 2.3.2 (added variables).
fn slope(task: &Task, left_out: &[LeftOut], column: &[f64]) -> Option<Dependence> {
    let wanted: Vec<usize> = (0..task.loads.len())
        .filter(|l| task.loads[*l].wanted)
        .collect();
    let sum = |f: &[f64]| wanted.iter().map(|l| f[*l]).sum::<f64>();
    let point = |l: &LeftOut| -> Option<(f64, f64, Vec<f64>)> {
        let x = column.get(l.number).copied().filter(|x| x.is_finite())?;
        let known = sum(&l.known);
        let shares = wanted.iter().map(|i| l.known[*i] / known).collect();
        (known != 0.0).then(|| (x, sum(&l.estimate.values) / known - 1.0, shares))
    };
    let points: Vec<(f64, f64, Vec<f64>)> = left_out.iter().filter_map(point).collect();
    let n = points.len();
    if n < 3 {
        return None;
    }
    let shares = Matrix::from_fn(n, wanted.len(), |r, l| points[r].2[l]);
    let d = dense::svd(&shares)?;
    let limit = d.s.first().copied().unwrap_or(0.0) * dense::RANK_TOLERANCE;
    let rank = d.s.iter().filter(|s| **s > limit).count();
    let free = n.checked_sub(rank + 1).filter(|f| *f > 0)? as f64;
    let left = |v: &[f64]| -> Vec<f64> {
        let mut out = v.to_vec();
        for i in 0..rank {
            let along: f64 = (0..n).map(|r| d.u[(r, i)] * v[r]).sum();
            (0..n).for_each(|r| out[r] -= along * d.u[(r, i)]);
        }
        out
    };
    let residual = |r: usize| {
        let own = 1.0 - (0..rank).map(|i| d.u[(r, i)].powi(2)).sum::<f64>();
        let off = points[r].1;
        off * own / (1.0 + (1.0 - own) * off)
    };
    let column: Vec<f64> = points.iter().map(|p| p.0).collect();
    let residuals: Vec<f64> = (0..n).map(residual).collect();
    let (x, y) = (left(&column), left(&residuals));
    let sxx: f64 = x.iter().map(|x| x * x).sum();
    let all: f64 = column.iter().map(|x| x * x).sum();
    if !(sxx > all * CHANGES) {
        return None;
    }
    let slope_rel = x.iter().zip(&y).map(|(x, y)| x * y).sum::<f64>() / sxx;
    let rest = x.iter().zip(&y).map(|(x, y)| (y - slope_rel * x).powi(2));
    let sigma = (rest.sum::<f64>() / free / sxx).sqrt();
    Some(Dependence {
        slope_rel,
        sigma,
        chance: chance(slope_rel, sigma, free),
        dof: free,
    })
}

/// Least share of a column's sum of squares that the loads leave; a smaller share is rounding.
const CHANGES: f64 = 1e-12;
