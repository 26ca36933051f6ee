//! Static states: one estimate a run, all judged together.

use super::errors::ErrorModel;
use super::solve::fit;
use super::{faults, verdict};
use crate::estimate::LoadEstimate;
use crate::finding::Finding;
use crate::linalg::Matrix;
use crate::sensitivity::Sensitivity;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Readings of one static state.
#[derive(Clone, Debug, PartialEq)]
pub struct Readings {
    /// Run name.
    pub run: String,
    /// Strain by gauge, zero and reference taken into account; NaN where a gauge gave nothing.
    pub strain: Vec<f64>,
    /// Noise variance of these readings in units of that of a single one: `1/n_run + 1/n_zero` for means of `n` effective samples.
    pub noise_factor: f64,
}

/// The estimate of one run with its residual.
#[derive(Clone, Debug, PartialEq)]
pub struct RunEstimate {
    /// Loads with covariance.
    pub estimate: LoadEstimate,
    /// Predicted strain by gauge.
    pub predicted: Vec<f64>,
    /// Reading less prediction; NaN where a gauge gave nothing.
    pub residual: Vec<f64>,
    /// 1 sd of each reading, stated noise and model error together.
    pub sd: Vec<f64>,
    /// Sum of squares of residuals over sd.
    pub chi2: f64,
    /// Readings less loads (plus stated priors).
    pub dof: usize,
    /// Leverage by gauge.
    pub leverage: Vec<f64>,
    /// Rank of the system.
    pub rank: usize,
}

/// All runs.
#[derive(Clone, Debug, PartialEq)]
pub struct Recovery {
    /// In the order given.
    pub runs: Vec<RunEstimate>,
    /// Root mean square of all residuals, strain, over the degrees of freedom.
    pub residual_rms: f64,
    /// Root mean square residual by gauge, strain.
    pub gauge_residual_rms: Vec<f64>,
    /// Mean leverage by gauge.
    pub gauge_leverage: Vec<f64>,
    /// What was noticed.
    pub findings: Vec<Finding>,
}

/// Factor on sigma of a 95 % interval where sigma is known.
pub const NORMAL_95: f64 = 1.959_963_984_540_054;

/// Factor on sigma of a 95 % interval where sigma is estimated with `dof` degrees of freedom.
pub fn student_95(dof: usize) -> f64 {
    StudentsT::new(0.0, 1.0, dof.max(1) as f64).map_or(NORMAL_95, |t| t.inverse_cdf(0.975))
}

