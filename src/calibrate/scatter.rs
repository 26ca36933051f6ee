//! Scatter of repeats: covariance over gauges of the residuals of the fitted runs, shrunk because runs are few and gauges many.

use super::overfit;
use crate::estimate::chi_square_tail;
use crate::linalg::{Matrix, spd};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::collections::BTreeMap;

/// Scatter over gauges in units of the run's root mean square strain.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scatter {
    /// `n x n` by rows; zeros if noise explains everything.
    pub covariance: Vec<f64>,
    /// Degrees of freedom behind `covariance`; infinite if it is zero.
    pub dof: f64,
    /// Degrees of freedom of a pattern outside the span of S. Shrinking such patterns towards their common mean raises them.
    pub dof_outside: f64,
    /// Share of the variance that repeats of one loading have in common. The cause is the error of S for that loading, or a property of that loading
    /// (a truck's axles, the position in a lane). Zero if repeats differ from each other as much as from S.
    pub common: f64,
}

/// Residuals of one run.
#[derive(Clone, Debug)]
pub(super) struct RunResiduals {
    /// Reading minus prediction by gauge, strain. NaN without a reading.
    pub residual: Vec<f64>,
    /// Mean square of the predicted strain.
    pub q2: f64,
    /// Variance of each reading from other known sources: noise, errors of the loads.
    pub explained: Vec<f64>,
    /// Group of the run: runs with one number are repeats of each other.
    pub group: usize,
}

/// Chance under which residuals count as larger than noise makes them.
const SIGNIFICANT: f64 = 1e-3;
/// Degrees of freedom below which the scatter cannot be separated from the fit.
const FEWEST: f64 = 0.9;

impl Scatter {
    /// Returns zero scatter. The readings then contain only noise.
    pub fn none(n: usize) -> Self {
        Self {
            covariance: vec![0.0; n * n],
            dof: f64::INFINITY,
            dof_outside: f64::INFINITY,
            common: 0.0,
        }
    }

    /// Returns the factor on the covariance of each of `repeats` runs of one group. With this factor, the runs can be treated as independent. They
    /// then give the same information on S as the correlated runs together. It is exact for runs of one loading if only scatter counts.
    ///
    /// # Reference
    /// L. Kish, Survey Sampling (1965), eq. 5.4.1: the design effect `1 + (m - 1) rho`.
    pub fn design(&self, repeats: usize) -> f64 {
        1.0 + (repeats.max(1) - 1) as f64 * self.common
    }

    /// Estimates the scatter from the residuals of runs. `fitted` is the number of degrees of freedom, counted in runs, that the fit of S took from
    /// each gauge. `columns` are the columns of S by gauge.
    ///
    /// Scatter is of two kinds. Patterns that loads make (size and place of the load: dynamic share, lateral place) determine the scatter of
    /// recovered loads. All other patterns are the second kind. The sample is shrunk towards a target that separates these kinds, without cross
    /// terms. The first block of the target is the block within the span of S, shrunk towards its mean. The second block is the mean of the other
    /// patterns. The result underestimates the scatter of loads. [`overfit`] gives the difference, which is added.
    ///
    /// # Reference
    /// Weight of the target: Y. Chen, A. Wiesel, Y. C. Eldar, A. O. Hero, IEEE Trans. Signal Process. 58 (2010) 5016, eq. 23 (oracle
    /// approximating shrinkage), with degrees of freedom for the number of samples.
    pub fn from_residuals(runs: &[RunResiduals], fitted: f64, columns: &Matrix) -> Self {
        let n = runs.first().map_or(0, |r| r.residual.len());
        let dof = runs.len() as f64 - fitted;
        if dof < FEWEST || !exceeds_noise(runs, dof) {
            return Self::none(n);
        }
        Self::at_most(runs, fitted, columns)
    }

