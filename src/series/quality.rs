//! Quality checks of each channel's sensor, from its own samples.

use super::channels::{Channel, Channels};
use super::detrend::{line, mean};
use crate::estimate::median;
use crate::finding::{Finding, Severity};

/// Measured quantity of a channel, which decides the checks that apply.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Vertical acceleration; a DC-coupled sensor reads +g at rest.
    Acceleration,
    /// Force, static part included.
    Force,
    /// Strain or anything else.
    Other,
}

/// Share of missing samples above which a channel is unreliable.
const MISSING_LIMIT: f64 = 0.05;
/// Samples in a row at one value that no working sensor gives.
const STUCK_RUN: usize = 25;
/// A channel below this share of its peers' median variation is dead.
const DEAD_SHARE: f64 = 0.01;
/// Number of consecutive samples at the extreme that make a clipped peak. An unclipped 10 Hz peak sampled at 500 Hz has one sample within 0.1 % of
/// its top.
const CLIP_RUN: usize = 4;
/// Clipped peaks needed: the single largest peak may be flat by chance.
const CLIP_PEAKS: usize = 3;
/// Limit of the ratio between a round peak (2) and a flat peak (1).
const ROUND_RATIO: f64 = 1.6;
/// Robust standard deviations of the second difference beyond which a sample is a spike.
const SPIKE_SIGMA: f64 = 20.0;
/// Relative tolerance on a mean that should be the acceleration of gravity.
const GRAVITY_TOLERANCE: f64 = 0.15;

/// Returns the findings on every channel of a record. `gravity` is in the units of the record.
pub fn check_channels(
    record: &Channels,
    gravity: f64,
    kind_of: impl Fn(&str) -> Kind,
) -> Vec<Finding> {
    let mut findings = Vec::new();
    let spreads: Vec<(Kind, f64)> = record
        .list
        .iter()
        .map(|c| (kind_of(&c.name), spread(&c.samples)))
        .collect();
    for (i, channel) in record.list.iter().enumerate() {
        let kind = spreads[i].0;
        let peers: Vec<f64> = spreads
            .iter()
            .enumerate()
            .filter(|(j, s)| *j != i && s.0 == kind)
            .map(|(_, s)| s.1)
            .collect();
        let before = findings.len();
        findings.extend(check_missing(channel));
        findings.extend(check_dead(channel, kind, spreads[i].1, &peers));
        if findings[before..]
            .iter()
            .any(|f: &Finding| f.code == "dead-channel")
        {
            continue;
        }
        findings.extend(check_clipped(channel, kind));
        findings.extend(check_spikes(channel));
        findings.extend(check_drift(channel, kind, gravity));
        if kind == Kind::Acceleration {
            findings.extend(check_gravity(channel, gravity));
        }
    }
    findings
}

fn finite_values(x: &[f64]) -> Vec<f64> {
    x.iter().copied().filter(|v| v.is_finite()).collect()
}

fn spread(x: &[f64]) -> f64 {
    let x = finite_values(x);
    let m = mean(&x);
    (x.iter().map(|v| (v - m) * (v - m)).sum::<f64>() / x.len().max(1) as f64).sqrt()
}

/// Missing samples.
fn check_missing(c: &Channel) -> Option<Finding> {
    let missing = c.samples.iter().filter(|v| !v.is_finite()).count();
    if missing == 0 {
        return None;
    }
    let share = missing as f64 / c.samples.len().max(1) as f64;
    let severity = if share > MISSING_LIMIT {
        Severity::Error
    } else {
        Severity::Warning
    };
    let message = format!(
        "{missing} of {} samples are missing; straight lines replace them.",
        c.samples.len()
    );
    let remedy = "Use a stretch without gaps, or check cable and logger.";
    Some(
        Finding::new(severity, "missing-samples", &c.name, message, remedy)
            .with_numbers(share, MISSING_LIMIT),
    )
}

