//! Best parameters of a vehicle with a set of effects, with corrected channels and declared tolerances as priors.

use super::at_rest::rest_row;
use super::candidate::Candidate;
use super::change::{Change, ChangedVehicle, assemble};
use super::columns::{fault_columns, nuisance, parameter_column, slices};
use super::corrections::adjustments;
use super::design::{Bins, Design, design};
use super::frame::MotionFrame;
use super::limits::{has_plausible_sizes, within_tolerance};
use super::motion_fit::{MotionFit, whiten_column};
use super::noise::{Background, Whitener, covariance, log_determinant};
use super::part::{ColumnOf, Part};
use super::response::responses;
use crate::estimate::columns::{PriorColumn, TargetSolution};
use crate::series::channels::Channels;
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::layout::Vehicle;
use crate::vehicle::stretch::slow_stretches;
use rustfft::num_complex::Complex64;
use std::sync::Arc;

/// Effort of a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Covariance, slow stretch and corrections until they settle.
    Settled,
    /// Once more from a near neighbour.
    Touch,
}

impl Effort {
    /// Returns the number of rounds, and the number of them that compute the slow stretch again.
    fn rounds(self) -> (usize, usize) {
        match self {
            Self::Settled => (7, 2),
            Self::Touch => (3, 0),
        }
    }
}

/// Returns the value of each held parameter; `None` for a free parameter.
pub fn held_parameters(
    frame: &MotionFrame,
    vehicle: &Vehicle,
    design: &Design,
) -> Vec<Option<f64>> {
    let names = vehicle.parameters();
    let mut out: Vec<Option<f64>> = names
        .iter()
        .map(|p| frame.known.get(&p.name).copied())
        .collect();
    let driven = design
        .equations
        .iter()
        .any(|e| e.target.iter().any(|t| t.norm_sqr() > 0.0));
    let scaled = (0..out.len()).any(|i| out[i].is_some_and(|v| v != 0.0) && design.has(i));
    if !driven && !scaled {
        let mut bodies = frame.bodies.clone();
        bodies.sort_by_key(|&b| !vehicle.bodies[b].sprung);
        let first = vehicle.masses(&bodies).into_iter().find(|&i| design.has(i));
        if let Some(i) = first {
            out[i] = Some(1.0);
        }
    }
    out
}

/// Fits a set of effects to a record, starting from the values of a neighbouring set if given.
///
/// The least squares are repeated. Each round computes the covariance of the equations from the parameters of the previous round. Corrections of
/// channels and the slow stretch of nonlinear terms are also from the previous round.
///
/// `None` if the record or the set cannot be fitted.
pub fn fit(
    frame: &MotionFrame,
    candidates: &[Candidate],
    record: &Channels,
    mut parts: Vec<Part>,
    from: Option<&MotionFit>,
    background: &Background,
    effort: Effort,
) -> Option<MotionFit> {
    let (rounds, renewed) = effort.rounds();
    let shapes: Vec<&Change> = parts.iter().map(|p| &p.shape).collect();
    let assembled = assemble(&frame.vehicle, &shapes);
    let v = &assembled.vehicle;
    let mut values: Option<Vec<f64>> = from.map(|f| inherit_values(&assembled, &parts, f));
    let nonlinear = v
        .links
        .iter()
        .any(|l| l.terms.iter().any(|t| !t.is_linear()));
    let mut current: Option<(Arc<Design>, Vec<Adjustment>)> = None;
    let mut last: Option<MotionFit> = None;
    for round in 0..rounds {
        let adjust = adjustments(frame, &parts);
        let fresh = match &current {
            None => true,
            Some((_, a)) => *a != adjust || nonlinear && round <= renewed,
        };
        if fresh {
            let slow = match &values {
                Some(x) if nonlinear => slow_stretches(v, x, record, &adjust),
                _ => vec![],
            };
            let d = design(frame, v, record, &adjust, slow).ok()?;
            current = Some((Arc::new(d), adjust));
        }
        let (d, _) = current.as_ref()?;
        let problem = Problem::new(frame, d, values.as_deref(), &parts, background);
        let (s, problem) = problem.solve_unknowns(frame)?;
        let new = problem.values(&s);
        let was_even = values.is_none();
        let moved = advance(&mut parts, &problem, &s);
        let done = !was_even
            && moved < 1.0
            && last.as_ref().is_some_and(|l| {
                (l.chi2 - s.chi2).abs() < SETTLED * s.chi2 && (!nonlinear || round > renewed)
            });
        values = Some(new.clone());
        if !was_even {
            last = Some(problem.into_fit(&assembled, &parts, new, s));
        }
        if done {
            break;
        }
    }
    let out = last?;
    has_plausible_sizes(&frame.rules, candidates, &out).then_some(out)
}

