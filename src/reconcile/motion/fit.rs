//! The best parameters of a vehicle with a set of effects in it, channels corrected, declared tolerances as priors.

use super::candidate::Candidate;
use super::change::{Assembled, Change, assemble, with_adjustment};
use super::design::{Bins, Design, design};
use super::frame::MotionFrame;
use super::gls::{PriorColumn, Solved, solved};
use super::noise::{Background, Whitener, covariance};
use super::response::responses;
use crate::series::channels::Channels;
use crate::vehicle::layout::Vehicle;
use crate::vehicle::motion::Adjustment;
use crate::vehicle::stretch::slow_stretches;
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;
use std::sync::Arc;

/// One effect of a set, in the form that was chosen.
#[derive(Clone, Debug)]
pub struct Part {
    /// Number of the candidate.
    pub candidate: usize,
    /// Its form.
    pub shape: Change,
    /// 1 / gain of a gain fault, delay in s of a delay fault; not used otherwise.
    pub fault: f64,
}

/// A fit.
#[derive(Clone, Debug)]
pub struct MotionFit {
    /// The effects.
    pub parts: Vec<Part>,
    /// The vehicle with them.
    pub assembled: Assembled,
    /// Its parameters; NaN where no compared equation holds them.
    pub values: Vec<f64>,
    /// One sd of each, 0 for fixed ones.
    pub sigmas: Vec<f64>,
    /// Parameters that were estimated, in the order of the first columns.
    pub free: Vec<usize>,
    /// Sizes of each effect's parameters, with one sd.
    pub sizes: Vec<Vec<[f64; 2]>>,
    /// Squared residual over its covariance.
    pub chi2: f64,
    /// Squared nuisance over its prior.
    pub penalty: f64,
    /// Data rows.
    pub n_rows: usize,
    /// The record as it was last seen.
    pub design: Arc<Design>,
    /// Responses at `values`.
    pub responses: Arc<Vec<Vec<Vec<Complex64>>>>,
    /// Whitening at `values`.
    pub whitener: Arc<Whitener>,
    /// Whitened columns.
    pub columns: Arc<Vec<PriorColumn>>,
    /// Whitened residual, priors at its end.
    pub residual: Arc<Vec<f64>>,
    /// Residual of each equation with nuisance at its estimate.
    pub left: Arc<Vec<Bins>>,
}

/// Which parameters are held, and at what.
pub fn held(frame: &MotionFrame, vehicle: &Vehicle, design: &Design) -> Vec<Option<f64>> {
    let names = vehicle.parameters();
    let mut out: Vec<Option<f64>> = names
        .iter()
        .map(|p| frame.known.get(&p.name).copied())
        .collect();
    let occurs = |i: usize| {
        design
            .equations
            .iter()
            .any(|e| e.columns.iter().any(|c| c.0 == i))
    };
    let driven = design
        .equations
        .iter()
        .any(|e| e.target.iter().any(|t| t.norm_sqr() > 0.0));
    let scaled = (0..out.len()).any(|i| out[i].is_some_and(|v| v != 0.0) && occurs(i));
    if !driven && !scaled {
        let mut bodies = frame.bodies.clone();
        bodies.sort_by_key(|&b| !vehicle.bodies[b].sprung);
        let first = vehicle.masses(&bodies).into_iter().find(|&i| occurs(i));
        if let Some(i) = first {
            out[i] = Some(1.0);
        }
    }
    out
}

/// Corrections of channels: those of the job and those of the set.
pub fn adjustments(frame: &MotionFrame, parts: &[Part]) -> Vec<Adjustment> {
    let mut out = frame.corrections.clone();
    for p in parts {
        let more = match &p.shape {
            Change::Gain { channel } => Adjustment {
                channel: channel.clone(),
                gain: 1.0 / p.fault,
                delay_s: 0.0,
            },
            Change::Delay { channel } => Adjustment {
                channel: channel.clone(),
                gain: 1.0,
                delay_s: p.fault,
            },
            Change::Flip { channel } => Adjustment {
                channel: channel.clone(),
                gain: -1.0,
                delay_s: 0.0,
            },
            _ => continue,
        };
        out = with_adjustment(&out, more);
    }
    out
}

