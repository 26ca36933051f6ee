//! Runs whose strain no combination of the calibrated loads makes, tested against the scatter of repeats.

use super::calibrated_loads::{Excess, estimate_with};
use super::errors::ErrorModel;
use super::types::{Readings, RunEstimate};
use super::verdict::{SIGNIFICANT, chance};
use crate::estimate::f_tail;
use crate::estimate::student_95;
use crate::finding::{Finding, Severity};
use crate::sensitivity::{Sensitivity, Uncertainty};

/// Code of a run that no combination of the loads explains.
pub const CODE: &str = "run-unlike-calibration";

/// Returns the probability that chi-square with `dof` degrees of freedom is at least `chi2`. The covariance was estimated with `from` degrees of
/// freedom (infinite for a known covariance).
pub fn chance_estimated(chi2: f64, dof: usize, from: f64) -> f64 {
    if !from.is_finite() || dof == 0 {
        return chance(chi2, dof);
    }
    f_tail(chi2 / dof as f64, dof as f64, from.max(1.0))
}

/// Returns whether the residual of a run is larger than noise, scatter and the uncertainty of S explain.
pub fn is_unlike(run: &RunEstimate, known: &Uncertainty) -> bool {
    chance_estimated(run.chi2, run.dof, known.dof) < SIGNIFICANT
}

/// Returns the root of chi-square over its degrees of freedom (R. T. Birge, Phys. Rev. 40 (1932) 207).
fn birge(run: &RunEstimate) -> f64 {
    (run.chi2 / run.dof.max(1) as f64).sqrt()
}

/// Returns a finding for each run, with the gauges that deviate most. Without a calibration, it is one finding for all runs.
pub fn check(gauges: &[String], runs: &[RunEstimate], known: &Uncertainty) -> Vec<Finding> {
    let unlike = runs.iter().filter(|r| is_unlike(r, known));
    if !known.dof.is_finite() {
        let list: Vec<&RunEstimate> = unlike.collect();
        return above_stated(gauges, &list, runs.len())
            .into_iter()
            .collect();
    }
    unlike
        .map(|r| {
            let birge = birge(r);
            Finding::new(
                Severity::Warning,
                CODE,
                &r.estimate.run,
                format!(
                    "run `{}`: the residual is {birge:.1} times the residual expected from noise, scatter and the uncertainty of S, \
                     largest at {}. The intervals of its loads include this residual, as scatter common to all gauges or as an error of \
                     each gauge, whichever fits better",
                    r.estimate.run,
                    list_worst_gauges(gauges, r)
                ),
                "check for a load at a place without a calibration run, a wrong zero, or a faulty gauge",
            )
            .with_numbers(birge, 1.0)
        })
        .collect()
}

/// Returns the finding on residuals above stated errors, if the errors of S are errors of a model and its mesh.
fn above_stated(gauges: &[String], unlike: &[&RunEstimate], of: usize) -> Option<Finding> {
    let worst_run = (unlike.iter()).max_by(|a, b| birge(a).total_cmp(&birge(b)))?;
    let most = birge(worst_run);
    Some(
        Finding::new(
            Severity::Warning,
            "residual-above-stated-errors",
            "residual",
            format!(
                "in {} of {of} runs residuals are up to {most:.1} times the size from noise, model uncertainty and mesh error, largest in `{}` at {}. The intervals of these runs include this residual as an error of every gauge",
                unlike.len(),
                worst_run.estimate.run,
                list_worst_gauges(gauges, worst_run)
            ),
            "state the actual noise and `model_uncertainty_rel`, or refine the deck; if both are correct, a small load is missing or a \
             gauge is wrong",
        )
        .with_numbers(most, 1.0),
    )
}

/// Steps in which the added error is looked for, times the variance of the readings; from the last of them it is no longer sought.
const STEP: f64 = 16.0;
const MOST: f64 = 1e30;
/// Halvings of the last step: to six digits.
const HALVINGS: usize = 20;

/// Returns the estimate with as much additional error as explains the residual. Of two forms of the error, the more likely one is used. The first
/// scales the whole covariance, as if the run scatters like the calibration runs, but more. The second adds a separate error to every reading, which
/// is an unknown pattern over the gauges. It is larger for gauges with larger noise, scatter and uncertainty of S. It occurs if a truck is at a place
/// that no run has covered. Each form has one size, which is determined from the run. If only a stated error of S is known, the second form is used.
///
/// The added error is not constant over the gauges: with a constant error the gauges near a wheel would dominate, which scatter most.
///
/// # Reference
/// Excess scatter as a factor: R. T. Birge, Phys. Rev. 40 (1932) 207. Excess scatter as an added variance: R. DerSimonian and N. Laird, Control.
/// Clin. Trials 7 (1986) 177.
pub fn estimate_loosely(
    s: &Sensitivity,
    readings: &Readings,
    errors: ErrorModel,
    known: &Uncertainty,
) -> RunEstimate {
    let with = |excess: Excess| estimate_with(s, readings, (errors, excess), known);
    let (apart, likelihood_apart) =
        estimate_with_least_excess(&|each| with(Excess { each, all: 0.0 }));
    if !known.dof.is_finite() {
        return apart;
    }
    let (mut together, likelihood) =
        estimate_with_least_excess(&|all| with(Excess { each: 0.0, all }));
    if !(likelihood > likelihood_apart) {
        return apart;
    }
    // The factor is estimated from this run, so it has at most the degrees of freedom of its residual.
    together.estimate.coverage_factor = student_95(known.dof.min(together.dof as f64));
    together
}

/// Returns the estimate with the least additional error that explains the residual of a run.
fn estimate_with_least_excess(with: &dyn Fn(f64) -> (RunEstimate, f64)) -> (RunEstimate, f64) {
    let is = |more: f64| {
        let run = with(more).0;
        run.chi2 <= run.dof as f64
    };
    let (mut low, mut high) = (0.0, 1.0);
    while !is(high) && high < MOST {
        (low, high) = (high, STEP * high);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match is(middle) {
            true => high = middle,
            false => low = middle,
        }
    }
    with(high)
}

/// Returns the three gauges with the largest residual over its sd, with reading minus prediction.
fn list_worst_gauges(gauges: &[String], run: &RunEstimate) -> String {
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
