//! Time shift between two recordings of the same signals.
//!
//! The cross-correlation of all signals together gives a coarse shift. The fine shift makes the residual orthogonal to the slope of the signal. It is
//! not tied to the grid of the samples.

use super::spectrum::Fourier;
use crate::estimate::student_95;

/// Signals of equal length, sampled by one clock. Missing samples are NaN.
#[derive(Clone, Copy, Debug)]
pub struct SampledSignals<'a> {
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Samples per second.
    pub rate_hz: f64,
    /// The signals.
    pub signals: &'a [Vec<f32>],
}

/// A value between samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterpolatedValue {
    /// Value from the cubic through the four nearest samples. Next to a missing sample and at the ends, it is the value from the line.
    pub value: f64,
    /// Value from the straight line through two samples.
    pub line: f64,
    /// Standard deviation of the value for independent noise of 1 in each sample.
    pub noise: f64,
}

/// Time shift from the clock of the moving signals to the clock of the fixed signals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// The shift, s.
    pub seconds: f64,
    /// Half width of the 95 % interval, s.
    pub half_width_s: f64,
    /// Mean correlation coefficient of the signals at the coarse shift.
    pub correlation: f64,
}

/// Reason why there is no shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoShift {
    /// No signal changes in both recordings.
    Constant,
    /// The largest correlation coefficient at any shift is too small.
    Unlike(f64),
    /// Two shifts, s, fit equally well.
    Ambiguous([f64; 2]),
}

/// Rules of the search for a shift.
#[derive(Clone, Copy, Debug)]
pub struct ShiftRules {
    /// Largest number of bins of the coarse search. The transforms then need some megabytes for each signal.
    pub most_bins: usize,
    /// Least overlap, as a share of the shorter recording. Short overlaps correlate by chance.
    pub overlap: f64,
    /// Least correlation coefficient. Below this value, more than three quarters of the variance differ at every shift.
    pub correlation: f64,
    /// Share of the largest coefficient from which another shift is ambiguous. Periodic signals repeat themselves.
    pub alike: f64,
    /// Largest number of samples of the fine search, spread evenly. More samples change the shift by less than its interval.
    pub most_samples: usize,
    /// Number of blocks whose scatter gives the interval. Student's factor of twenty blocks is 7 % above the factor of the normal distribution.
    pub blocks: usize,
}

impl Default for ShiftRules {
    fn default() -> Self {
        Self {
            most_bins: 1 << 17,
            overlap: 0.5,
            correlation: 0.5,
            alike: 0.97,
            most_samples: 100_000,
            blocks: 20,
        }
    }
}

/// Steps of the fine search at most; each reduces the error by the share of noise in the slopes.
const STEPS: usize = 30;
/// Share of a sample by which the fine search may still move when it ends.
const SETTLED: f64 = 1e-4;
/// Share of a sample by which a time may miss a sample and still be its time: times are rounded.
const ON_SAMPLE: f64 = 1e-6;

impl SampledSignals<'_> {
    /// Returns signal `s` at a time; `None` outside the recording and next to a missing sample.
    pub fn value_at(&self, s: usize, time_s: f64) -> Option<InterpolatedValue> {
        let x = self.signals.get(s)?;
        let place = (time_s - self.start_s) * self.rate_hz;
        let near = place.round();
        let sample = |i: isize| -> Option<f64> {
            let v = f64::from(*x.get(usize::try_from(i).ok()?)?);
            v.is_finite().then_some(v)
        };
        if (place - near).abs() <= ON_SAMPLE {
            let value = sample(near as isize)?;
            return Some(InterpolatedValue {
                value,
                line: value,
                noise: 1.0,
            });
        }
        let below = place.floor();
        let (i, u) = (below as isize, place - below);
        let (b, c) = (sample(i)?, sample(i + 1)?);
        let line = b + u * (c - b);
        let Some((a, d)) = sample(i - 1).zip(sample(i + 2)) else {
            return Some(InterpolatedValue {
                value: line,
                line,
                noise: (1.0 - u).hypot(u),
            });
        };
        let weights = [
            -u * (u - 1.0) * (u - 2.0) / 6.0,
            (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
            -(u + 1.0) * u * (u - 2.0) / 2.0,
            (u + 1.0) * u * (u - 1.0) / 6.0,
        ];
        Some(InterpolatedValue {
            value: weights.iter().zip([a, b, c, d]).map(|(w, v)| w * v).sum(),
            line,
            noise: weights.iter().map(|w| w * w).sum::<f64>().sqrt(),
        })
    }

    fn n_samples(&self) -> usize {
        self.signals.first().map_or(0, Vec::len)
    }

    /// Means over bins of `width_s`, minus the mean of all; zero in bins without samples.
    fn bins(&self, s: usize, width_s: f64, n: usize) -> Vec<f64> {
        let (mut sums, mut counts) = (vec![0.0; n], vec![0_u32; n]);
        let per_sample = 1.0 / (self.rate_hz * width_s);
        for (i, v) in self.signals[s]
            .iter()
            .enumerate()
            .filter(|v| v.1.is_finite())
        {
            let bin = (i as f64 * per_sample + ON_SAMPLE) as usize;
            if let (Some(sum), Some(count)) = (sums.get_mut(bin), counts.get_mut(bin)) {
                *sum += f64::from(*v);
                *count += 1;
            }
        }
        let means = sums.iter().zip(&counts).filter(|b| *b.1 > 0);
        let means: Vec<f64> = means.map(|(s, c)| s / f64::from(*c)).collect();
        let mean = means.iter().sum::<f64>() / means.len().max(1) as f64;
        let bin = |(s, c): (&f64, &u32)| match *c {
            0 => 0.0,
            c => s / f64::from(c) - mean,
        };
        sums.iter().zip(&counts).map(bin).collect()
    }
}

