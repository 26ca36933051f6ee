//! Frequencies and damping of the modes, estimated from the record that they are removed from.
//!
//! More gauges than loads leave a residual `r(w) = B (1 - H G) eps`. A mode whose frequency or damping differs from the model adds, to first order,
//! `B (1 - H G) psi_j da_j c_j' f` to it, with `f = G eps` and `da_j` the derivative of the response by the logarithm of the frequency or of the
//! damping. Gauss and Newton's method finds the logarithms `x` that minimise the mean square of the residual over the record. The stated standard
//! deviations are the prior of `x`.
//!
//! Errors of the static S leave residuals in phase with the loads. They are projected out first: for every gauge, residual and derivatives are
//! replaced by their parts that are orthogonal to all loads over the record (the theorem of Frisch and Waugh). The covariance of the gradient has
//! two parts. Its scatter over parts of the record states the noise, which neighbouring samples share (a sandwich estimate). Errors of the strain of
//! a mode at a gauge, independent by mode and gauge, leave residuals in phase with the motion of the mode: `psi_gj a_j c_j' f` each.

use super::block::{Spectrum, spectrum, time_history};
use super::correct::Stretches;
use super::kernel::Kernel;
use super::plant::Plant;
use super::types::{BAND_END, Dynamics, Unfit};
use crate::linalg::{Complex, Matrix, Vector};
use crate::sensitivity::Sensitivity;
use rayon::prelude::*;
use std::ops::Range;

/// Steps of the method of Gauss and Newton at most.
const STEPS: usize = 10;
/// A step below this share of every standard deviation ends the search.
const CONVERGED: f64 = 0.05;
/// Largest change in one step of the logarithm of a frequency and of a damping, within which the response is nearly linear in them.
const LONGEST_STEP: [f64; 2] = [0.1, 0.7];
/// Damping from which an estimate without a stated value starts; the start with the smallest residual is taken.
const STARTS: [f64; 4] = [0.01, 0.03, 0.1, 0.3];
/// One standard deviation of the logarithm of a damping without a stated value, about the start: a factor of 4.5 either way.
const OPEN: f64 = 1.5;
/// Least standard deviation of the strain of a mode at a gauge, share of it: what a mesh that was not fitted to measured shapes is off by.
const SHAPE: f64 = 0.01;
/// Blocks of the record that are used, evenly spaced, and parts whose gradients are compared.
const MOST_BLOCKS: usize = 64;
const PARTS: usize = 64;

/// Estimated deviation of a parameter of a mode from its stated value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Estimated logarithm of the ratio to the stated value.
    pub log: f64,
    /// One standard deviation of `log`.
    pub sd: f64,
    /// One standard deviation that was stated.
    pub stated_sd: f64,
}

impl Deviation {
    /// Returns the deviation in units of the standard deviation that it has if the stated one is right; `None` if the record says nothing on it.
    ///
    /// The estimate shrinks towards 0. Under a prior of variance `p` and an estimate of variance `v` its variance is `p - v`.
    pub fn standardised(&self) -> Option<f64> {
        let (prior, own) = (self.stated_sd.powi(2), self.sd.powi(2));
        (own < 0.5 * prior).then(|| self.log / (prior - own).sqrt())
    }
}

/// Modes as the record shows them.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedModes {
    /// The model with estimated frequencies and damping, and the standard deviations that remain.
    pub dynamics: Dynamics,
    /// Deviation of frequency and of damping by mode; `None` for a parameter that was not estimated.
    pub deviations: Vec<[Option<Deviation>; 2]>,
    /// Mean square of the residual that the modes do not explain, over the mean square without any mode, both less noise.
    pub unexplained: f64,
    /// Mean square of the residual with the modes, over the mean square of noise.
    pub over_noise: f64,
}

