//! The filter that puts readings at rest, and how far round a sample it reaches.

use super::plant::Plant;
use super::types::{BAND_END, Unfit};
use crate::linalg::complex::ComplexMatrix;
use crate::linalg::{Complex, Matrix};
use crate::series::plans::{forward, inverse};
use rayon::prelude::*;
use std::ops::Range;

/// Share of the filter's weight that may lie beyond its reach: an error of a thousandth of what the loads were there.
const BEYOND: f64 = 1e-3;
/// Longest transform, samples.
const LONGEST: usize = 1 << 20;
/// Numbers that a filter may hold: 256 MB.
const MOST_NUMBERS: usize = 16_000_000;
/// Samples of the first transform that is tried, in periods of the highest frequency wanted.
const PERIODS: f64 = 16.0;
/// Share of a transform that the reach may take at either side.
const SIDE: usize = 8;
/// Blocks in memory at a time.
const GROUP: usize = 16;

/// `T(w) = B (1 - Psi a C G)`, `n x n`, a matrix a frequency.
pub(super) struct Kernel {
    /// Samples of a transform.
    length: usize,
    /// Samples to either side that a sample at rest hangs on.
    pub reach: usize,
    bins: Vec<Bin>,
    shapes: ComplexMatrix,
    /// Variance of a reading at rest over that of a reading, mean of the gauges.
    pub noise_share: f64,
    /// By load: variance of what readings at rest make of it beyond that of readings with `noise_share` of the variance, for noise of variance 1.
    pub excess: Vec<f64>,
}

/// A frequency.
struct Bin {
    /// B.
    band: f64,
    /// B a C G: what each mode moves beyond its answer at rest, `m x n`.
    motion: ComplexMatrix,
}

impl Kernel {
    /// For samples at `rate_hz`.
    ///
    /// # Errors
    /// See [`Unfit`].
    pub fn new(plant: &Plant<'_>, rate_hz: f64) -> Result<Self, Unfit> {
        let up_to = plant.dynamics().up_to_hz;
        let end_hz = BAND_END * up_to;
        if !(2.0 * end_hz < rate_hz) {
            return Err(Unfit::Rate { rate_hz, end_hz });
        }
        let at_rest = plant.gain_at_rest().ok_or(Unfit::Untold { hz: 0.0 })?;
        let mut length = ((PERIODS * rate_hz / up_to) as usize).next_power_of_two();
        loop {
            let n_bins = (end_hz / rate_hz * length as f64) as usize + 1;
            let numbers = 2 * n_bins * (plant.n_modes() + plant.n_loads()) * plant.n_gauges();
            if length > LONGEST || numbers > MOST_NUMBERS {
                let seconds = length as f64 / (2 * SIDE) as f64 / rate_hz;
                return Err(Unfit::Rings { seconds });
            }
            let bins = (0..n_bins)
                .into_par_iter()
                .map(|b| bin(plant, b as f64 * rate_hz / length as f64))
                .collect::<Result<Vec<Bin>, Unfit>>()?;
            let loads = of_loads(plant, &at_rest, &bins);
            let reach = reach_of(&loads, length, at_rest.shape());
            if reach <= length / SIDE {
                let mut kernel = Self {
                    length,
                    reach,
                    bins,
                    shapes: plant.shapes.clone(),
                    noise_share: 0.0,
                    excess: Vec::new(),
                };
                kernel.noise(&loads, &at_rest);
                return Ok(kernel);
            }
            length *= 2;
        }
    }

    /// What it does to white noise; `loads` is what it makes of each load.
    fn noise(&mut self, loads: &[ComplexMatrix], at_rest: &Matrix) {
        let n = self.shapes.nrows();
        let sides = |b: usize| if b == 0 { 1.0 } else { 2.0 } / self.length as f64;
        let readings = (0..self.bins.len()).into_par_iter().map(|b| {
            let bin = &self.bins[b];
            let mut t = -(&self.shapes * &bin.motion);
            (0..n).for_each(|g| t[(g, g)] += bin.band);
            sides(b) * t.norm_squared() / n.max(1) as f64
        });
        self.noise_share = readings.collect::<Vec<f64>>().iter().sum();
        let of_load = |l: usize| {
            let made = loads.iter().enumerate();
            let made: f64 = made.map(|(b, k)| sides(b) * k.row(l).norm_squared()).sum();
            (made - self.noise_share * at_rest.row(l).norm_squared()).max(0.0)
        };
        self.excess = (0..at_rest.nrows()).map(of_load).collect();
    }

    /// Samples of a transform.
    pub fn length(&self) -> usize {
        self.length
    }

