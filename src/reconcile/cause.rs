//! Causes measured in every run (a settlement, a temperature) whose strain no model gives. The runs determine which of them drive the readings, and
//! which are indistinguishable.
//!
//! For every channel, y_r = m + sum over causes of b x_r + noise, with x scaled to a range of 1. The mean m is unknown. The prior standard deviation
//! of each slope b is the range of the readings of the channel. The evidence of a set of causes is the Gaussian density of the readings with m and b
//! integrated out.

use super::observation::Observations;
use super::outcome::Verdict;
use super::rules::DECISIVE;
use crate::linalg::precision::Precision;
use crate::linalg::spd::dot;

/// Quantity measured in every run.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// Name of the cause.
    pub name: String,
    /// Value by run.
    pub values: Vec<f64>,
}

/// A set of causes with its evidence, gap and slopes.
#[derive(Clone, Debug, PartialEq)]
pub struct CauseSet {
    /// Names of the causes.
    pub names: Vec<String>,
    /// Log evidence over the fit runs.
    pub log_evidence: f64,
    /// RMS(reading - prediction) / RMS(reading) over the held-out runs, with each channel divided by its own scale. The mean of the fit runs is
    /// subtracted from readings and predictions.
    pub gap: f64,
    /// Change of the reading per unit of the cause, with its standard deviation, by cause and then by channel.
    pub slopes: Vec<Vec<(f64, f64)>>,
}

/// Result of comparing all sets of causes over the runs.
#[derive(Clone, Debug, PartialEq)]
pub struct CauseOutcome {
    /// `named` if one set leads all others, `unknown` if several sets explain the runs equally well, `none` if no cause raises the evidence enough.
    pub verdict: Verdict,
    /// Every set, best first.
    pub sets: Vec<CauseSet>,
    /// Sets that these runs can't distinguish from the best one, the best one first; empty unless the verdict is `unknown`.
    pub rivals: Vec<CauseSet>,
    /// Instruction for runs that separate `rivals`; `none needed` if there are none.
    pub next_measurement: String,
}

/// Difference of log evidence below which two sets are indistinguishable.
const INDISTINGUISHABLE_LOG_EVIDENCE: f64 = 3.0;
/// Largest number of causes tested together; every further cause doubles the number of sets.
const MOST: usize = 6;

/// Computes the evidence of all sets of `causes` (the first six) over the fit runs. `noise` is one standard deviation of a reading, by channel. NaN
/// readings are left out.
pub fn evaluate_cause_sets(
    observations: &Observations,
    noise: &[f64],
    causes: &[Cause],
) -> CauseOutcome {
    let causes = &causes[..causes.len().min(MOST)];
    let mut sets: Vec<CauseSet> = (0..1usize << causes.len())
        .map(|mask| {
            let chosen = causes
                .iter()
                .enumerate()
                .filter(|(k, _)| (mask >> k) & 1 == 1);
            evaluate_cause_set(
                observations,
                noise,
                &chosen.map(|c| c.1).collect::<Vec<_>>(),
            )
        })
        .collect();
    // Each cause in a set costs `DECISIVE` of log evidence. Of equally good sets, the set with fewer causes is therefore first.
    let penalised = |s: &CauseSet| s.log_evidence - DECISIVE * s.names.len() as f64;
    sets.sort_by(|a, b| penalised(b).total_cmp(&penalised(a)));
    let Some(best) = sets.first().cloned() else {
        return CauseOutcome {
            verdict: Verdict::None,
            sets,
            rivals: Vec::new(),
            next_measurement: "none needed".into(),
        };
    };
    let alike = |s: &&CauseSet| {
        s.names.len() == best.names.len()
            && (penalised(&best) - penalised(s)).abs() < INDISTINGUISHABLE_LOG_EVIDENCE
    };
    let rivals: Vec<CauseSet> = sets.iter().filter(alike).cloned().collect();
    let verdict = match (best.names.is_empty(), rivals.len()) {
        (true, _) => Verdict::None,
        (false, 1) => Verdict::Named,
        _ => Verdict::Unknown,
    };
    let rivals = if verdict == Verdict::Unknown {
        rivals
    } else {
        Vec::new()
    };
    CauseOutcome {
        verdict,
        next_measurement: next(observations, causes, &rivals),
        sets,
        rivals,
    }
}

/// Returns the instruction that separates `rivals`: runs in which one cause changes and the other does not.
fn next(observations: &Observations, causes: &[Cause], rivals: &[CauseSet]) -> String {
    if rivals.is_empty() {
        return "none needed".into();
    }
    let names: Vec<String> = rivals.iter().map(|r| r.names.join(" with ")).collect();
    let at = |name: &str| causes.iter().find(|c| c.name == name);
    let pair = (
        rivals.first().and_then(|r| at(r.names.first()?)),
        rivals.get(1).and_then(|r| at(r.names.first()?)),
    );
    let together = match pair {
        (Some(a), Some(b)) => correlation(observations, a, b)
            .map(|c| format!(" (so far both changed together, correlation {c:.2})"))
            .unwrap_or_default(),
        _ => String::new(),
    };
    format!(
        "measure runs in which one of {} changes and the other one is constant{together}: record both with time stamps in the file of the readings",
        names.join(" and ")
    )
}