/// Returns the shift of the `moving` signals against the `fixed` ones, signal by signal in the same order.
///
/// # Errors
/// Returns an error for signals that do not change, do not correlate at any shift, or correlate equally at several shifts.
///
/// # Example
/// The clock of the second recorder is 0.25 s ahead of the first one:
/// ```
/// use strainbridge::series::shift::{SampledSignals, ShiftRules, estimate_shift};
///
/// // A sum of sines without a common period, sampled at two rates.
/// let signal = |t: f64| ((1.3 * t).sin() + (3.1 * t).sin() + (7.7 * t + 0.5).sin()) as f32;
/// let fixed = [(0..2000).map(|i| signal(f64::from(i) / 50.0)).collect()];
/// let moving = [(0..2500).map(|i| signal(f64::from(i) / 64.0 - 0.25)).collect()];
/// let shift = estimate_shift(
///     SampledSignals { start_s: 0.0, rate_hz: 50.0, signals: &fixed },
///     SampledSignals { start_s: 0.0, rate_hz: 64.0, signals: &moving },
///     &ShiftRules::default(),
/// )
/// .unwrap();
/// // `seconds` is added to the times of the moving signals.
/// assert!((shift.seconds + 0.25).abs() < 1e-3);
/// assert!(shift.correlation > 0.95);
/// ```
pub fn estimate_shift(
    fixed: SampledSignals,
    moving: SampledSignals,
    rules: &ShiftRules,
) -> Result<Shift, NoShift> {
    let coarse = coarse_shift(fixed, moving, rules)?;
    let fine = FineSearch::new(fixed, moving, coarse.width_s, rules);
    let (seconds, half_width_s) = fine
        .search(coarse.seconds)
        .filter(|found| (found.0 - coarse.seconds).abs() <= 3.0 * coarse.width_s)
        .unwrap_or((coarse.seconds, coarse.width_s));
    Ok(Shift {
        seconds,
        half_width_s,
        correlation: coarse.correlation,
    })
}

/// A shift on the grid of bins.
struct CoarseShift {
    seconds: f64,
    width_s: f64,
    correlation: f64,
}

