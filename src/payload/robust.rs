//! One payload from many gauges of which some are wrong: a posterior in which every gauge may be noisier than stated.

use std::f64::consts::TAU;

/// What one gauge alone says: its reading over its sensitivity, a value a run.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeEstimates {
    /// Gauge name.
    pub name: String,
    /// Estimated payload force, a value a run; NaN where the run has no reading.
    pub estimates: Vec<f64>,
    /// Stated noise over sensitivity, a value a run; `None` where nothing is known of the gauge's noise.
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
    /// 2.5 % and 97.5 % points.
    pub interval: [f64; 2],
}

/// What became of one gauge.
#[derive(Clone, Debug, PartialEq)]
pub struct GaugeVerdict {
    /// Gauge name.
    pub name: String,
    /// Whether it carries the answer.
    pub used: bool,
    /// Posterior probability that it is as good as the model of a good gauge says.
    pub probability_good: f64,
    /// Why it is not used, or why it is.
    pub reason: String,
}

/// The answer for all runs.
#[derive(Clone, Debug, PartialEq)]
pub struct RobustPayload {
    /// A value a run.
    pub runs: Vec<RunPayload>,
    /// A verdict a gauge, in the order given.
    pub gauges: Vec<GaugeVerdict>,
}

/// Noise levels a gauge may have, log-spaced.
const N_LEVELS: usize = 25;
/// Where the noise is stated: the largest factor on it. Such a gauge carries nothing.
const LARGEST_FACTOR: f64 = 1.0e4;
/// Where it is not: from this share of the largest payload to its inverse.
const SMALLEST_SHARE: f64 = 1.0e-3;
/// Prior probability that a stated noise is right.
const PRIOR_AS_STATED: f64 = 0.6;
/// Points of the one-dimensional posterior of a run, and the factor that they reach on either side of the mode.
const N_GRID: usize = 801;
const GRID_REACH: f64 = 20.0;
/// Gauges whose own estimates are tried as a start of the search, the most probable first.
const N_STARTS: usize = 5;
/// Above this probability a gauge counts as used.
const USED_ABOVE: f64 = 0.5;
/// A gauge is good when its noise is at most this factor above the stated one, or above the scatter that all gauges have.
const GOOD_FACTOR: f64 = 3.0;
/// A negative estimate counts against a gauge from this many of its standard deviations on.
pub(super) const SIGN_SIGMAS: f64 = 3.0;

/// The posterior of the payload force of every run.
///
/// Model, gauge i, run j: `p_ij ~ N(F_j, (tau F_j)^2 + (m_i s_ij)^2)`. Where the noise `s_ij` is stated, `m_i` is 1 for a good gauge and
/// log-uniform above for a bad one; where it is not, `m_i s_ij` is one unknown level a gauge, log-uniform over six decades. The level
/// belongs to the gauge, so a gauge that disagrees in one run loses its say in all. `F_j` is uniform on `(0, largest]`: a payload pulls
/// down, a negative one is refused. The joint mode is found by coordinate ascent from every gauge's own estimates; each run's interval
/// is its posterior with the other runs at the mode.
///
/// Units: those of the estimates. Returns `None` when no gauge has a finite positive estimate.
pub fn robust_payload(gauges: &[GaugeEstimates], spec: &RobustSpec) -> Option<RobustPayload> {
    let n_runs = gauges.iter().map(|g| g.estimates.len()).max()?;
    let possible = |p: f64| p.is_finite() && p > 0.0 && p <= spec.largest;
    let median = |j: usize| {
        let mut all: Vec<f64> = gauges
            .iter()
            .filter_map(|g| g.estimates.get(j).copied())
            .filter(|p| possible(*p))
            .collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied()
    };
    let medians: Vec<f64> = (0..n_runs).map(median).collect::<Option<_>>()?;
    let mut starts: Vec<(f64, Vec<f64>)> = gauges
        .iter()
        .map(|g| {
            let own = |j: usize| {
                g.estimates
                    .get(j)
                    .copied()
                    .filter(|p| possible(*p))
                    .unwrap_or(medians[j])
            };
            let f: Vec<f64> = (0..n_runs).map(own).collect();
            (log_posterior(gauges, spec, &f), f)
        })
        .collect();
    starts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mode = starts
        .into_iter()
        .take(N_STARTS)
        .map(|(_, start)| ascend(gauges, spec, start))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, f)| f)?;
    let runs = (0..n_runs)
        .map(|j| run_posterior(gauges, spec, &mode, j))
        .collect::<Vec<_>>();
    let centre: Vec<f64> = runs.iter().map(|r| r.value).collect();
    let gauges = gauges.iter().map(|g| verdict(g, spec, &centre)).collect();
    Some(RobustPayload { runs, gauges })
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

