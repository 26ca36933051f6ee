//! Loads of runs with intervals as stated errors make them, and the runs by the gauges that read in them.

use super::dynamic::AddedCovariance;
use super::errors::ErrorModel;
use super::gain::Gain;
use super::residuals::{Pattern, Projection, RemovedLoads};
use super::types::{Readings, RunEstimate, Widening};
use crate::estimate::LoadEstimate;
use crate::estimate::NORMAL_95;
use crate::sensitivity::Sensitivity;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Iterations between loads and the variances that depend on them; they settle in two or three.
const ITERATIONS: usize = 4;

/// Estimates with intervals from the stated errors.
pub(super) struct RunEstimates {
    pub runs: Vec<RunEstimate>,
    /// Groups of runs with the same active gauges, the largest group first, with the estimate of each group. `None` if S is not finite.
    pub patterns: Vec<(Pattern, Option<Gain>)>,
    /// Loads at which the model error is weighted.
    pub typical: Vec<f64>,
}

/// The estimate of each pattern, and the loads of every run.
type Estimates = (Vec<Option<Gain>>, Vec<Vec<f64>>);

/// Returns groups of runs with the same active gauges and noise, the largest group first.
pub(super) fn patterns(n: usize, readings: &[Readings]) -> Vec<Pattern> {
    let mut map: BTreeMap<(Vec<usize>, u64), Vec<usize>> = BTreeMap::new();
    for (i, r) in readings.iter().enumerate() {
        let used = (0..n)
            .filter(|&g| r.strain.get(g).is_some_and(|v| v.is_finite()))
            .collect();
        map.entry((used, r.noise_factor.to_bits()))
            .or_default()
            .push(i);
    }
    let mut list: Vec<Pattern> = map
        .into_iter()
        .map(|((used, noise), runs)| Pattern {
            used,
            noise_factor: f64::from_bits(noise),
            runs,
        })
        .collect();
    list.sort_by(|a, b| b.runs.len().cmp(&a.runs.len()).then(a.runs.cmp(&b.runs)));
    list
}

/// Computes the loads of every run. The weights depend on typical loads through the model error, so the solution and the weights are computed
/// alternately.
pub(super) fn solve(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> RunEstimates {
    solve_beyond(s, readings, errors, &[])
}

/// Computes the loads of readings with errors beyond noise, by run. `beyond` is empty without such errors. These errors do not change the weights.
pub(super) fn solve_beyond(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    beyond: &[AddedCovariance],
) -> RunEstimates {
    let k = s.loads.len();
    let patterns = patterns(s.gauges.len(), readings);
    let mut typical = vec![0.0; k];
    let mut last: Estimates = at_typical(s, readings, errors, &patterns, &typical);
    if errors.model_rel > 0.0 {
        for _ in 0..ITERATIONS {
            typical = root_mean_squares(k, determined_loads(&patterns, &last));
            last = at_typical(s, readings, errors, &patterns, &typical);
        }
    }
    let (gains, loads) = last;
    let mut runs: Vec<Option<RunEstimate>> = vec![None; readings.len()];
    for (p, gain) in patterns.iter().zip(&gains) {
        let projection = Projection::new(s, p, errors, &typical, RemovedLoads::Unstated);
        for &i in &p.runs {
            let run = estimate_of(s, &readings[i], errors, p, gain.as_ref(), &loads[i]);
            let own = beyond.get(i).map(|b| &b.noise + &b.shared);
            runs[i] = Some(match &projection {
                Some(projection) => RunEstimate {
                    chi2: projection.chi2_of_run(
                        p,
                        &projection.project_strain(p, &readings[i].strain),
                        &loads[i],
                        own.as_ref(),
                    ),
                    dof: projection.m(),
                    ..run
                },
                None => run,
            });
        }
    }
    RunEstimates {
        runs: runs.into_iter().flatten().collect(),
        patterns: patterns.into_iter().zip(gains).collect(),
        typical,
    }
}

/// Returns the estimate of each pattern, with weights at the `typical` loads, and the loads of every run.
fn at_typical(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    patterns: &[Pattern],
    typical: &[f64],
) -> Estimates {
    let gains: Vec<Option<Gain>> = patterns
        .par_iter()
        .map(|p| Gain::new(s, &p.used, errors, p.noise_factor, typical))
        .collect();
    let mut loads = vec![vec![0.0; s.loads.len()]; readings.len()];
    for (p, gain) in patterns.iter().zip(&gains) {
        let Some(gain) = gain else { continue };
        for &i in &p.runs {
            loads[i] = gain.loads(&readings[i].strain);
        }
    }
    (gains, loads)
}

/// Returns the loads of all runs that the readings determine, by number, with their values. The values of the other loads are arbitrary.
fn determined_loads<'a>(
    patterns: &'a [Pattern],
    (gains, loads): &'a Estimates,
) -> impl Iterator<Item = (usize, f64)> + 'a {
    let of_pattern = patterns.iter().zip(gains);
    let of_pattern = of_pattern.filter_map(|(p, gain)| Some((p, gain.as_ref()?)));
    of_pattern.flat_map(|(p, gain)| {
        let runs = p.runs.iter().flat_map(|&i| loads[i].iter().enumerate());
        runs.filter(|(l, _)| gain.is_seen(*l)).map(|(l, v)| (l, *v))
    })
}