/// The column of one channel in every equation, times a function of angular frequency.
fn channel_column(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    channel: usize,
    factor: impl Fn(f64) -> Complex64,
) -> Vec<Bins> {
    responses
        .iter()
        .map(|r| {
            r[channel]
                .iter()
                .zip(&design.channels[channel].bins)
                .zip(&design.f_hz)
                .map(|((h, a), f)| h * a * factor(2.0 * PI * f))
                .collect()
        })
        .collect()
}

/// Column of a fault of a channel per unit of its parameter (1 / gain, or delay).
pub fn fault_column(
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    shape: &Change,
    fault: f64,
) -> Option<Vec<Bins>> {
    let (channel, is_gain) = match shape {
        Change::Gain { channel } => (channel, true),
        Change::Delay { channel } => (channel, false),
        _ => return None,
    };
    let c = design.channels.iter().position(|x| x.name == *channel)?;
    Some(channel_column(design, responses, c, |w| {
        if is_gain {
            Complex64::new(1.0 / fault, 0.0)
        } else {
            Complex64::new(0.0, w)
        }
    }))
}

/// What is declared to be uncertain, as columns with priors.
fn nuisance(
    frame: &MotionFrame,
    design: &Design,
    responses: &[Vec<Vec<Complex64>>],
    parts: &[Part],
) -> Vec<(Vec<Bins>, f64)> {
    let mut out = Vec::new();
    for (c, channel) in design.channels.iter().enumerate() {
        let faulty = |is_gain: bool| {
            parts.iter().any(|p| match &p.shape {
                Change::Gain { channel: x } => is_gain && *x == channel.name,
                Change::Delay { channel: x } => !is_gain && *x == channel.name,
                _ => false,
            })
        };
        if frame.gain_tolerance > 0.0 && !faulty(true) {
            let one = |_: f64| Complex64::new(1.0, 0.0);
            out.push((
                channel_column(design, responses, c, one),
                frame.gain_tolerance,
            ));
        }
        if frame.sync_tolerance_s > 0.0 && !faulty(false) {
            let late = |w: f64| Complex64::new(0.0, w);
            out.push((
                channel_column(design, responses, c, late),
                frame.sync_tolerance_s,
            ));
        }
    }
    out
}

/// Equations of a column list, one slice each.
pub fn slices(column: &[Bins]) -> Vec<&[Complex64]> {
    column.iter().map(Vec::as_slice).collect()
}

/// The column of a parameter in every equation.
pub fn parameter_column(design: &Design, parameter: usize) -> Vec<&[Complex64]> {
    design
        .equations
        .iter()
        .map(|e| {
            e.columns
                .iter()
                .find(|c| c.0 == parameter)
                .map_or(&[] as &[Complex64], |c| c.1.as_slice())
        })
        .collect()
}

/// How much a fit is worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// Covariance, slow stretch and corrections until they settle.
    Settled,
    /// Once more from a near neighbour.
    Touch,
}

impl Effort {
    /// Rounds, and how many of them see slow stretch anew.
    fn rounds(self) -> (usize, usize) {
        match self {
            Self::Settled => (7, 2),
            Self::Touch => (3, 0),
        }
    }
}

