//! Runs left out one by one: their loads recovered from the other runs, compared with the known loads.

use super::common_zero::{less_zero, zero_of};
use super::posterior::{Equation, Posterior, solve};
use super::prior::{RowPrior, rows};
use super::scatter::{RunResiduals, Scatter};
use super::state::{State, run_residuals, sensitivity_of};
use super::types::{Coverage, KnownLoads, KnownRun, LeftOut, Task};
use super::unknown_directions::{SPANNED, UNKNOWN, wide_directions};
use crate::estimate::COVERAGE;
use crate::linalg::spd;
use crate::recovery::{ErrorModel, Readings, RunEstimate, estimate};
use crate::sensitivity::Sensitivity;
use rayon::prelude::*;
use statrs::distribution::{ChiSquared, ContinuousCDF, FisherSnedecor};

/// Chance under which left-out runs count as farther off than expected: then a factor is applied.
const WIDEN: f64 = 0.05;
/// Chance over all runs together below which a run certainly contradicts the other runs and is not used. The scatter of repeats has longer tails than
/// a Gaussian (a truck off its lane), so that a chance of 0.001 is not enough.
pub(super) const REFUSE: f64 = 1e-6;
/// Chance over all runs together below which a run is reported and does not widen the intervals of the other runs.
pub(super) const SUSPECT: f64 = 1e-3;

/// Recovers every run from the other runs, if these determine it.
pub(super) fn leave_out(task: &Task, state: &State) -> Vec<LeftOut> {
    (0..state.used.len())
        .into_par_iter()
        .filter_map(|i| recover_left_out(task, state, i, &[], &task.runs[state.used[i]].loads))
        .collect()
}

/// Recovers the used run `i` and compares the result with `loads`. S comes from the other runs except `left_out`. Returns `None` if these runs do not
/// determine the loads of run `i`.
pub(super) fn recover_left_out(
    task: &Task,
    state: &State,
    i: usize,
    left_out: &[usize],
    loads: &KnownLoads,
) -> Option<LeftOut> {
    let number = *state.used.get(i)?;
    let run = task.runs.get(number)?;
    let gone: Vec<usize> = std::iter::once(i).chain(left_out.iter().copied()).collect();
    if task.model.is_none() && !others_span(state, &gone) {
        return None;
    }
    let order = (state.posterior.n * state.posterior.k) as f64;
    let affordable = order.powi(3) * state.used.len() as f64 <= AFFORDABLE;
    let cheap = affordable || state.equations.iter().all(Equation::is_by_gauge);
    // Each gauge's own model error is estimated without this run too. With this run included, the run would be closer to S than a new run.
    let learnt = task.model.as_ref().zip(state.error_evidence.as_ref());
    let learnt = learnt.filter(|_| cheap).map(|(model, evidence)| {
        let wrong = &state.wrongly_wired;
        let errors = evidence.by_gauge_without(i, model, &state.scales, wrong);
        rows(model, &state.scales, errors.into_iter().enumerate())
    });
    let prior = learnt.as_deref().unwrap_or(&state.prior);
    // Repeats share an error with this run that new runs do not have. They are therefore left out as well.
    let group: Vec<usize> = (0..state.used.len())
        .filter(|j| task.runs[state.used[*j]].group == run.group)
        .collect();
    let with_repeats = cheap
        && left_out.is_empty()
        && state.scatter.common > 0.0
        && group.len() > 1
        && (task.model.is_some() || others_span(state, &group));
    let out = if with_repeats { group } else { gone };
    let mut posterior = match learnt.is_some() || out.len() > 1 {
        true => solve_without_runs(state, prior, &out, &state.scatter_used)?,
        false => state.posterior.without_equation(&state.equations[i])?,
    };
    // A single wrong run may be the whole scatter. The residuals of the other runs are then noise, and the run is tested against noise.
    let scatters = state.scatter.dof.is_finite();
    let mut scatter = Scatter::none(posterior.n);
    // Two rounds: if a wrong run is included, the first equations give the other runs too little weight.
    let rounds = match (scatters, affordable) {
        (false, _) => 0,
        (true, false) => 1,
        (true, true) => ROUNDS,
    };
    for _ in 0..rounds {
        let others = others_left(task, state, &out, &posterior);
        scatter = Scatter::at_most(&others, state.fitted, &posterior.matrix());
        if !scatter.dof.is_finite() {
            return None;
        }
        if affordable {
            posterior = solve_without_runs(state, prior, &out, &scatter)?;
        }
    }
    let dof = scatter.dof;
    let s = sensitivity_of(
        task,
        (&state.scales, &posterior, &scatter),
        1.0,
        &state.lack,
    );
    let found = recover_run(task, run, &s, &zero_of(task, &posterior));
    let k = s.loads.len();
    let loads = &loads.first_loads(k);
    if found.rank < k {
        return None;
    }
    let wanted: Vec<usize> = (0..k).filter(|&l| task.loads[l].wanted).collect();
    let w = wanted.len();
    let entry = |i: usize| {
        let at = wanted[i / w] * k + wanted[i % w];
        found.estimate.covariance[at] + loads.covariance[at]
    };
    let covariance: Vec<f64> = (0..w * w).map(entry).collect();
    let told = KnownLoadPart::from_known_loads(loads, &wanted, &state.scales[..k]);
    if told.combinations == 0 {
        return None;
    }
    let apart: Vec<f64> = wanted
        .iter()
        .map(|&l| found.estimate.values[l] - loads.mean[l])
        .collect();
    let sum = |terms: &Vec<f64>| -> f64 {
        let terms: Vec<f64> = wanted
            .iter()
            .map(|&l| terms.get(l).copied().unwrap_or(0.0))
            .collect();
        let off = spd::dot(&terms, &apart);
        let variance: f64 = (0..w * w)
            .map(|i| terms[i / w] * terms[i % w] * covariance[i])
            .sum();
        off * off / variance
    };
    let each = told.alone.iter();
    let each = each.map(|&i| apart[i] * apart[i] / covariance[i * w + i]);
    Some(LeftOut {
        each: each.sum::<f64>() / told.alone.len().max(1) as f64,
        alone: told.alone.len(),
        sums: task
            .sums
            .iter()
            .map(sum)
            .filter(|z| z.is_finite())
            .collect(),
        number,
        distance: mahalanobis(&covariance, &apart)?,
        loads: told.combinations,
        dof,
        misfit: found.chi2 / found.dof.max(1) as f64,
        known: loads.mean.clone(),
        estimate: found.estimate,
    })
}

