//! Frequencies and damping of the modes, estimated from the record that they are removed from.
//!
//! More gauges than loads leave a residual `r(w) = B (1 - H G) eps`. A mode whose frequency or damping differs from the model adds a term to it. To
//! first order, this term is `B (1 - H G) psi_j da_j c_j' f`, with `f = G eps`. `da_j` is the derivative of the response by the logarithm of the
//! frequency or of the damping. Gauss and Newton's method finds the logarithms `x` that minimise the mean square of the residual over the record.
//! The stated standard deviations are the prior of `x`.
//!
//! Errors of the static S leave residuals in phase with the loads. They are projected out first (the theorem of Frisch and Waugh). For every gauge,
//! this keeps the parts of the residual and of the derivatives that are orthogonal to all loads over the record. The covariance of the gradient has
//! two parts. Its scatter over parts of the record states the noise, which neighbouring samples share (a sandwich estimate). Errors of the strain of
//! a mode at a gauge, independent by mode and gauge, leave residuals in phase with the motion of the mode: `psi_gj a_j c_j' f` each.

use super::correct::Stretches;
use super::kernel::Kernel;
use super::normal_equations::{Normal, Products, Shapes};
use super::plant::Plant;
use super::residual_courses::{Record, View};
use super::rules::RULES;
use super::types::{BAND_END, Dynamics, Unfit};
use crate::linalg::{Matrix, Vector};
use crate::sensitivity::Sensitivity;
use crate::series::detrend::finite_mean;
use rayon::prelude::*;
use std::ops::Range;

/// Estimated deviation of a parameter of a mode from its stated value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// Estimated logarithm of the ratio to the stated value.
    pub log: f64,
    /// One standard deviation of `log`.
    pub sd: f64,
    /// Stated standard deviation.
    pub stated_sd: f64,
}

impl Deviation {
    /// Returns the deviation in units of the standard deviation that it has if the stated standard deviation is right. `None` if the record does not
    /// determine the parameter.
    ///
    /// The estimate shrinks towards 0. Under a prior of variance `p` and an estimate of variance `v` its variance is `p - v`.
    pub fn standard_deviations_off(&self) -> Option<f64> {
        let (prior, own) = (self.stated_sd.powi(2), self.sd.powi(2));
        (own < 0.5 * prior).then(|| self.log / (prior - own).sqrt())
    }
}

/// Modes as determined from the record.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimatedModes {
    /// The model with estimated frequencies and damping, and the standard deviations that remain.
    pub dynamics: Dynamics,
    /// Deviation of frequency and of damping by mode; `None` for a parameter that was not estimated.
    pub deviations: Vec<[Option<Deviation>; 2]>,
    /// Mean square of the residual that the modes do not explain, over the mean square without any mode, both minus noise.
    pub unexplained: f64,
    /// Mean square of the residual with the modes, over the mean square of noise.
    pub over_noise: f64,
}

/// Estimates frequencies and damping of the modes from a record. Arguments as in [`super::readings_at_rest`]; with `open_damping` the damping of
/// `dynamics` is not used. `model_rel` is one standard deviation of the strain of a mode at a gauge, as a share of this strain. At least 1 % is
/// assumed.
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
        prior
            .modes
            .iter_mut()
            .for_each(|m| m.damping_sd = RULES.open_sd);
    }
    let record = Record {
        s,
        noise,
        shape_sd: model_rel.max(RULES.shape_sd),
        readings,
        rate_hz,
        means: readings.iter().map(|x| finite_mean(x)).collect(),
        spans: Stretches::from_readings(readings, readings.first().map_or(0, Vec::len))
            .of_all_gauges(),
    };
    let in_band = |m: &usize| prior.modes[*m].hz <= BAND_END * prior.up_to_hz;
    let stated = |m: usize| [prior.modes[m].frequency_sd, prior.modes[m].damping_sd];
    let parameters: Vec<(usize, usize)> = (0..prior.modes.len())
        .filter(in_band)
        .flat_map(|m| [(m, 0), (m, 1)])
        .filter(|(m, kind)| stated(*m)[*kind] > 0.0)
        .take(RULES.parameters)
        .collect();
    if parameters.is_empty() {
        return Ok(None);
    }
    let starts: &[f64] = if open_damping { &RULES.starts } else { &[] };
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

/// Parameters, mode and kind (0 frequency, 1 damping), with their prior.
struct Problem<'a> {
    record: Record<'a>,
    prior: Dynamics,
    parameters: Vec<(usize, usize)>,
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
        let mut first_error = None;
        for damping in dampings {
            self.set_damping(*damping);
            // A structure with little damping may ring longer than the record or the filter.
            match self.normal(&zero) {
                Ok(Some(n)) if best.as_ref().is_none_or(|b| n.squares < b.1.squares) => {
                    best = Some((*damping, n));
                }
                Ok(_) => {}
                Err(e) => {
                    first_error.get_or_insert(e);
                }
            }
        }
        if let (None, Some(e)) = (&best, first_error) {
            return Err(e);
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
                mode.damping = (mode.damping * x.exp()).min(RULES.largest_damping);
            }
        }
        out
    }

    /// Runs the method of Gauss and Newton.
    fn solve(&self, (mut x, mut normal): (Vector, Normal)) -> Result<EstimatedModes, Unfit> {
        let mut posterior = self.posterior(&x, &normal);
        for _ in 0..RULES.steps {
            let mut step = &posterior.mean - &x;
            let limit =
                |(of, (_, kind)): (&f64, &(usize, usize))| (of / RULES.longest_step[*kind]).abs();
            let longest = step
                .iter()
                .zip(&self.parameters)
                .map(limit)
                .fold(1.0, f64::max);
            step /= longest;
            let small = |(i, of): (usize, &f64)| {
                of.abs() <= RULES.converged * posterior.covariance[(i, i)].sqrt()
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
        Ok(self.conclude(&x, &normal, &posterior))
    }

    /// Returns twice the negative logarithm of the posterior density, up to a constant.
    fn objective(&self, x: &Vector, normal: &Normal, variance: f64) -> f64 {
        let prior = x.iter().zip(&self.parameters);
        let prior: f64 = prior.map(|(x, p)| (x / self.stated_sd(*p)).powi(2)).sum();
        normal.squares / variance + prior
    }

    fn conclude(&self, x: &Vector, normal: &Normal, posterior: &Posterior) -> EstimatedModes {
        let mut dynamics = self.with_parameters(x);
        let mut deviations = vec![[None; 2]; dynamics.modes.len()];
        for (i, &(mode, kind)) in self.parameters.iter().enumerate() {
            // Where the search stopped before the best estimate, the distance to it is uncertainty too.
            let off = posterior.mean[i] - x[i];
            let sd = (posterior.covariance[(i, i)].max(0.0) + off * off).sqrt();
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
            // A residual that exceeds the motion of the modes comes from elsewhere: noise, or a load that is not listed.
            unexplained: match above(normal.squares_without) {
                without if without > 0.0 && above(normal.squares) < normal.squares_of_motion => {
                    (above(normal.squares) / without).min(1.0)
                }
                _ => 0.0,
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
        // Covariance of the gradient. A parameter without effect on the residual has zeros.
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
        let every = blocks.len().div_ceil(RULES.blocks).max(1);
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