/// The fit of a set of effects to a record, from a neighbour's values where given.
///
/// `None` where a record or a set can't be fitted at all.
pub fn fit(
    frame: &MotionFrame,
    candidates: &[Candidate],
    record: &Channels,
    mut parts: Vec<Part>,
    from: Option<&MotionFit>,
    background: &Background,
    effort: Effort,
) -> Option<MotionFit> {
    let (rounds, anew) = effort.rounds();
    let shapes: Vec<&Change> = parts.iter().map(|p| &p.shape).collect();
    let assembled = assemble(&frame.vehicle, &shapes);
    let v = &assembled.vehicle;
    let mut values: Option<Vec<f64>> = from.map(|f| inherited(&assembled, &parts, f));
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
            Some((_, a)) => *a != adjust || nonlinear && round <= anew,
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
        let n = d.equations.len();
        let held = held(frame, v, d);
        let (h, whitener) = match &values {
            Some(x) => {
                let h = responses(d, x);
                let s = covariance(frame, d, &h, background);
                (h, Whitener::of(&s, n))
            }
            None => (vec![], Whitener::of(&even(d), n)),
        };
        let free: Vec<usize> = (0..held.len())
            .filter(|&i| {
                held[i].is_none()
                    && d.equations
                        .iter()
                        .any(|e| e.columns.iter().any(|c| c.0 == i))
            })
            .collect();
        let mut columns: Vec<PriorColumn> = free
            .iter()
            .map(|&i| PriorColumn {
                rows: whitener.rows(&parameter_column(d, i)),
                prior: None,
            })
            .collect();
        let mut extra: Vec<Vec<Bins>> = Vec::new();
        let mut faults: Vec<usize> = Vec::new();
        if values.is_some() {
            for (i, p) in parts.iter().enumerate() {
                if let Some(c) = fault_column(d, &h, &p.shape, p.fault) {
                    faults.push(i);
                    columns.push(PriorColumn {
                        rows: whitener.rows(&slices(&c)),
                        prior: None,
                    });
                    extra.push(c);
                }
            }
            for (c, prior) in nuisance(frame, d, &h, &parts) {
                columns.push(PriorColumn {
                    rows: whitener.rows(&slices(&c)),
                    prior: Some(prior),
                });
                extra.push(c);
            }
        }
        let fixed: Vec<f64> = held.iter().map(|v| v.unwrap_or(0.0)).collect();
        let target: Vec<Bins> = d
            .residual(&fixed)
            .into_iter()
            .map(|r| r.into_iter().map(|v| -v).collect())
            .collect();
        let rows = whitener.rows(&slices(&target));
        let s = within_tolerance(&mut columns, &rows);
        if s.x.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let mut new: Vec<f64> = held.iter().map(|h| h.unwrap_or(f64::NAN)).collect();
        free.iter().zip(&s.x).for_each(|(&i, x)| new[i] = *x);
        let first_fault = free.len();
        let mut moved = 0.0f64;
        for (k, &i) in faults.iter().enumerate() {
            let step = s.x[first_fault + k];
            let size = if matches!(parts[i].shape, Change::Gain { .. }) {
                1e-4
            } else {
                1e-6
            };
            moved = moved.max((step / size).abs());
            // A step beyond any sensible fault is cut; the next round goes on from there.
            let most = if matches!(parts[i].shape, Change::Gain { .. }) {
                0.3
            } else {
                0.02
            };
            parts[i].fault += step.clamp(-most, most);
        }
        let done = values.is_some()
            && moved < 1.0
            && last.as_ref().is_some_and(|l| {
                (l.chi2 - s.chi2).abs() < 2e-4 * s.chi2 && (!nonlinear || round > anew)
            });
        let was_even = values.is_none();
        values = Some(new.clone());
        if !was_even {
            last = Some(finish(
                &assembled,
                &parts,
                new,
                &free,
                &faults,
                s,
                d,
                h,
                whitener,
                columns,
                rows.len(),
                &extra,
            ));
        }
        if done {
            break;
        }
    }
    let out = last?;
    plausible(frame, candidates, &out).then_some(out)
}

/// The solution with every nuisance within a few standard deviations of its tolerance: priors of those that would leave it are
/// narrowed until they stay. Without this a model that fits badly is silenced by channels that read nothing at all.
fn within_tolerance(columns: &mut [PriorColumn], target: &[f64]) -> Solved {
    /// Standard deviations that a healthy channel may be off.
    const MOST: f64 = 2.5;
    /// Narrowing settles in a few rounds; what is left beyond is small.
    const ROUNDS: usize = 6;
    let declared: Vec<Option<f64>> = columns.iter().map(|c| c.prior).collect();
    let mut s = solved(columns, target);
    for _ in 0..ROUNDS {
        let mut beyond = false;
        for ((c, declared), x) in columns.iter_mut().zip(&declared).zip(&s.x) {
            if let (Some(prior), Some(sd)) = (&mut c.prior, declared)
                && x.abs() > 1.05 * MOST * sd
            {
                *prior *= (MOST * sd / x.abs()).max(0.03);
                beyond = true;
            }
        }
        if !beyond {
            break;
        }
        s = solved(columns, target);
    }
    // What was taken counts as the declared tolerance has it.
    s.penalty = declared
        .iter()
        .zip(&s.x)
        .filter_map(|(d, x)| d.map(|d| (x / d).powi(2)))
        .sum();
    s
}