/// Estimates frequencies and damping of the modes from a record. Arguments as in [`super::readings_at_rest`]; with `open_damping` the damping of
/// `dynamics` is not used. `model_rel` is one standard deviation of the strain of a mode at a gauge, share of it; at least 1 % is assumed.
///
/// Returns `None` where the record contains no information: no more gauges than loads, no mode in the band, or no stretch of the record with all
/// gauges that is long enough.
///
/// # Errors
/// See [`Unfit`].
pub fn estimate_modes(
    s: &Sensitivity,
    dynamics: &Dynamics,
    open_damping: bool,
    (noise, model_rel): (f64, f64),
    (readings, rate_hz): (&[Vec<f64>], f64),
) -> Result<Option<EstimatedModes>, Unfit> {
    let (n, k) = (s.gauges.len(), s.loads.len());
    if n <= k {
        return Ok(None);
    }
    let mut prior = dynamics.clone();
    if open_damping {
        prior.modes.iter_mut().for_each(|m| m.damping_sd = OPEN);
    }
    let record = Record {
        s,
        noise,
        shape_sd: model_rel.max(SHAPE),
        readings,
        rate_hz,
        spans: Stretches::from_readings(readings, readings.first().map_or(0, Vec::len))
            .of_all_gauges(),
    };
    let in_band = |m: &usize| prior.modes[*m].hz <= BAND_END * prior.up_to_hz;
    let stated = |m: usize| [prior.modes[m].frequency_sd, prior.modes[m].damping_sd];
    let parameters: Vec<(usize, usize)> = (0..prior.modes.len())
        .filter(in_band)
        .flat_map(|m| [(m, 0), (m, 1)])
        .filter(|(m, kind)| stated(*m)[*kind] > 0.0)
        .collect();
    if parameters.is_empty() {
        return Ok(None);
    }
    let starts: &[f64] = if open_damping { &STARTS } else { &[] };
    let mut problem = Problem {
        record,
        prior,
        parameters,
    };
    let Some(first) = problem.start(starts)? else {
        return Ok(None);
    };
    Ok(Some(problem.solve(first)?))
}

/// Record to estimate from.
struct Record<'a> {
    s: &'a Sensitivity,
    noise: f64,
    /// One standard deviation of the strain of a mode at a gauge, share of it.
    shape_sd: f64,
    readings: &'a [Vec<f64>],
    rate_hz: f64,
    /// Stretches in which all gauges read.
    spans: Vec<Range<usize>>,
}

/// Parameters, mode and kind (0 frequency, 1 damping), with their prior.
struct Problem<'a> {
    record: Record<'a>,
    prior: Dynamics,
    parameters: Vec<(usize, usize)>,
}

/// Sums of products over part of the record. Columns are the derivatives by parameter, the residual, and the residual without modes.
#[derive(Clone)]
struct Products {
    /// Loads and motions of the `m` modes with one another, `(k + m) x (k + m)`.
    loads: Matrix,
    /// Loads and motions with columns by gauge, `(k + m) x (p + 2)`.
    by_gauge: Vec<Matrix>,
    /// Columns with columns, `(p + 2) x (p + 2)`, sum over the gauges.
    columns: Matrix,
    samples: f64,
}

/// Normal equations at one set of parameters.
struct Normal {
    /// Derivatives with derivatives, and with the residual.
    matrix: Matrix,
    right: Vector,
    /// Sum of squares of the residual, without modes too.
    squares: f64,
    squares_without: f64,
    /// Gradient of each part of the record, after the best linear step.
    gradients: Vec<Vector>,
    /// Covariance of the gradient from errors of the modes' strain, `p x p`.
    by_shape: Matrix,
    /// Samples times residual degrees of freedom.
    freedom: f64,
    /// Share of white noise in the band.
    band: f64,
}

/// Prior and information at one set of parameters.
struct Posterior {
    mean: Vector,
    covariance: Matrix,
}

