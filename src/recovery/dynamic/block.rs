//! A record through the filter, block by block, and what its errors are there.

use super::kernel::{Bin, Kernel};
use crate::linalg::Complex;
use crate::series::plans::{forward, inverse};
use rayon::prelude::*;
use std::ops::Range;

/// Blocks in memory at a time.
const GROUP: usize = 16;

/// Quasi-static block of a record. Errors and sums contain every `step`-th sample, which is often enough for the band.
pub(super) struct Block {
    /// First sample.
    pub first: usize,
    /// Readings of each gauge that reads.
    pub readings: Vec<Vec<f64>>,
    /// Samples between two samples with computed errors.
    pub step: usize,
    /// First sample with computed errors.
    pub first_valid: usize,
    /// Both quarters of the time history of each error, by error and by gauge that reads, at these samples, strain. The mean of their squares is the
    /// size of the error.
    pub errors: Vec<Vec<[Vec<f64>; 2]>>,
    /// Error of the quasi-static recovery of each load, at the samples with computed errors.
    pub motion: Vec<Vec<f64>>,
    /// Each load, at the same samples.
    pub loads: Vec<Vec<f64>>,
}

/// Spectrum of a channel: one value for each frequency of the filter.
pub(super) type Spectrum = Vec<Complex<f64>>;

impl Kernel {
    /// Computes quasi-static readings from the readings `from` of the samples `span`, one channel for each gauge, and passes them to `sink` in
    /// blocks. Samples nearer than the reach to an end of `span` are left out.
    pub fn apply(&self, from: &[&[f64]], span: &Range<usize>, mut sink: impl FnMut(&Block)) {
        let hop = self.length - 2 * self.reach;
        let firsts: Vec<usize> = (span.start + self.reach..span.end.saturating_sub(self.reach))
            .step_by(hop)
            .collect();
        for group in firsts.chunks(GROUP) {
            let done: Vec<Block> = group
                .par_iter()
                .map(|first| {
                    let to = (first + hop).min(span.end - self.reach);
                    self.block(from, span, *first..to)
                })
                .collect();
            done.iter().for_each(&mut sink);
        }
    }

    /// The samples `wanted`, from those up to the reach round them.
    fn block(&self, from: &[&[f64]], span: &Range<usize>, wanted: Range<usize>) -> Block {
        let begin = wanted.start - self.reach;
        // No wanted sample depends on readings beyond the end of the stretch, so the last reading is repeated.
        let last = span.end - 1;
        let spectra: Vec<Spectrum> = from
            .iter()
            .map(|channel| spectrum(self.length, |i| channel[(begin + i).min(last)]))
            .collect();
        let loads = self.loads_of(&spectra);
        let at_rest = self.remove_dynamic_strain(&spectra, &loads);
        let back = |bins: &[Complex<f64>], length: usize| time_history(bins, length, self.length);
        let kept = self.reach..self.reach + wanted.len();
        let whole = |bins: &Spectrum| back(bins, self.length)[kept.clone()].to_vec();
        // Use the shortest transform that contains the band.
        let short = (2 * self.bins.len()).next_power_of_two().min(self.length);
        let step = self.length / short;
        // The range contains at least one sample, which may be before the first wanted sample.
        let first_valid = self.reach / step;
        let told = first_valid..kept.end.div_ceil(step);
        let thin = |bins: &[Complex<f64>]| back(bins, short)[told.clone()].to_vec();
        let quarters = |bins: &Spectrum| {
            let turned: Spectrum = bins.iter().map(|v| Complex::new(v.im, -v.re)).collect();
            [thin(bins), thin(&turned)]
        };
        let errors = self.errors_of(&loads);
        let motion = self.motion_of(&loads);
        let loads = self.at_rest_of(&at_rest);
        Block {
            first: wanted.start,
            readings: at_rest.iter().map(whole).collect(),
            step,
            first_valid: begin + first_valid * step,
            errors: errors
                .iter()
                .map(|by_gauge| by_gauge.iter().map(quarters).collect())
                .collect(),
            motion: motion.iter().map(|bins| thin(bins)).collect(),
            loads: loads.iter().map(|bins| thin(bins)).collect(),
        }
    }

    /// Returns `G eps` by load.
    pub fn loads_of(&self, spectra: &[Spectrum]) -> Vec<Spectrum> {
        let of_load = |l: usize| -> Spectrum {
            let bins = self.bins.iter().enumerate();
            let of_bin = |(b, bin): (usize, &Bin)| -> Complex<f64> {
                let row = bin.gain.row(l);
                row.iter().zip(spectra).map(|(w, s)| w * s[b]).sum()
            };
            bins.map(of_bin).collect()
        };
        (0..self.at_rest.nrows()).map(of_load).collect()
    }

