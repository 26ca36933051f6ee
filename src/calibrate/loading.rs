//! Loadings of a calibration: its runs, repeats of one loading taken together.

use super::state::State;
use super::types::Task;
use std::collections::BTreeMap;

/// Mean of the runs of one loading (repeats).
pub(super) struct Loading {
    /// Loads in units of their size. The common zero is one of the loads.
    pub phi: Vec<f64>,
    /// Strain; not a number if a gauge has none.
    pub strain: Vec<f64>,
    /// Weight of each gauge: number of runs divided by the variance of one run.
    pub weight: Vec<f64>,
}

/// Returns the means of repeats by loading.
pub(super) fn loadings(task: &Task, state: &State) -> Vec<Loading> {
    let n = task.gauges.len();
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, run) in state.used.iter().enumerate() {
        groups.entry(task.runs[*run].group).or_default().push(i);
    }
    let variance = |i: usize, g: usize| {
        let left = &state.lefts[i];
        let scatter = left.q2 * state.scatter.covariance[g * n + g];
        scatter + task.noise * task.noise * task.runs[state.used[i]].noise_factor
    };
    let mean = |members: &[usize], of: &dyn Fn(usize) -> f64| {
        let read = members.iter().map(|i| of(*i)).filter(|v| v.is_finite());
        let (sum, count) = read.fold((0.0, 0.0), |a, v| (a.0 + v, a.1 + 1.0));
        (sum / count, count)
    };
    let one = |members: Vec<usize>| {
        let strain = |g: usize| mean(&members, &|i| task.runs[state.used[i]].strain[g]);
        let weight = |g: usize| {
            let (variance, _) = mean(&members, &|i| variance(i, g).max(f64::MIN_POSITIVE));
            strain(g).1 / variance
        };
        let k = state.scales.len();
        Loading {
            phi: (0..k)
                .map(|l| mean(&members, &|i| state.equations[i].phi[l]).0)
                .collect(),
            strain: (0..n).map(|g| strain(g).0).collect(),
            weight: (0..n).map(weight).collect(),
        }
    };
    groups.into_values().map(one).collect()
}
