//! Residuals of runs: the part of their readings that no load can make, with its covariance across the runs.
//!
//! The model's error is equal in every run, so residuals of runs are not independent. `r_i = T (e_i + D f_i)`, with the projection `T` that
//! removes all loads, the noise `e_i` and the errors `D` of the influence coefficients. Then `cov(r_i, r_j) = T (d_ij N + M(f_i, f_j)) T'`.
//! If the left singular vectors of the loads rotate the runs, only the first few rotated runs contain `M`, all further runs noise alone.

use super::errors::ErrorModel;
use super::gain::Gain;
use super::types::ShiftKind;
use crate::linalg::{Matrix, SymmetricEigen, dense, spd};
use crate::sensitivity::Sensitivity;

/// Largest number of unknowns of one covariance of rotated runs: a second of work. Further rotated runs are solved one by one, the strongest first.
const TOGETHER: usize = 1200;
/// Share of the largest loads below which a rotated run has no load: rounding.
const EMPTY: f64 = 1e-9;
/// Squared length of the part of a gauge's reading that no load can make, below which the gauge is unchecked: rounding.
const UNCHECKED: f64 = 1e-9;

/// Runs with the same active gauges.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Gauges of S that read.
    pub used: Vec<usize>,
    /// Noise variance relative to a single reading.
    pub noise_factor: f64,
    /// Runs.
    pub runs: Vec<usize>,
}

/// Error of one gauge, estimated from the residuals of all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaugeTest {
    /// Gauge of S.
    pub gauge: usize,
    /// Kind of the error.
    pub kind: ShiftKind,
    /// Size of the error, divided by its standard deviation. It is standard normal if all gauges are right.
    pub t: f64,
    /// Size of the error: a share of the reading, or strain.
    pub size: f64,
}

/// Statistics of the residuals of all runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Joint {
    /// Sum of squares of the residuals relative to their covariance.
    pub chi2: f64,
    /// Degrees of freedom.
    pub dof: usize,
    /// Effective number of independent errors in the sum.
    pub effective: f64,
    /// Estimated errors of single gauges.
    pub gauges: Vec<GaugeTest>,
}

/// Runs with the same active gauges, and the joint test of these runs.
pub(super) struct PatternTest<'a> {
    pub pattern: &'a Pattern,
    pub gain: &'a Gain,
    pub projection: Projection,
    /// Strain of each run of the pattern.
    pub strain: Vec<&'a [f64]>,
    pub joint: Joint,
}

/// Part of readings that no loads can cause.
pub(super) struct Projection {
    /// `m x n_used`; orthonormal rows times one over the typical sd of each reading.
    t: Matrix,
    /// `m x m` by rows: Cholesky factor of the covariance of noise and nuisance loads.
    noise: Vec<f64>,
    /// `m x m` by rows.
    noise_covariance: Vec<f64>,
    /// 1 sd of each reading at typical loads.
    sd: Vec<f64>,
    s: Matrix,
    errors: ErrorModel,
    /// Share of independent runs in the runs; 1 except for samples of a record.
    share: f64,
}

/// Loads that a projection removes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RemovedLoads {
    /// All loads, whatever their stated size.
    All,
    /// Loads without a stated size; loads with one count as scatter of that size.
    Unstated,
}

impl Projection {
    /// Creates the projection. `None` if no reading is redundant.
    pub fn new(
        s: &Sensitivity,
        pattern: &Pattern,
        errors: ErrorModel,
        typical: &[f64],
        out: RemovedLoads,
    ) -> Option<Self> {
        let (n, k) = (pattern.used.len(), s.loads.len());
        let rows = Matrix::from_fn(n, k, |i, l| s.values[(pattern.used[i], l)]);
        let noise = errors.noise_variance(pattern.noise_factor);
        let of_gauges = errors.noise_covariance(s, &pattern.used, pattern.noise_factor);
        let differs = |i: usize| of_gauges.as_ref().map_or(0.0, |c| c[(i, i)] - noise);
        let sd: Vec<f64> = errors
            .variances(&rows, typical, pattern.noise_factor)
            .iter()
            .enumerate()
            .map(|(i, v)| (v + differs(i)).sqrt())
            .collect();
        let priors = s.priors();
        let weighted = Matrix::from_fn(n, k, |i, l| {
            if out == RemovedLoads::All || priors[l].is_none() {
                rows[(i, l)] / sd[i]
            } else {
                0.0
            }
        });
        let basis = complement(&dense::unit_columns(&weighted))?;
        let m = basis.ncols();
        let t = Matrix::from_fn(m, n, |a, i| basis[(i, a)] / sd[i]);
        let mut covariance = match &of_gauges {
            None => (&t * t.transpose()) * noise,
            Some(of_gauges) => &t * of_gauges * t.transpose(),
        };
        if out == RemovedLoads::Unstated {
            for (l, prior) in priors.iter().enumerate() {
                let Some(p) = prior else { continue };
                let column = &t * rows.column(l) * *p;
                covariance += &column * column.transpose();
            }
        }
        let noise_covariance: Vec<f64> = covariance.transpose().iter().copied().collect();
        let noise = spd::cholesky(&noise_covariance, m)?;
        Some(Self {
            t,
            noise,
            noise_covariance,
            sd,
            s: rows,
            errors,
            share: 1.0,
        })
    }

