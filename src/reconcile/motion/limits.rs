//! Limits of a fit from physics and declared tolerances.

use super::candidate::{Candidate, Sign};
use super::change::Change;
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use super::part::ColumnOf;
use crate::estimate::columns::{PriorColumn, TargetSolution, solve_with_priors};
use crate::reconcile::rules::MotionRules;
use crate::vehicle::term::{Side, Term, share_done};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal};

/// Returns the limit of a declared tolerance, in standard deviations. In one healthy job of a hundred, one channel exceeds it. It is the two-sided
/// normal quantile with the probability divided by `n` gains and delays.
pub fn tolerance_limit(rules: &MotionRules, n: usize) -> f64 {
    let tail = rules.false_rate / (2.0 * n.max(1) as f64);
    Normal::new(0.0, 1.0).map_or(3.0, |z| z.inverse_cdf(1.0 - tail))
}

/// Returns the solution with every nuisance within the limit of a healthy job ([`tolerance_limit`]). Priors of nuisances beyond the limit are
/// narrowed until they are within. Without this limit, a model that fits badly would lose its residual through gains at which channels read nothing.
pub fn within_tolerance(
    rules: &MotionRules,
    columns: &mut [PriorColumn],
    target: &[f64],
) -> TargetSolution {
    /// Narrowing settles in a few rounds; the remaining change is small.
    const ROUNDS: usize = 6;
    /// Beyond the limit by less than this share is at it.
    const SLACK: f64 = 1.05;
    let declared: Vec<Option<f64>> = columns.iter().map(|c| c.prior).collect();
    let most = tolerance_limit(rules, declared.iter().flatten().count());
    let mut s = solve_with_priors(columns, target);
    for _ in 0..ROUNDS {
        let mut beyond = false;
        for ((c, declared), x) in columns.iter_mut().zip(&declared).zip(&s.x) {
            if let (Some(prior), Some(sd)) = (&mut c.prior, declared)
                && x.abs() > SLACK * most * sd
            {
                *prior *= (most * sd / x.abs()).max(0.03);
                beyond = true;
            }
        }
        if !beyond {
            break;
        }
        s = solve_with_priors(columns, target);
    }
    if columns.iter().zip(&declared).any(|(c, d)| c.prior != *d) {
        // The standard deviations use the declared tolerances, since a narrowed prior contains no information.
        let as_declared: Vec<PriorColumn> = columns
            .iter()
            .zip(&declared)
            .map(|(c, d)| PriorColumn {
                rows: c.rows.clone(),
                prior: *d,
            })
            .collect();
        s.covariance = solve_with_priors(&as_declared, target).covariance;
    }
    // The penalty uses the declared tolerances, not the narrowed priors.
    s.penalty = declared
        .iter()
        .zip(&s.x)
        .filter_map(|(d, x)| d.map(|d| (x / d).powi(2)))
        .sum();
    s
}

/// Returns whether every gain and delay of a fit exceeds the limit of a healthy channel. This limit combines the declared tolerance with the standard
/// deviation of the fitted value, which includes the tolerances of the other channels.
pub fn beyond_tolerance(frame: &MotionFrame, fit: &MotionFit) -> bool {
    let tolerances = fit
        .column_of
        .iter()
        .filter(|c| {
            matches!(
                c,
                ColumnOf::Gain(_) | ColumnOf::Delay(_) | ColumnOf::Fault(_)
            )
        })
        .count();
    let limit = tolerance_limit(&frame.rules, tolerances);
    let beyond = |off: f64, tolerance: f64, sigma: f64| off.abs() > limit * tolerance.hypot(sigma);
    let of = |is: fn(&Change) -> Option<f64>| -> Vec<f64> {
        let parts = fit.parts.iter().zip(&fit.sizes);
        parts
            .filter_map(|(p, sizes)| Some(sizes.first()?[0] - is(&p.shape)?))
            .collect()
    };
    let gains = of(|c| matches!(c, Change::Gain { .. }).then_some(1.0));
    let delays = of(|c| matches!(c, Change::Delay { .. }).then_some(0.0));
    let n = fit.design.channels.len();
    if are_healthy(&frame.rules, &gains, n, frame.gain_tolerance)
        || are_healthy(&frame.rules, &delays, n, frame.sync_tolerance_s)
    {
        return false;
    }
    fit.parts.iter().zip(&fit.sizes).all(|(p, sizes)| {
        let Some([size, sigma]) = sizes.first() else {
            return true;
        };
        match p.shape {
            Change::Gain { .. } => beyond(size - 1.0, frame.gain_tolerance, *sigma),
            Change::Delay { .. } => beyond(*size, frame.sync_tolerance_s, *sigma),
            Change::Clock { .. } | Change::Slip { .. } | Change::Lag { .. } => {
                let late = late_on_average(&p.shape, fit) / p.shape.stated_size_factor();
                beyond(late * size, frame.sync_tolerance_s, late * *sigma)
            }
            _ => true,
        }
    })
}