/// Relative change of the squared residual between rounds at which a fit has settled.
const SETTLED: f64 = 2e-4;

/// One round of least squares.
struct Problem {
    design: Arc<Design>,
    responses: Vec<Vec<Vec<Complex64>>>,
    whitener: Whitener,
    log_det: f64,
    rest: Option<super::at_rest::RestRow>,
    held: Vec<Option<f64>>,
    free: Vec<usize>,
    column_of: Vec<ColumnOf>,
    columns: Vec<PriorColumn>,
    /// Columns after the parameter columns, before whitening.
    extra: Vec<Vec<Bins>>,
    rows: Vec<f64>,
}

impl Problem {
    fn new(
        frame: &MotionFrame,
        d: &Arc<Design>,
        values: Option<&[f64]>,
        parts: &[Part],
        background: &Background,
    ) -> Self {
        let n = d.equations.len();
        let held = held_parameters(frame, &d.vehicle, d);
        let (responses, whitener, log_det) = match values {
            Some(x) => {
                let h = responses(d, x);
                let s = covariance(frame, d, &h, background);
                let log_det = log_determinant(frame, d, &h, background, &s);
                (h, Whitener::from_covariance(&s, n), log_det)
            }
            None => (vec![], Whitener::from_covariance(&even(d), n), 0.0),
        };
        let rest = values.and_then(|x| rest_row(frame, d, x));
        let free: Vec<usize> = (0..held.len())
            .filter(|&i| held[i].is_none() && d.has(i))
            .collect();
        let mut out = Self {
            design: Arc::clone(d),
            responses,
            whitener,
            log_det,
            rest,
            held,
            column_of: vec![],
            columns: vec![],
            extra: vec![],
            rows: vec![],
            free: free.clone(),
        };
        for i in free {
            out.push(ColumnOf::Parameter(i), &parameter_column(d, i), None);
        }
        if values.is_some() {
            for (i, p) in parts.iter().enumerate() {
                let is_line = matches!(p.shape, Change::Line { .. });
                let of = if is_line {
                    ColumnOf::Line(i)
                } else {
                    ColumnOf::Fault(i)
                };
                for c in fault_columns(d, &out.responses, &p.shape, p.fault) {
                    out.push(of, &slices(&c), None);
                    out.extra.push(c);
                }
            }
            for (of, c, prior) in nuisance(frame, d, &out.responses, parts) {
                out.push(of, &slices(&c), Some(prior));
                out.extra.push(c);
            }
        }
        let fixed: Vec<f64> = out.held.iter().map(|v| v.unwrap_or(0.0)).collect();
        let target: Vec<Bins> = d
            .residual(&fixed)
            .into_iter()
            .map(|r| r.into_iter().map(|v| -v).collect())
            .collect();
        let at_rest = out.rest.as_ref().map_or(0.0, |r| r.target(&fixed));
        out.rows = whiten_column(&out.whitener, out.rest.as_ref(), &slices(&target), at_rest);
        out
    }

    fn push(&mut self, of: ColumnOf, bins: &[&[Complex64]], prior: Option<f64>) {
        let at_rest = self.rest.as_ref().map_or(0.0, |r| r.entry(&of));
        let rows = whiten_column(&self.whitener, self.rest.as_ref(), bins, at_rest);
        self.column_of.push(of);
        self.columns.push(PriorColumn { rows, prior });
    }