fn correlation(observations: &Observations, a: &Cause, b: &Cause) -> Option<f64> {
    let runs = observations.fit_runs();
    let of = |c: &Cause| -> Vec<f64> {
        let v: Vec<f64> = runs
            .iter()
            .filter_map(|&r| c.values.get(r).copied())
            .collect();
        let mean = v.iter().sum::<f64>() / v.len().max(1) as f64;
        v.iter().map(|x| x - mean).collect()
    };
    let (a, b) = (of(a), of(b));
    let size = (dot(&a, &a) * dot(&b, &b)).sqrt();
    (size > 0.0).then(|| dot(&a, &b) / size)
}

/// A channel over the fit runs, from their mean.
struct Channel {
    runs: Vec<usize>,
    readings: Vec<f64>,
    mean: f64,
    range: f64,
}

fn channel(observations: &Observations, c: usize) -> Option<Channel> {
    let runs: Vec<usize> = observations
        .fit_runs()
        .into_iter()
        .filter(|&r| observations.value(r, c).is_finite())
        .collect();
    let raw: Vec<f64> = runs.iter().map(|&r| observations.value(r, c)).collect();
    let mean = raw.iter().sum::<f64>() / raw.len().max(1) as f64;
    let most = raw.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let least = raw.iter().copied().fold(f64::INFINITY, f64::min);
    (raw.len() > 1 && most > least).then(|| Channel {
        runs,
        readings: raw.iter().map(|v| v - mean).collect(),
        mean,
        range: most - least,
    })
}

/// Returns the values of a cause minus their middle, divided by their range, and the range.
fn scale_values(cause: &Cause) -> (Vec<f64>, f64) {
    let finite = || cause.values.iter().copied().filter(|v| v.is_finite());
    let most = finite().fold(f64::NEG_INFINITY, f64::max);
    let least = finite().fold(f64::INFINITY, f64::min);
    let range = if most > least { most - least } else { 1.0 };
    let middle = 0.5 * (most + least);
    (
        cause.values.iter().map(|v| (v - middle) / range).collect(),
        range,
    )
}

fn evaluate_cause_set(observations: &Observations, noise: &[f64], causes: &[&Cause]) -> CauseSet {
    let x: Vec<(Vec<f64>, f64)> = causes.iter().map(|c| scale_values(c)).collect();
    let at = |k: usize, r: usize| x[k].0.get(r).copied().unwrap_or(0.0);
    let mut out = CauseSet {
        names: causes.iter().map(|c| c.name.clone()).collect(),
        log_evidence: 0.0,
        gap: 0.0,
        slopes: vec![Vec::new(); causes.len()],
    };
    let (mut missed, mut seen) = (0.0, 0.0);
    for c in 0..observations.n_channels() {
        let Some(ch) = channel(observations, c) else {
            out.slopes.iter_mut().for_each(|s| s.push((0.0, 0.0)));
            continue;
        };
        let sigma = noise.get(c).copied().unwrap_or(1.0).max(f64::MIN_POSITIVE);
        let n = ch.runs.len();
        let slope_variance = ch.range * ch.range;
        // The mean is unknown, so its prior variance is far above the change of the readings.
        let mean_variance = 100.0 * slope_variance;
        let shared = |r: usize, s: usize| {
            let slopes: f64 = (0..x.len()).map(|k| at(k, r) * at(k, s)).sum();
            mean_variance + slope_variance * slopes
        };
        let mut covariance = vec![0.0; n * n];
        for (i, &r) in ch.runs.iter().enumerate() {
            for (j, &s) in ch.runs.iter().enumerate() {
                covariance[i * n + j] = shared(r, s) + if i == j { sigma * sigma } else { 0.0 };
            }
        }
        let Some(p) = Precision::from_covariance(&covariance, n) else {
            continue;
        };
        let weighted = p.apply(&ch.readings);
        let chi2: f64 = weighted.iter().zip(&ch.readings).map(|(a, b)| a * b).sum();
        out.log_evidence -= 0.5 * (chi2 + p.log_det());
        for (k, slopes) in out.slopes.iter_mut().enumerate() {
            let column: Vec<f64> = ch.runs.iter().map(|&r| slope_variance * at(k, r)).collect();
            let value: f64 = column.iter().zip(&weighted).map(|(a, b)| a * b).sum();
            let explained: f64 = column
                .iter()
                .zip(p.apply(&column))
                .map(|(a, b)| a * b)
                .sum();
            let left = (slope_variance - explained).max(0.0).sqrt();
            slopes.push((value / x[k].1, left / x[k].1));
        }
        for run in observations.proof_runs() {
            let reading = observations.value(run, c) - ch.mean;
            if !reading.is_finite() {
                continue;
            }
            let predicted: f64 = ch
                .runs
                .iter()
                .zip(&weighted)
                .map(|(&s, w)| shared(run, s) * w)
                .sum();
            missed += ((reading - predicted) / ch.range).powi(2);
            seen += (reading / ch.range).powi(2);
        }
    }
    if seen > 0.0 {
        out.gap = f64::sqrt(missed / seen);
    }
    out
}
