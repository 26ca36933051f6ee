//! What the residual says: do stated noise and model error explain it, and if not, can the loads be trusted?

use super::errors::ErrorModel;
use super::runs::{Readings, RunEstimate};
use crate::finding::{Finding, Severity};
use crate::linalg::{Matrix, dense};
use crate::sensitivity::Sensitivity;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Findings of this module that widen the intervals.
pub const CODES: [&str; 2] = ["strain-not-explained", "residual-above-stated-errors"];

/// Chance under which a sum of squares counts as larger than stated errors make it.
const SIGNIFICANT: f64 = 1e-3;
/// Chance from which it is beyond doubt.
const BEYOND_DOUBT: f64 = 1e-6;
/// Residual over readings (root mean squares): a right model with the wrong mesh stays under this, a missing load does not.
const EXPLAINED_LIMIT: f64 = 0.05;
/// `sqrt(chi2 / dof)` under which a misfit is small next to stated errors whatever its share.
const BIRGE_LIMIT: f64 = 3.0;

/// Chance of a sum of squares at least as large, where the stated errors are right.
pub fn chance(chi2: f64, dof: usize) -> f64 {
    if dof == 0 {
        return 1.0;
    }
    ChiSquared::new(dof as f64).map_or(1.0, |d| d.sf(chi2))
}

/// Findings on rank, redundancy and the size of the residuals.
pub fn check(
    s: &Sensitivity,
    readings: &[Readings],
    runs: &[RunEstimate],
    errors: ErrorModel,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let dof: usize = runs.iter().map(|r| r.dof).sum();
    let chi2: f64 = runs.iter().map(|r| r.chi2).sum();
    for r in runs.iter().filter(|r| r.rank < s.loads.len()) {
        findings.push(Finding::new(
            Severity::Error,
            "run-not-solvable",
            &r.estimate.run,
            "the gauges that read in this run don't separate the loads: some of its values are arbitrary",
            "bring the silent gauges back, drop loads, or state `expected` for loads with role \"nuisance\"",
        ));
    }
    if dof == 0 {
        findings.push(Finding::new(
            Severity::Warning,
            "no-redundancy",
            "gauges",
            "there are no more gauges than loads: the residual is zero whatever the readings, and a faulty gauge can't be noticed",
            "add gauges: each one above the number of loads checks the rest",
        ));
        return findings;
    }
    let p = chance(chi2, dof);
    let birge = (chi2 / dof as f64).sqrt();
    let share = |pairs: &[(&Readings, &RunEstimate)]| {
        let (mut r2, mut y2, mut n, mut free) = (0.0, 0.0, 0usize, 0usize);
        for (y, r) in pairs {
            free += r.dof;
            for (v, e) in y
                .strain
                .iter()
                .zip(&r.residual)
                .filter(|(v, _)| v.is_finite())
            {
                y2 += v * v;
                r2 += e * e;
                n += 1;
            }
        }
        if y2 > 0.0 && free > 0 {
            (r2 / y2 * n as f64 / free as f64).sqrt()
        } else {
            0.0
        }
    };
    let pairs: Vec<(&Readings, &RunEstimate)> = readings.iter().zip(runs).collect();
    let all = share(&pairs);
    let noise = errors.noise * 1e6;
    let stated = match errors.model_rel {
        r if r > 0.0 => format!(
            "noise of {noise} microstrain and a model uncertainty of {} %",
            r * 100.0
        ),
        _ => format!("noise of {noise} microstrain"),
    };
    let patterns = patterns(runs);
    let remedy = match patterns {
        0 | 1 => "look for a load that acts and is not among the [[load]] (payload, lateral forces, temperature), or a faulty gauge".to_owned(),
        m => format!(
            "the residuals of the runs follow {m} patterns: look for {m} loads or effects that act and are not among the [[load]] (payload and \
             its moments, lateral forces, temperature), then for a faulty gauge"
        ),
    };
    let bad: Vec<&str> = pairs
        .iter()
        .filter(|(_, r)| {
            chance(r.chi2, r.dof) < BEYOND_DOUBT
                && (r.chi2 / r.dof.max(1) as f64).sqrt() > BIRGE_LIMIT
        })
        .filter(|pair| share(&[**pair]) > EXPLAINED_LIMIT)
        .map(|(_, r)| r.estimate.run.as_str())
        .collect();
    if p < BEYOND_DOUBT && birge > BIRGE_LIMIT && (all > EXPLAINED_LIMIT || !bad.is_empty()) {
        let subject = if bad.is_empty() || bad.len() == runs.len() {
            "all runs".to_owned()
        } else {
            bad.join(", ")
        };
        findings.push(
            Finding::new(
                Severity::Error,
                "strain-not-explained",
                subject,
                format!(
                    "the loads asked for leave {:.0} % of the measured strain unexplained, {birge:.1} times what {stated} make: something \
                     else strains the structure, and these loads have taken over part of it. They can't be trusted, nor can their intervals",
                    all * 100.0
                ),
                remedy,
            )
            .with_numbers(birge, BIRGE_LIMIT),
        );
    } else if p < SIGNIFICANT {
        findings.push(
            Finding::new(
                Severity::Warning,
                "residual-above-stated-errors",
                "residual",
                format!(
                    "residuals are {birge:.2} times what {stated} make ({:.1} % of the measured strain): intervals are widened accordingly",
                    all * 100.0
                ),
                "state the noise and `model_uncertainty_rel` you believe in; if you do, a small load is missing or a gauge is off",
            )
            .with_numbers(birge, 1.0),
        );
    } else if 1.0 - p < BEYOND_DOUBT && dof >= 10 {
        findings.push(
            Finding::new(
                Severity::Info,
                "residual-below-stated-errors",
                "residual",
                format!("residuals are {birge:.2} times what {stated} make: intervals are wider than the readings call for"),
                "state a smaller noise or model uncertainty, if that is what you believe",
            )
            .with_numbers(birge, 1.0),
        );
    }
    findings
}

/// Number of patterns among the residuals of the runs that stand out of noise: singular values above the largest one of pure noise.
fn patterns(runs: &[RunEstimate]) -> usize {
    let Some(first) = runs.first() else { return 0 };
    let (n, m) = (first.residual.len(), runs.len());
    let std = |g: usize, r: &RunEstimate| {
        if r.residual[g].is_finite() && r.sd[g] > 0.0 {
            r.residual[g] / r.sd[g]
        } else {
            0.0
        }
    };
    let a = Matrix::from_fn(
        n.max(m),
        m,
        |g, i| if g < n { std(g, &runs[i]) } else { 0.0 },
    );
    let edge = (n as f64).sqrt() + (m as f64).sqrt() + 3.0;
    dense::svd(&a).map_or(0, |d| d.s.iter().filter(|&&s| s > edge).count())
}
