//! Errors of the loads of a record by the gauges that read in it. The errors are larger in samples in which some gauges give nothing.

use super::record_recovery::RecordRecovery;
use crate::recovery::Gain;
use crate::recovery::history::Filter;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Largest number of gauge sets in the mean, the most frequent first. Each further set has only a few samples.
const SETS: usize = 16;
/// Factor on the size of a load that makes noise negligible.
const FAR: f64 = 1e6;

/// Returns the standard deviation of the noise in a sample by load, report unit, as root mean square over the record. In dead parts, it is the noise
/// with the remaining gauges.
pub(super) fn noise_of(r: &RecordRecovery) -> Vec<f64> {
    let zeros = vec![0.0; r.factors.len()];
    let all = r.filter.sigma(&zeros);
    let samples = r.samples.max(1) as f64;
    let mut squares: Vec<f64> = all.iter().map(|s| s * s).collect();
    for (stretch, gain) in r.filter.stretches(&r.blank) {
        let share = stretch.len() as f64 / samples;
        let of_part = r.filter.sigma_with(&gain, &zeros);
        for ((sum, s), all) in squares.iter_mut().zip(of_part).zip(&all) {
            // A load that the gauges do not determine in this part adds no noise.
            if s.is_finite() {
                *sum += share * (s * s - all * all);
            }
        }
    }
    let factors = squares.iter().zip(&r.factors);
    factors.map(|(s, f)| s.max(0.0).sqrt() * f).collect()
}

/// Returns the covariance of the scale errors of each load with every load, `n_loads x n_loads` for each load. It is the mean over the samples of the
/// record. `whole` is the number of samples with all gauges, and `by_gauges` is the number with each other set of gauges.
pub(super) fn scales(
    r: &RecordRecovery,
    filter: &Filter,
    whole: u64,
    by_gauges: &BTreeMap<Vec<usize>, u64>,
) -> Vec<Vec<f64>> {
    let k = r.factors.len();
    let mut sets: Vec<(&Vec<usize>, u64)> = by_gauges.iter().map(|(g, n)| (g, *n)).collect();
    sets.sort_by(|a, b| b.1.cmp(&a.1).then(a.0.cmp(b.0)));
    sets.truncate(SETS);
    let scales = r.sensitivity.scales();
    let covariances = |sigma: &dyn Fn(&[f64]) -> Vec<f64>| covariances(&scales, &r.factors, sigma);
    let of_all = covariances(&|f| filter.sigma(f));
    if sets.is_empty() {
        return of_all;
    }
    let others: Vec<(Arc<Gain>, f64, Vec<Vec<f64>>)> = sets
        .into_iter()
        .filter_map(|(gauges, n)| {
            let gain = filter.estimate(gauges.clone())?;
            let of_set = covariances(&|f| filter.sigma_with(&gain, f));
            Some((gain, n as f64, of_set))
        })
        .collect();
    (0..k)
        .map(|l| {
            // Samples that do not determine the load add no damage of this load.
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

/// Returns a matrix B for each load. The variance of the load, by `sigma` at loads `f`, grows by `f' B f`. The diagonal comes from loads that act
/// alone, the other entries from pairs of loads.
///
/// `scales`: sizes of the loads. `factors`: report units per job unit, of the loads, then of the sums of loads, which the loads determine.
fn covariances(
    scales: &[f64],
    factors: &[f64],
    sigma: impl Fn(&[f64]) -> Vec<f64>,
) -> Vec<Vec<f64>> {
    let k = factors.len();
    let one = |m: usize| scales.get(m).copied().filter(|s| *s > 0.0).unwrap_or(1.0);
    let own = scales.len();
    let at_rest = sigma(&vec![0.0; k]);
    let gained = |loads: &[usize]| -> Vec<f64> {
        let mut f = vec![0.0; k];
        for m in loads {
            if let Some(slot) = f.get_mut(*m) {
                *slot = FAR * one(*m);
            }
        }
        let both = sigma(&f).into_iter().zip(&at_rest);
        both.map(|(s, rest)| (s * s - rest * rest).max(0.0))
            .collect()
    };
    let alone: Vec<Vec<f64>> = (0..own).map(|m| gained(&[m])).collect();
    let factor = |l: usize| factors.get(l).copied().unwrap_or(1.0);
    let mut out = vec![vec![0.0; k * k]; k];
    for (m, of_m) in alone.iter().enumerate() {
        for (n, of_n) in alone.iter().enumerate().skip(m) {
            let pair = if n > m { gained(&[m, n]) } else { Vec::new() };
            for (l, matrix) in out.iter_mut().enumerate() {
                let at = |v: &[f64]| v.get(l).copied().unwrap_or(0.0);
                let (a, b) = (at(of_m), at(of_n));
                let most = (a * b).sqrt();
                let both = match n > m {
                    true => (0.5 * (at(&pair) - a - b)).clamp(-most, most),
                    false => a,
                };
                let units = factor(l) * factor(l) / (factor(m) * factor(n));
                let per = both / (FAR * one(m)) / (FAR * one(n)) * units;
                for i in [m * k + n, n * k + m] {
                    if let Some(slot) = matrix.get_mut(i) {
                        *slot = per;
                    }
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_of_loads_has_what_their_errors_have_in_common() {
        // Both loads and their sum have one error of 2 %. The loads are in N, the covariances in kN.
        let common = |of: [f64; 2]| move |f: &[f64]| 0.02 * (of[0] * f[0] + of[1] * f[1]);
        let errors = [common([1.0, 0.0]), common([0.0, 1.0]), common([1.0, 1.0])];
        let sigma = |f: &[f64]| errors.iter().map(|e| e(f).hypot(3.0)).collect();
        let out = covariances(&[2e4, 5e3], &[1e-3; 3], sigma);
        let is_close = |of: &[f64], expected: [f64; 9]| {
            // The noise of 3 is negligible at loads of 1e9 and more.
            let both = of.iter().zip(expected);
            both.for_each(|(a, b)| assert!((a - b).abs() < 1e-12, "{of:?}"));
        };
        let s = 0.02 * 0.02;
        is_close(&out[0], [s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        is_close(&out[1], [0.0, 0.0, 0.0, 0.0, s, 0.0, 0.0, 0.0, 0.0]);
        is_close(&out[2], [s, s, 0.0, s, s, 0.0, 0.0, 0.0, 0.0]);
    }
}