/// No signal, a frozen value, or a small fraction of what its peers show.
fn check_dead(c: &Channel, kind: Kind, own: f64, peers: &[f64]) -> Option<Finding> {
    let peer = median(peers.to_vec()).unwrap_or(0.0);
    let scale = mean(&finite_values(&c.samples)).abs();
    if own <= 1e-9 * scale || own == 0.0 || own < DEAD_SHARE * peer {
        let message = "The channel has no signal. Results that need it are not reliable.";
        let remedy = "Check sensor, supply and cable, or remove the channel from the job.";
        return Some(
            Finding::new(Severity::Error, "dead-channel", &c.name, message, remedy)
                .with_numbers(own, DEAD_SHARE * peer),
        );
    }
    let (mut longest, mut run) = (0, 1);
    for w in c.samples.windows(2) {
        let lifted = kind == Kind::Force && w[0] == 0.0;
        run = if w[0] == w[1] && !lifted { run + 1 } else { 1 };
        longest = longest.max(run);
    }
    // Repeated values at an extreme are clipping and are reported as clipping.
    if longest >= STUCK_RUN && check_clipped(c, kind).is_none() {
        let message = format!(
            "The value is constant over {longest} samples: the sensor or logger did not update."
        );
        return Some(
            Finding::new(
                Severity::Warning,
                "stuck-channel",
                &c.name,
                message,
                "Use another stretch of the record.",
            )
            .with_numbers(longest as f64, STUCK_RUN as f64),
        );
    }
    None
}

/// Robust standard deviation of what differs between neighbouring samples: noise, and a little of the signal.
fn unrest(x: &[f64]) -> f64 {
    let bends: Vec<f64> = x
        .windows(3)
        .map(|w| (w[1] - 0.5 * (w[0] + w[2])).abs())
        .filter(|v| v.is_finite())
        .collect();
    // For white noise, the bend has 1.22 times the standard deviation of the noise.
    1.4826 * median(bends).unwrap_or(0.0) / 1.22
}

/// Flat peaks at the largest or smallest value. A wheel force that stops at zero is a tyre off the ground, no fault.
fn check_clipped(c: &Channel, kind: Kind) -> Option<Finding> {
    let x = finite_values(&c.samples);
    let (lo, hi) = x
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| {
            (l.min(v), h.max(v))
        });
    // Noise added after the clipping widens the flat part.
    let near = (8.0 * unrest(&x)).clamp(5e-4 * (hi - lo), 0.01 * (hi - lo));
    if near <= 0.0 || !near.is_finite() {
        return None;
    }
    let lifts = kind == Kind::Force && lo.abs() < 0.02 * hi;
    let peaks = |at: &dyn Fn(f64) -> bool| {
        let (mut peaks, mut run, mut total) = (0, 0, 0);
        for &v in &x {
            run = if at(v) { run + 1 } else { 0 };
            peaks += usize::from(run == CLIP_RUN);
            total += usize::from(at(v));
        }
        (peaks, total)
    };
    let (top, top_total) = peaks(&|v| v > hi - near);
    let (bottom, bottom_total) = if lifts {
        (0, 0)
    } else {
        peaks(&|v| v < lo + near)
    };
    let (level, total) = if top >= bottom {
        (hi, top_total)
    } else {
        (lo, bottom_total)
    };
    // Within four times the depth, a round peak has twice as many samples. A flat peak has hardly more.
    let deeper = x
        .iter()
        .filter(|v| (**v - level).abs() < 4.0 * near)
        .count();
    if top.max(bottom) < CLIP_PEAKS || deeper as f64 > ROUND_RATIO * total as f64 {
        return None;
    }
    let message = format!(
        "{} peaks are cut flat at {level:.4} ({total} samples): the sensor or its amplifier saturated.",
        top.max(bottom)
    );
    let remedy =
        "Measure again with a larger range. Peaks and integrals of this channel are too small.";
    Some(
        Finding::new(
            Severity::Error,
            "saturated-channel",
            &c.name,
            message,
            remedy,
        )
        .with_numbers(top.max(bottom) as f64, CLIP_PEAKS as f64),
    )
}

