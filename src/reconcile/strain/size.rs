//! Estimation of the usual size of amplitudes that differ from run to run, from a residual. Each run has one covariance over its gauges. The part of
//! the amplitudes that repeats in all runs is estimated with it.

use super::covariance::{Selection, add_outer, covariance};
use super::frame::StrainFrame;
use crate::linalg::precision::Precision;
use crate::linalg::spd::dot;
use crate::reconcile::effect::{Amplitudes, Member, SizedAmplitudes};

/// Covariance of each run separately, without unknown amplitudes.
pub struct RunBlocks {
    blocks: Vec<RunBlock>,
    n_gauges: usize,
    doubt: Vec<f64>,
}

/// Readings of one run: their indices in the selection, their gauges, and their covariance.
struct RunBlock {
    at: Vec<usize>,
    gauges: Vec<usize>,
    covariance: Vec<f64>,
}

/// Run with its precision, including the scatter of amplitudes, for fast sums.
pub struct RunPrecision<'a> {
    /// Places of the readings in the selection.
    pub at: &'a [usize],
    /// Gauges of the readings.
    pub gauges: &'a [usize],
    /// Precision of the readings, with the scatter of amplitudes and without the correlation with other runs.
    pub precision: Precision,
}

impl RunBlocks {
    /// Computes the blocks of `selection` with the prediction of `members`.
    pub fn from_selection(
        frame: &StrainFrame,
        members: &[Member<'_>],
        selection: &Selection,
    ) -> Self {
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
            doubt: frame.relative_uncertainty(),
        }
    }

    /// Returns the precision of each run with the scatter of `unknown`. Runs without a valid factor are omitted.
    pub fn precisions(&self, unknown: &[SizedAmplitudes]) -> Vec<RunPrecision<'_>> {
        let added = self.added_covariance(unknown);
        let one = |b: &'_ RunBlock| b.precision(&added, self.n_gauges);
        let made = self.blocks.iter().filter_map(|b| Some((b, one(b)?)));
        made.map(|(b, precision)| RunPrecision {
            at: &b.at,
            gauges: &b.gauges,
            precision,
        })
        .collect()
    }

    /// Returns the covariance that unknown amplitudes add to a run, `n_gauges x n_gauges`: their scatter, and the uncertainty of their patterns.
    fn added_covariance(&self, unknown: &[SizedAmplitudes]) -> Vec<f64> {
        let n = self.n_gauges;
        let mut out = vec![0.0; n * n];
        for u in unknown {
            for (pattern, &kind) in u.amplitudes.patterns.iter().zip(&u.amplitudes.kinds) {
                let scatter = u.scatter_variance(kind);
                add_outer(&mut out, pattern, scatter);
                let doubted = scatter + u.steady_variance(kind);
                for (g, (a, doubt)) in pattern.iter().zip(&self.doubt).enumerate() {
                    out[g * n + g] += doubted * (doubt * a).powi(2);
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
        Precision::from_covariance(&k, n)
    }
}

/// Pattern with its family, its kind, and the variance of its part that repeats in all runs.
struct Pattern<'a> {
    family: usize,
    kind: usize,
    values: &'a [f64],
    steady: f64,
}

fn patterns_of(unknown: &[SizedAmplitudes]) -> Vec<Pattern<'_>> {
    let one = |(family, u): (usize, &'_ SizedAmplitudes)| -> Vec<(usize, usize, f64)> {
        u.amplitudes
            .kinds
            .iter()
            .map(|&k| (family, k, u.steady_variance(k)))
            .collect()
    };
    let listed = unknown.iter().enumerate().flat_map(one);
    let values = unknown.iter().flat_map(|u| &u.amplitudes.patterns);
    listed
        .zip(values)
        .map(|((family, kind, steady), v)| Pattern {
            family,
            kind,
            values: v,
            steady,
        })
        .collect()
}

/// Posterior of amplitudes that repeat in all runs: mean, covariance and gain of log likelihood.
struct RepeatedAmplitudes {
    /// Numbers of the patterns that repeat.
    which: Vec<usize>,
    mean: Vec<f64>,
    /// (H + T^-1), inverted.
    posterior: Option<Precision>,
    gain: f64,
}