    fn solve_unknowns(mut self, frame: &MotionFrame) -> Option<(TargetSolution, Self)> {
        let s = within_tolerance(&frame.rules, &mut self.columns, &self.rows);
        s.x.iter().all(|x| x.is_finite()).then_some((s, self))
    }

    /// Returns the parameters of the vehicle.
    fn values(&self, s: &TargetSolution) -> Vec<f64> {
        let mut new: Vec<f64> = self.held.iter().map(|h| h.unwrap_or(f64::NAN)).collect();
        self.free.iter().zip(&s.x).for_each(|(&i, x)| new[i] = *x);
        new
    }

    fn into_fit(
        self,
        assembled: &ChangedVehicle,
        parts: &[Part],
        values: Vec<f64>,
        s: TargetSolution,
    ) -> MotionFit {
        let sd = |k: usize| s.covariance[k][k].max(0.0).sqrt();
        let mut sigmas = vec![0.0; values.len()];
        self.free
            .iter()
            .enumerate()
            .for_each(|(k, &i)| sigmas[i] = sd(k));
        let fault_sd = |p: usize| {
            let k = self.column_of.iter().position(|c| *c == ColumnOf::Fault(p));
            k.map_or(f64::NAN, sd)
        };
        let sizes = parts
            .iter()
            .enumerate()
            .map(|(p, part)| match &part.shape {
                Change::Gain { .. } => {
                    let gain = 1.0 / part.fault;
                    vec![[gain, fault_sd(p) * gain * gain]]
                }
                Change::Delay { .. }
                | Change::Clock { .. }
                | Change::Slip { .. }
                | Change::Lag { .. } => {
                    let unit = part.shape.stated_size_factor();
                    vec![[unit * part.fault, unit * fault_sd(p)]]
                }
                Change::Line { .. } => {
                    let own = (0..self.column_of.len())
                        .filter(|&k| self.column_of[k] == ColumnOf::Line(p));
                    let [mut power, mut variance] = [0.0; 2];
                    for k in own {
                        power += s.x[k] * s.x[k];
                        variance += 0.5 * sd(k).powi(2);
                    }
                    vec![[power.sqrt(), variance.sqrt()]]
                }
                Change::Flip { .. } => vec![[-1.0, 0.0]],
                _ => assembled.own[p]
                    .iter()
                    .map(|&i| [values[i], sigmas[i]])
                    .collect(),
            })
            .collect();
        let covariance = self.covariance_of_sizes(assembled, parts, &s);
        let mut left = self.design.residual(&values);
        for (k, c) in self.extra.iter().enumerate() {
            let x = s.x[self.free.len() + k];
            for (l, c) in left.iter_mut().zip(c) {
                l.iter_mut().zip(c).for_each(|(l, c)| *l += c * x);
            }
        }
        MotionFit {
            parts: parts.to_vec(),
            assembled: assembled.clone(),
            sigmas,
            free: self.free,
            sizes,
            covariance,
            chi2: s.chi2,
            penalty: s.penalty,
            log_det: self.log_det,
            n_rows: self.rows.len(),
            design: self.design,
            responses: Arc::new(self.responses),
            whitener: Arc::new(self.whitener),
            rest: self.rest,
            columns: Arc::new(self.columns),
            column_of: self.column_of,
            estimates: s.x,
            residual: Arc::new(s.residual),
            left: Arc::new(left),
            values,
        }
    }
}