    /// The readings `from` of the samples `span`, a channel each, put at rest and handed to `sink` in blocks: first sample, channels. Samples nearer
    /// than the reach to an end of `span` are left out.
    pub fn apply(
        &self,
        from: &[&[f64]],
        span: Range<usize>,
        mut sink: impl FnMut(usize, &[Vec<f64>]),
    ) {
        let hop = self.length - 2 * self.reach;
        let firsts: Vec<usize> = (span.start + self.reach..span.end.saturating_sub(self.reach))
            .step_by(hop)
            .collect();
        for group in firsts.chunks(GROUP) {
            let done: Vec<Vec<Vec<f64>>> = group
                .par_iter()
                .map(|first| {
                    let to = (first + hop).min(span.end - self.reach);
                    self.block(from, &span, *first..to)
                })
                .collect();
            for (first, block) in group.iter().zip(&done) {
                sink(*first, block);
            }
        }
    }

    /// The samples `wanted`, from those up to the reach round them.
    fn block(&self, from: &[&[f64]], span: &Range<usize>, wanted: Range<usize>) -> Vec<Vec<f64>> {
        let begin = wanted.start - self.reach;
        let plan = forward(self.length);
        let spectra: Vec<Vec<Complex<f64>>> = from
            .iter()
            .map(|channel| {
                let mut input = plan.make_input_vec();
                let last = span.end - 1;
                // Beyond the end of the stretch nothing that is wanted reaches.
                let sample = |i: usize| channel[(begin + i).min(last)];
                input
                    .iter_mut()
                    .enumerate()
                    .for_each(|(i, v)| *v = sample(i));
                let mut out = plan.make_output_vec();
                let done = plan.process(&mut input, &mut out);
                debug_assert!(done.is_ok());
                out
            })
            .collect();
        let back = inverse(self.length);
        let mut bins: Vec<Vec<Complex<f64>>> = spectra
            .iter()
            .map(|s| vec![Complex::default(); s.len()])
            .collect();
        let mut motion = vec![Complex::default(); self.shapes.ncols()];
        for (b, bin) in self.bins.iter().enumerate() {
            for (j, m) in motion.iter_mut().enumerate() {
                let row = bin.motion.row(j);
                *m = row.iter().zip(&spectra).map(|(w, s)| w * s[b]).sum();
            }
            for (g, out) in bins.iter_mut().enumerate() {
                let moved = self.shapes.row(g);
                let moved: Complex<f64> = moved.iter().zip(&motion).map(|(w, m)| w * m).sum();
                out[b] = spectra[g][b] * bin.band - moved;
            }
        }
        let scale = 1.0 / self.length as f64;
        bins.iter_mut()
            .map(|bins| {
                bins[0].im = 0.0;
                let mut out = back.make_output_vec();
                let done = back.process(bins, &mut out);
                debug_assert!(done.is_ok());
                let kept = &out[self.reach..self.reach + wanted.len()];
                kept.iter().map(|v| v * scale).collect()
            })
            .collect()
    }
}

fn bin(plant: &Plant<'_>, hz: f64) -> Result<Bin, Unfit> {
    let band = plant.band(hz);
    let gain = plant.gain(hz).ok_or(Unfit::Untold { hz })?;
    let mut motion = plant.moved_by(&gain);
    for j in 0..plant.n_modes() {
        let added = plant.answer(j, hz).added * band;
        motion.row_mut(j).iter_mut().for_each(|v| *v *= added);
    }
    Ok(Bin { band, motion })
}

/// What the filter and the static gain after it make of readings, `k x n` a frequency.
fn of_loads(plant: &Plant<'_>, at_rest: &Matrix, bins: &[Bin]) -> Vec<ComplexMatrix> {
    let gain = at_rest.map(|v| Complex::new(v, 0.0));
    let of_shapes = &gain * &plant.shapes;
    bins.par_iter()
        .map(|b| &gain * Complex::new(b.band, 0.0) - &of_shapes * &b.motion)
        .collect()
}

/// The samples to either side beyond which no load has more than [`BEYOND`] of its weights.
fn reach_of(loads: &[ComplexMatrix], length: usize, (k, n): (usize, usize)) -> usize {
    let plan = inverse(length);
    let of_load = |l: usize| {
        let mut by_lag = vec![0.0; length / 2 + 1];
        for g in 0..n {
            let mut bins = plan.make_input_vec();
            for (bin, of_bin) in bins.iter_mut().zip(loads) {
                *bin = of_bin[(l, g)];
            }
            bins[0].im = 0.0;
            let mut out = plan.make_output_vec();
            let done = plan.process(&mut bins, &mut out);
            debug_assert!(done.is_ok());
            for (i, v) in out.iter().enumerate() {
                by_lag[i.min(length - i)] += v.abs();
            }
        }
        let may_lie_beyond = BEYOND * by_lag.iter().sum::<f64>();
        let mut beyond = 0.0;
        let lags = by_lag.iter().enumerate().rev();
        let mut farther = lags.skip_while(|(_, w)| {
            beyond += **w;
            beyond <= may_lie_beyond
        });
        farther.next().map_or(0, |(lag, _)| lag)
    };
    let reaches: Vec<usize> = (0..k).into_par_iter().map(of_load).collect();
    reaches.into_iter().max().unwrap_or(0)
}