/// A run recovered by S, its readings minus the common zero.
fn recover_run(task: &Task, run: &KnownRun, s: &Sensitivity, zero: &[f64]) -> RunEstimate {
    let readings = Readings {
        run: run.run.clone(),
        strain: less_zero(&run.strain, zero),
        noise_factor: run.noise_factor,
    };
    let errors = ErrorModel {
        noise: task.noise,
        model_rel: 0.0,
    };
    estimate(s, &readings, errors)
}

/// Known part of a run's wanted loads.
struct KnownLoadPart {
    /// Number of independent combinations that are known.
    combinations: usize,
    /// Loads that are known individually, by number among the wanted loads.
    alone: Vec<usize>,
}

impl KnownLoadPart {
    fn from_known_loads(known: &KnownLoads, wanted: &[usize], scales: &[f64]) -> Self {
        let (k, w) = (scales.len(), wanted.len());
        let entry = |i: usize| known.covariance[wanted[i / w] * k + wanted[i % w]];
        let loads = KnownLoads {
            mean: wanted.iter().map(|l| known.mean[*l]).collect(),
            covariance: (0..w * w).map(entry).collect(),
        };
        let scales: Vec<f64> = wanted.iter().map(|l| scales[*l]).collect();
        let sd = |i: usize| loads.covariance[i * w + i].sqrt();
        Self {
            combinations: w - wide_directions(&loads, &scales).len(),
            alone: (0..w).filter(|i| sd(*i) <= UNKNOWN * scales[*i]).collect(),
        }
    }
}

/// Iterations between the scatter of the other runs and the posterior from this scatter.
const ROUNDS: usize = 2;

/// Returns the residuals of the runs other than `out` under this posterior.
fn others_left(
    task: &Task,
    state: &State,
    out: &[usize],
    posterior: &Posterior,
) -> Vec<RunResiduals> {
    let others = (0..state.used.len()).filter(|j| !out.contains(j));
    let one = |j: usize| {
        let run = &task.runs[state.used[j]];
        run_residuals(task, run, posterior, &state.equations[j].phi)
    };
    others.map(one).collect()
}