fn coarse_shift(
    fixed: SampledSignals,
    moving: SampledSignals,
    rules: &ShiftRules,
) -> Result<CoarseShift, NoShift> {
    let step = (1.0 / fixed.rate_hz).max(1.0 / moving.rate_hz);
    let seconds = |s: &SampledSignals| s.n_samples() as f64 / s.rate_hz;
    let longest = seconds(&fixed).max(seconds(&moving));
    let width_s = step * (longest / step / rules.most_bins as f64).ceil().max(1.0);
    let n_of = |s: &SampledSignals| ((seconds(s) / width_s).ceil() as usize).max(1);
    let (n, m) = (n_of(&fixed), n_of(&moving));
    let least = (rules.overlap * n.min(m) as f64).ceil().max(2.0) as isize;
    let (first, last) = (least - m as isize, n as isize - least);
    let lags: Vec<isize> = (first..=last).collect();
    let mut sum = vec![0.0; lags.len()];
    let mut used = 0_usize;
    for s in 0..fixed.signals.len().min(moving.signals.len()) {
        let (x, y) = (fixed.bins(s, width_s, n), moving.bins(s, width_s, m));
        let coefficients = correlation(&x, &y, &lags);
        if let Some(coefficients) = coefficients {
            used += 1;
            sum.iter_mut().zip(coefficients).for_each(|(a, c)| *a += c);
        }
    }
    if used == 0 {
        return Err(NoShift::Constant);
    }
    sum.iter_mut().for_each(|c| *c /= used as f64);
    let largest = |range: &mut dyn Iterator<Item = usize>| -> Option<(usize, f64)> {
        let all = range.filter_map(|i| Some((i, *sum.get(i)?)));
        all.max_by(|a, b| a.1.total_cmp(&b.1))
    };
    let (at, best) = largest(&mut (0..sum.len())).unwrap_or((0, f64::NAN));
    if !(best >= rules.correlation) {
        return Err(NoShift::Unlike(best));
    }
    let of = |i: usize| fixed.start_s - moving.start_s + lags[i] as f64 * width_s;
    let below = |i: &usize| sum[*i] < 0.5 * best;
    let left = (0..at).rev().find(below).unwrap_or(0);
    let right = (at..sum.len()).find(below).unwrap_or(sum.len());
    if let Some((other, c)) = largest(&mut (0..left).chain(right..sum.len()))
        && c > rules.alike * best
    {
        return Err(NoShift::Ambiguous([of(at), of(other)]));
    }
    Ok(CoarseShift {
        seconds: of(at),
        width_s,
        correlation: best,
    })
}

/// Correlation coefficients of `x[i + lag]` and `y[i]` over the samples that both have; `None` where one does not change.
fn correlation(x: &[f64], y: &[f64], lags: &[isize]) -> Option<Vec<f64>> {
    let n = x.len().max(y.len());
    let padded = |v: &[f64]| {
        let mut v = v.to_vec();
        v.resize(n, 0.0);
        v
    };
    let energy = |v: &[f64]| -> Vec<f64> {
        let squares = v.iter().scan(0.0, |sum, v| {
            *sum += v * v;
            Some(*sum)
        });
        std::iter::once(0.0).chain(squares).collect()
    };
    let (of_x, of_y) = (energy(x), energy(y));
    let (all_x, all_y) = (*of_x.last()?, *of_y.last()?);
    if !(all_x > 0.0 && all_y > 0.0) {
        return None;
    }
    let mut fourier = Fourier::default();
    let [a, b] = [x, y].map(|v| fourier.spectrum(&padded(v), 1.0));
    let products = fourier.correlation(&a, &b);
    let coefficient = |lag: &isize| {
        let from = (-lag).max(0);
        let to = (x.len() as isize - lag).min(y.len() as isize);
        let at = |sums: &[f64], i: isize| sums.get(i.max(0) as usize).copied().unwrap_or(0.0);
        let ex = at(&of_x, to + lag) - at(&of_x, from + lag);
        let ey = at(&of_y, to) - at(&of_y, from);
        let place = lag.rem_euclid(products.len() as isize) as usize;
        // If the overlap contains hardly any energy, the correlation is rounding error.
        let enough = ex > 1e-9 * all_x && ey > 1e-9 * all_y;
        match enough {
            true => products[place] / (ex * ey).sqrt(),
            false => 0.0,
        }
    };
    Some(lags.iter().map(coefficient).collect())
}

/// The fine search: with residual `r = fixed(t) - moving(t - shift) - mean` and slopes `f'`, `m'` over the same span, the shift is that at
/// which `sum r f' = 0`; a step is `- sum r f' / sum m' f'`. Noise of the two recordings is in no product twice.
struct FineSearch<'a> {
    fixed: SampledSignals<'a>,
    moving: SampledSignals<'a>,
    /// Samples to either side over which a slope is taken.
    side: usize,
    /// Samples from one that is looked at to the next.
    stride: usize,
    blocks: usize,
}

/// Sums of one step.
struct Sums {
    /// `sum r f'` of each block.
    products: Vec<f64>,
    /// `sum m' f'`.
    slopes: f64,
    /// Number, sum and sum of squares of `fixed - moving`, for each signal.
    residuals: Vec<[f64; 3]>,
}

