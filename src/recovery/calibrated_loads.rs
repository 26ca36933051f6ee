//! Loads by a calibrated S: the covariance of the strain given the loads is known, scatter of repeats and uncertainty of S together.
//!
//! `eps = S f + e`, `Cov e = noise + Cov(eps | f)` of [`Uncertainty`], which grows with the loads, so that solution and weights alternate.

use super::errors::ErrorModel;
use super::types::{Readings, RunEstimate};
use crate::estimate::{LinearEstimate, LinearGaussian, LoadEstimate, ReadingErrors, student_95};
use crate::linalg::{Matrix, spd};
use crate::sensitivity::{GaugeNoise, Sensitivity, Uncertainty};

/// Rounds between loads and the covariance that depends on them; they settle in three.
const ROUNDS: usize = 5;

/// Returns the estimate of one run.
pub fn estimate(
    s: &Sensitivity,
    r: &Readings,
    errors: ErrorModel,
    known: &Uncertainty,
) -> RunEstimate {
    estimate_with(s, r, (errors, Excess::NONE), known).0
}

/// Excess error of readings, relative to the known errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Excess {
    /// Independent excess variance of each reading, divided by its known variance.
    pub each: f64,
    /// Excess covariance of all readings, divided by their known covariance.
    pub all: f64,
}

impl Excess {
    pub const NONE: Self = Self {
        each: 0.0,
        all: 0.0,
    };
}

/// Returns the estimate of readings with an excess error, and the log of their restricted likelihood. It does not depend on the loads:
/// `-1/2 (ln |V| + ln |S' V^-1 S| + r' V^-1 r)`.
///
/// # Reference
/// H. D. Patterson and R. Thompson, Biometrika 58 (1971) 545.
pub(super) fn estimate_with(
    s: &Sensitivity,
    r: &Readings,
    (errors, excess): (ErrorModel, Excess),
    known: &Uncertainty,
) -> (RunEstimate, f64) {
    let (n, k) = (s.gauges.len(), s.loads.len());
    let used: Vec<usize> = (0..n)
        .filter(|&g| r.strain.get(g).is_some_and(|v| v.is_finite()))
        .collect();
    let a = Matrix::from_fn(used.len(), k, |i, l| s.values[(used[i], l)]);
    let y: Vec<f64> = used.iter().map(|&g| r.strain[g]).collect();
    let priors = s.priors();
    let mut out = RunEstimate {
        estimate: LoadEstimate {
            run: r.run.clone(),
            names: s.loads.iter().map(|l| l.name.clone()).collect(),
            values: vec![0.0; k],
            covariance: vec![f64::INFINITY; k * k],
            coverage_factor: student_95(known.dof),
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
    let noise = (errors.noise * errors.noise * r.noise_factor).max(f64::MIN_POSITIVE);
    let of_gauges = s.noise.as_ref().map(|n| n.of_gauges(&used));
    let known_of_used = known.of_gauges(&used);
    let solved = solve(
        &a,
        &y,
        (noise, of_gauges.as_ref(), excess),
        &priors,
        &s.scales(),
        &known_of_used,
    );
    let Some(solved) = solved else {
        return (out, f64::NAN);
    };
    let f = solved.fit.value;
    for l in 0..k {
        for m in 0..k {
            out.estimate.covariance[l * k + m] =
                known.scale * known.scale * solved.fit.covariance[(l, m)];
        }
    }
    for g in 0..n {
        out.predicted[g] = (0..k).map(|l| s.values[(g, l)] * f[l]).sum();
    }
    for (i, &g) in used.iter().enumerate() {
        out.residual[g] = y[i] - out.predicted[g];
        out.sd[g] = solved.variances[i].sqrt();
        out.leverage[g] = solved.fit.leverage[i];
    }
    let stated = f.iter().zip(&priors).filter_map(|(f, p)| Some(f / (*p)?));
    out.chi2 = solved.fit.chi2 + stated.map(|z| z * z).sum::<f64>();
    out.dof = (used.len() + priors.iter().flatten().count()).saturating_sub(solved.fit.rank);
    out.rank = solved.fit.rank;
    out.estimate.values = f;
    let posterior = solved.fit.covariance.transpose();
    let posterior =
        spd::cholesky(posterior.as_slice(), k).map_or(f64::NAN, |l| spd::log_det(&l, k));
    let likelihood = 0.5 * (posterior - solved.log_det - out.chi2);
    (out, likelihood)
}

/// Estimate of one run with the variances of its readings.
struct RunSolution {
    fit: LinearEstimate,
    variances: Vec<f64>,
    /// `ln |V|`.
    log_det: f64,
}

fn solve(
    a: &Matrix,
    y: &[f64],
    (noise, of_gauges, excess): (f64, Option<&GaugeNoise>, Excess),
    priors: &[Option<f64>],
    scales: &[f64],
    known: &Uncertainty,
) -> Option<RunSolution> {
    let n = y.len();
    let estimate = |errors: ReadingErrors<'_>| {
        let model = LinearGaussian {
            rows: a,
            errors,
            prior_sd: priors,
            scales,
        };
        model.estimate(y)
    };
    let mut f = estimate(ReadingErrors::Variances(&vec![noise; n]))?.value;
    let mut out = None;
    for _ in 0..ROUNDS {
        let mut covariance = known.strain_covariance(n, &f);
        covariance.iter_mut().for_each(|v| *v *= 1.0 + excess.all);
        let noise = noise * (1.0 + excess.all);
        for (i, v) in covariance.iter_mut().enumerate() {
            let (g, h) = (i / n, i % n);
            if let Some(of_gauges) = of_gauges.filter(|_| g != h) {
                *v += noise * of_gauges.covariance_between(g, h);
            } else if g == h {
                let own = of_gauges.map_or(1.0, |o| o.variance(g));
                *v = (*v + noise * own) * (1.0 + excess.each);
            }
        }
        let fit = estimate(ReadingErrors::Covariance(&covariance))?;
        f.clone_from(&fit.value);
        out = Some(RunSolution {
            fit,
            variances: (0..n).map(|g| covariance[g * n + g]).collect(),
            log_det: spd::log_det(&spd::cholesky(&covariance, n)?, n),
        });
    }
    out
}
