//! One payload from many gauges of which some are wrong: a posterior in which every gauge may be noisier than stated.

use std::f64::consts::TAU;

/// Payload estimates of one gauge alone: reading divided by sensitivity, one value for each run.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeEstimates {
    /// Gauge name.
    pub name: String,
    /// Estimated payload force, one value for each run. NaN if the run has no reading.
    pub estimates: Vec<f64>,
    /// Stated noise divided by sensitivity, one value for each run. `None` if the noise of the gauge is unknown.
    pub sigma: Option<Vec<f64>>,
}

/// Settings of [`robust_payload`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobustSpec {
    /// Scatter of good gauges that is proportional to the load (gain, angle, place, model), 1 sd.
    pub relative_scatter: f64,
    /// Largest payload that is possible, same unit as the estimates.
    pub largest: f64,
}

/// The payload of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunPayload {
    /// Posterior mean.
    pub value: f64,
    /// Posterior standard deviation.
    pub sigma: f64,
    /// Ends of the 95 % interval: the 2.5 % and 97.5 % points of the posterior distribution.
    pub interval: [f64; 2],
}

/// Result of the test of one gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeVerdict {
    /// Gauge name.
    pub name: String,
    /// Whether the gauge contributes to the answer.
    pub used: bool,
    /// Posterior probability that the noise of the gauge is as small as assumed for a good gauge.
    pub probability_good: f64,
    /// Reason why the gauge is used or not used.
    pub reason: String,
}

/// The answer for all runs.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustPayload {
    /// Value of each run.
    pub runs: Vec<RunPayload>,
    /// Verdict on each gauge, in the given order.
    pub gauges: Vec<GaugeVerdict>,
}

/// Number of noise levels of a gauge, log-spaced.
pub(super) const N_LEVELS: usize = 25;
/// Largest factor on stated noise. A gauge with this factor contributes nothing.
pub(super) const LARGEST_FACTOR: f64 = 1.0e4;
/// Where it is not: from this share of the largest payload to its inverse.
const SMALLEST_SHARE: f64 = 1.0e-3;
/// Prior probability that a stated noise is right.
pub(super) const PRIOR_AS_STATED: f64 = 0.6;
/// Points of the one-dimensional posterior of a run, and the factor that they reach on either side of the mode.
const N_GRID: usize = 801;
const GRID_REACH: f64 = 20.0;
/// Log of the density below which a point of that posterior is negligible: the grid is then computed again over the other points.
const NOTHING: f64 = -30.0;
/// Gauges whose own estimates are tried as a start of the search, the most probable first.
const N_STARTS: usize = 5;
/// Above this probability a gauge counts as used.
const USED_ABOVE: f64 = 0.5;
/// Largest noise of a good gauge, as a factor on the stated noise or on the scatter of all gauges.
pub(super) const GOOD_FACTOR: f64 = 3.0;
/// Number of standard deviations below zero from which an estimate counts against a gauge.
pub(super) const SIGN_SIGMAS: f64 = 3.0;