/// Returns the delay of a channel from a timing fault of size one, RMS over the record about its mean, s. This delay is compared with the tolerance
/// of synchronisation, which applies to one delay.
pub(super) fn late_on_average(shape: &Change, fit: &MotionFit) -> f64 {
    let [begin, end] = fit.design.span_s();
    match shape {
        // The delay grows linearly from begin to end, so its RMS about the mean is the duration over the root of 12.
        Change::Clock { .. } => (end - begin) / 12f64.sqrt(),
        // Before and after the slip, the delay is taken as half a step away from its mean.
        Change::Slip { .. } => 0.5,
        _ => 1.0,
    }
}

/// Returns whether several faults of a kind are within the scatter of `n` healthy channels. An error common to all channels is not observable, so the
/// channels without a fault may be off in the opposite direction. The test uses the sum of squares about the mean of all channels, over the squared
/// tolerance. The limit is the chi-square quantile of n - 1 degrees of freedom that one healthy job in a hundred exceeds.
fn are_healthy(rules: &MotionRules, off: &[f64], n: usize, tolerance: f64) -> bool {
    if off.len() < 2 || n < 2 || tolerance <= 0.0 {
        return false;
    }
    let mean = off.iter().sum::<f64>() / n as f64;
    let about: f64 = off.iter().map(|x| (x - mean).powi(2)).sum();
    let rest = n.saturating_sub(off.len()) as f64 * mean * mean;
    let chi2 = (about + rest) / (tolerance * tolerance);
    let most = ChiSquared::new((n - 1) as f64).map(|c| c.inverse_cdf(1.0 - rules.false_rate));
    most.is_ok_and(|most| chi2 < most)
}

/// Plausible gains of a channel with a gain fault. A gain outside this range has another cause (unit, sensor, wire).
const GAINS: std::ops::Range<f64> = 0.5..2.0;
/// Longest delay, s, that the search follows: a tenth of the period of the lowest frequencies that vehicles are compared at.
const LONGEST_DELAY_S: f64 = 0.15;

/// Rate by which a clock may be off and still be a clock, millionths.
const MOST_CLOCK_PPM: f64 = 1e4;