/// Returns the single samples that are far off the line through their neighbours, in ascending order, and the distance that a sample needs for it.
///
/// For a single sample that is off a smooth course by `h`, the second difference is `h`. It is `-h / 2` at both neighbours, and 0 at the samples next
/// to them. Waves of any frequency have other second differences.
pub fn find_spikes(x: &[f64]) -> (Vec<usize>, f64) {
    let bend: Vec<f64> = x.windows(3).map(|w| w[1] - 0.5 * (w[0] + w[2])).collect();
    let size = |limit: f64| {
        let sizes = bend.iter().map(|v| v.abs());
        1.4826 * median(sizes.filter(|v| v.is_finite() && *v > limit).collect()).unwrap_or(0.0)
    };
    // More than half of the samples of a coarse reading at rest have no second difference at all.
    let sigma = if size(-1.0) > 0.0 {
        size(-1.0)
    } else {
        size(0.0)
    };
    let is_spike = |w: &[f64]| {
        let next = |v: f64| (-0.75..-0.25).contains(&(v / w[2]));
        let far = |v: f64| v.abs() < 0.25 * w[2].abs();
        w[2].abs() > SPIKE_SIGMA * sigma && next(w[1]) && next(w[3]) && far(w[0]) && far(w[4])
    };
    let spikes = bend.windows(5).enumerate().filter(|(_, w)| is_spike(w));
    (spikes.map(|(i, _)| i + 3).collect(), SPIKE_SIGMA * sigma)
}

/// Reports single samples far off the line through their neighbours.
fn check_spikes(c: &Channel) -> Option<Finding> {
    let x = &c.samples;
    let (spikes, limit) = find_spikes(x);
    if spikes.is_empty() {
        return None;
    }
    let count = spikes.len();
    let off = |i: &usize| (x[*i] - 0.5 * (x[i - 1] + x[i + 1])).abs();
    let largest = spikes.iter().map(off).fold(0.0, f64::max);
    let message =
        format!("{count} single samples differ from their neighbours by up to {largest:.4}.");
    let remedy = "Check for loose contacts. Remove the spikes before the band limit is applied, which widens them.";
    Some(
        Finding::new(Severity::Warning, "spikes", &c.name, message, remedy)
            .with_numbers(largest, limit),
    )
}

/// A trend of the block means that their scatter does not explain.
fn check_drift(c: &Channel, kind: Kind, gravity: f64) -> Option<Finding> {
    const BLOCKS: usize = 16;
    let x = finite_values(&c.samples);
    if x.len() < 10 * BLOCKS {
        return None;
    }
    let means: Vec<f64> = x
        .chunks_exact(x.len() / BLOCKS)
        .take(BLOCKS)
        .map(mean)
        .collect();
    let (offset, slope) = line(&means);
    let n = means.len() as f64;
    let rest = means
        .iter()
        .enumerate()
        .map(|(i, m)| (m - offset - slope * i as f64).powi(2))
        .sum::<f64>()
        / (n - 2.0);
    let sigma = (rest * 12.0 / (n * (n * n - 1.0))).sqrt();
    let change = slope * n;
    let material = match kind {
        Kind::Acceleration => 0.02 * gravity,
        Kind::Force => 0.05 * mean(&x).abs(),
        Kind::Other => 0.2 * spread(&x),
    };
    if slope.abs() < 6.0 * sigma || change.abs() < material {
        return None;
    }
    let message = format!("The mean moves by {change:.4} over the record.");
    let remedy = "Check for temperature or a loose sensor (accelerations), or for load that is gained or lost (forces).";
    Some(
        Finding::new(Severity::Warning, "drift", &c.name, message, remedy)
            .with_numbers(change, material),
    )
}

/// A DC-coupled accelerometer must read +g on the mean.
fn check_gravity(c: &Channel, gravity: f64) -> Option<Finding> {
    let m = mean(&finite_values(&c.samples));
    let near = |target: f64| (m / target - 1.0).abs() < GRAVITY_TOLERANCE;
    if near(gravity) {
        let off = m - gravity;
        let limit = 0.05 * gravity;
        return (off.abs() > limit).then(|| {
            let message = format!("The mean is {m:.3}, gravity is {gravity:.3}: an offset of {off:.3}. Band-limiting removes it.");
            Finding::new(Severity::Info, "offset", &c.name, message, "Zero the sensor on level ground.").with_numbers(off, limit)
        });
    }
    // A mean near zero indicates an AC-coupled sensor, which is no fault. Gravity does not explain any other mean.
    let limit = 0.3 * gravity;
    (m.abs() > limit).then(|| {
        let message =
            format!("The mean is {m:.3}: neither 0 (AC coupled) nor gravity {gravity:.3}.");
        Finding::new(
            Severity::Warning,
            "offset",
            &c.name,
            message,
            "Check zero and scale of this channel.",
        )
        .with_numbers(m, gravity)
    })
}
