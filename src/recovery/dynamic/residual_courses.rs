//! Time histories of the residual of a record, of its derivatives by the parameters of the modes, and of the motion of the modes.

use super::block::{Spectrum, spectrum, time_history};
use super::kernel::Kernel;
use super::normal_equations::Products;
use super::plant::Plant;
use super::rules::RULES;
use crate::linalg::{Complex, Matrix};
use crate::sensitivity::Sensitivity;
use rayon::prelude::*;
use std::ops::Range;

/// Record to estimate from.
pub(super) struct Record<'a> {
    pub s: &'a Sensitivity,
    pub noise: f64,
    /// One standard deviation of the strain of a mode at a gauge, as a share of this strain.
    pub shape_sd: f64,
    pub readings: &'a [Vec<f64>],
    pub rate_hz: f64,
    /// Mean of the finite readings by gauge. Motion has no mean, and the mean may be the zero of the gauge.
    pub means: Vec<f64>,
    /// Stretches in which all gauges read.
    pub spans: Vec<Range<usize>>,
}

/// Derivatives of one mode at one frequency.
pub(super) struct ModeAt {
    /// `B (1 - H G) psi_j`, by gauge.
    pub spread: Vec<Complex<f64>>,
    /// Response beyond the static response, `a_j`.
    pub response: Complex<f64>,
    /// Derivatives of the response by the logarithms of frequency and damping.
    pub slopes: [Complex<f64>; 2],
}

/// The kernel with the derivatives of the residual.
pub(super) struct View<'a> {
    pub record: &'a Record<'a>,
    pub kernel: &'a Kernel,
    pub parameters: &'a [(usize, usize)],
    /// Modes with parameters, and the static displacement of each by a unit of each load.
    pub modes: Vec<usize>,
    pub displacement: Vec<Vec<f64>>,
    /// Values by frequency and by entry of `modes`.
    pub at: Vec<Vec<ModeAt>>,
    /// Share of white noise in the band.
    pub band: f64,
}

impl<'a> View<'a> {
    pub fn new(
        record: &'a Record<'a>,
        kernel: &'a Kernel,
        plant: &Plant<'_>,
        parameters: &'a [(usize, usize)],
    ) -> Self {
        let mut modes: Vec<usize> = parameters.iter().map(|p| p.0).collect();
        modes.dedup();
        let s = record.s.values.map(|v| Complex::new(v, 0.0));
        let of_bin = |b: usize| -> Vec<ModeAt> {
            let bin = &kernel.bins[b];
            let hz = b as f64 * record.rate_hz / kernel.length as f64;
            let band = Complex::new(bin.band, 0.0);
            let response = &s * band + &bin.added;
            let of_mode = |j: &usize| {
                let shape = plant.shapes.column(*j).into_owned();
                let spread = &shape * band - &response * (&bin.gain * &shape);
                let answer = plant.answer(*j, hz);
                ModeAt {
                    spread: spread.iter().copied().collect(),
                    response: answer.added,
                    slopes: [answer.by_frequency, answer.by_damping],
                }
            };
            modes.iter().map(of_mode).collect()
        };
        let sides = |b: usize| if b == 0 { 1.0 } else { 2.0 } / kernel.length as f64;
        let bands = kernel.bins.iter().enumerate();
        Self {
            at: (0..kernel.bins.len()).into_par_iter().map(of_bin).collect(),
            displacement: modes.iter().map(|j| plant.modal_displacement(*j)).collect(),
            band: bands.map(|(b, bin)| sides(b) * bin.band.powi(2)).sum(),
            record,
            kernel,
            parameters,
            modes,
        }
    }