/// Returns the posterior of the payload force of every run.
///
/// Model, gauge i, run j: `p_ij ~ N(F_j, (tau F_j)^2 + (m_i s_ij)^2)`. If the noise `s_ij` is stated, `m_i` is 1 for a good gauge and log-uniform
/// above 1 for a bad one. If it is not, `m_i s_ij` is one unknown level for each gauge, log-uniform over six decades. The level belongs to the gauge,
/// so a gauge that disagrees in one run loses its weight in all runs. `F_j` is uniform. The joint mode is found by coordinate ascent from every
/// gauge's own estimates. The search ends at `largest` above, and at zero minus the noise of an empty structure (`doubt`). The interval of each run
/// is from its posterior around this mode, with the other runs at their modes. It is not cut at zero: `cut_at_zero` gives the interval of a payload
/// of zero or more.
///
/// Units: the units of the estimates. Returns `None` if a run has no finite, possible estimate. Leave out runs whose gauges give a payload
/// significantly below zero, or no payload: they would reduce the weight of every gauge.
pub fn robust_payload(gauges: &[GaugeEstimates], spec: &RobustSpec) -> Option<RobustPayload> {
    let n_runs = gauges.iter().map(|g| g.estimates.len()).max()?;
    let slack: Vec<f64> = (0..n_runs).map(|j| run_uncertainty(gauges, j)).collect();
    let own = |g: &GaugeEstimates, j: usize| {
        let p = g.estimates.get(j).copied().unwrap_or(f64::NAN);
        let sigma = g
            .sigma
            .as_ref()
            .map_or(0.0, |s| s.get(j).copied().unwrap_or(0.0));
        let possible = p.is_finite() && p > -SIGN_SIGMAS * sigma && p <= spec.largest;
        possible.then(|| p.max(-slack[j]))
    };
    let median = |j: usize| {
        let mut all: Vec<f64> = gauges.iter().filter_map(|g| own(g, j)).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied()
    };
    let medians: Vec<f64> = (0..n_runs).map(median).collect::<Option<_>>()?;
    let mut starts: Vec<(f64, Vec<f64>)> = gauges
        .iter()
        .map(|g| {
            let f: Vec<f64> = (0..n_runs)
                .map(|j| own(g, j).unwrap_or(medians[j]))
                .collect();
            (log_posterior(&all_terms(gauges, spec, &f)), f)
        })
        .collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mode = starts
        .into_iter()
        .take(N_STARTS)
        .map(|(_, start)| ascend_posterior(gauges, spec, &slack, start))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, f)| f)?;
    let runs = (0..n_runs)
        .map(|j| run_posterior(gauges, spec, (&mode, slack[j]), j))
        .collect::<Vec<_>>();
    let centre: Vec<f64> = runs.iter().map(|r| r.value).collect();
    let gauges = gauges.iter().map(|g| verdict(g, spec, &centre)).collect();
    Some(RobustPayload { runs, gauges })
}

/// Returns three standard deviations of the joint estimate of gauges with these standard deviations: an empty structure may read so far below zero.
/// The weights are `1 / s`, so the mean of `n` has the standard deviation `sqrt(n) / sum(1 / s)`.
pub(super) fn joint_uncertainty(sigma: impl Iterator<Item = f64>) -> f64 {
    let (n, told) = sigma
        .filter(|s| *s > 0.0 && s.is_finite())
        .fold((0.0_f64, 0.0), |a, s| (a.0 + 1.0, a.1 + 1.0 / s));
    if told > 0.0 {
        SIGN_SIGMAS * n.sqrt() / told
    } else {
        0.0
    }
}

/// Returns `doubt` of one run, or zero if no noise is stated.
fn run_uncertainty(gauges: &[GaugeEstimates], j: usize) -> f64 {
    joint_uncertainty(gauges.iter().filter_map(|g| {
        let read = g.estimates.get(j)?.is_finite();
        g.sigma.as_ref()?.get(j).copied().filter(|_| read)
    }))
}

/// Returns the value and the 95 % interval of a load that can't be negative, from the value and interval without this constraint. They are `max(0,
/// v)` and `[max(0, low), max(0, v) + (high - v)]`.
///
/// An unconstrained interval `v -+ h` contains any true value `t >= 0` with 95 %. This is also true after the cut at zero, because the true value is
/// never in the removed part. The upper end is never below `h`, so the interval can't end below zero. An unconstrained interval ends below zero for
/// one empty structure in forty.
///
/// The interval misses `t` if `v - h > t` (2.5 %), and if `max(0, v) + h < t` (2.5 % for `t > h`, never for `t < h`). It contains 97.5 % of the loads
/// below its half width and 95 % of all larger loads. If `low` is above zero, it equals the unconstrained interval.
///
/// # Reference
/// The mean of a Gaussian bounded by zero, its empty intervals and undercoverage: G. J. Feldman, R. D. Cousins, Phys. Rev. D 57 (1998) 3873,
/// section IV B. The construction here is simpler than theirs and covers somewhat more.
pub(super) fn cut_at_zero(value: f64, [low, high]: [f64; 2]) -> (f64, [f64; 2]) {
    if !value.is_finite() {
        return (value, [low, high]);
    }
    let cut = value.max(0.0);
    (cut, [low.max(0.0), cut + (high - value)])
}

