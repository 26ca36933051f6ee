//! How large amplitudes that differ from run to run usually are, from a residual: run by run, gauges in one covariance.

use super::covariance::{Selection, SizedAmplitudes, covariance};
use super::frame::StrainFrame;
use crate::linalg::precision::Precision;
use crate::reconcile::effect::{Amplitudes, Member};

/// The covariance of each run by itself, without unknown amplitudes.
pub struct RunBlocks {
    blocks: Vec<RunBlock>,
    n_gauges: usize,
    doubt: Vec<f64>,
}

/// Readings of one run: their places in the selection, their gauges, their covariance.
struct RunBlock {
    at: Vec<usize>,
    gauges: Vec<usize>,
    covariance: Vec<f64>,
}

impl RunBlocks {
    /// The blocks of `selection` with the prediction of `members`.
    pub fn of(frame: &StrainFrame, members: &[Member<'_>], selection: &Selection) -> Self {
        let mut runs: Vec<usize> = selection.0.iter().map(|e| e.0).collect();
        runs.dedup();
        let block = |&run: &usize| {
            let here = selection.0.iter().enumerate().filter(|(_, e)| e.0 == run);
            let (at, gauges): (Vec<usize>, Vec<usize>) = here.map(|(i, e)| (i, e.1)).unzip();
            let part = Selection(gauges.iter().map(|&g| (run, g)).collect());
            RunBlock {
                at,
                gauges,
                covariance: covariance(frame, members, &part, &[]),
            }
        };
        Self {
            blocks: runs.iter().map(block).collect(),
            n_gauges: frame.n_gauges(),
            doubt: frame.relative_doubt(),
        }
    }

    /// What unknown amplitudes add to the covariance of a run, `n_gauges x n_gauges`.
    fn added(&self, families: &[(&Amplitudes, &[f64])]) -> Vec<f64> {
        let n = self.n_gauges;
        let mut out = vec![0.0; n * n];
        for (f, sizes) in families {
            for (pattern, &kind) in f.patterns.iter().zip(&f.kinds) {
                let variance = sizes.get(kind).map_or(0.0, |s| s * s);
                for (g, (row, a)) in out.chunks_exact_mut(n.max(1)).zip(pattern).enumerate() {
                    for (cell, b) in row.iter_mut().zip(pattern) {
                        *cell += variance * a * b;
                    }
                    if let (Some(own), Some(doubt)) = (row.get_mut(g), self.doubt.get(g)) {
                        *own += variance * (doubt * a).powi(2);
                    }
                }
            }
        }
        out
    }
}

impl RunBlock {
    fn precision(&self, added: &[f64], n_gauges: usize) -> Option<Precision> {
        let n = self.gauges.len();
        let mut k = self.covariance.clone();
        for (i, &g) in self.gauges.iter().enumerate() {
            for (j, &h) in self.gauges.iter().enumerate() {
                k[i * n + j] += added[g * n_gauges + h];
            }
        }
        Precision::of(&k, n)
    }
}

/// Sum over runs of the log density of `residual` with `unknown` amplitudes, less constants; correlation between runs left out.
pub fn run_by_run_log_likelihood(
    blocks: &RunBlocks,
    residual: &[f64],
    unknown: &[SizedAmplitudes],
) -> f64 {
    let families: Vec<(&Amplitudes, &[f64])> = unknown
        .iter()
        .map(|u| (&u.amplitudes, u.sizes.as_slice()))
        .collect();
    let added = blocks.added(&families);
    let mut sum = 0.0;
    for block in &blocks.blocks {
        let r: Vec<f64> = block.at.iter().map(|&i| residual[i]).collect();
        let Some(p) = block.precision(&added, blocks.n_gauges) else {
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
pub fn usual_sizes(blocks: &RunBlocks, residual: &[f64], families: &[Amplitudes]) -> Vec<Vec<f64>> {
    /// The usual size counts as much as this many amplitudes seen.
    const NU: f64 = 1.0;
    /// Weight of the common scale of a family against the amplitudes of one kind.
    const SHARED: f64 = 0.5;
    /// Steps; sizes move by less than a rounding step after a few tens.
    const STEPS: usize = 30;
    /// Natural log of a size: far less than what sizes are known to.
    const SETTLED: f64 = 0.04;
    let mut sizes: Vec<Vec<f64>> = families.iter().map(|f| f.usual.clone()).collect();
    if families.is_empty() {
        return sizes;
    }
    for _ in 0..STEPS {
        let usual = |f: &Amplitudes| f.usual.iter().map(|u| NU * u * u).collect();
        let mut sums: Vec<Vec<f64>> = families.iter().map(usual).collect();
        let mut counts: Vec<Vec<f64>> = families.iter().map(|f| vec![NU; f.usual.len()]).collect();
        let sized: Vec<(&Amplitudes, &[f64])> = families
            .iter()
            .zip(sizes.iter().map(Vec::as_slice))
            .collect();
        let added = blocks.added(&sized);
        for block in &blocks.blocks {
            let Some(p) = block.precision(&added, blocks.n_gauges) else {
                return sizes;
            };
            let r: Vec<f64> = block.at.iter().map(|&i| residual[i]).collect();
            let pr = p.apply(&r);
            for (f, family) in families.iter().enumerate() {
                for (pattern, &kind) in family.patterns.iter().zip(&family.kinds) {
                    let here: Vec<f64> = block.gauges.iter().map(|&g| pattern[g]).collect();
                    let variance = sizes[f].get(kind).map_or(0.0, |s| s * s);
                    let along: f64 = here.iter().zip(&pr).map(|(a, b)| a * b).sum();
                    let mean = variance * along;
                    let known: f64 = here.iter().zip(p.apply(&here)).map(|(a, b)| a * b).sum();
                    let slots = (sums[f].get_mut(kind), counts[f].get_mut(kind));
                    if let (Some(sum), Some(count)) = slots {
                        *sum += mean * mean + variance - variance * variance * known;
                        *count += 1.0;
                    }
                }
            }
        }
        let mut moved = 0.0f64;
        for (f, s) in sizes.iter_mut().enumerate() {
            // All kinds of a family share one scale, and each its own size in part: side forces bring their moments along.
            let usual = &families[f].usual;
            let free = |k: usize| sums[f][k] / counts[f][k].max(1.0);
            let logs = (0..usual.len()).map(|k| {
                0.5 * (free(k) / (usual[k] * usual[k]))
                    .max(f64::MIN_POSITIVE)
                    .ln()
            });
            let scale = (logs.sum::<f64>() / usual.len().max(1) as f64).exp();
            for (kind, size) in s.iter_mut().enumerate() {
                let drawn = SHARED * counts[f][kind];
                let common = (scale * usual[kind]).powi(2);
                let next = (sums[f][kind] + drawn * common) / (counts[f][kind] + drawn);
                let next = next.max(f64::MIN_POSITIVE).sqrt();
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