    /// Returns the largest scatter that the residuals allow, with its degrees of freedom: [`Scatter::from_residuals`] without the test against
    /// noise.
    pub fn at_most(runs: &[RunResiduals], fitted: f64, columns: &Matrix) -> Self {
        let n = runs.first().map_or(0, |r| r.residual.len());
        let dof = runs.len() as f64 - fitted;
        if dof < FEWEST || n == 0 {
            return Self::none(n);
        }
        let Sample {
            covariance: sample,
            dof,
            common,
            explained,
        } = Sample::from_residuals(runs, n, dof);
        let trace: f64 = (0..n).map(|g| sample[g * n + g]).sum();
        // The residuals contain noise too, which is counted in addition to the scatter.
        let noise_share = explained * n as f64 / trace;
        let keep = (1.0 - noise_share).max(LEAST_KEPT);
        let shrink = shrinkage(&sample, n, dof);
        let target = target(&sample, columns, dof);
        let outside = n.saturating_sub(columns.ncols()).max(1) as f64;
        let shrunk: Vec<f64> = (0..n * n)
            .map(|i| (1.0 - shrink) * sample[i] + shrink * target[i])
            .collect();
        let added = overfit::overfit_scatter(&sample, (&shrunk, shrink), columns, dof);
        let added = added.unwrap_or_else(|| vec![0.0; n * n]);
        let all = shrunk.iter().zip(&added);
        Self {
            covariance: all.map(|(c, a)| keep * (c + a)).collect(),
            dof,
            dof_outside: dof_of_shrunk(dof, shrink, outside),
            // Noise does not contribute to the common error of repeats.
            common: (common / keep).min(1.0),
        }
    }

    /// Returns the root mean square over gauges.
    pub fn rms(&self) -> f64 {
        let n = (self.covariance.len() as f64).sqrt().round() as usize;
        let trace: f64 = (0..n).map(|g| self.covariance[g * n + g]).sum();
        (trace / n.max(1) as f64).sqrt()
    }
}

/// Covariance of the residuals of runs, in units of their root mean square strain.
struct Sample {
    /// Covariance over gauges of the residuals of one run, `n x n`.
    covariance: Vec<f64>,
    /// Degrees of freedom of the scatter.
    dof: f64,
    /// Share of it that repeats have in common.
    common: f64,
    /// Mean of the variance from other known sources.
    explained: f64,
}

/// Sums of products about the means of groups, and of these means times their runs.
struct Squares {
    within: Vec<f64>,
    between: Vec<f64>,
}

