//! Runs whose strain is none that the calibrated loads make, judged against what repeats scatter by.

use super::calibrated::estimate;
use super::errors::ErrorModel;
use super::types::{Readings, RunEstimate};
use super::verdict::chance;
use crate::finding::{Finding, Severity};
use crate::linalg::tail::f_tail;
use crate::sensitivity::{Sensitivity, Uncertainty};

/// Code of a run that no combination of the loads explains.
pub const CODE: &str = "run-unlike-calibration";

/// Chance under which a run counts as unlike the calibration.
const SIGNIFICANT: f64 = 1e-3;

/// Chance of `chi2` over `dof` at least as large, where the covariance behind it was estimated with `from` degrees of freedom.
pub fn chance_estimated(chi2: f64, dof: usize, from: f64) -> f64 {
    if !from.is_finite() || dof == 0 {
        return chance(chi2, dof);
    }
    f_tail(chi2 / dof as f64, dof as f64, from.max(1.0))
}

/// Whether a run's residual is larger than noise, scatter and the uncertainty of S make it.
pub fn is_unlike(run: &RunEstimate, known: &Uncertainty) -> bool {
    chance_estimated(run.chi2, run.dof, known.dof) < SIGNIFICANT
}

/// A finding a run, with the gauges that deviate most.
pub fn check(gauges: &[String], runs: &[RunEstimate], known: &Uncertainty) -> Vec<Finding> {
    let unlike = runs.iter().filter(|r| is_unlike(r, known));
    unlike
        .map(|r| {
            let birge = (r.chi2 / r.dof.max(1) as f64).sqrt();
            Finding::new(
                Severity::Warning,
                CODE,
                &r.estimate.run,
                format!(
                    "run `{}`: what the loads leave is {birge:.1} times what noise, scatter and the uncertainty of S make, most at {}. Its loads are estimated with \
                     that much more error on every gauge, their intervals accordingly",
                    r.estimate.run,
                    worst(gauges, r)
                ),
                "look for a load at a place that the calibration has not seen, a wrong zero, or a faulty gauge",
            )
            .with_numbers(birge, 1.0)
        })
        .collect()
}

/// Halvings of the interval in which the added error is sought: more than any reading has digits.
const HALVINGS: usize = 30;

/// The estimate with as much error added to every reading as explains what is left: an unknown pattern, alike for all gauges.
///
/// # Reference
/// R. DerSimonian and N. Laird, Control. Clin. Trials 7 (1986) 177: excess scatter as a variance added, not as a factor.
pub fn estimate_loosely(
    s: &Sensitivity,
    readings: &Readings,
    errors: ErrorModel,
    known: &Uncertainty,
) -> RunEstimate {
    let with = |noise: f64| estimate(s, readings, ErrorModel { noise, ..errors }, known);
    let largest = readings
        .strain
        .iter()
        .filter(|v| v.is_finite())
        .fold(errors.noise, |a, v| a.max(v.abs()));
    let (mut low, mut high) = (errors.noise, largest);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let run = with(middle);
        if run.chi2 > run.dof as f64 {
            low = middle;
        } else {
            high = middle;
        }
    }
    with(high)
}

/// The three gauges with the largest residual over its sd, with reading less prediction.
fn worst(gauges: &[String], run: &RunEstimate) -> String {
    let mut order: Vec<(f64, usize)> = (0..gauges.len())
        .filter(|&g| run.residual[g].is_finite() && run.sd[g] > 0.0)
        .map(|g| (run.residual[g].abs() / run.sd[g], g))
        .collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let list = order.iter().take(3).map(|&(_, g)| {
        format!(
            "`{}` ({:+.1} microstrain)",
            gauges[g],
            run.residual[g] * 1e6
        )
    });
    list.collect::<Vec<_>>().join(", ")
}