/// Log posterior density, flat prior on F.
fn log_posterior(gauges: &[GaugeEstimates], spec: &RobustSpec, f: &[f64]) -> f64 {
    gauges
        .iter()
        .map(|g| log_sum(&gauge_terms(g, spec, f, |_| true)))
        .sum()
}

/// Coordinate ascent in log F with a shrinking step.
fn ascend(gauges: &[GaugeEstimates], spec: &RobustSpec, mut f: Vec<f64>) -> (f64, Vec<f64>) {
    let mut best = log_posterior(gauges, spec, &f);
    let mut step = 0.1;
    while step > 1e-4 {
        let mut moved = false;
        for j in 0..f.len() {
            for direction in [1.0 + step, 1.0 / (1.0 + step)] {
                let old = f[j];
                f[j] = (old * direction).min(spec.largest);
                let value = log_posterior(gauges, spec, &f);
                if value > best + 1e-12 {
                    best = value;
                    moved = true;
                } else {
                    f[j] = old;
                }
            }
        }
        if !moved {
            step *= 0.5;
        }
    }
    (best, f)
}

/// Mean, sd and 95 % interval of one run on a grid that is fine in log F, the other runs held at the mode.
fn run_posterior(
    gauges: &[GaugeEstimates],
    spec: &RobustSpec,
    mode: &[f64],
    j: usize,
) -> RunPayload {
    let others: Vec<[f64; N_LEVELS]> = gauges
        .iter()
        .map(|g| gauge_terms(g, spec, mode, |k| k != j))
        .collect();
    let points: Vec<f64> = (0..N_GRID)
        .map(|i| mode[j] * GRID_REACH.powf(2.0 * i as f64 / (N_GRID - 1) as f64 - 1.0))
        .take_while(|x| *x <= spec.largest)
        .collect();
    // Points are even in log F: the Jacobian F makes the prior flat in F.
    let log_density: Vec<f64> = points
        .iter()
        .map(|x| {
            let each = gauges.iter().zip(&others).map(|(g, other)| {
                let own = run_terms(g, spec, j, *x);
                log_sum(&std::array::from_fn::<f64, N_LEVELS, _>(|k| {
                    other[k] + own[k]
                }))
            });
            each.sum::<f64>() + x.ln()
        })
        .collect();
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
    let quantile = |share: f64| {
        let mut sum = 0.0;
        for (w, x) in weights.iter().zip(&points) {
            sum += w;
            if sum >= share * total {
                return *x;
            }
        }
        spec.largest
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
    // With stated noise a sign is against a gauge only where noise can't have made it.
    let slack: Vec<f64> = match &gauge.sigma {
        Some(s) => s.iter().map(|s| SIGN_SIGMAS * s).collect(),
        None => vec![0.0; gauge.estimates.len()],
    };
    verdict_words(&gauge.name, &gauge.estimates, &slack, f, probability_good)
}

/// Whether a gauge is used, and why, from its own estimates by run, the answers `f` and how probable it is that the gauge is good.
/// An estimate below zero by more than its `slack` rejects the gauge.
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
    let worst = finite
        .iter()
        .max_by(|a, b| ((a.1 - f[a.0]).abs() / f[a.0]).total_cmp(&((b.1 - f[b.0]).abs() / f[b.0])));
    let used = probability_good > USED_ABOVE && !negative && !finite.is_empty();
    let reason = if finite.is_empty() {
        "no reading".to_owned()
    } else if used {
        format!(
            "agrees within {:.1} %",
            worst.map_or(0.0, |w| 100.0 * (w.1 - f[w.0]).abs() / f[w.0])
        )
    } else if positive && negative {
        format!(
            "changes sign between runs ({}): noise, or a zero that moved, not payload",
            list()
        )
    } else if negative {
        format!(
            "negative in every run ({}): wrong sign of gauge or model, or no sensitivity",
            list()
        )
    } else {
        let (j, p) = worst.copied().unwrap_or((0, f64::NAN));
        format!(
            "reads {p:.1} where the others agree on {:.1}",
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