/// Returns the root mean square of each of `k` loads over its determined values; 0 for a load without values.
pub(super) fn root_mean_squares(
    k: usize,
    determined: impl Iterator<Item = (usize, f64)>,
) -> Vec<f64> {
    let mut sums = vec![(0.0, 0_usize); k];
    for (l, v) in determined {
        sums[l].0 += v * v;
        sums[l].1 += 1;
    }
    let sums = sums.into_iter();
    sums.map(|(square, n)| (square / n.max(1) as f64).sqrt())
        .collect()
}

/// Returns the estimate of one run without a test of its residual.
fn estimate_of(
    s: &Sensitivity,
    r: &Readings,
    errors: ErrorModel,
    pattern: &Pattern,
    gain: Option<&Gain>,
    f: &[f64],
) -> RunEstimate {
    let (n, k) = (s.gauges.len(), s.loads.len());
    let mut out = RunEstimate {
        estimate: LoadEstimate {
            run: r.run.clone(),
            names: s.loads.iter().map(|l| l.name.clone()).collect(),
            values: f.to_vec(),
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
    let Some(gain) = gain else { return out };
    out.estimate.covariance = gain.covariance(f, &Widening::none());
    out.rank = gain.rank;
    for (g, row) in s.values.row_iter().enumerate() {
        out.predicted[g] = row.iter().zip(f).map(|(s, f)| s * f).sum();
    }
    for (&g, leverage) in pattern.used.iter().zip(&gain.leverage) {
        out.residual[g] = r.strain[g] - out.predicted[g];
        let noise = errors.noise_of(s, g, r.noise_factor);
        out.sd[g] =
            (noise + errors.model_error_covariance(s.values.row(g).iter().copied(), f, f)).sqrt();
        out.leverage[g] = *leverage;
    }
    out
}

/// Returns the estimate of a single run, with the interval from stated errors.
pub fn estimate(s: &Sensitivity, r: &Readings, errors: ErrorModel) -> RunEstimate {
    if let Some(known) = &s.uncertainty {
        return super::calibrated_loads::estimate(s, r, errors, known);
    }
    let solved = solve(s, std::slice::from_ref(r), errors);
    solved.runs.into_iter().next().unwrap_or_else(|| {
        let nothing = Pattern {
            used: Vec::new(),
            noise_factor: r.noise_factor,
            runs: Vec::new(),
        };
        estimate_of(s, r, errors, &nothing, None, &vec![f64::NAN; s.loads.len()])
    })
}
