//! Slow stretch of a link from the force that passes through it: what double integration of accelerations loses in drift.

use super::adjustment::Adjustment;
use super::layout::{Measures, Shape, Vehicle};
use super::treatment::SlowStretch;
use crate::series::channels::Channels;
use crate::series::detrend::mean;

/// Returns the slow stretch of every link with a nonlinear term whose force follows from the equation of one body. This body only heaves, no other
/// link holds it, and all its outside forces are measured.
///
/// The force is F = (sum of wheel forces - m q'') / weight. The equation sum of coefficient times term(d, d') = F is then solved for d step by step
/// (implicit Euler, Newton's method). Links whose law can't be solved are left out.
pub fn slow_stretches(
    vehicle: &Vehicle,
    values: &[f64],
    record: &Channels,
    adjust: &[Adjustment],
) -> Vec<SlowStretch> {
    (0..vehicle.links.len())
        .filter(|&l| vehicle.links[l].terms.iter().any(|t| !t.is_linear()))
        .filter_map(|l| {
            let force = link_force(vehicle, values, record, adjust, l)?;
            let stretch = solve_stretch(vehicle, values, l, &force, record)?;
            Some(SlowStretch { link: l, stretch })
        })
        .collect()
}

/// Force of a link from the equation of a body that it alone holds.
fn link_force(
    vehicle: &Vehicle,
    values: &[f64],
    record: &Channels,
    adjust: &[Adjustment],
    link: usize,
) -> Option<Vec<f64>> {
    let ends = &vehicle.links.get(link)?.ends;
    let mut candidates: Vec<(f64, usize)> = ends.iter().map(|(w, p)| (*w, p.body)).collect();
    // Try bodies without wheels first: they need no force channel.
    candidates.sort_by_key(|(_, b)| vehicle.wheels.iter().any(|w| w.at.body == *b));
    let alone = |b: usize| {
        vehicle
            .links
            .iter()
            .filter(|l| l.ends.iter().any(|e| e.1.body == b) && !l.terms.is_empty())
            .count()
            == 1
    };
    let (weight, body) = candidates.into_iter().find(|&(w, b)| {
        w != 0.0
            && vehicle.bodies[b].shape == Shape::Heave
            && alone(b)
            && vehicle
                .sensors
                .iter()
                .all(|s| s.at.body != b || s.measures == Measures::Acceleration)
            && vehicle
                .wheels
                .iter()
                .all(|x| x.at.body != b || record.has(&x.channel))
    })?;
    let mass = *values.get(vehicle.inertia_index(body, 0, 0))?;
    let own: Vec<&str> = vehicle
        .sensors
        .iter()
        .filter(|s| s.at.body == body)
        .map(|s| s.channel.as_str())
        .collect();
    let mut force = vec![0.0; record.n_samples()];
    for name in &own {
        let a = correct_channel(record, name, adjust)?;
        let share = -mass / own.len() as f64 / weight;
        force.iter_mut().zip(a).for_each(|(f, a)| *f += share * a);
    }
    for wheel in vehicle.wheels.iter().filter(|w| w.at.body == body) {
        let f = correct_channel(record, &wheel.channel, adjust)?;
        force
            .iter_mut()
            .zip(f)
            .for_each(|(out, f)| *out += f / weight);
    }
    force.iter().all(|f| f.is_finite()).then_some(force)
}

/// A channel without its mean, corrected; shifted to the nearest sample, which is enough for slow motion.
fn correct_channel(record: &Channels, name: &str, adjust: &[Adjustment]) -> Option<Vec<f64>> {
    let x = record.samples(name).ok()?;
    let m = mean(x);
    let own = Adjustment::of_channel(adjust, name).unwrap_or_else(|| Adjustment::none(name));
    let last = x.len() as isize - 1;
    let shift = |i: isize| {
        let t_s = record.start_s + i as f64 / record.rate_hz;
        (own.lateness(t_s, record.start_s) * record.rate_hz).round() as isize
    };
    Some(
        (0..=last)
            .map(|i| (x[(i + shift(i)).clamp(0, last) as usize] - m) / own.gain)
            .collect(),
    )
}

/// d(t) with sum of c . term(d, d') = force(t), from rest.
fn solve_stretch(
    vehicle: &Vehicle,
    values: &[f64],
    link: usize,
    force: &[f64],
    record: &Channels,
) -> Option<Vec<f64>> {
    let rate_hz = record.rate_hz;
    /// Newton steps; four suffice but where friction turns.
    const STEPS: usize = 30;
    let terms: Vec<(f64, super::term::Term)> = vehicle.links[link]
        .terms
        .iter()
        .enumerate()
        .map(|(t, term)| {
            (
                values
                    .get(vehicle.term_index(link, t))
                    .copied()
                    .unwrap_or(f64::NAN),
                *term,
            )
        })
        .collect();
    let h = 1.0 / rate_hz;
    let size = force.iter().fold(0.0f64, |a, f| a.max(f.abs()));
    let stiffness: f64 = terms
        .iter()
        .map(|(c, t)| c * t.basis(1e-6, 0.0))
        .sum::<f64>()
        / 1e-6;
    if !(size > 0.0 && stiffness.is_finite() && stiffness > 0.0) {
        return None;
    }
    let speed = size / stiffness * rate_hz;
    let law = |d: f64, v: f64, t_s: f64| -> f64 {
        terms.iter().map(|(c, t)| c * t.basis_at(d, v, t_s)).sum()
    };
    let (mut d, mut v) = (0.0f64, 0.0f64);
    let mut out = Vec::with_capacity(force.len());
    for (i, &f) in force.iter().enumerate() {
        let t_s = record.start_s + i as f64 * h;
        let miss = |v: f64| law(d + h * v, v, t_s) - f;
        // The law increases with v, so the root is between the last points of either sign.
        let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
        for _ in 0..STEPS {
            let g = miss(v);
            if g.abs() < 1e-9 * size {
                break;
            }
            if g > 0.0 {
                high = high.min(v);
            } else {
                low = low.max(v);
            }
            let step = 1e-7 * speed;
            let slope = (miss(v + step) - g) / step;
            let mut next = v - g / slope;
            if !next.is_finite() || next <= low || next >= high {
                next = if low.is_finite() && high.is_finite() {
                    0.5 * (low + high)
                } else {
                    v - g.signum() * speed
                };
            }
            v = next;
        }
        d += h * v;
        if !d.is_finite() || d.abs() > 1e3 * size / stiffness {
            return None;
        }
        out.push(d);
    }
    Some(out)
}
