//! How large amplitudes that differ from run to run usually are, from a residual: run by run, gauges in one covariance.

use super::covariance::{Selection, SizedAmplitudes, covariance};
use super::frame::StrainFrame;
use crate::linalg::precision::Precision;
use crate::reconcile::effect::{Amplitudes, Member};

/// Readings of one run: their places in the selection, their gauges, the precision without amplitudes.
struct RunBlock {
    at: Vec<usize>,
    gauges: Vec<usize>,
    covariance: Vec<f64>,
}

fn blocks(
    frame: &StrainFrame,
    members: &[Member<'_>],
    selection: &Selection,
    unknown: &[SizedAmplitudes],
) -> Vec<RunBlock> {
    let mut runs: Vec<usize> = selection.0.iter().map(|e| e.0).collect();
    runs.dedup();
    let block = |&run: &usize| {
        let (at, gauges): (Vec<usize>, Vec<usize>) = selection
            .0
            .iter()
            .enumerate()
            .filter(|(_, e)| e.0 == run)
            .map(|(i, e)| (i, e.1))
            .unzip();
        let part = Selection(gauges.iter().map(|&g| (run, g)).collect());
        let covariance = covariance(frame, members, &part, unknown);
        RunBlock {
            at,
            gauges,
            covariance,
        }
    };
    runs.iter().map(block).collect()
}

/// Sum over runs of the log density of `residual` with `unknown` amplitudes, less constants; correlation between runs left out.
pub fn run_by_run_log_likelihood(
    frame: &StrainFrame,
    members: &[Member<'_>],
    selection: &Selection,
    residual: &[f64],
    unknown: &[SizedAmplitudes],
) -> f64 {
    let mut sum = 0.0;
    for block in blocks(frame, members, selection, unknown) {
        let r: Vec<f64> = block.at.iter().map(|&i| residual[i]).collect();
        let Some(p) = Precision::of(&block.covariance, r.len()) else {
            return f64::NEG_INFINITY;
        };
        let pr = p.apply(&r);
        sum -= 0.5 * (p.log_det() + r.iter().zip(&pr).map(|(a, b)| a * b).sum::<f64>());
    }
    sum
}

/// By family and kind: the size (standard deviation) that explains `residual` best, drawn towards the usual one.
///
/// Expectation maximisation: with a_r the amplitudes of run r given its residual, size_k^2 = (sum E[a^2] + nu usual_k^2) / (count + nu).
pub fn usual_sizes(
    frame: &StrainFrame,
    members: &[Member<'_>],
    selection: &Selection,
    residual: &[f64],
    families: &[Amplitudes],
) -> Vec<Vec<f64>> {
    /// The usual size counts as much as this many amplitudes seen.
    const NU: f64 = 1.0;
    /// Steps; sizes move by less than a rounding step after a few tens.
    const STEPS: usize = 30;
    /// Natural log of a size: far less than what sizes are known to.
    const SETTLED: f64 = 0.02;
    let mut sizes: Vec<Vec<f64>> = families.iter().map(|f| f.usual.clone()).collect();
    if families.is_empty() {
        return sizes;
    }
    let plain = blocks(frame, members, selection, &[]);
    for _ in 0..STEPS {
        let mut sums: Vec<Vec<f64>> = families
            .iter()
            .map(|f| f.usual.iter().map(|u| NU * u * u).collect())
            .collect();
        let mut counts: Vec<Vec<f64>> = families.iter().map(|f| vec![NU; f.usual.len()]).collect();
        let n_g = frame.n_gauges();
        let mut added = vec![0.0; n_g * n_g];
        for (f, s) in families.iter().zip(&sizes) {
            for (pattern, &kind) in f.patterns.iter().zip(&f.kinds) {
                let variance = s.get(kind).map_or(0.0, |s| s * s);
                for (row, a) in added.chunks_exact_mut(n_g.max(1)).zip(pattern) {
                    row.iter_mut()
                        .zip(pattern)
                        .for_each(|(cell, b)| *cell += variance * a * b);
                }
            }
        }
        for block in &plain {
            let n = block.gauges.len();
            let mut k = block.covariance.clone();
            for (i, &g) in block.gauges.iter().enumerate() {
                for (j, &h) in block.gauges.iter().enumerate() {
                    k[i * n + j] += added[g * n_g + h];
                }
            }
            let Some(p) = Precision::of(&k, n) else {
                return sizes;
            };
            let r: Vec<f64> = block.at.iter().map(|&i| residual[i]).collect();
            let pr = p.apply(&r);
            for (f, family) in families.iter().enumerate() {
                for (pattern, &kind) in family.patterns.iter().zip(&family.kinds) {
                    let here: Vec<f64> = block.gauges.iter().map(|&g| pattern[g]).collect();
                    let variance = sizes[f].get(kind).map_or(0.0, |s| s * s);
                    let mean: f64 =
                        variance * here.iter().zip(&pr).map(|(a, b)| a * b).sum::<f64>();
                    let known: f64 = here.iter().zip(p.apply(&here)).map(|(a, b)| a * b).sum();
                    if let (Some(sum), Some(count)) =
                        (sums[f].get_mut(kind), counts[f].get_mut(kind))
                    {
                        *sum += mean * mean + variance - variance * variance * known;
                        *count += 1.0;
                    }
                }
            }
        }
        let mut moved = 0.0f64;
        for (f, s) in sizes.iter_mut().enumerate() {
            for (kind, size) in s.iter_mut().enumerate() {
                let next = (sums[f][kind] / counts[f][kind])
                    .max(f64::MIN_POSITIVE)
                    .sqrt();
                moved = moved.max((next / *size).ln().abs());
                *size = next;
            }
        }
        if moved < SETTLED {
            break;
        }
    }
    sizes
}
