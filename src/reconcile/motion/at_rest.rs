//! Static part of a record. The mean wheel forces add up to the weight of the vehicle, and the mean of an accelerometer is gravity times its gain.

use super::change::Change;
use super::design::Design;
use super::frame::MotionFrame;
use super::part::ColumnOf;
use crate::vehicle::layout::{Measures, Vehicle};
use std::f64::consts::PI;

/// Range of the ratio of a channel's mean to gravity in which the channel is assumed to contain its static part.
pub(super) const STATIC: std::ops::Range<f64> = 0.5..2.0;
/// Factor on the velocity in the band that accounts for slower motion between the ends of a record.
const SLOWER: f64 = 2.0;

/// Balance of weight as an additional row of the least squares: g (sum of masses) = sum of mean wheel forces.
#[derive(Clone, Debug, PartialEq)]
pub struct RestRow {
    /// Parameters with the acceleration that each is multiplied by.
    masses: Vec<(usize, f64)>,
    /// Channels of the design with their mean force.
    forces: Vec<(usize, f64)>,
    /// One sd of the balance, force.
    pub sigma: f64,
}

/// Returns the balance of the compared bodies; `None` if a wheel force is missing or zeroed, or if a link is attached to the ground.
pub fn rest_row(frame: &MotionFrame, design: &Design, values: &[f64]) -> Option<RestRow> {
    let v = &design.vehicle;
    let grounded = v
        .links
        .iter()
        .any(|l| l.ends.iter().map(|e| e.0).sum::<f64>().abs() > 1e-9);
    let wheels: Vec<&str> = v
        .wheels
        .iter()
        .filter(|w| frame.bodies.contains(&w.at.body))
        .map(|w| w.channel.as_str())
        .collect();
    if grounded || wheels.is_empty() {
        return None;
    }
    let mut forces = Vec::new();
    let mut variance = 0.0;
    for name in wheels {
        let gain = design.gain_of(name);
        let (mean, n) = finite_mean(frame.data.samples(name).ok()?)?;
        let at = design.channels.iter().position(|c| c.name == name)?;
        forces.push((at, mean / gain));
        variance += (frame.noise_force.unwrap_or(0.0) / gain).powi(2) / n as f64;
        variance += (frame.rules.zero_force * mean / gain).powi(2);
    }
    let own = v.masses(&frame.bodies);
    let mut masses: Vec<(usize, f64)> = own.iter().map(|&i| (i, frame.gravity)).collect();
    let value = |i: usize| values.get(i).copied().unwrap_or(f64::NAN);
    for (s, step) in v.steps.iter().enumerate() {
        let i = v.step_index(s);
        if step.gravity > 0.0 {
            masses.push((i, step.gravity * step_share(frame, step)));
        }
    }
    let weight: f64 = masses.iter().map(|&(i, g)| g * value(i)).sum();
    let force: f64 = forces.iter().map(|f| f.1).sum();
    // A force that was zeroed reads less than the weight. A force that stays well above zero was not zeroed. If the
    // identified mass is near zero and the force is not, the fit is wrong: masses and springs of zero also satisfy the equations of a free body.
    let ratio = weight / force;
    let astray = force > 0.0 && ratio < STATIC.start && stays_above_nothing(frame, v);
    if !(STATIC.contains(&ratio) || astray) {
        return None;
    }
    // The mean of m a over the record is the change of momentum divided by the duration.
    let momentum: f64 = frame
        .bodies
        .iter()
        .filter(|&&b| !v.is_witness(b))
        .map(|&b| value(v.inertia_index(b, 0, 0)) * velocity(design, b))
        .sum();
    variance += 2.0 * (SLOWER * momentum / frame.data.duration_s()).powi(2);
    let sigma = variance.sqrt();
    (sigma.is_finite() && sigma > 0.0).then_some(RestRow {
        masses,
        forces,
        sigma,
    })
}

/// Returns whether every wheel force of the compared bodies has a mean of more than one and a half of its standard deviations.
fn stays_above_nothing(frame: &MotionFrame, v: &Vehicle) -> bool {
    const TIMES: f64 = 1.5;
    let stays = |channel: &str| {
        let x = frame.data.samples(channel).ok()?;
        let (mean, n) = finite_mean(x)?;
        let finite = x.iter().filter(|v| v.is_finite());
        let variance = finite.map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64;
        Some(mean > TIMES * variance.sqrt())
    };
    v.wheels
        .iter()
        .filter(|w| frame.bodies.contains(&w.at.body))
        .all(|w| stays(&w.channel).unwrap_or(false))
}

/// Returns the share of the record during which a change of mass is present.
fn step_share(frame: &MotionFrame, step: &crate::vehicle::layout::MassStep) -> f64 {
    let n = frame.data.n_samples().max(1);
    let at = |i: usize| frame.data.start_s + i as f64 / frame.data.rate_hz;
    (0..n).map(|i| step.share_at(at(i))).sum::<f64>() / n as f64
}

/// Returns the RMS of a body's vertical velocity in the band.
fn velocity(design: &Design, body: usize) -> f64 {
    let n = design.motion.n_samples().max(1) as f64;
    let sensor = design
        .vehicle
        .sensors
        .iter()
        .find(|s| s.at.body == body && s.measures == Measures::Acceleration);
    let bins = sensor.and_then(|s| design.channels.iter().find(|c| c.name == s.channel));
    let power: f64 = bins.map_or(0.0, |c| {
        c.bins
            .iter()
            .zip(&design.f_hz)
            .map(|(a, f)| a.norm_sqr() / (2.0 * PI * f).powi(2))
            .sum()
    });
    // E|X|^2 of a bin is the variance of white noise; a one-sided sum contains half of it.
    (2.0 * power / n).sqrt()
}

impl RestRow {
    /// Returns the entry of a column, over the row's standard deviation.
    pub fn entry(&self, of: &ColumnOf) -> f64 {
        let sum = match of {
            ColumnOf::Parameter(i) => self.acceleration_of(*i),
            // A gain error of a force channel enters the balance as a share of the mean force.
            ColumnOf::Gain(c) => -(self.forces.iter())
                .filter(|f| f.0 == *c)
                .map(|f| f.1)
                .sum::<f64>(),
            ColumnOf::Fault(_) | ColumnOf::Line(_) | ColumnOf::Delay(_) => 0.0,
        };
        sum / self.sigma
    }

    /// Returns the entry of a parameter that a change would add, over the row's standard deviation.
    pub fn entry_of_change(&self, frame: &MotionFrame, change: &Change) -> f64 {
        match change {
            Change::Step(s) => s.gravity * step_share(frame, s) / self.sigma,
            _ => 0.0,
        }
    }

    /// Returns the right-hand side minus the contribution of held parameters, over the row's standard deviation.
    pub fn target(&self, fixed: &[f64]) -> f64 {
        let force: f64 = self.forces.iter().map(|f| f.1).sum();
        let held: f64 = self
            .masses
            .iter()
            .map(|&(i, g)| g * fixed.get(i).copied().unwrap_or(0.0))
            .sum();
        (force - held) / self.sigma
    }

    fn acceleration_of(&self, parameter: usize) -> f64 {
        self.masses
            .iter()
            .filter(|m| m.0 == parameter)
            .map(|m| m.1)
            .sum()
    }
}

/// Returns the mean and number of the samples that are numbers.
pub(super) fn finite_mean(x: &[f64]) -> Option<(f64, usize)> {
    let (sum, n) = x
        .iter()
        .filter(|v| v.is_finite())
        .fold((0.0, 0usize), |(s, n), v| (s + v, n + 1));
    (n > 0).then(|| (sum / n as f64, n))
}