    /// `T eps = B eps - B Psi a C G eps` by gauge.
    fn remove_dynamic_strain(&self, spectra: &[Spectrum], loads: &[Spectrum]) -> Vec<Spectrum> {
        let of_gauge = |(g, own): (usize, &Spectrum)| -> Spectrum {
            let bins = self.bins.iter().enumerate();
            let of_bin = |(b, bin): (usize, &Bin)| -> Complex<f64> {
                let row = bin.added.row(g);
                let moved: Complex<f64> = row.iter().zip(loads).map(|(w, f)| w * f[b]).sum();
                own[b] * bin.band - moved
            };
            bins.map(of_bin).collect()
        };
        spectra.iter().enumerate().map(of_gauge).collect()
    }

    /// Returns the errors of the quasi-static readings, by error source and gauge. Sources are one standard deviation of each mode's frequency and
    /// damping, and the response of modes outside the model.
    fn errors_of(&self, loads: &[Spectrum]) -> Vec<Vec<Spectrum>> {
        let n = self.at_rest.ncols();
        let mut out = Vec::new();
        for (j, moved) in self.moved.iter().enumerate() {
            for kind in 0..2 {
                if self
                    .bins
                    .iter()
                    .all(|b| b.errors[j][kind].norm_sqr() == 0.0)
                {
                    continue;
                }
                let moves = |(b, bin): (usize, &Bin)| {
                    let by: Complex<f64> = loads.iter().zip(moved).map(|(f, c)| f[b] * *c).sum();
                    by * bin.errors[j][kind]
                };
                let moves: Spectrum = self.bins.iter().enumerate().map(moves).collect();
                let of_gauge = |g: usize| -> Spectrum {
                    let bins = self.bins.iter().zip(&moves);
                    bins.map(|(bin, m)| bin.spread[j][g] * m).collect()
                };
                out.push((0..n).map(of_gauge).collect());
            }
        }
        if self.bins.iter().any(|b| b.further.is_some()) {
            let of_gauge = |g: usize| -> Spectrum {
                let of_bin = |(b, bin): (usize, &Bin)| -> Complex<f64> {
                    let Some(m) = &bin.further else {
                        return Complex::default();
                    };
                    m.row(g).iter().zip(loads).map(|(w, f)| w * f[b]).sum()
                };
                self.bins.iter().enumerate().map(of_bin).collect()
            };
            out.push((0..n).map(of_gauge).collect());
        }
        out
    }

    /// Returns the error of quasi-static recovery, for each load.
    fn motion_of(&self, loads: &[Spectrum]) -> Vec<Spectrum> {
        let (k, n) = self.at_rest.shape();
        let of_load = |l: usize| -> Spectrum {
            let of_bin = |(b, bin): (usize, &Bin)| -> Complex<f64> {
                let of_gauge = |g: usize| -> Complex<f64> {
                    let row = bin.added.row(g);
                    let moved: Complex<f64> = row.iter().zip(loads).map(|(w, f)| w * f[b]).sum();
                    moved * self.at_rest[(l, g)]
                };
                (0..n).map(of_gauge).sum()
            };
            self.bins.iter().enumerate().map(of_bin).collect()
        };
        (0..k).map(of_load).collect()
    }

    /// Returns the loads that the static gain computes from quasi-static readings.
    fn at_rest_of(&self, at_rest: &[Spectrum]) -> Vec<Spectrum> {
        let of_load = |l: usize| -> Spectrum {
            let row = self.at_rest.row(l);
            let of_bin = |b: usize| -> Complex<f64> {
                row.iter().zip(at_rest).map(|(w, s)| s[b] * *w).sum()
            };
            (0..self.bins.len()).map(of_bin).collect()
        };
        (0..self.at_rest.nrows()).map(of_load).collect()
    }
}

/// Returns the transform of `length` samples.
pub(super) fn spectrum(length: usize, sample: impl Fn(usize) -> f64) -> Spectrum {
    let plan = forward(length);
    let mut input = plan.make_input_vec();
    input
        .iter_mut()
        .enumerate()
        .for_each(|(i, v)| *v = sample(i));
    let mut out = plan.make_output_vec();
    let done = plan.process(&mut input, &mut out);
    debug_assert!(done.is_ok());
    out
}

/// Returns the time history over `length` samples from the first `bins` of a transform of `of` samples. Higher bins are zero.
pub(super) fn time_history(bins: &[Complex<f64>], length: usize, of: usize) -> Vec<f64> {
    let back = inverse(length);
    let mut input = back.make_input_vec();
    input.iter_mut().zip(bins).for_each(|(v, b)| *v = *b);
    input[0].im = 0.0;
    let mut out = back.make_output_vec();
    let done = back.process(&mut input, &mut out);
    debug_assert!(done.is_ok());
    let scale = 1.0 / of as f64;
    out.iter_mut().for_each(|v| *v *= scale);
    out
}