    /// Returns the projection for samples of a record of which only a `share` is independent: squares and degrees of freedom count that share.
    pub fn with_share(self, share: f64) -> Self {
        Self { share, ..self }
    }

    /// Returns the share of independent runs in the runs.
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Returns the projection with a covariance of the readings beyond noise, by gauge of S; `None` if the sum is not a covariance.
    pub fn with_reading_covariance(
        mut self,
        pattern: &Pattern,
        of_readings: &Matrix,
    ) -> Option<Self> {
        let m = self.m();
        let added = self.of_readings(pattern, of_readings);
        self.noise_covariance
            .iter_mut()
            .zip(&added)
            .for_each(|(c, v)| *c += v);
        self.noise = spd::cholesky(&self.noise_covariance, m)?;
        Some(self)
    }

    /// `T C T'` of a covariance of the readings, by rows.
    fn of_readings(&self, pattern: &Pattern, of_readings: &Matrix) -> Vec<f64> {
        let n = pattern.used.len();
        let used = Matrix::from_fn(n, n, |a, b| of_readings[(pattern.used[a], pattern.used[b])]);
        (&self.t * used * self.t.transpose())
            .transpose()
            .iter()
            .copied()
            .collect()
    }

    /// Returns the number of dimensions.
    pub fn m(&self) -> usize {
        self.t.nrows()
    }

    /// Returns `T y`.
    pub fn project_strain(&self, pattern: &Pattern, strain: &[f64]) -> Vec<f64> {
        (0..self.m())
            .map(|a| {
                let terms = pattern.used.iter().enumerate();
                terms.map(|(i, &g)| self.t[(a, i)] * strain[g]).sum()
            })
            .collect()
    }

    /// `T M(f, g) T'`, by rows.
    fn model_error_covariance(&self, f: &[f64], g: &[f64]) -> Vec<f64> {
        let errors = &self.errors;
        let m = self.m();
        let by_gauge: Vec<f64> = self
            .s
            .row_iter()
            .map(|row| errors.model_error_covariance(row.iter().copied(), f, g))
            .collect();
        let mut out = vec![0.0; m * m];
        for a in 0..m {
            for b in 0..m {
                let terms = by_gauge.iter().enumerate();
                out[a * m + b] = terms
                    .map(|(i, v)| self.t[(a, i)] * self.t[(b, i)] * v)
                    .sum();
            }
        }
        out
    }

    /// Returns the sum of squares of the residual `z` of one run, relative to its covariance at loads `f`. `beyond` is the covariance of its readings
    /// beyond noise.
    pub fn chi2_of_run(
        &self,
        pattern: &Pattern,
        z: &[f64],
        f: &[f64],
        beyond: Option<&Matrix>,
    ) -> f64 {
        let mut x = z.to_vec();
        if self.errors.model_rel > 0.0 || beyond.is_some() {
            let mut covariance = self.model_error_covariance(f, f);
            let beyond = beyond.map(|b| self.of_readings(pattern, b));
            for part in std::iter::once(&self.noise_covariance).chain(&beyond) {
                covariance.iter_mut().zip(part).for_each(|(c, n)| *c += n);
            }
            let Some(l) = spd::cholesky(&covariance, self.m()) else {
                return f64::INFINITY;
            };
            spd::solve_lower(&l, &mut x);
        } else {
            spd::solve_lower(&self.noise, &mut x);
        }
        spd::dot(&x, &x)
    }