impl Problem {
    /// Returns the joint covariance of the sizes of all parts: the covariance of the columns, transformed by the derivatives of the sizes. A reversed
    /// sign has no covariance.
    fn covariance_of_sizes(
        &self,
        assembled: &ChangedVehicle,
        parts: &[Part],
        s: &TargetSolution,
    ) -> Vec<Vec<f64>> {
        let n = self.column_of.len();
        let columns_of = |of: ColumnOf| (0..n).filter(move |&k| self.column_of[k] == of);
        let derivatives = |(p, part): (usize, &Part)| -> Vec<Vec<(usize, f64)>> {
            let fault = |d: f64| {
                let first = columns_of(ColumnOf::Fault(p)).next();
                vec![first.map(|k| (k, d)).into_iter().collect()]
            };
            match &part.shape {
                // The size of a gain fault is the gain, 1 / fault.
                Change::Gain { .. } => fault(-1.0 / (part.fault * part.fault)),
                Change::Delay { .. }
                | Change::Clock { .. }
                | Change::Slip { .. }
                | Change::Lag { .. } => fault(part.shape.stated_size_factor()),
                Change::Line { .. } => {
                    let squares = columns_of(ColumnOf::Line(p)).map(|k| s.x[k] * s.x[k]);
                    let size = squares.sum::<f64>().sqrt().max(f64::MIN_POSITIVE);
                    vec![
                        columns_of(ColumnOf::Line(p))
                            .map(|k| (k, s.x[k] / size))
                            .collect(),
                    ]
                }
                Change::Flip { .. } => vec![Vec::new()],
                Change::Terms { .. } | Change::Links(_) | Change::Step(_) | Change::Swap { .. } => {
                    let own = assembled.own[p].iter();
                    own.map(|&i| {
                        columns_of(ColumnOf::Parameter(i))
                            .map(|k| (k, 1.0))
                            .collect()
                    })
                    .collect()
                }
            }
        };
        let all: Vec<Vec<(usize, f64)>> = parts.iter().enumerate().flat_map(derivatives).collect();
        let entry = |a: &[(usize, f64)], b: &[(usize, f64)]| -> f64 {
            a.iter()
                .flat_map(|(i, u)| b.iter().map(move |(k, v)| u * v * s.covariance[*i][*k]))
                .sum()
        };
        all.iter()
            .map(|a| all.iter().map(|b| entry(a, b)).collect())
            .collect()
    }
}

/// Smallest time constant of a low-pass, s.
const LEAST_LAG_S: f64 = 1e-5;

/// Moves the channel faults by the result of a round; returns the largest step over the step that counts as settled.
fn advance(parts: &mut [Part], problem: &Problem, s: &TargetSolution) -> f64 {
    let mut moved = 0.0f64;
    for (of, step) in problem.column_of.iter().zip(&s.x) {
        let ColumnOf::Fault(i) = of else { continue };
        // A step larger than any plausible fault is limited, and the next round continues from there.
        let motion = &problem.design.motion;
        let length_s = (motion.n_samples() as f64 / motion.rate_hz).max(1.0);
        let (settled, most) = match parts[*i].shape {
            Change::Gain { .. } => (1e-4, 0.3),
            Change::Clock { .. } => (1e-6 / length_s, 0.02 / length_s),
            _ => (1e-6, 0.02),
        };
        moved = moved.max((step / settled).abs());
        parts[*i].fault += step.clamp(-most, most);
        if matches!(parts[*i].shape, Change::Lag { .. }) {
            parts[*i].fault = parts[*i].fault.max(LEAST_LAG_S);
        }
    }
    moved
}

/// Returns equal weights. If an equation without outside force had more weight than an equation with one, all parameters would vanish.
fn even(d: &Design) -> Vec<Vec<Complex64>> {
    let n = d.equations.len();
    let mut s = vec![Complex64::default(); n * n];
    for i in 0..n {
        s[i * n + i] = Complex64::new(1.0, 0.0);
    }
    vec![s; d.f_hz.len()]
}

/// Returns the values of a neighbour for the parameters that both have; 0 for new parameters.
fn inherit_values(assembled: &ChangedVehicle, parts: &[Part], from: &MotionFit) -> Vec<f64> {
    let mut out = vec![0.0; assembled.vehicle.parameters().len()];
    for (&to, &old) in assembled.base.iter().zip(&from.assembled.base) {
        out[to] = from.values[old];
    }
    for (p, own) in parts.iter().zip(&assembled.own) {
        let known = from.parts.iter().position(|q| q.candidate == p.candidate);
        if let Some(q) = known {
            for (&to, &old) in own.iter().zip(&from.assembled.own[q]) {
                out[to] = from.values[old];
            }
        }
    }
    out
}