/// Number of operations up to which every left-out run gets a separate posterior with separate scatter: about a second. Above it, the scatter behind
/// the covariance of S (not the scatter of the run) includes the run's own share. Each gauge's error then comes from all runs if readings are
/// correlated. No finding reports this: the left-out run appears slightly closer to the other runs, and applied intervals do not change.
const AFFORDABLE: f64 = 1e9;

/// The posterior of the runs other than `out` with this scatter.
fn solve_without_runs(
    state: &State,
    prior: &[RowPrior],
    out: &[usize],
    scatter: &Scatter,
) -> Option<Posterior> {
    let n = state.posterior.n;
    let others = (0..state.equations.len()).filter(|j| !out.contains(j));
    let equations: Vec<Equation> = others
        .map(|j| {
            let (e, q2) = (&state.equations[j], state.q2_used[j]);
            let m = e.gauges.len();
            let times = |s: &Scatter| q2 * s.design(state.repeats[j]);
            let (new, old) = (times(scatter), times(&state.scatter_used));
            let change = |at: usize| {
                let entry = e.gauges[at / m] * n + e.gauges[at % m];
                new * scatter.covariance[entry] - old * state.scatter_used.covariance[entry]
            };
            Equation {
                covariance: e
                    .covariance
                    .iter()
                    .enumerate()
                    .map(|(at, c)| c + change(at))
                    .collect(),
                ..e.clone()
            }
        })
        .collect();
    solve(prior, &equations)
}

/// Returns whether the loads of the other runs span the loads of the runs `out`.
fn others_span(state: &State, out: &[usize]) -> bool {
    let k = state.scales.len();
    let rank = |skip: &[usize]| {
        let mut gram = vec![0.0; k * k];
        for (_, e) in state
            .equations
            .iter()
            .enumerate()
            .filter(|(j, _)| !skip.contains(j))
        {
            spd::add_outer(&mut gram, &e.phi, 1.0);
        }
        let all = spd::eigenvalues(&gram, k);
        let top = all.last().copied().unwrap_or(0.0);
        all.iter().filter(|v| **v > SPANNED * top).count()
    };
    rank(out) == rank(&[])
}

/// `x' C^-1 x`, with scales of the entries evened out first.
fn mahalanobis(covariance: &[f64], x: &[f64]) -> Option<f64> {
    let k = x.len();
    let sd: Vec<f64> = (0..k).map(|i| covariance[i * k + i].sqrt()).collect();
    let even: Vec<f64> = (0..k * k)
        .map(|i| covariance[i] / (sd[i / k] * sd[i % k]))
        .collect();
    let root = spd::inverse_lower(&spd::cholesky(&even, k)?, k);
    let z: Vec<f64> = x.iter().zip(&sd).map(|(v, s)| v / s).collect();
    Some(
        (0..k)
            .map(|i| spd::dot(&root[i * k..i * k + i + 1], &z[..=i]).powi(2))
            .sum(),
    )
}

/// Returns the mean of `distance / loads` if the covariance was estimated with `dof` degrees of freedom.
fn expected_ratio(dof: f64) -> f64 {
    if dof > 4.0 && dof.is_finite() {
        dof / (dof - 2.0)
    } else if dof.is_finite() {
        // The mean of F is too large or infinite here. Its value at 4 degrees of freedom replaces it.
        2.0
    } else {
        1.0
    }
}

/// Returns the factor for scatter estimated from runs. A few left-out runs that are far off need not be significant. The variance of the intervals
/// relative to the scatter is its posterior mean, `(dof + runs z2) / (dof + runs)`, at least 1. The scatter, known with `dof` degrees of freedom,
/// contributes 1. The left-out runs contribute `z2`, their largest mean square. The more runs there are, the less the factor adds to the test of
/// [`test_coverage`].
///
/// # Reference
/// A. Gelman and others, Bayesian Data Analysis (3rd ed., 2013), section 2.6: a variance with a scaled inverse chi-square prior.
fn few_runs(scores: &[(f64, f64)], runs: usize, dof: f64) -> f64 {
    if !dof.is_finite() {
        return 1.0;
    }
    let z2 = scores.iter().map(|s| s.0).fold(0.0, f64::max);
    let runs = runs as f64;
    ((dof + runs * z2) / (dof + runs)).max(1.0).sqrt()
}