    /// Returns the sums of products of the samples `wanted` in parts, one block of `n_blocks`.
    pub fn products(
        &self,
        span: &Range<usize>,
        wanted: &Range<usize>,
        n_blocks: usize,
    ) -> Vec<Products> {
        let kernel = self.kernel;
        let begin = wanted.start - kernel.reach;
        let last = span.end - 1;
        let channels = self.record.readings.iter().zip(&self.record.means);
        let spectra: Vec<Spectrum> = channels
            .map(|(channel, mean)| {
                spectrum(kernel.length, |i| channel[(begin + i).min(last)] - mean)
            })
            .collect();
        let loads = kernel.loads_of(&spectra);
        // A transform as short as the band allows.
        let short = (2 * kernel.bins.len())
            .next_power_of_two()
            .min(kernel.length);
        let step = kernel.length / short;
        let kept = kernel.reach.div_ceil(step)..(kernel.reach + wanted.len()).div_ceil(step);
        let course = |bins: &dyn Fn(usize) -> Complex<f64>| -> Vec<f64> {
            let bins: Spectrum = (0..kernel.bins.len()).map(bins).collect();
            time_history(&bins, short, kernel.length)[kept.clone()].to_vec()
        };
        let mut load_courses: Vec<Vec<f64>> = (loads.iter())
            .map(|f| course(&|b| f[b] * kernel.bins[b].band))
            .collect();
        let amplitudes: Vec<Spectrum> = (self.displacement.iter())
            .map(|c| {
                let of_bin = |b: usize| loads.iter().zip(c).map(|(f, c)| f[b] * *c).sum();
                (0..kernel.bins.len()).map(of_bin).collect()
            })
            .collect();
        let motions = amplitudes.iter().enumerate().map(|(m, amplitude)| {
            course(&|b| amplitude[b] * self.at[b][m].response * kernel.bins[b].band)
        });
        load_courses.extend(motions);
        let mode_of: Vec<usize> = (self.parameters.iter())
            .map(|p| self.modes.iter().position(|m| *m == p.0).unwrap_or(0))
            .collect();
        let s = &self.record.s.values;
        let columns: Vec<Vec<Vec<f64>>> = (0..spectra.len())
            .map(|g| {
                let derivative = |(m, (_, kind)): (&usize, &(usize, usize))| {
                    course(&|b| {
                        let at = &self.at[b][*m];
                        at.spread[g] * at.slopes[*kind] * amplitudes[*m][b]
                    })
                };
                let mut columns: Vec<Vec<f64>> = mode_of
                    .iter()
                    .zip(self.parameters)
                    .map(derivative)
                    .collect();
                columns.push(course(&|b| {
                    let bin = &kernel.bins[b];
                    let by_load = loads.iter().enumerate();
                    let of_loads: Complex<f64> = by_load
                        .map(|(l, f)| f[b] * (bin.added[(g, l)] + bin.band * s[(g, l)]))
                        .sum();
                    spectra[g][b] * bin.band - of_loads
                }));
                columns
            })
            .collect();
        let without = self.residual_without_modes(&spectra, &course);
        let parts = RULES.parts.div_ceil(n_blocks);
        let length = kept.len().div_ceil(parts).max(1);
        (0..kept.len())
            .step_by(length)
            .map(|from| {
                let to = (from + length).min(kept.len());
                Products::new(&load_courses, &columns, &without, from..to)
            })
            .collect()
    }

    /// Returns the course of the residual of the static S, by gauge.
    pub fn residual_without_modes(
        &self,
        spectra: &[Spectrum],
        course: &dyn Fn(&dyn Fn(usize) -> Complex<f64>) -> Vec<f64>,
    ) -> Vec<Vec<f64>> {
        let n = spectra.len();
        let projection = Matrix::identity(n, n) - &self.record.s.values * &self.kernel.at_rest;
        (0..n)
            .map(|g| {
                course(&|b| {
                    let row = projection.row(g);
                    let sum: Complex<f64> = row.iter().zip(spectra).map(|(p, e)| e[b] * *p).sum();
                    sum * self.kernel.bins[b].band
                })
            })
            .collect()
    }
}
