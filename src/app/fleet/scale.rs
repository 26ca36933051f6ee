//! Errors of the loads of a record by the gauges that read in it: those of all where all read, larger ones where some gave nothing.

use super::recovering::Recovering;
use crate::recovery::Gain;
use crate::recovery::history::Filter;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Sets of gauges that are weighed, the most frequent first: what is left are a few samples each.
const SETS: usize = 16;
/// A load so large that noise is nothing beside it.
const FAR: f64 = 1e6;

/// Standard deviation of the noise in a sample, by load, report unit: root mean square over the record, dead parts of gauges by the gauges left.
pub(super) fn noise_of(r: &Recovering) -> Vec<f64> {
    let zeros = vec![0.0; r.factors.len()];
    let all = r.filter.sigma(&zeros);
    let samples = r.samples.max(1) as f64;
    let mut squares: Vec<f64> = all.iter().map(|s| s * s).collect();
    for (stretch, gain) in r.filter.stretches(&r.blank) {
        let share = stretch.len() as f64 / samples;
        let of_part = r.filter.sigma_with(&gain, &zeros);
        for ((sum, s), all) in squares.iter_mut().zip(of_part).zip(&all) {
            // A load that is not told there has no noise either.
            if s.is_finite() {
                *sum += share * (s * s - all * all);
            }
        }
    }
    let factors = squares.iter().zip(&r.factors);
    factors.map(|(s, f)| s.max(0.0).sqrt() * f).collect()
}

/// Covariance of the errors of scale of each load with every load, `n_loads x n_loads` a load: the mean over the samples of the record, of which
/// `whole` have all gauges and `by_gauges` those named.
pub(super) fn scales(
    r: &Recovering,
    filter: &Filter,
    whole: u64,
    by_gauges: &BTreeMap<Vec<usize>, u64>,
) -> Vec<Vec<f64>> {
    let k = r.factors.len();
    let mut sets: Vec<(&Vec<usize>, u64)> = by_gauges.iter().map(|(g, n)| (g, *n)).collect();
    sets.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    sets.truncate(SETS);
    let of_all = covariances(r, |f| filter.sigma(f));
    if sets.is_empty() {
        return of_all;
    }
    let others: Vec<(Arc<Gain>, f64, Vec<Vec<f64>>)> = sets
        .into_iter()
        .filter_map(|(gauges, n)| {
            let gain = filter.estimate(gauges.clone())?;
            let of_set = covariances(r, |f| filter.sigma_with(&gain, f));
            Some((gain, n as f64, of_set))
        })
        .collect();
    (0..k)
        .map(|l| {
            // Samples that don't tell the load do no damage by it.
            let told = others.iter().filter(|o| o.0.is_seen(l));
            let n = told.clone().map(|o| o.1).sum::<f64>() + whole as f64;
            let entry = |i: usize| {
                let at = |of: &[Vec<f64>]| of.get(l).and_then(|c| c.get(i)).copied().unwrap_or(0.0);
                let sum: f64 = told.clone().map(|o| o.1 * at(&o.2)).sum();
                match n > 0.0 {
                    true => (sum + whole as f64 * at(&of_all)) / n,
                    false => at(&of_all),
                }
            };
            (0..k * k).map(entry).collect()
        })
        .collect()
}

/// What the variance of each load, by `sigma` at loads, gains where one load acts alone.
fn covariances(r: &Recovering, sigma: impl Fn(&[f64]) -> Vec<f64>) -> Vec<Vec<f64>> {
    let k = r.factors.len();
    let zero_sigma = sigma(&vec![0.0; k]);
    let mut out = vec![vec![0.0; k * k]; k];
    for m in 0..k {
        let scales = r.sensitivity.scales();
        let one = scales.get(m).copied().filter(|s| *s > 0.0).unwrap_or(1.0);
        let mut f = vec![0.0; k];
        if let Some(slot) = f.get_mut(m) {
            *slot = FAR * one;
        }
        for (l, sigma) in sigma(&f).iter().enumerate() {
            let own = zero_sigma.get(l).copied().unwrap_or(0.0);
            let per = (sigma * sigma - own * own).max(0.0) / (FAR * one).powi(2);
            let factor = |l: usize| r.factors.get(l).copied().unwrap_or(1.0);
            let units = factor(l) / factor(m);
            if let Some(slot) = out.get_mut(l).and_then(|row| row.get_mut(m * k + m)) {
                *slot = per * units * units;
            }
        }
    }
    out
}