impl Problem<'_> {
    /// Returns the parameters to start from with their normal equations; `None` if the record is too short.
    fn start(&mut self, dampings: &[f64]) -> Result<Option<(Vector, Normal)>, Unfit> {
        let zero = Vector::zeros(self.parameters.len());
        if dampings.is_empty() {
            return Ok(self.normal(&zero)?.map(|normal| (zero, normal)));
        }
        let mut best: Option<(f64, Normal)> = None;
        for damping in dampings {
            self.set_damping(*damping);
            let Some(normal) = self.normal(&zero)? else {
                return Ok(None);
            };
            if best.as_ref().is_none_or(|b| normal.squares < b.1.squares) {
                best = Some((*damping, normal));
            }
        }
        Ok(best.map(|(damping, normal)| {
            self.set_damping(damping);
            (zero, normal)
        }))
    }

    fn set_damping(&mut self, damping: f64) {
        self.prior
            .modes
            .iter_mut()
            .for_each(|m| m.damping = damping);
        self.prior.further_damping = damping;
    }

    fn stated_sd(&self, (mode, kind): (usize, usize)) -> f64 {
        let mode = &self.prior.modes[mode];
        [mode.frequency_sd, mode.damping_sd][kind]
    }

    /// Returns the model with the parameters `x`. Strain and displacement under static loads do not change.
    fn with_parameters(&self, x: &Vector) -> Dynamics {
        let mut out = self.prior.clone();
        for (&(mode, kind), x) in self.parameters.iter().zip(x.iter()) {
            let mode = &mut out.modes[mode];
            if kind == 0 {
                mode.hz *= x.exp();
                mode.work.iter_mut().for_each(|w| *w *= (2.0 * x).exp());
            } else {
                mode.damping *= x.exp();
            }
        }
        out
    }

    /// Runs the method of Gauss and Newton.
    fn solve(&self, (mut x, mut normal): (Vector, Normal)) -> Result<EstimatedModes, Unfit> {
        let mut posterior = self.posterior(&x, &normal);
        for _ in 0..STEPS {
            let mut step = &posterior.mean - &x;
            let limit = |(of, (_, kind)): (&f64, &(usize, usize))| (of / LONGEST_STEP[*kind]).abs();
            let longest = step
                .iter()
                .zip(&self.parameters)
                .map(limit)
                .fold(1.0, f64::max);
            step /= longest;
            let small = |(i, of): (usize, &f64)| {
                of.abs() <= CONVERGED * posterior.covariance[(i, i)].sqrt()
            };
            if step.iter().enumerate().all(small) {
                break;
            }
            let variance = normal.variance(self.record.noise);
            let now = self.objective(&x, &normal, variance);
            let mut improved = false;
            for _ in 0..3 {
                let next = &x + &step;
                // Parameters with which the gauges do not separate the loads are no improvement.
                if let Ok(Some(there)) = self.normal(&next)
                    && self.objective(&next, &there, variance) < now
                {
                    (x, normal) = (next, there);
                    posterior = self.posterior(&x, &normal);
                    improved = true;
                    break;
                }
                step *= 0.3;
            }
            if !improved {
                break;
            }
        }
        Ok(self.estimated(&x, &normal, &posterior))
    }

    /// Returns twice the negative logarithm of the posterior density, up to a constant.
    fn objective(&self, x: &Vector, normal: &Normal, variance: f64) -> f64 {
        let prior = x.iter().zip(&self.parameters);
        let prior: f64 = prior.map(|(x, p)| (x / self.stated_sd(*p)).powi(2)).sum();
        normal.squares / variance + prior
    }

    fn estimated(&self, x: &Vector, normal: &Normal, posterior: &Posterior) -> EstimatedModes {
        let mut dynamics = self.with_parameters(x);
        let mut deviations = vec![[None; 2]; dynamics.modes.len()];
        for (i, &(mode, kind)) in self.parameters.iter().enumerate() {
            let sd = posterior.covariance[(i, i)].max(0.0).sqrt();
            deviations[mode][kind] = Some(Deviation {
                log: x[i],
                sd,
                stated_sd: self.stated_sd((mode, kind)),
            });
            let mode = &mut dynamics.modes[mode];
            *[&mut mode.frequency_sd, &mut mode.damping_sd][kind] = sd;
        }
        let noise = self.record.noise.powi(2) * normal.band * normal.freedom;
        let above = |squares: f64| (squares - noise).max(0.0);
        EstimatedModes {
            dynamics,
            deviations,
            unexplained: match above(normal.squares_without) {
                0.0 => 0.0,
                without => above(normal.squares) / without,
            },
            over_noise: normal.squares / noise,
        }
    }

    /// Returns mean and covariance of the parameters, by the normal equations at `x` and the prior.
    fn posterior(&self, x: &Vector, normal: &Normal) -> Posterior {
        let p = self.parameters.len();
        let variance = normal.variance(self.record.noise);
        let scatter = |i: usize| {
            let of_parts: f64 = normal.gradients.iter().map(|g| g[i] * g[i]).sum();
            let expected = variance * normal.matrix[(i, i)];
            if expected > 0.0 {
                (of_parts / expected).max(1.0).sqrt()
            } else {
                1.0
            }
        };
        let scatter: Vec<f64> = (0..p).map(scatter).collect();
        // Covariance of the gradient; a parameter that the residual does not contain has none.
        let mut gradient = Matrix::from_fn(p, p, |i, j| {
            normal.matrix[(i, j)] * variance * scatter[i] * scatter[j] + normal.by_shape[(i, j)]
        });
        let largest = gradient.diagonal().max().max(f64::MIN_POSITIVE);
        for i in 0..p {
            gradient[(i, i)] += 1e-12 * largest;
        }
        let weights = gradient
            .try_inverse()
            .unwrap_or_else(|| Matrix::zeros(p, p))
            * &normal.matrix;
        let information = normal.matrix.transpose() * &weights;
        let mut precision = information.clone();
        for (i, parameter) in self.parameters.iter().enumerate() {
            precision[(i, i)] += self.stated_sd(*parameter).powi(-2);
        }
        let prior = || {
            let sd2 = self.parameters.iter().map(|p| self.stated_sd(*p).powi(2));
            Matrix::from_diagonal(&Vector::from_iterator(p, sd2))
        };
        let covariance = precision.try_inverse().unwrap_or_else(prior);
        let right = &information * x + weights.transpose() * &normal.right;
        Posterior {
            mean: &covariance * right,
            covariance,
        }
    }

    /// Returns the normal equations at `x`; `None` if no stretch of the record is long enough.
    fn normal(&self, x: &Vector) -> Result<Option<Normal>, Unfit> {
        let record = &self.record;
        let dynamics = self.with_parameters(x);
        let all: Vec<usize> = (0..record.s.gauges.len()).collect();
        let plant = Plant::new(record.s, &all, &dynamics, record.noise);
        let kernel = Kernel::without_errors(&plant, record.rate_hz, super::correct::MOST_NUMBERS)?;
        let view = View::new(record, &kernel, &plant, &self.parameters);
        let hop = kernel.length - 2 * kernel.reach;
        let blocks: Vec<(Range<usize>, Range<usize>)> = (record.spans.iter())
            .flat_map(|span| {
                let last = span.end.saturating_sub(kernel.reach);
                let firsts = (span.start + kernel.reach..last).step_by(hop);
                firsts.map(move |first| (span.clone(), first..(first + hop).min(last)))
            })
            .collect();
        let every = blocks.len().div_ceil(MOST_BLOCKS).max(1);
        let used: Vec<_> = blocks.iter().step_by(every).collect();
        let products: Vec<Products> = (used.par_iter())
            .flat_map_iter(|(span, wanted)| view.products(span, wanted, used.len()))
            .collect();
        let shapes = (0..all.len())
            .map(|g| {
                view.modes
                    .iter()
                    .map(|j| plant.shapes[(g, *j)].re)
                    .collect()
            })
            .collect();
        let shapes = Shapes {
            strain: shapes,
            sd: record.shape_sd,
            n_loads: record.s.loads.len(),
        };
        Ok(Normal::new(&products, &shapes, view.band))
    }
}