    /// Tests all runs of a pattern together. `strain` and `loads` are by run of the pattern.
    pub fn test_pattern(
        &self,
        pattern: &Pattern,
        strain: &[&[f64]],
        loads: &[Vec<f64>],
    ) -> Option<Joint> {
        let m = self.m();
        let together = self.joint_residuals(pattern, strain, loads)?;
        let runs = (strain.len() as f64 * self.share).round().max(1.0);
        let dof = m * runs as usize;
        let share = self.share_of_model(loads);
        let turned: usize = together.turned.iter().map(|b| b.over_runs.len()).sum();
        let independent = (turned * m).clamp(m.min(dof), dof.max(1));
        let effective = (dof as f64).min(
            1.0 / (share * share / independent.max(1) as f64
                + (1.0 - share) * (1.0 - share) / dof.max(1) as f64),
        );
        let kinds = [ShiftKind::Gain, ShiftKind::Offset];
        let gauges = (0..pattern.used.len()).flat_map(|i| kinds.map(|kind| (i, kind)));
        let gauges = gauges.filter_map(|(i, kind)| self.test(&together, pattern, loads, i, kind));
        Some(Joint {
            chi2: together.chi2,
            dof,
            effective,
            gauges: gauges.collect(),
        })
    }

    /// Returns the residuals of all runs, relative to their covariance at `loads`.
    pub fn joint_residuals(
        &self,
        pattern: &Pattern,
        strain: &[&[f64]],
        loads: &[Vec<f64>],
    ) -> Option<WhitenedResiduals> {
        let white: Vec<Vec<f64>> = strain
            .iter()
            .map(|y| {
                let mut z = self.project_strain(pattern, y);
                spd::solve_lower(&self.noise, &mut z);
                z
            })
            .collect();
        let turned = self.model_error_blocks(pattern, strain, loads)?;
        let mut chi2: f64 = white.iter().map(|z| spd::dot(z, z)).sum();
        for block in &turned {
            chi2 += block.chi2 - block.chi2_of_noise;
        }
        Some(WhitenedResiduals {
            chi2: chi2 * self.share,
            white,
            turned,
        })
    }

    /// Returns the error of the `i`-th gauge of the pattern that these residuals indicate. `None` if nothing checks this gauge.
    pub fn test(
        &self,
        together: &WhitenedResiduals,
        pattern: &Pattern,
        loads: &[Vec<f64>],
        i: usize,
        kind: ShiftKind,
    ) -> Option<GaugeTest> {
        let column: Vec<f64> = self.t.column(i).iter().copied().collect();
        if spd::dot(&column, &column) * self.sd[i] * self.sd[i] < UNCHECKED {
            return None;
        }
        let mut own = column.clone();
        spd::solve_lower(&self.noise, &mut own);
        let along: Vec<f64> = match kind {
            ShiftKind::Gain => loads
                .iter()
                .map(|f| self.s.row(i).iter().zip(f).map(|(s, f)| s * f).sum())
                .collect(),
            ShiftKind::Offset => vec![1.0; loads.len()],
        };
        let mut rest = along.clone();
        let (mut information, mut score) = (0.0, 0.0);
        for block in &together.turned {
            let shares = block.shares(&along);
            for (r, u) in shares.iter().zip(&block.over_runs) {
                rest.iter_mut().zip(u).for_each(|(v, u)| *v -= r * u);
            }
            let mut d: Vec<f64> = shares
                .iter()
                .flat_map(|b| column.iter().map(move |c| b * c))
                .collect();
            spd::solve_lower(&block.factor, &mut d);
            information += spd::dot(&d, &d);
            score += spd::dot(&d, &block.white);
        }
        information += spd::dot(&own, &own) * rest.iter().map(|v| v * v).sum::<f64>();
        let by_run = together.white.iter().map(|z| spd::dot(&own, z));
        score += rest.iter().zip(by_run).map(|(r, z)| r * z).sum::<f64>();
        (information > 0.0 && information.is_finite()).then(|| GaugeTest {
            gauge: pattern.used[i],
            kind,
            t: score / information.sqrt() * self.share.sqrt(),
            size: score / information,
        })
    }

    /// Share of the model's error in the variance of the residuals.
    fn share_of_model(&self, loads: &[Vec<f64>]) -> f64 {
        if self.errors.model_rel <= 0.0 {
            return 0.0;
        }
        let m = self.m();
        let trace = |c: &[f64]| (0..m).map(|a| c[a * m + a]).sum::<f64>();
        let noise = trace(&self.noise_covariance) * loads.len() as f64;
        let of_loads = |f: &Vec<f64>| trace(&self.model_error_covariance(f, f));
        let model: f64 = loads.iter().map(of_loads).sum();
        model / (model + noise)
    }