/// Noise level k of a gauge in run j, and the log of its prior.
fn level(gauge: &GaugeEstimates, spec: &RobustSpec, j: usize, k: usize) -> (f64, f64) {
    let share = k as f64 / (N_LEVELS - 1) as f64;
    match &gauge.sigma {
        Some(stated) => {
            let prior = if k == 0 {
                PRIOR_AS_STATED
            } else {
                (1.0 - PRIOR_AS_STATED) / (N_LEVELS - 1) as f64
            };
            (
                stated.get(j).copied().unwrap_or(0.0) * LARGEST_FACTOR.powf(share),
                prior.ln(),
            )
        }
        None => (
            spec.largest * SMALLEST_SHARE.powf(1.0 - 2.0 * share),
            -(N_LEVELS as f64).ln(),
        ),
    }
}

/// Log-likelihood of run j of one gauge at each noise level; nothing where the run has no reading.
fn run_terms(gauge: &GaugeEstimates, spec: &RobustSpec, j: usize, f: f64) -> [f64; N_LEVELS] {
    let p = gauge.estimates.get(j).copied().unwrap_or(f64::NAN);
    std::array::from_fn(|k| {
        if !p.is_finite() {
            return 0.0;
        }
        let variance = level(gauge, spec, j, k).0.powi(2) + (spec.relative_scatter * f).powi(2);
        // A lower bound of the variance keeps the terms finite at zero load without noise, so that they can be subtracted.
        let variance = variance.max(1e-200);
        -0.5 * ((p - f).powi(2) / variance + (TAU * variance).ln())
    })
}

/// Log-likelihood of one gauge at each noise level over the runs that `take` lets pass, prior included.
fn gauge_terms(
    gauge: &GaugeEstimates,
    spec: &RobustSpec,
    f: &[f64],
    take: impl Fn(usize) -> bool,
) -> [f64; N_LEVELS] {
    let mut terms: [f64; N_LEVELS] = std::array::from_fn(|k| level(gauge, spec, 0, k).1);
    for (j, f) in f.iter().enumerate().filter(|(j, _)| take(*j)) {
        for (sum, term) in terms.iter_mut().zip(run_terms(gauge, spec, j, *f)) {
            *sum += term;
        }
    }
    terms
}

fn log_sum(terms: &[f64]) -> f64 {
    if terms.is_empty() {
        return f64::NEG_INFINITY;
    }
    let top = terms.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    top + terms.iter().map(|t| (t - top).exp()).sum::<f64>().ln()
}

/// Log posterior density, flat prior on F, of the terms of every gauge.
fn log_posterior(terms: &[[f64; N_LEVELS]]) -> f64 {
    terms.iter().map(|t| log_sum(t)).sum()
}

/// Terms of every gauge over all runs.
fn all_terms(gauges: &[GaugeEstimates], spec: &RobustSpec, f: &[f64]) -> Vec<[f64; N_LEVELS]> {
    let of = |g| gauge_terms(g, spec, f, |_| true);
    gauges.iter().map(of).collect()
}

/// Gain of log density below which a step does not count: far above rounding, far below the effect of any evidence.
const GAIN: f64 = 1e-9;

