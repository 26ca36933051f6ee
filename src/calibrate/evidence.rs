//! Probability of the readings of one gauge under different priors of its row.

use super::given_others::ByGauge;
use crate::linalg::precision::Precision;
use crate::linalg::spd;

/// Normal equations of one row from the runs, in loads of unit size: `A = sum phi phi' / v` and `b = sum phi y / v`.
#[derive(Clone, Debug)]
pub(super) struct NormalEquations {
    matrix: Vec<f64>,
    right: Vec<f64>,
}

impl NormalEquations {
    /// Sums the normal equations of gauge `g` over the runs in which the gauge has a reading.
    pub fn from_runs(g: usize, k: usize, runs: &[ByGauge]) -> Self {
        let mut out = Self {
            matrix: vec![0.0; k * k],
            right: vec![0.0; k],
        };
        for run in runs {
            let Some(y) = run.y.get(g).filter(|v| v.is_finite()) else {
                continue;
            };
            out.add(&run.phi, *y, 1.0 / run.variance[g]);
        }
        out
    }

    /// Returns the normal equations without a reading `y` at loads `phi`; unchanged if `y` is not finite.
    pub fn without_reading(&self, phi: &[f64], y: f64, variance: f64) -> Self {
        let mut out = self.clone();
        if y.is_finite() {
            out.add(phi, y, -1.0 / variance);
        }
        out
    }

    fn add(&mut self, phi: &[f64], y: f64, weight: f64) {
        spd::add_outer(&mut self.matrix, phi, weight);
        for (b, p) in self.right.iter_mut().zip(phi) {
            *b += p * y * weight;
        }
    }
}

/// Log marginal likelihood of a gauge's readings if its row is `s + e`, `Cov e = B`, and its change with additions to the row.
///
/// With `W = B^-1 + A` and `d = b - A s`, up to terms that do not depend on the prior, it is `L(0) = (d' W^-1 d - ln |B| - ln |W|) / 2`. For a row
/// `s + t + e` it is `L(t) = L(0) + t' B^-1 W^-1 d - t' B^-1 W^-1 A t / 2`.
pub(super) struct RowEvidence<'a> {
    normal: &'a NormalEquations,
    /// `B^-1` and `W^-1`.
    prior: Precision,
    posterior: Precision,
    /// `B^-1 W^-1 d`.
    slope: Vec<f64>,
    /// `L(0)`.
    log: f64,
}

impl<'a> RowEvidence<'a> {
    /// Returns the evidence for a row of this mean and covariance; `None` if the covariance is not positive definite.
    pub fn from_row_prior(
        mean: &[f64],
        covariance: &[f64],
        normal: &'a NormalEquations,
    ) -> Option<Self> {
        let k = mean.len();
        let prior = Precision::from_covariance(covariance, k)?;
        let total: Vec<f64> = (0..k * k)
            .map(|i| prior.entry(i / k, i % k) + normal.matrix[i])
            .collect();
        let posterior = Precision::from_covariance(&total, k)?;
        let mut known = vec![0.0; k];
        spd::times(&normal.matrix, mean, &mut known);
        let d = normal.right.iter().zip(&known).map(|(b, a)| b - a);
        let d: Vec<f64> = d.collect();
        let found = posterior.apply(&d);
        // `log_det` returns the log determinant of the inverted matrix: of B for the prior, of W for the posterior.
        let log = 0.5 * (spd::dot(&found, &d) - prior.log_det() - posterior.log_det());
        Some(Self {
            normal,
            slope: prior.apply(&found),
            prior,
            posterior,
            log,
        })
    }

    /// Returns `L(0)`.
    pub fn log(&self) -> f64 {
        self.log
    }

    /// Returns the first and second order of `L` in the amounts of some directions `t_i`: `t_i' B^-1 W^-1 d`, and `t_i' B^-1 W^-1 A t_j` by rows.
    pub fn orders(&self, directions: &[&[f64]]) -> (Vec<f64>, Vec<f64>) {
        let first = directions.iter().map(|t| spd::dot(t, &self.slope));
        let mut second = Vec::with_capacity(directions.len() * directions.len());
        for t in directions {
            let mut taught = vec![0.0; t.len()];
            spd::times(&self.normal.matrix, t, &mut taught);
            let bent = self.prior.apply(&self.posterior.apply(&taught));
            second.extend(directions.iter().map(|u| spd::dot(u, &bent)));
        }
        (first.collect(), second)
    }

    /// Returns the log marginal likelihood if each direction is added with an independent amount of standard deviation `sd`. It is
    /// `L(0) - ln |I + Q| / 2 + l' (I + Q)^-1 l / 2`, with `l` and `Q` the first and second order in units of `sd`.
    pub fn log_with_directions(&self, directions: &[&[f64]], sd: f64) -> f64 {
        let n = directions.len();
        let (first, second) = self.orders(directions);
        let total: Vec<f64> = (0..n * n)
            .map(|i| sd * sd * second[i] + if i / n == i % n { 1.0 } else { 0.0 })
            .collect();
        let first: Vec<f64> = first.iter().map(|l| sd * l).collect();
        Precision::from_covariance(&total, n).map_or(f64::NEG_INFINITY, |p| {
            self.log + 0.5 * (spd::dot(&p.apply(&first), &first) - p.log_det())
        })
    }
}