impl Sample {
    /// Computes the covariance of residuals. If the residuals in a group are more similar than chance allows, it is the sum of two variances: within
    /// groups and between groups. Each variance has its own degrees of freedom. Otherwise the runs are independent. `dof` is the number of runs minus
    /// the degrees of freedom that the fit of S took.
    ///
    /// `W = SS_within / (R - G)`, `M = SS_between / (G - fitted)`, `C = W + (M - W) / m`, with `m` runs in a group.
    ///
    /// # Reference
    /// S. R. Searle, G. Casella, C. E. McCulloch, Variance Components (1992), chapter 3 (analysis of variance, one way); degrees of freedom
    /// of the sum: F. E. Satterthwaite, Biometrics Bulletin 2 (1946) 110.
    fn from_residuals(runs: &[RunResiduals], n: usize, dof: f64) -> Self {
        let kept: Vec<&RunResiduals> = runs.iter().filter(|r| r.q2 > 0.0).collect();
        let (mut explained, mut readings) = (0.0, 0.0_f64);
        let mut read = vec![0.0; n];
        for r in &kept {
            for g in (0..n).filter(|&g| r.residual[g].is_finite()) {
                read[g] += 1.0;
                explained += r.explained[g] / r.q2;
                readings += 1.0;
            }
        }
        let explained = explained / readings.max(1.0);
        let all = kept.len() as f64;
        // The divisor of a pair of gauges comes from the number of runs of each gauge. With the number of runs that have both, the result need not be
        // a covariance.
        let scaled = |squares: &[f64], dof: f64| -> Vec<f64> {
            let share = |g: usize| (read[g] * dof / all).max(FEWEST.min(dof));
            let pairs = squares.iter().enumerate();
            pairs
                .map(|(i, s)| s / (share(i / n) * share(i % n)).sqrt())
                .collect()
        };
        let dof = dof * all / runs.len().max(1) as f64;
        let Squares { within, between } = Squares::from_residuals(&kept, n);
        let total: Vec<f64> = within.iter().zip(&between).map(|(w, b)| w + b).collect();
        let independent = |covariance: Vec<f64>| Self {
            covariance,
            dof,
            common: 0.0,
            explained,
        };
        let mut sizes: BTreeMap<usize, f64> = BTreeMap::new();
        kept.iter()
            .for_each(|r| *sizes.entry(r.group).or_default() += 1.0);
        let groups = sizes.len() as f64;
        let (of_within, of_between) = (all - groups, dof - (all - groups));
        if of_within < 1.0 || of_between < FEWEST || groups < 2.0 {
            return independent(scaled(&total, dof));
        }
        let within = scaled(&within, of_within);
        let between = scaled(&between, of_between);
        let trace = |c: &[f64]| (0..n).map(|g| c[g * n + g]).sum::<f64>();
        let (w, m) = (trace(&within), trace(&between));
        // Gauges scatter together. The number of independent gauges is the number of directions of their covariance.
        let patterns = trace(&total).powi(2) / total.iter().map(|v| v * v).sum::<f64>();
        let chance = FisherSnedecor::new(of_between * patterns, of_within * patterns)
            .map_or(1.0, |f| f.sf(m / w));
        if !(chance < SIMILAR_REPEATS_CHANCE) {
            return independent(scaled(&total, dof));
        }
        let squares: f64 = sizes.values().map(|s| s * s).sum();
        let repeats = (all - squares / all) / (groups - 1.0);
        let (a, b) = (1.0 - 1.0 / repeats, 1.0 / repeats);
        let sum = a * w + b * m;
        Self {
            covariance: within
                .iter()
                .zip(&between)
                .map(|(w, m)| a * w + b * m)
                .collect(),
            dof: sum * sum / ((a * w).powi(2) / of_within + (b * m).powi(2) / of_between),
            common: b * (m - w) / sum,
            explained,
        }
    }
}

/// Chance below which repeats with such similar residuals are not independent.
const SIMILAR_REPEATS_CHANCE: f64 = 0.05;

impl Squares {
    fn from_residuals(runs: &[&RunResiduals], n: usize) -> Self {
        let mut out = Self {
            within: vec![0.0; n * n],
            between: vec![0.0; n * n],
        };
        let mut groups: BTreeMap<usize, Vec<Vec<f64>>> = BTreeMap::new();
        for r in runs {
            let unit = r.residual.iter().map(|e| e / r.q2.sqrt()).collect();
            groups.entry(r.group).or_default().push(unit);
        }
        let mean = |members: &[Vec<f64>], g: usize| {
            let read = members.iter().map(|e| e[g]).filter(|e| e.is_finite());
            let (sum, count) = read.fold((0.0, 0.0), |a, e| (a.0 + e, a.1 + 1.0));
            (sum / count, count)
        };
        let add = |to: &mut [f64], e: &[f64]| {
            for (row, a) in to.chunks_exact_mut(n.max(1)).zip(e) {
                for (v, b) in row.iter_mut().zip(e) {
                    let product = a * b;
                    *v += if product.is_finite() { product } else { 0.0 };
                }
            }
        };
        for members in groups.values() {
            let means: Vec<(f64, f64)> = (0..n).map(|g| mean(members, g)).collect();
            for e in members {
                let off: Vec<f64> = e.iter().zip(&means).map(|(e, m)| e - m.0).collect();
                add(&mut out.within, &off);
            }
            let root: Vec<f64> = means.iter().map(|(m, count)| m * count.sqrt()).collect();
            add(&mut out.between, &root);
        }
        out
    }
}