/// Equal weights: an equation without outside force must not weigh more than one with, or all its parameters vanish.
fn even(d: &Design) -> Vec<Vec<Complex64>> {
    let n = d.equations.len();
    let mut s = vec![Complex64::default(); n * n];
    for i in 0..n {
        s[i * n + i] = Complex64::new(1.0, 0.0);
    }
    vec![s; d.f_hz.len()]
}

/// Values of a neighbour for the parameters that both have; 0 for new ones.
fn inherited(assembled: &Assembled, parts: &[Part], from: &MotionFit) -> Vec<f64> {
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

#[allow(clippy::too_many_arguments)]
fn finish(
    assembled: &Assembled,
    parts: &[Part],
    values: Vec<f64>,
    free: &[usize],
    faults: &[usize],
    s: Solved,
    d: &Arc<Design>,
    h: Vec<Vec<Vec<Complex64>>>,
    whitener: Whitener,
    columns: Vec<PriorColumn>,
    n_rows: usize,
    extra: &[Vec<Bins>],
) -> MotionFit {
    let sd = |k: usize| s.covariance[k][k].max(0.0).sqrt();
    let mut sigmas = vec![0.0; values.len()];
    free.iter()
        .enumerate()
        .for_each(|(k, &i)| sigmas[i] = sd(k));
    let sizes = parts
        .iter()
        .enumerate()
        .map(|(p, part)| match &part.shape {
            Change::Gain { .. } | Change::Delay { .. } => {
                let k = faults.iter().position(|&f| f == p).map(|k| free.len() + k);
                let sigma = k.map_or(f64::NAN, sd);
                if matches!(part.shape, Change::Gain { .. }) {
                    let gain = 1.0 / part.fault;
                    vec![[gain, sigma * gain * gain]]
                } else {
                    vec![[part.fault, sigma]]
                }
            }
            Change::Flip { .. } => vec![[-1.0, 0.0]],
            _ => assembled.own[p]
                .iter()
                .map(|&i| [values[i], sigmas[i]])
                .collect(),
        })
        .collect();
    let mut left = d.residual(&values);
    for (k, c) in extra.iter().enumerate() {
        let x = s.x[free.len() + k];
        for (l, c) in left.iter_mut().zip(c) {
            l.iter_mut().zip(c).for_each(|(l, c)| *l += c * x);
        }
    }
    MotionFit {
        parts: parts.to_vec(),
        assembled: assembled.clone(),
        sigmas,
        free: free.to_vec(),
        sizes,
        chi2: s.chi2,
        penalty: s.penalty,
        n_rows,
        design: Arc::clone(d),
        responses: Arc::new(h),
        whitener: Arc::new(whitener),
        columns: Arc::new(columns),
        residual: Arc::new(s.residual),
        left: Arc::new(left),
        values,
    }
}

/// Whether every effect's size is one that nature and the declared tolerances allow.
fn plausible(frame: &MotionFrame, candidates: &[Candidate], fit: &MotionFit) -> bool {
    /// A healthy channel stays within this many standard deviations of its tolerance.
    const BEYOND: f64 = 2.5;
    fit.parts.iter().zip(&fit.sizes).all(|(p, sizes)| {
        let Some([x, _]) = sizes.first() else {
            return true;
        };
        match &p.shape {
            Change::Gain { .. } => {
                (x - 1.0).abs() > BEYOND * frame.gain_tolerance && (0.5..2.0).contains(x)
            }
            Change::Delay { .. } => x.abs() > BEYOND * frame.sync_tolerance_s && x.abs() < 0.15,
            // More than half of the body doesn't come or go; nor can a record tell its part from the whole. Without a wheel force a
            // mass is known relative to the springs alone, and springs that change would pass for one.
            Change::Step(s) => {
                let m = fit.values[fit.assembled.vehicle.inertia_index(s.body, 0, 0)];
                let weighed = frame
                    .vehicle
                    .wheels
                    .iter()
                    .any(|w| frame.data.has(&w.channel));
                x.abs() < if weighed { 0.6 } else { 0.35 } * m.abs()
            }
            _ => {
                candidates
                    .get(p.candidate)
                    .is_none_or(|c| c.sign == super::candidate::Sign::Any)
                    || *x > 0.0
            }
        }
    })
}