impl<'a> FineSearch<'a> {
    fn new(
        fixed: SampledSignals<'a>,
        moving: SampledSignals<'a>,
        width_s: f64,
        rules: &ShiftRules,
    ) -> Self {
        let side = (0.5 * width_s * fixed.rate_hz).round().max(1.0) as usize;
        let n = fixed.n_samples();
        Self {
            fixed,
            moving,
            side,
            stride: n.div_ceil(rules.most_samples).max(1),
            // A block needs several samples, so that its sum averages over them.
            blocks: (n / 8).clamp(2, rules.blocks),
        }
    }

    /// Shift and half width of its interval from a coarse shift.
    fn search(&self, coarse: f64) -> Option<(f64, f64)> {
        let k = self.fixed.signals.len().min(self.moving.signals.len());
        let (mut shift, mut means) = (coarse, vec![0.0; k]);
        let first: Vec<f64> = (0..k).map(|s| self.first_weight(s)).collect();
        let mut weights = first.clone();
        for step in 0..STEPS {
            let sums = self.sums(shift, &means, &weights);
            for (s, [n, sum, squares]) in sums.residuals.iter().enumerate() {
                let n = n.max(1.0);
                means[s] = sum / n;
                let variance = squares / n - means[s] * means[s];
                // Signals that agree to the last digit get a limited weight, given by 1e-6 of their variance.
                let least = 1e-6 / first[s].max(f64::MIN_POSITIVE);
                weights[s] = match weights[s] > 0.0 {
                    true => 1.0 / variance.max(least),
                    false => 0.0,
                };
            }
            if step == 0 {
                // The first step only gives means and weights for the residuals of the next step.
                continue;
            }
            if !(sums.slopes > 0.0) {
                return None;
            }
            let change = -sums.products.iter().sum::<f64>() / sums.slopes;
            shift += change;
            if !shift.is_finite() {
                return None;
            }
            if change.abs() * self.fixed.rate_hz.max(self.moving.rate_hz) < SETTLED {
                let blocks = self.blocks as f64;
                let mean = sums.products.iter().sum::<f64>() / blocks;
                let squares = sums.products.iter().map(|p| (p - mean) * (p - mean));
                let scatter = squares.sum::<f64>() * blocks / (blocks - 1.0);
                let sigma = scatter.sqrt() / sums.slopes;
                return Some((shift, student_95(blocks - 1.0) * sigma));
            }
        }
        None
    }

    /// One over the variance of a signal; 0 where it does not change.
    fn first_weight(&self, s: usize) -> f64 {
        let values = self.fixed.signals[s].iter().filter(|v| v.is_finite());
        let (mut n, mut mean, mut squares) = (0.0, 0.0, 0.0);
        for v in values.step_by(self.stride) {
            n += 1.0;
            let off = f64::from(*v) - mean;
            mean += off / n;
            squares += off * (f64::from(*v) - mean);
        }
        match squares > 0.0 {
            true => n / squares,
            false => 0.0,
        }
    }

    fn sums(&self, shift: f64, means: &[f64], weights: &[f64]) -> Sums {
        let (n, side) = (self.fixed.n_samples(), self.side);
        let mut out = Sums {
            products: vec![0.0; self.blocks],
            slopes: 0.0,
            residuals: vec![[0.0; 3]; means.len()],
        };
        let span_s = side as f64 / self.fixed.rate_hz;
        for i in (side..n.saturating_sub(side)).step_by(self.stride) {
            let time = self.fixed.start_s + i as f64 / self.fixed.rate_hz - shift;
            let block = (i * self.blocks / n).min(self.blocks - 1);
            for (s, weight) in weights.iter().enumerate().filter(|w| *w.1 > 0.0) {
                let x = &self.fixed.signals[s];
                let [before, here, after] = [i - side, i, i + side].map(|i| f64::from(x[i]));
                let slope = (after - before) / (2.0 * span_s);
                let moving = |t: f64| self.moving.value_at(s, t).map(|v| v.value);
                let (Some(m), Some(low), Some(high)) =
                    (moving(time), moving(time - span_s), moving(time + span_s))
                else {
                    continue;
                };
                let residual = here - m;
                if !(slope.is_finite() && residual.is_finite()) {
                    continue;
                }
                out.products[block] += weight * (residual - means[s]) * slope;
                out.slopes += weight * slope * (high - low) / (2.0 * span_s);
                let [count, sum, squares] = &mut out.residuals[s];
                *count += 1.0;
                *sum += residual;
                *squares += residual * residual;
            }
        }
        out
    }
}

#[cfg(test)]
mod tests;