    /// The turned runs that hold errors of the model.
    fn model_error_blocks(
        &self,
        pattern: &Pattern,
        strain: &[&[f64]],
        loads: &[Vec<f64>],
    ) -> Option<Vec<Block>> {
        if self.errors.model_rel <= 0.0 {
            return Some(Vec::new());
        }
        let m = self.m();
        let (runs, k) = (loads.len(), self.s.ncols());
        let d = dense::svd(&Matrix::from_fn(runs, k, |i, l| loads[i][l]))?;
        let least = d.s.first().copied().unwrap_or(0.0) * EMPTY;
        let held = d.s.iter().filter(|s| **s > least && **s > 0.0).count();
        let project = |y: &&[f64]| self.project_strain(pattern, y);
        let z: Vec<Vec<f64>> = strain.iter().map(project).collect();
        let together = (TOGETHER / m.max(1)).clamp(1, held.max(1)).min(held);
        let sets = std::iter::once((0..together).collect::<Vec<_>>())
            .chain((together..held).map(|j| vec![j]));
        sets.filter(|set| !set.is_empty())
            .map(|set| {
                let over_runs: Vec<Vec<f64>> = set
                    .iter()
                    .map(|&j| (0..runs).map(|i| d.u[(i, j)]).collect())
                    .collect();
                let loads: Vec<Vec<f64>> = set
                    .iter()
                    .map(|&j| (0..k).map(|l| d.s[j] * d.v[(l, j)]).collect())
                    .collect();
                self.block(over_runs, &loads, &z)
            })
            .collect()
    }

    fn block(&self, over_runs: Vec<Vec<f64>>, loads: &[Vec<f64>], z: &[Vec<f64>]) -> Option<Block> {
        let (m, q) = (self.m(), loads.len());
        let size = q * m;
        let mut covariance = vec![0.0; size * size];
        for (a, f) in loads.iter().enumerate() {
            for (b, g) in loads.iter().enumerate() {
                let shared = self.model_error_covariance(f, g);
                for i in 0..m {
                    for j in 0..m {
                        let noise = if a == b {
                            self.noise_covariance[i * m + j]
                        } else {
                            0.0
                        };
                        covariance[(a * m + i) * size + b * m + j] = noise + shared[i * m + j];
                    }
                }
            }
        }
        let factor = spd::cholesky(&covariance, size)?;
        let turned: Vec<f64> = over_runs
            .iter()
            .flat_map(|u| (0..m).map(move |a| u.iter().zip(z).map(|(u, z)| u * z[a]).sum::<f64>()))
            .collect();
        let chi2_of_noise = turned
            .chunks_exact(m.max(1))
            .map(|z| {
                let mut x = z.to_vec();
                spd::solve_lower(&self.noise, &mut x);
                spd::dot(&x, &x)
            })
            .sum();
        let mut white = turned;
        spd::solve_lower(&factor, &mut white);
        Some(Block {
            chi2: spd::dot(&white, &white),
            chi2_of_noise,
            over_runs,
            factor,
            white,
        })
    }
}

/// Residuals of all runs, relative to their covariance.
pub(super) struct WhitenedResiduals {
    /// Sum of squares.
    pub chi2: f64,
    /// Residuals of each run, whitened by the covariance of noise and nuisance loads.
    white: Vec<Vec<f64>>,
    turned: Vec<Block>,
}

/// Rotated runs with correlated residuals.
struct Block {
    /// Unit vectors over the runs.
    over_runs: Vec<Vec<f64>>,
    /// Cholesky factor of the covariance.
    factor: Vec<f64>,
    /// Residuals divided by the Cholesky factor.
    white: Vec<f64>,
    chi2: f64,
    /// Sum of squares of the residuals for a covariance of noise alone.
    chi2_of_noise: f64,
}

impl Block {
    /// Returns the components of a vector over the runs in the rotated runs.
    fn shares(&self, along: &[f64]) -> Vec<f64> {
        self.over_runs.iter().map(|u| spd::dot(u, along)).collect()
    }
}

/// Returns orthonormal columns orthogonal to all columns of `a`, `n x (n - rank)`; `None` without such columns or if numbers are not finite.
pub(super) fn complement(a: &Matrix) -> Option<Matrix> {
    let n = a.nrows();
    let d = dense::svd(a)?;
    let largest = d.s.first().copied().unwrap_or(0.0);
    let rank =
        d.s.iter()
            .filter(|&&v| v > largest * dense::RANK_TOLERANCE && v > 0.0)
            .count();
    if rank >= n {
        return None;
    }
    let mut projector = Matrix::identity(n, n);
    for i in 0..rank {
        let u = d.u.column(i);
        projector -= u * u.transpose();
    }
    let e = SymmetricEigen::new(projector);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| {
        e.eigenvalues[j]
            .total_cmp(&e.eigenvalues[i])
            .then(i.cmp(&j))
    });
    order.truncate(n - rank);
    Some(Matrix::from_fn(n, n - rank, |r, c| {
        e.eigenvectors[(r, order[c])]
    }))
}