/// Returns the repeating amplitudes `m = (H + T^-1)^-1 sum of A' P r` over runs, with `H = sum of A' P A` over runs. Their gain is
/// `(m' (H + T^-1) m - ln det(I + T H)) / 2`.
fn estimate_steady_amplitudes(
    runs: &[RunPrecision<'_>],
    residual: &[f64],
    patterns: &[Pattern<'_>],
) -> RepeatedAmplitudes {
    let which: Vec<usize> = (0..patterns.len())
        .filter(|p| patterns[*p].steady > 0.0)
        .collect();
    let n = which.len();
    let nothing = RepeatedAmplitudes {
        which: Vec::new(),
        mean: Vec::new(),
        posterior: None,
        gain: 0.0,
    };
    if n == 0 {
        return nothing;
    }
    let (mut h, mut s) = (vec![0.0; n * n], vec![0.0; n]);
    for run in runs {
        let here = |p: usize| {
            run.gauges
                .iter()
                .map(|&g| patterns[p].values[g])
                .collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = which.iter().map(|&p| here(p)).collect();
        let r: Vec<f64> = run.at.iter().map(|&i| residual[i]).collect();
        let pr = run.precision.apply(&r);
        for (i, a) in columns.iter().enumerate() {
            let weighted = run.precision.apply(a);
            s[i] += dot(a, &pr);
            for (j, b) in columns.iter().enumerate().take(i + 1) {
                h[i * n + j] += dot(&weighted, b);
            }
        }
    }
    let mut log_prior = 0.0;
    for (i, &p) in which.iter().enumerate() {
        h[i * n + i] += 1.0 / patterns[p].steady;
        log_prior += patterns[p].steady.ln();
    }
    let Some(posterior) = Precision::from_covariance(&h, n) else {
        return nothing;
    };
    let mean = posterior.apply(&s);
    let gain = 0.5 * (dot(&mean, &s) - posterior.log_det() - log_prior);
    RepeatedAmplitudes {
        which,
        mean,
        posterior: Some(posterior),
        gain,
    }
}

/// Returns the sum over runs of the log density of `residual` with `unknown` amplitudes, without constants. The only correlation between runs that it
/// contains is from repeating amplitudes.
pub fn run_by_run_log_likelihood(
    blocks: &RunBlocks,
    residual: &[f64],
    unknown: &[SizedAmplitudes],
) -> f64 {
    let runs = blocks.precisions(unknown);
    if runs.len() < blocks.blocks.len() {
        return f64::NEG_INFINITY;
    }
    let mut sum = estimate_steady_amplitudes(&runs, residual, &patterns_of(unknown)).gain;
    for run in &runs {
        let r: Vec<f64> = run.at.iter().map(|&i| residual[i]).collect();
        sum -= 0.5 * (run.precision.log_det() + dot(&r, &run.precision.apply(&r)));
    }
    sum
}

/// Draws on each size by the usual one and by its family.
mod draw {
    /// Number of observed amplitudes whose weight equals the weight of the usual size.
    pub(super) const NU: f64 = 1.0;
    /// Weight of the common scale of a family against the amplitudes of one kind.
    pub(super) const SHARED: f64 = 0.5;
}

/// Sums of squares of the amplitudes of each kind, and how many there were.
struct Squares {
    sum: Vec<f64>,
    count: Vec<f64>,
}

impl Squares {
    fn prior(usual: &[f64]) -> Self {
        Self {
            sum: usual.iter().map(|u| draw::NU * u * u).collect(),
            count: vec![draw::NU; usual.len()],
        }
    }

    fn add(&mut self, kind: usize, square: f64) {
        if let (Some(sum), Some(count)) = (self.sum.get_mut(kind), self.count.get_mut(kind)) {
            *sum += square;
            *count += 1.0;
        }
    }

    /// Returns the new sizes. All kinds of a family share one scale, since side forces also cause moments. In addition, each kind has a size of its
    /// own in part.
    fn sizes(&self, usual: &[f64]) -> Vec<f64> {
        let known = |k: &usize| usual[*k] > 0.0;
        let logs: Vec<f64> = (0..usual.len())
            .filter(known)
            .map(|k| {
                0.5 * (self.sum[k] / self.count[k] / (usual[k] * usual[k]))
                    .max(f64::MIN_POSITIVE)
                    .ln()
            })
            .collect();
        let scale = (logs.iter().sum::<f64>() / logs.len().max(1) as f64).exp();
        let one = |k: usize| {
            let drawn = draw::SHARED * self.count[k];
            let common = (scale * usual[k]).powi(2);
            ((self.sum[k] + drawn * common) / (self.count[k] + drawn)).sqrt()
        };
        (0..usual.len())
            .map(|k| if known(&k) { one(k) } else { 0.0 })
            .collect()
    }
}

/// Returns the amplitudes of one run given its residual. By pattern, these are the mean of the part that differs from run to run, and its remaining
/// variance.
fn estimate_scattered_amplitudes(
    run: &RunPrecision<'_>,
    residual: &[f64],
    unknown: &[SizedAmplitudes],
    patterns: &[Pattern<'_>],
    repeated: &RepeatedAmplitudes,
) -> Vec<[f64; 2]> {
    let repeats = |g: usize| -> f64 {
        let listed = repeated.which.iter().zip(&repeated.mean);
        listed.map(|(&p, m)| m * patterns[p].values[g]).sum()
    };
    let r: Vec<f64> = (run.at.iter().zip(run.gauges))
        .map(|(&i, &g)| residual[i] - repeats(g))
        .collect();
    let pr = run.precision.apply(&r);
    let one = |p: &Pattern<'_>| {
        let here: Vec<f64> = run.gauges.iter().map(|&g| p.values[g]).collect();
        let variance = unknown[p.family].scatter_variance(p.kind);
        let known = variance * variance * dot(&here, &run.precision.apply(&here));
        [variance * dot(&here, &pr), variance - known]
    };
    patterns.iter().map(one).collect()
}

/// Returns, by run and pattern, the amplitude that `residual` shows, with its variance. The amplitude is the mean of the repeating part plus the mean
/// of the part that differs from run to run. The runs are the runs of `blocks` whose precision exists.
pub fn amplitudes_by_run(
    blocks: &RunBlocks,
    residual: &[f64],
    unknown: &[SizedAmplitudes],
) -> Vec<Vec<[f64; 2]>> {
    let patterns = patterns_of(unknown);
    let runs = blocks.precisions(unknown);
    let repeated = estimate_steady_amplitudes(&runs, residual, &patterns);
    let mut constant = vec![[0.0; 2]; patterns.len()];
    for (i, (&p, mean)) in repeated.which.iter().zip(&repeated.mean).enumerate() {
        let left = repeated.posterior.as_ref().map_or(0.0, |q| q.entry(i, i));
        constant[p] = [*mean, left];
    }
    let of_run = |run: &RunPrecision<'_>| -> Vec<[f64; 2]> {
        let own = estimate_scattered_amplitudes(run, residual, unknown, &patterns, &repeated);
        let both = own.into_iter().zip(&constant);
        both.map(|(own, c)| [own[0] + c[0], own[1] + c[1]])
            .collect()
    };
    runs.iter().map(of_run).collect()
}

/// Returns, by family and kind, the root mean square over runs and patterns of the amplitudes in `residual`, with its standard deviation.
pub fn amplitudes_found(
    blocks: &RunBlocks,
    residual: &[f64],
    unknown: &[SizedAmplitudes],
) -> Vec<Vec<[f64; 2]>> {
    let patterns = patterns_of(unknown);
    // By family and kind: sum of squares, sum of squares times their variance, and number of amplitudes.
    let empty = |u: &SizedAmplitudes| vec![[0.0; 3]; u.amplitudes.usual.len()];
    let mut sums: Vec<Vec<[f64; 3]>> = unknown.iter().map(empty).collect();
    for run in amplitudes_by_run(blocks, residual, unknown) {
        for (p, [mean, left]) in patterns.iter().zip(run) {
            let sum = &mut sums[p.family][p.kind];
            sum[0] += mean * mean;
            sum[1] += mean * mean * left;
            sum[2] += 1.0;
        }
    }
    let found = |[squares, errors, n]: [f64; 3]| match squares > 0.0 {
        true => [(squares / n).sqrt(), (errors / (n * squares)).sqrt()],
        false => [0.0, 0.0],
    };
    let of = |kinds: Vec<[f64; 3]>| kinds.into_iter().map(found).collect();
    sums.into_iter().map(of).collect()
}

/// Returns, by family, the sizes (see [`SizedAmplitudes::sizes`]) that explain `residual` best, with the usual sizes as prior.
///
/// The method is expectation maximisation. With a the amplitudes of a run and m their repeating part,
/// `scatter_k^2 = (sum E[(a - m)^2] + nu usual_k^2) / (count + nu)`, given the residuals. The steady part follows likewise from `E[m^2]`.
pub fn usual_sizes(blocks: &RunBlocks, residual: &[f64], families: &[Amplitudes]) -> Vec<Vec<f64>> {
    /// Steps; sizes move by less than a rounding step after a few tens.
    const STEPS: usize = 30;
    /// Natural log of a size: far less than what sizes are known to.
    const SETTLED: f64 = 0.04;
    let sized = |a: &Amplitudes| SizedAmplitudes {
        amplitudes: a.clone(),
        sizes: [a.usual.as_slice(), &a.steady].concat(),
    };
    let mut unknown: Vec<SizedAmplitudes> = families.iter().map(sized).collect();
    if families.is_empty() {
        return Vec::new();
    }
    for _ in 0..STEPS {
        let patterns = patterns_of(&unknown);
        let runs = blocks.precisions(&unknown);
        let repeated = estimate_steady_amplitudes(&runs, residual, &patterns);
        let mut scatter: Vec<Squares> = families.iter().map(|f| Squares::prior(&f.usual)).collect();
        let mut steady: Vec<Squares> = families.iter().map(|f| Squares::prior(&f.steady)).collect();
        for (i, &p) in repeated.which.iter().enumerate() {
            let known = repeated.posterior.as_ref().map_or(0.0, |q| q.entry(i, i));
            steady[patterns[p].family].add(patterns[p].kind, repeated.mean[i].powi(2) + known);
        }
        for run in &runs {
            let own = estimate_scattered_amplitudes(run, residual, &unknown, &patterns, &repeated);
            for (p, [mean, left]) in patterns.iter().zip(own) {
                scatter[p.family].add(p.kind, mean * mean + left);
            }
        }
        let mut moved = 0.0f64;
        for (f, family) in families.iter().enumerate() {
            let next = [
                scatter[f].sizes(&family.usual),
                steady[f].sizes(&family.steady),
            ]
            .concat();
            for (old, new) in unknown[f]
                .sizes
                .iter()
                .zip(&next)
                .filter(|(old, _)| **old > 0.0)
            {
                moved = moved.max((new / old).ln().abs());
            }
            unknown[f].sizes = next;
        }
        if moved < SETTLED {
            break;
        }
    }
    unknown.into_iter().map(|u| u.sizes).collect()
}
