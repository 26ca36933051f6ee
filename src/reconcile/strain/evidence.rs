//! Log evidence of a set: log likelihood at its best parameters, minus the cost of their width and of the prior weights.

use super::calibration_scatter::heavier_tail;
use super::likelihood::{Fit, Likelihood};
use crate::linalg::precision::Precision;
use crate::reconcile::search::{Addition, ScoredSet};

impl Likelihood<'_> {
    /// Fits `set`, starting from the neutral parameters or from a fit of a neighbouring set.
    pub(super) fn evidence_of(
        &mut self,
        set: &[usize],
        from: Option<(&ScoredSet<Fit>, Option<&Addition>)>,
    ) -> Option<ScoredSet<Fit>> {
        let families = self.with_amplitudes(set);
        let mut sizes: Vec<(usize, Vec<f64>)> = Vec::new();
        for &c in &families {
            let known = from.and_then(|(near, _)| {
                near.fit
                    .sizes
                    .iter()
                    .find(|s| s.0 == c)
                    .map(|s| s.1.clone())
            });
            let added =
                from.and_then(|(_, a)| a.filter(|a| a.candidate == c).map(|a| a.sizes.clone()));
            let a = self.candidates.get(c)?.effect.amplitudes(self.frame)?;
            let usual = [a.usual, a.steady].concat();
            sizes.push((
                c,
                known
                    .or(added)
                    .filter(|s| s.len() == usual.len())
                    .unwrap_or(usual),
            ));
        }
        let mut precision = self.precision(&sizes)?;
        let mut best = match from.and_then(|(near, addition)| self.start_near(set, near, addition))
        {
            Some(start) => self.optimise(set, start, &precision)?,
            None => self.best_of_starts(set, &precision)?,
        };
        if !families.is_empty() {
            let members = self.members(set, &best.theta);
            sizes = self.sizes_from(&families, &members, &best.residual);
            precision = self.precision(&sizes)?;
            best = self.optimise(set, best.theta, &precision)?;
        }
        let n = best.hessian.len().isqrt();
        let tail = heavier_tail(self.frame, best.chi2, self.selection.len());
        let mut log_evidence = tail - best.value - 0.5 * precision.log_det();
        let mut joint = Vec::new();
        let mut sigma: Vec<Vec<f64>> = best.theta.iter().map(|t| vec![0.0; t.len()]).collect();
        if n > 0 {
            let posterior = Precision::from_covariance(&best.hessian, n)?;
            log_evidence -= 0.5 * posterior.log_det();
            let mut i = 0;
            for (m, ps) in self.parameters_of(set).iter().enumerate() {
                for (k, p) in ps.iter().enumerate() {
                    log_evidence -= p.prior_sd.ln();
                    sigma[m][k] = posterior.entry(i, i).max(0.0).sqrt();
                    i += 1;
                }
            }
            joint = (0..n * n).map(|k| posterior.entry(k / n, k % n)).collect();
        }
        let runs = self.runs.len();
        for (_, s) in &sizes {
            // Each size is a parameter whose logarithm is estimated from all runs.
            let n_sizes = s.iter().filter(|s| **s > 0.0).count();
            log_evidence -= 0.5 * (runs.max(1) as f64).ln() * n_sizes as f64;
        }
        log_evidence += set
            .iter()
            .filter_map(|&c| self.candidates.get(c))
            .map(|c| c.log_prior)
            .sum::<f64>();
        let fit = Fit {
            parameters: best.theta,
            sigma,
            covariance: joint,
            sizes,
            residual: best.residual,
            chi2: best.chi2,
        };
        Some(ScoredSet {
            set: set.to_vec(),
            log_evidence,
            fit,
        })
    }
}