/// Coordinate ascent with a shrinking step: in log F far from zero, in F within the noise of an empty structure.
fn ascend_posterior(
    gauges: &[GaugeEstimates],
    spec: &RobustSpec,
    slack: &[f64],
    mut f: Vec<f64>,
) -> (f64, Vec<f64>) {
    let mut step = 0.1;
    while step > 1e-4 {
        let mut moved = false;
        // Recompute the terms in each round: adding and subtracting accumulates rounding errors.
        let mut terms = all_terms(gauges, spec, &f);
        let mut best = log_posterior(&terms);
        for j in 0..f.len() {
            for share in [step, -step / (1.0 + step)] {
                let size = f[j].abs() + slack[j] / SIGN_SIGMAS;
                let there = (f[j] + share * size).clamp(-slack[j], spec.largest.max(0.0));
                // Only one run changes, so the terms of the other runs are kept.
                let with = |(g, own): (&GaugeEstimates, &[f64; N_LEVELS])| {
                    let before = run_terms(g, spec, j, f[j]);
                    let after = run_terms(g, spec, j, there);
                    std::array::from_fn(|k| own[k] + (after[k] - before[k]))
                };
                let tried: Vec<[f64; N_LEVELS]> = gauges.iter().zip(&terms).map(with).collect();
                let value = log_posterior(&tried);
                if value > best + GAIN {
                    (best, terms, f[j]) = (value, tried, there);
                    moved = true;
                }
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    (log_posterior(&all_terms(gauges, spec, &f)), f)
}

/// Returns the mean, standard deviation and 95 % interval of one run around its mode, with the other runs at their modes. The grid is uniform in `t`
/// with `F = s sinh t`, where `s` is the noise of an empty structure. It is nearly uniform in F near zero, where F may be negative, and uniform in
/// log F far from zero.
fn run_posterior(
    gauges: &[GaugeEstimates],
    spec: &RobustSpec,
    (mode, slack): (&[f64], f64),
    j: usize,
) -> RunPayload {
    let others: Vec<[f64; N_LEVELS]> = gauges
        .iter()
        .map(|g| gauge_terms(g, spec, mode, |k| k != j))
        .collect();
    // Without stated noise, any size far below the mode gives a uniform grid in log F.
    let size = (slack / SIGN_SIGMAS)
        .max(1e-9 * mode[j].abs())
        .max(f64::MIN_POSITIVE);
    let log_density = |x: f64| -> f64 {
        let each = gauges.iter().zip(&others).map(|(g, other)| {
            let own = run_terms(g, spec, j, x);
            log_sum(&std::array::from_fn::<f64, N_LEVELS, _>(|k| {
                other[k] + own[k]
            }))
        });
        each.sum()
    };
    let grid = |from: f64, to: f64| -> (Vec<f64>, Vec<f64>) {
        let t = (0..N_GRID).map(|i| from + (to - from) * i as f64 / (N_GRID - 1) as f64);
        // The prior is uniform in F, so the weight of a point is its spacing in F, s cosh t.
        t.map(|t| (t, size * t.sinh()))
            .take_while(|(_, x)| *x <= spec.largest)
            .map(|(t, x)| (x, log_density(x) + (size * t.cosh()).ln()))
            .unzip()
    };
    let middle = (mode[j] / size).asinh();
    let reach = GRID_REACH.ln();
    let (points, wide) = grid(middle - reach, middle + reach);
    // A second, finer grid covers the points with significant weight: a payload known to a thousandth is between two points of the first grid.
    let top = wide.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let counts = |l: &f64| *l > top + NOTHING;
    let first = wide.iter().position(counts).unwrap_or(0);
    let last = wide.iter().rposition(counts).unwrap_or(0);
    let edge = |i: usize| points.get(i).map_or(middle, |x| (x / size).asinh());
    let end = edge((last + 1).min(points.len().saturating_sub(1)));
    let (points, log_density) = grid(edge(first.saturating_sub(1)), end);
    let top = log_density
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let weights: Vec<f64> = log_density.iter().map(|l| (l - top).exp()).collect();
    let total: f64 = weights.iter().sum();
    let mean = weights.iter().zip(&points).map(|(w, x)| w * x).sum::<f64>() / total;
    let variance = weights
        .iter()
        .zip(&points)
        .map(|(w, x)| w * (x - mean).powi(2))
        .sum::<f64>()
        / total;
    // A point represents the interval up to the midpoints to its neighbours.
    let quantile = |share: f64| {
        let (mut sum, mut before) = (0.0, points.first().copied().unwrap_or(mean));
        for (i, (w, x)) in weights.iter().zip(&points).enumerate() {
            let after = points.get(i + 1).map_or(*x, |next| (x + next) / 2.0);
            if sum + w >= share * total {
                return before + (after - before) * (share * total - sum) / w;
            }
            sum += w;
            before = after;
        }
        before
    };
    RunPayload {
        value: mean,
        sigma: variance.sqrt(),
        interval: [quantile(0.025), quantile(0.975)],
    }
}

fn verdict(gauge: &GaugeEstimates, spec: &RobustSpec, f: &[f64]) -> GaugeVerdict {
    let terms = gauge_terms(gauge, spec, f, |_| true);
    let mean = f.iter().sum::<f64>() / f.len() as f64;
    let limit = match &gauge.sigma {
        Some(stated) => GOOD_FACTOR * stated.first().copied().unwrap_or(0.0),
        None => GOOD_FACTOR * spec.relative_scatter * mean,
    };
    let n_good = (0..N_LEVELS)
        .take_while(|k| level(gauge, spec, 0, *k).0 <= limit * (1.0 + 1e-9))
        .count();
    let probability_good = (log_sum(&terms[..n_good]) - log_sum(&terms)).exp();
    // With stated noise, a negative sign counts against a gauge only if noise can't have caused it.
    let slack: Vec<f64> = match &gauge.sigma {
        Some(s) => s.iter().map(|s| SIGN_SIGMAS * s).collect(),
        None => vec![0.0; gauge.estimates.len()],
    };
    verdict_words(&gauge.name, &gauge.estimates, &slack, f, probability_good)
}

/// Returns whether a gauge is used, and the reason. Inputs are its estimates by run, the answers `f` and the probability that the gauge is good. An
/// estimate below zero by more than its `slack` rejects the gauge.
pub(super) fn verdict_words(
    name: &str,
    estimates: &[f64],
    slack: &[f64],
    f: &[f64],
    probability_good: f64,
) -> GaugeVerdict {
    let finite: Vec<(usize, f64)> = estimates
        .iter()
        .copied()
        .enumerate()
        .filter(|(_, p)| p.is_finite())
        .collect();
    let (positive, negative) = (
        finite.iter().any(|p| p.1 > 0.0),
        finite
            .iter()
            .any(|p| p.1 < -slack.get(p.0).copied().unwrap_or(0.0)),
    );
    let list = || {
        finite
            .iter()
            .map(|p| format!("{:.1}", p.1))
            .collect::<Vec<_>>()
            .join(", ")
    };
    // A relative deviation is not defined for an empty structure.
    let apart = |p: &(usize, f64)| {
        let of = f.get(p.0).copied().unwrap_or(f64::NAN);
        (of > 0.0).then(|| (p.1 - of).abs() / of)
    };
    let worst = finite
        .iter()
        .filter(|p| apart(p).is_some())
        .max_by(|a, b| apart(a).unwrap_or(0.0).total_cmp(&apart(b).unwrap_or(0.0)));
    let used = probability_good > USED_ABOVE && !negative && !finite.is_empty();
    let reason = if finite.is_empty() {
        "no reading".to_owned()
    } else if used {
        match worst.and_then(apart) {
            Some(share) if share < 1.0 => format!("agrees within {:.1} %", 100.0 * share),
            _ => "agrees within its noise".to_owned(),
        }
    } else if positive && negative {
        format!(
            "changes sign between runs ({}), as with noise or a drifted zero",
            list()
        )
    } else if negative {
        format!(
            "negative in every run ({}): the sign of the gauge or of the model is wrong, or the gauge does not measure the payload",
            list()
        )
    } else {
        let (j, p) = worst.or(finite.first()).copied().unwrap_or((0, f64::NAN));
        format!(
            "reads {p:.1}, and the other gauges agree on {:.1}",
            f.get(j).copied().unwrap_or(f64::NAN)
        )
    };
    GaugeVerdict {
        name: name.to_owned(),
        used,
        probability_good,
        reason,
    }
}