/// The sample with patterns that loads make and all others apart, `n x n`.
fn target(sample: &[f64], columns: &Matrix, dof: f64) -> Vec<f64> {
    let n = columns.nrows();
    let all: f64 = (0..n).map(|g| sample[g * n + g]).sum();
    let Some(basis) = overfit::basis(columns) else {
        return (0..n * n)
            .map(|i| if i / n == i % n { all / n as f64 } else { 0.0 })
            .collect();
    };
    let k = basis.len();
    let mut inside = vec![0.0; k * k];
    for (i, u) in basis.iter().enumerate() {
        let mut cu = vec![0.0; n];
        spd::times(sample, u, &mut cu);
        for (j, v) in basis.iter().enumerate() {
            inside[i * k + j] = spd::dot(&cu, v);
        }
    }
    let within: f64 = (0..k).map(|i| inside[i * k + i]).sum();
    let rest = ((all - within) / (n - k).max(1) as f64).max(0.0);
    let shrink = if k > 1 {
        shrinkage(&inside, k, dof)
    } else {
        0.0
    };
    for (i, v) in inside.iter_mut().enumerate() {
        let mean = if i / k == i % k {
            within / k as f64
        } else {
            0.0
        };
        *v = (1.0 - shrink) * *v + shrink * mean;
    }
    let mut out = vec![0.0; n * n];
    for g in 0..n {
        out[g * n + g] = rest;
        for h in 0..n {
            for (i, u) in basis.iter().enumerate() {
                out[g * n + h] -= rest * u[g] * u[h];
                for (j, v) in basis.iter().enumerate() {
                    out[g * n + h] += inside[i * k + j] * u[g] * v[h];
                }
            }
        }
    }
    out
}

/// Share of the residuals' variance that is kept as scatter however large the stated noise.
const LEAST_KEPT: f64 = 0.05;

/// Returns the degrees of freedom of a shrunk variance. It is `1 - w` times a sample's variance in one of `n` patterns, of `dof` each, plus `w` times
/// their mean. All patterns have one size, and the relative variance of such an estimate is 2 over its degrees of freedom.
///
/// `1 / v = ((1 - w)^2 + (1 - (1 - w)^2) / n) / dof`
///
/// # Reference
/// F. E. Satterthwaite, Biometrics Bulletin 2 (1946) 110, with the pattern's own share in the mean.
pub(super) fn dof_of_shrunk(dof: f64, w: f64, n: f64) -> f64 {
    let own = (1.0 - w).powi(2);
    dof / (own + (1.0 - own) / n)
}

/// Weight of the identity in the shrunk covariance.
fn shrinkage(sample: &[f64], n: usize, dof: f64) -> f64 {
    let square: f64 = sample.iter().map(|v| v * v).sum();
    let trace: f64 = (0..n).map(|g| sample[g * n + g]).sum();
    let p = n as f64;
    let above = (1.0 - 2.0 / p) * square + trace * trace;
    let below = (dof + 1.0 - 2.0 / p) * (square - trace * trace / p);
    if below > 0.0 {
        (above / below).clamp(SHRINK_LEAST, 1.0)
    } else {
        1.0
    }
}

/// Smallest weight of the identity in the covariance. With fewer runs than gauges, some directions of the sample have no scatter at all. Real
/// directions have some.
const SHRINK_LEAST: f64 = 0.02;

/// Returns whether the residuals exceed the noise.
fn exceeds_noise(runs: &[RunResiduals], dof: f64) -> bool {
    let (mut chi2, mut readings) = (0.0, 0usize);
    for r in runs {
        for (e, v) in r
            .residual
            .iter()
            .zip(&r.explained)
            .filter(|(e, _)| e.is_finite())
        {
            chi2 += e * e / v.max(f64::MIN_POSITIVE);
            readings += 1;
        }
    }
    let free = readings as f64 * dof / runs.len().max(1) as f64;
    chi_square_tail(chi2, free) < SIGNIFICANT
}