/// Loads of every run with intervals, and findings on what the residuals say.
///
/// Where the residuals are larger than stated noise and model error explain, the covariance of a run is multiplied by its
/// `chi2 / dof` (Birge) and its interval takes Student's factor.
///
/// # Reference
/// R. T. Birge, Phys. Rev. 40 (1932) 207; A. C. Aitken, Proc. R. Soc. Edinburgh 55 (1935) 42.
pub fn recover(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> Recovery {
    let mut runs: Vec<RunEstimate> = readings
        .par_iter()
        .map(|r| estimate(s, r, errors))
        .collect();
    let mut findings = verdict::check(s, readings, &runs, errors);
    if findings.iter().any(|f| verdict::CODES.contains(&f.code)) {
        findings.extend(faults::check(s, readings, errors));
        for r in &mut runs {
            let birge = if r.dof > 0 {
                r.chi2 / r.dof as f64
            } else {
                1.0
            };
            if birge > 1.0 {
                r.estimate.covariance.iter_mut().for_each(|v| *v *= birge);
                r.estimate.coverage_factor = student_95(r.dof);
            }
        }
    }
    let (n, mut sum, mut dof) = (s.gauges.len(), 0.0, 0);
    let mut by_gauge = vec![(0.0, 0usize); n];
    let mut leverage = vec![0.0; n];
    for r in &runs {
        dof += r.dof;
        for g in 0..n {
            leverage[g] += r.leverage[g] / runs.len() as f64;
            if r.residual[g].is_finite() {
                sum += r.residual[g].powi(2);
                by_gauge[g].0 += r.residual[g].powi(2);
                by_gauge[g].1 += 1;
            }
        }
    }
    Recovery {
        runs,
        residual_rms: if dof > 0 {
            (sum / dof as f64).sqrt()
        } else {
            0.0
        },
        gauge_residual_rms: by_gauge
            .iter()
            .map(|(q, m)| if *m > 0 { (q / *m as f64).sqrt() } else { 0.0 })
            .collect(),
        gauge_leverage: leverage,
        findings,
    }
}

/// Iterations between loads and the variances that depend on them; they settle in two or three.
const ITERATIONS: usize = 4;

/// One run: weights depend on the loads through the model error, so solution and weights alternate.
pub fn estimate(s: &Sensitivity, r: &Readings, errors: ErrorModel) -> RunEstimate {
    let (n, k) = (s.gauges.len(), s.loads.len());
    let used: Vec<usize> = (0..n)
        .filter(|&g| r.strain.get(g).is_some_and(|v| v.is_finite()))
        .collect();
    let a = Matrix::from_fn(used.len(), k, |i, l| s.values[(used[i], l)]);
    let y: Vec<f64> = used.iter().map(|&g| r.strain[g]).collect();
    let priors: Vec<Option<f64>> = s
        .loads
        .iter()
        .map(|l| {
            if l.wanted {
                None
            } else {
                l.expected.filter(|e| *e > 0.0)
            }
        })
        .collect();
    let scales = s.scales();
    let mut f = vec![0.0; k];
    let mut variances = vec![1.0; used.len()];
    let mut solved = None;
    let rounds = if errors.model_rel > 0.0 {
        ITERATIONS
    } else {
        1
    };
    for round in 0..rounds {
        variances = if round == 0 {
            vec![(errors.noise * errors.noise * r.noise_factor).max(f64::MIN_POSITIVE); used.len()]
        } else {
            errors
                .variances(&a, &f, r.noise_factor)
                .iter()
                .map(|v| v.max(f64::MIN_POSITIVE))
                .collect()
        };
        solved = fit(&a, &y, &variances, &priors, &scales);
        match &solved {
            Some(fit) => f.clone_from(&fit.f),
            None => break,
        }
    }
    if errors.model_rel > 0.0 {
        variances = errors
            .variances(&a, &f, r.noise_factor)
            .iter()
            .map(|v| v.max(f64::MIN_POSITIVE))
            .collect();
    }
    let mut out = RunEstimate {
        estimate: LoadEstimate {
            run: r.run.clone(),
            names: s.loads.iter().map(|l| l.name.clone()).collect(),
            values: f.clone(),
            covariance: vec![f64::INFINITY; k * k],
            coverage_factor: NORMAL_95,
            findings: Vec::new(),
        },
        predicted: vec![f64::NAN; n],
        residual: vec![f64::NAN; n],
        sd: vec![f64::NAN; n],
        chi2: 0.0,
        dof: 0,
        leverage: vec![0.0; n],
        rank: 0,
    };
    let Some(fit) = solved else { return out };
    for l in 0..k {
        for m in 0..k {
            out.estimate.covariance[l * k + m] = fit.covariance[(l, m)];
        }
        out.estimate.covariance[l * k + l] += errors.column_variance(f[l]);
    }
    for g in 0..n {
        out.predicted[g] = (0..k).map(|l| s.values[(g, l)] * f[l]).sum();
    }
    for (i, &g) in used.iter().enumerate() {
        out.residual[g] = y[i] - out.predicted[g];
        out.sd[g] = variances[i].sqrt();
        out.chi2 += out.residual[g].powi(2) / variances[i];
        out.leverage[g] = fit.leverage[i];
    }
    for (l, p) in priors.iter().enumerate() {
        if let Some(p) = p {
            out.chi2 += (f[l] / p).powi(2);
        }
    }
    let stated = priors.iter().flatten().count();
    out.dof = (used.len() + stated).saturating_sub(fit.rank);
    out.rank = fit.rank;
    out
}