/// Returns the tally and the factor on sigma. The factor is the result of [`few_runs`], or more: if left-out runs are farther off than expected, in
/// single loads or in a sum, it is at least the root of the largest ratio.
pub(super) fn test_coverage(left_out: &[LeftOut], dof: f64) -> Coverage {
    let suspect = suspects(left_out);
    let kept = || left_out.iter().filter(|l| !suspect.contains(&l.number));
    let mut scores =
        vec![score(kept().map(|l| {
            (l.each * l.alone as f64 / expected_ratio(l.dof), l.alone)
        }))];
    let sums = left_out.iter().map(|l| l.sums.len()).min().unwrap_or(0);
    for i in 0..sums {
        scores.push(score(
            kept().map(|l| (l.sums[i] / expected_ratio(l.dof), 1)),
        ));
    }
    let limit = WIDEN / scores.len() as f64;
    let factor = scores
        .iter()
        .filter(|s| s.1 < limit)
        .map(|s| s.0.sqrt())
        .fold(few_runs(&scores, kept().count(), dof), f64::max);
    let held = left_out
        .iter()
        .filter(|l| l.distance <= factor * factor * region(l.loads, dof))
        .count();
    Coverage {
        held,
        of: left_out.len(),
        factor,
    }
}

/// Returns the numbers of runs that are farther off than the scatter of the other runs makes likely.
pub(super) fn suspects(left_out: &[LeftOut]) -> Vec<usize> {
    let scale = typical_scale(left_out);
    let most = SUSPECT / left_out.len().max(1) as f64;
    left_out
        .iter()
        .filter(|l| chance(l, scale) < most)
        .map(|l| l.number)
        .collect()
}

/// Mean of squared distances divided by their number of loads, and the probability of a mean at least as large.
fn score(distances: impl Iterator<Item = (f64, usize)>) -> (f64, f64) {
    let (sum, loads) = distances.fold((0.0, 0), |a, d| (a.0 + d.0, a.1 + d.1));
    let chance = if loads > 0 {
        crate::recovery::verdict::chance(sum, loads)
    } else {
        1.0
    };
    (sum / loads.max(1) as f64, chance)
}

/// Squared radius of the 95 % region of `loads` loads.
fn region(loads: usize, dof: f64) -> f64 {
    let k = loads.max(1) as f64;
    if dof.is_finite() {
        FisherSnedecor::new(k, dof.max(1.0)).map_or(f64::INFINITY, |d| k * d.inverse_cdf(COVERAGE))
    } else {
        ChiSquared::new(k).map_or(f64::INFINITY, |d| d.inverse_cdf(COVERAGE))
    }
}

/// Returns the chance that a run is at least as far off if `scale` widens all intervals.
pub(super) fn chance(l: &LeftOut, scale: f64) -> f64 {
    crate::recovery::uncalibrated_strain::chance_estimated(
        l.distance / (scale * scale),
        l.loads,
        l.dof,
    )
}

/// Returns the root of the median squared distance over its expected value, at least 1. One wrong run does not change it.
fn typical_scale(left_out: &[LeftOut]) -> f64 {
    let mut ratios: Vec<f64> = left_out
        .iter()
        .map(|l| {
            let median = ChiSquared::new(l.loads.max(1) as f64).map_or(1.0, |d| d.inverse_cdf(0.5));
            l.distance / median
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    ratios
        .get(ratios.len() / 2)
        .copied()
        .unwrap_or(1.0)
        .sqrt()
        .max(1.0)
}

/// Returns the number of the run that contradicts the other runs most, if the probability of its deviation is below `REFUSE`.
pub(super) fn find_contradicting_run(left_out: &[LeftOut]) -> Option<usize> {
    let scale = typical_scale(left_out);
    let worst = left_out
        .iter()
        .min_by(|a, b| chance(a, scale).total_cmp(&chance(b, scale)))?;
    (chance(worst, scale) * (left_out.len() as f64) < REFUSE).then_some(worst.number)
}