/// Returns whether the size of every effect is physically plausible.
pub fn has_plausible_sizes(rules: &MotionRules, candidates: &[Candidate], fit: &MotionFit) -> bool {
    fit.parts.iter().zip(&fit.sizes).all(|(p, sizes)| {
        let Some([x, _]) = sizes.first() else {
            return true;
        };
        match &p.shape {
            Change::Gain { .. } => GAINS.contains(x),
            Change::Delay { .. } => x.abs() < LONGEST_DELAY_S,
            Change::Lag { .. } => *x > 0.0 && *x < LONGEST_DELAY_S,
            Change::Slip { at_s, .. } => {
                x.abs() < LONGEST_DELAY_S && is_seen(fit, |t_s| f64::from(u8::from(t_s >= *at_s)))
            }
            Change::Clock { .. } => x.abs() < MOST_CLOCK_PPM,
            Change::Line { .. } => x.is_finite(),
            Change::Flip { .. } | Change::Swap { .. } => is_upright(fit),
            // An added mass may have any size. A removed mass is smaller than the mass that was present.
            Change::Step(s) => {
                let m = fit.values[fit.assembled.vehicle.inertia_index(s.body, 0, 0)];
                m > 0.0 && *x > -m && is_seen(fit, |t_s| s.share_at(t_s))
            }
            shape => {
                let signed = candidates
                    .get(p.candidate)
                    .is_none_or(|c| c.sign == Sign::Any)
                    || *x > 0.0;
                signed && stiffness_is_sensible(rules, shape, *x, fit)
            }
        }
    })
}

/// Returns whether no mass and no spring of the analyst's model is negative. A reversed channel gives negative masses or springs.
fn is_upright(fit: &MotionFit) -> bool {
    let v = &fit.assembled.vehicle;
    let bodies: Vec<usize> = (0..v.bodies.len()).collect();
    let springs = v.links.iter().enumerate().flat_map(|(l, link)| {
        let terms = link.terms.iter().enumerate();
        terms
            .filter(|(_, term)| **term == Term::Stiffness)
            .map(move |(t, _)| v.term_index(l, t))
    });
    v.masses(&bodies)
        .into_iter()
        .chain(springs)
        .all(|i| fit.values.get(i).is_none_or(|x| !(*x < 0.0)))
}

/// Returns whether every effect with a size exceeds its own scatter by three and a half standard deviations. This equals the evidence that a name
/// requires, odds of 400.
pub fn effects_exceed_scatter(rules: &MotionRules, fit: &MotionFit) -> bool {
    let least = (2.0 * rules.decisive).sqrt();
    fit.parts.iter().zip(&fit.sizes).all(|(p, sizes)| {
        let neutral = match p.shape {
            Change::Gain { .. } => 1.0,
            Change::Flip { .. } | Change::Swap { .. } => return true,
            _ => 0.0,
        };
        let seen = |s: &[f64; 2]| !((s[0] - neutral).abs() < least * s[1]);
        sizes.is_empty() || sizes.iter().any(seen)
    })
}

/// Share of the compared stretch at either end in which no change is searched for.
pub(super) const END: f64 = 0.1;

/// Returns whether at least half of a change happens within the compared stretch, excluding a share [`END`] at either end. Before or after it, the
/// change is not visible in this record.
fn is_seen(fit: &MotionFit, done: impl Fn(f64) -> f64) -> bool {
    let [begin, end] = fit.design.span_s();
    let margin = END * (end - begin);
    done(end - margin) - done(begin + margin) >= 0.5
}

/// Returns whether the stiffness of a spring is plausible with the effect. Within free play, almost no stiffness may remain. An end stop leaves a
/// spring that works. A spring that changes keeps a positive stiffness.
fn stiffness_is_sensible(rules: &MotionRules, shape: &Change, size: f64, fit: &MotionFit) -> bool {
    let play = rules.play;
    let Change::Terms { link, terms } = shape else {
        return true;
    };
    let v = &fit.assembled.vehicle;
    let Some(l) = v.links.get(*link) else {
        return true;
    };
    let at = l.terms.iter().position(|t| *t == Term::Stiffness);
    let Some(k) = at.map(|t| fit.values[v.term_index(*link, t)]) else {
        return true;
    };
    match terms.first() {
        Some(Term::DeadZone { .. }) => k - size < play * k && k - size > -play * k,
        Some(Term::BumpStop {
            side: Side::Both, ..
        }) => k > play * (k + size),
        Some(Term::StiffnessChange { at_s, over_s }) => {
            let seen = is_seen(fit, |t_s| share_done(*at_s, *over_s, t_s));
            seen && k > 0.0 && k + size > 0.0
        }
        _ => true,
    }
}
