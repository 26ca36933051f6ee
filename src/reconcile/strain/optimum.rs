//! Parameters of a set that maximise its posterior, with amplitudes integrated out.

use super::likelihood::{Fit, Likelihood};
use crate::linalg::precision::Precision;
use crate::reconcile::effect::Parameter;
use crate::reconcile::search::{Addition, ScoredSet};

/// Parameters that maximise the posterior of a set.
pub(super) struct Optimum {
    /// Parameters by member.
    pub(super) theta: Vec<Vec<f64>>,
    /// Half the sum of chi-square and the squared deviations of the parameters from neutral over their prior standard deviations.
    pub(super) value: f64,
    pub(super) chi2: f64,
    pub(super) residual: Vec<f64>,
    /// Hessian of `value` in all parameters, by rows.
    pub(super) hessian: Vec<f64>,
}

impl Likelihood<'_> {
    /// Computes the parameters of `set` that maximise the posterior, by Gauss-Newton from `start` with step halving.
    pub(super) fn optimise(
        &self,
        set: &[usize],
        start: Vec<Vec<f64>>,
        precision: &Precision,
    ) -> Option<Optimum> {
        /// Steps: a quadratic objective needs two.
        const STEPS: usize = 12;
        /// Gain of log posterior below which the optimum is reached.
        const SETTLED: f64 = 1e-6;
        let described = self.parameters_of(set);
        let flat: Vec<(usize, usize, &Parameter)> = described
            .iter()
            .enumerate()
            .flat_map(|(m, ps)| ps.iter().enumerate().map(move |(k, p)| (m, k, p)))
            .collect();
        let objective = |theta: &[Vec<f64>]| {
            let r = self.residual(set, theta);
            let pr = precision.apply(&r);
            let fit: f64 = r.iter().zip(&pr).map(|(a, b)| a * b).sum();
            let prior: f64 = flat
                .iter()
                .map(|&(m, k, p)| ((theta[m][k] - p.neutral) / p.prior_sd).powi(2))
                .sum();
            (0.5 * (fit + prior), fit, r, pr)
        };
        let mut theta = start;
        let (mut value, mut chi2, mut r, mut pr) = objective(&theta);
        let n = flat.len();
        let mut hessian = Vec::new();
        for _ in 0..STEPS {
            // Columns of -dr/dtheta: the change of the prediction.
            let mut columns = Vec::with_capacity(n);
            for &(m, k, p) in &flat {
                let mut moved = theta.clone();
                moved[m][k] += p.step;
                let rm = self.residual(set, &moved);
                columns.push(
                    r.iter()
                        .zip(&rm)
                        .map(|(a, b)| (a - b) / p.step)
                        .collect::<Vec<f64>>(),
                );
            }
            let weighted: Vec<Vec<f64>> = columns.iter().map(|c| precision.apply(c)).collect();
            hessian = vec![0.0; n * n];
            let mut gradient = vec![0.0; n];
            for (i, &(m, k, p)) in flat.iter().enumerate() {
                for (j, w) in weighted.iter().enumerate() {
                    hessian[i * n + j] = columns[i].iter().zip(w).map(|(a, b)| a * b).sum();
                }
                hessian[i * n + i] += 1.0 / (p.prior_sd * p.prior_sd);
                let slope: f64 = columns[i].iter().zip(&pr).map(|(a, b)| a * b).sum();
                gradient[i] = slope - (theta[m][k] - p.neutral) / (p.prior_sd * p.prior_sd);
            }
            if n == 0 {
                break;
            }
            let step = Precision::from_covariance(&hessian, n)?.apply(&gradient);
            let mut scale = 1.0;
            let mut improved = false;
            for _ in 0..6 {
                let mut moved = theta.clone();
                for (&(m, k, _), s) in flat.iter().zip(&step) {
                    moved[m][k] += scale * s;
                }
                let (v, c, rm, prm) = objective(&moved);
                if v < value - SETTLED {
                    (theta, value, chi2, r, pr) = (moved, v, c, rm, prm);
                    improved = true;
                    break;
                }
                scale *= 0.4;
            }
            if !improved {
                break;
            }
        }
        Some(Optimum {
            theta,
            value,
            chi2,
            residual: r,
            hessian,
        })
    }

    /// Returns every combination of the starts of the members' parameters, at most a dozen.
    fn starts(&self, set: &[usize]) -> Vec<Vec<Vec<f64>>> {
        const MOST: usize = 12;
        let mut out: Vec<Vec<Vec<f64>>> = vec![Vec::new()];
        for parameters in self.parameters_of(set) {
            let mut here: Vec<Vec<f64>> = vec![Vec::new()];
            for p in &parameters {
                here = here
                    .iter()
                    .flat_map(|h| p.starts.iter().map(move |s| [h.as_slice(), &[*s]].concat()))
                    .collect();
            }
            out = out
                .iter()
                .flat_map(|o| {
                    here.iter()
                        .map(move |h| [o.as_slice(), std::slice::from_ref(h)].concat())
                })
                .collect();
            out.truncate(MOST);
        }
        out
    }

    /// Returns start parameters of `set` from the fit of a neighbouring set and from an addition. `None` if a member is in neither.
    pub(super) fn start_near(
        &self,
        set: &[usize],
        near: &ScoredSet<Fit>,
        addition: Option<&Addition>,
    ) -> Option<Vec<Vec<f64>>> {
        let known = |c: &usize| {
            let at = near.set.iter().position(|n| n == c);
            let from_near = at.and_then(|k| near.fit.parameters.get(k).cloned());
            from_near.or_else(|| {
                addition
                    .filter(|a| a.candidate == *c)
                    .map(|a| a.parameters.clone())
            })
        };
        set.iter().map(known).collect()
    }

    pub(super) fn best_of_starts(&self, set: &[usize], precision: &Precision) -> Option<Optimum> {
        let found = self
            .starts(set)
            .into_iter()
            .filter_map(|s| self.optimise(set, s, precision));
        found.min_by(|a, b| a.value.total_cmp(&b.value))
    }
}
