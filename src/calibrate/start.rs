//! First S if the job has no model: from the runs with known loads, or from the known part of the loads of each run.

use super::posterior::{Equation, Posterior, solve};
use super::prior::RowPrior;
use super::types::{KnownRun, Task};
use super::unknown_directions::{
    SPANNED, UNKNOWN, UnknownDirections, have_equal_span, project_out,
};
use crate::linalg::{Matrix, dense, spd};

/// Returns whether every load of a run is known to better than [`UNKNOWN`] of its size.
pub(super) fn is_known(run: &KnownRun, sizes: &[f64]) -> bool {
    let k = sizes.len();
    (0..k).all(|l| {
        let variance = run.loads.covariance.get(l * k + l).copied();
        variance.unwrap_or(0.0).sqrt() <= UNKNOWN * sizes[l]
    })
}

/// Computes S from the runs with known loads. Returns `None` if all runs have known loads, or if these runs do not determine all loads. In a run with
/// a known sum, S alone determines how the sum is shared. If the fit starts without S, all loads have equal columns, and their differences count as
/// scatter.
pub(super) fn from_known(
    task: &Task,
    runs: &[&KnownRun],
    scales: &[f64],
    prior: &[RowPrior],
) -> Option<Posterior> {
    let k = scales.len();
    let known: Vec<&KnownRun> = runs
        .iter()
        .copied()
        .filter(|r| is_known(r, scales))
        .collect();
    if known.len() == runs.len() {
        return None;
    }
    let mut gram = vec![0.0; k * k];
    let mut equations = Vec::with_capacity(known.len());
    for run in known {
        let phi: Vec<f64> = (run.loads.mean.iter().zip(scales))
            .map(|(f, c)| f / c)
            .collect();
        spd::add_outer(&mut gram, &phi, 1.0);
        equations.push(with_noise(task, run, phi));
    }
    let values = spd::eigenvalues(&gram, k);
    let (least, most) = (values.first()?, values.last()?);
    if *least <= SPANNED * most {
        return None;
    }
    solve(prior, &equations)
}

/// Returns a run as an equation of the loads `phi`. Its readings have noise, but no scatter.
fn with_noise(task: &Task, run: &KnownRun, phi: Vec<f64>) -> Equation {
    let gauges: Vec<usize> = (0..task.gauges.len())
        .filter(|&g| run.strain.get(g).is_some_and(|v| v.is_finite()))
        .collect();
    let m = gauges.len();
    let noise = (task.noise * task.noise * run.noise_factor).max(f64::MIN_POSITIVE);
    let between = |i: usize| noise * task.noise_between(gauges[i / m], gauges[i % m]);
    let covariance = (0..m * m).map(between).collect();
    Equation {
        y: gauges.iter().map(|&g| run.strain[g]).collect(),
        gauges,
        phi,
        covariance,
    }
}

/// Returns rows of S by gauge if no run determines the loads along some directions. For the known parts of the loads, the rows come from least
/// squares. Along the free directions, they are the patterns over gauges in the remaining strain, the largest first. Each pattern is for loads of a
/// root mean square of 1.
///
/// # Reference
/// M. E. Tipping, C. M. Bishop, J. R. Stat. Soc. B 61 (1999) 611: principal components are the most probable columns if noise is equal.
pub(super) fn from_parts(
    task: &Task,
    runs: &[&KnownRun],
    unknown: &UnknownDirections,
    prior: &[RowPrior],
) -> Option<Vec<Vec<f64>>> {
    let n = prior.len();
    let known = runs.iter().zip(&unknown.parts);
    let equations: Vec<Equation> = known
        .map(|(run, part)| with_noise(task, run, part.clone()))
        .collect();
    let found = solve(prior, &equations)?;
    let mut rows: Vec<Vec<f64>> = (found.mean.chunks_exact(found.k.max(1)))
        .map(<[f64]>::to_vec)
        .collect();
    let left = |(run, part): (&&KnownRun, &Vec<f64>)| -> Vec<f64> {
        let off = run.strain.iter().zip(found.predict(part));
        off.map(|(y, p)| if y.is_finite() { y - p } else { 0.0 })
            .collect()
    };
    let lefts: Vec<Vec<f64>> = runs.iter().zip(&unknown.parts).map(left).collect();
    // Directions with their patterns.
    let (mut directions, mut patterns) = (Vec::<Vec<f64>>::new(), Vec::<Vec<f64>>::new());
    for free in &unknown.free {
        let new = orthonormal_complement(free, &directions);
        if new.is_empty() {
            continue;
        }
        let explained: Vec<Vec<f64>> = (directions.iter().zip(&patterns))
            .filter(|(z, _)| free.iter().any(|f| spd::dot(f, z).abs() > OVERLAP))
            .map(|(_, u)| u.clone())
            .collect();
        let alike = unknown.free.iter().zip(&lefts);
        let alike: Vec<Vec<f64>> = alike
            .filter(|(other, _)| have_equal_span(free, other))
            .map(|(_, left)| {
                let mut left = left.clone();
                project_out(&mut left, &explained);
                left
            })
            .collect();
        let d = dense::svd(&Matrix::from_fn(alike.len(), n, |r, g| alike[r][g]))?;
        for (i, z) in new.into_iter().enumerate().take(d.s.len()) {
            let pattern: Vec<f64> = d.v.column(i).iter().copied().collect();
            let size = d.s[i] / (alike.len() as f64).sqrt();
            for (row, u) in rows.iter_mut().zip(&pattern) {
                row.iter_mut().zip(&z).for_each(|(s, z)| *s += size * u * z);
            }
            directions.push(z);
            patterns.push(pattern);
        }
    }
    Some(rows)
}

/// Cosine from which two directions have something in common.
const OVERLAP: f64 = 1e-3;

/// Returns orthonormal directions of the span of `free` that are orthogonal to the orthonormal `taken`.
fn orthonormal_complement(free: &[Vec<f64>], taken: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let mut all = taken.to_vec();
    for f in free {
        let mut rest = f.clone();
        project_out(&mut rest, &all);
        let size = spd::dot(&rest, &rest).sqrt();
        if size > OVERLAP {
            all.push(rest.iter().map(|v| v / size).collect());
        }
    }
    all.split_off(taken.len())
}