/// Strain of the modes with parameters at the gauges.
struct Shapes {
    /// By gauge, by mode.
    strain: Vec<Vec<f64>>,
    /// One standard deviation, share of the strain.
    sd: f64,
    n_loads: usize,
}

/// Derivatives of one mode at one frequency.
struct ModeAt {
    /// `B (1 - H G) psi_j`, by gauge.
    spread: Vec<Complex<f64>>,
    /// Response beyond the static one, `a_j`.
    response: Complex<f64>,
    /// Derivatives of the response by the logarithms of frequency and damping.
    slopes: [Complex<f64>; 2],
}

/// The kernel with the derivatives of the residual.
struct View<'a> {
    record: &'a Record<'a>,
    kernel: &'a Kernel,
    parameters: &'a [(usize, usize)],
    /// Modes with parameters, and the static displacement of each by a unit of each load.
    modes: Vec<usize>,
    displacement: Vec<Vec<f64>>,
    /// By frequency, by entry of `modes`.
    at: Vec<Vec<ModeAt>>,
    /// Share of white noise in the band.
    band: f64,
}

impl<'a> View<'a> {
    fn new(
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
    fn products(
        &self,
        span: &Range<usize>,
        wanted: &Range<usize>,
        n_blocks: usize,
    ) -> Vec<Products> {
        let kernel = self.kernel;
        let begin = wanted.start - kernel.reach;
        let last = span.end - 1;
        let spectra: Vec<Spectrum> = (self.record.readings.iter())
            .map(|channel| spectrum(kernel.length, |i| channel[(begin + i).min(last)]))
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
        let parts = PARTS.div_ceil(n_blocks);
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
    fn residual_without_modes(
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

impl Products {
    /// Sums over the samples `part`. `columns` are by gauge the courses of the derivatives and of the residual.
    fn new(
        loads: &[Vec<f64>],
        columns: &[Vec<Vec<f64>>],
        without: &[Vec<f64>],
        part: Range<usize>,
    ) -> Self {
        let dot = |a: &[f64], b: &[f64]| -> f64 {
            let (a, b) = (&a[part.clone()], &b[part.clone()]);
            a.iter().zip(b).map(|(x, y)| x * y).sum()
        };
        let k = loads.len();
        let p = columns.first().map_or(0, Vec::len) + 1;
        let mut products = Matrix::zeros(p, p);
        let by_gauge = columns.iter().zip(without).map(|(columns, without)| {
            let all: Vec<&[f64]> = columns
                .iter()
                .chain(std::iter::once(without))
                .map(Vec::as_slice)
                .collect();
            for i in 0..p {
                for j in 0..=i {
                    let sum = dot(all[i], all[j]);
                    products[(i, j)] += sum;
                    if i != j {
                        products[(j, i)] += sum;
                    }
                }
            }
            Matrix::from_fn(k, p, |l, i| dot(&loads[l], all[i]))
        });
        let by_gauge = by_gauge.collect();
        Self {
            loads: Matrix::from_fn(k, k, |a, b| dot(&loads[a], &loads[b])),
            by_gauge,
            columns: products,
            samples: part.len() as f64,
        }
    }

    fn add(&mut self, other: &Self) {
        self.loads += &other.loads;
        self.columns += &other.columns;
        self.samples += other.samples;
        for (own, of_other) in self.by_gauge.iter_mut().zip(&other.by_gauge) {
            *own += of_other;
        }
    }

    /// Returns the products of columns less their regression on the loads, with the coefficients `regression` by gauge, `k x (p + 2)`.
    fn orthogonal(&self, regression: &[Matrix]) -> Matrix {
        let mut out = self.columns.clone();
        let k = regression.first().map_or(0, Matrix::nrows);
        let loads = self.loads.view((0, 0), (k, k));
        for (own, by) in self.by_gauge.iter().zip(regression) {
            let cross = by.transpose() * own.rows(0, k);
            out -= &cross + cross.transpose();
            out += by.transpose() * loads * by;
        }
        out
    }

    /// Returns the covariance of the gradient from errors of `shape_sd` of the strain of each mode at each gauge, `p x p`. `shapes` is the strain of
    /// the modes, by gauge.
    fn shape_covariance(
        &self,
        regression: &[Matrix],
        shapes: &[Vec<f64>],
        shape_sd: f64,
    ) -> Matrix {
        let (k, columns) = regression.first().map_or((0, 2), Matrix::shape);
        let p = columns - 2;
        let mut out = Matrix::zeros(p, p);
        for ((own, by), shape) in self.by_gauge.iter().zip(regression).zip(shapes) {
            for (m, strain) in shape.iter().enumerate() {
                let with_loads = self.loads.view((0, k + m), (k, 1)).column(0).into_owned();
                let of_mode = own.row(k + m).transpose() - by.transpose() * with_loads;
                let of_mode = of_mode.rows(0, p) * (shape_sd * strain);
                out += &of_mode * of_mode.transpose();
            }
        }
        out
    }
}

impl Normal {
    /// Forms the normal equations from the sums over parts of the record; `None` without any, or with too few samples.
    fn new(parts: &[Products], shapes: &Shapes, band: f64) -> Option<Self> {
        let mut all = parts.first()?.clone();
        parts[1..].iter().for_each(|part| all.add(part));
        let (n, k, p) = (all.by_gauge.len(), shapes.n_loads, all.columns.nrows() - 2);
        if all.samples < 10.0 * (k + p) as f64 {
            return None;
        }
        let inverse = all.loads.view((0, 0), (k, k)).into_owned();
        let inverse = inverse.pseudo_inverse(0.0).ok()?;
        let regression: Vec<Matrix> = (all.by_gauge.iter())
            .map(|m| &inverse * m.rows(0, k))
            .collect();
        let whole = all.orthogonal(&regression);
        let mut normal = Self {
            matrix: whole.view((0, 0), (p, p)).into_owned(),
            right: whole.view((0, p), (p, 1)).column(0).into_owned(),
            squares: whole[(p, p)].max(0.0),
            squares_without: whole[(p + 1, p + 1)].max(0.0),
            gradients: Vec::new(),
            by_shape: all.shape_covariance(&regression, &shapes.strain, shapes.sd),
            freedom: all.samples * (n - k) as f64,
            band,
        };
        let step = normal.step();
        let gradient = |part: &Products| {
            let own = part.orthogonal(&regression);
            own.view((0, p), (p, 1)).column(0).into_owned() - own.view((0, 0), (p, p)) * &step
        };
        normal.gradients = parts.iter().map(gradient).collect();
        Some(normal)
    }

    /// Returns the parameters' change that minimises the linearised residual, the shortest of all.
    fn step(&self) -> Vector {
        // Scaled to a diagonal of 1; combinations that the residual does not contain stay as they are.
        let n = self.right.len();
        let scale = |i: usize| self.matrix[(i, i)].max(f64::MIN_POSITIVE).sqrt();
        let scaled = Matrix::from_fn(n, n, |i, j| self.matrix[(i, j)] / (scale(i) * scale(j)));
        let right = Vector::from_fn(n, |i, _| self.right[i] / scale(i));
        let svd = scaled.svd(true, true);
        let step = svd
            .solve(&right, 1e-10)
            .unwrap_or_else(|_| Vector::zeros(n));
        Vector::from_fn(n, |i, _| step[i] / scale(i))
    }

    /// Returns the variance of one residual: of noise, or what the best linear step leaves if that is larger.
    fn variance(&self, noise: f64) -> f64 {
        let left = (self.squares - self.right.dot(&self.step())).max(0.0) / self.freedom;
        (noise * noise * self.band).max(left).max(f64::MIN_POSITIVE)
    }
}
