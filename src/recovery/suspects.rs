//! Gauges that contradict the others by the measure of a calibrated S: each one left out in turn, the worst one given a name.

use super::calibrated::estimate;
use super::errors::ErrorModel;
use super::types::{Readings, RunEstimate};
use crate::estimate::student;
use crate::finding::{Finding, Severity};
use crate::sensitivity::{Sensitivity, Uncertainty};
use rayon::prelude::*;

/// Sigmas, root mean square over runs, from which a gauge is named whatever is known of the scatter. A few repeats know their own scatter to a
/// factor of two at best, and healthy gauges near a wheel reach five: calibrations of two runs a lane on two measured bridges.
const NAMED: f64 = 8.0;
/// Chance of a gauge that is named where all are sound.
const FALSE: f64 = 0.01;
/// How close to the chi2 without the gauge a repair must come to be the cause.
const AS_GOOD: f64 = 1.5;
/// Share of what the others expect under which a gauge reads nothing.
const NOTHING: f64 = 0.1;
/// Gauges that are tried for an exchange with the worst.
const PARTNERS: usize = 6;
/// Faults looked for one after the other.
const MOST: usize = 3;

/// A gauge left out of all runs.
struct Without {
    gauge: usize,
    /// Fall of chi2 a run.
    fall: f64,
    chi2: f64,
    /// Degrees of freedom of what is left.
    dof: usize,
}

impl Without {
    /// Sigmas from which the gauge is named, one of `n`: those of Student's t with the degrees of freedom of the scatter (Bonferroni), times what
    /// the others have too much; never more than [`NAMED`]. All runs may have the same error, so that they count as one.
    fn limit(&self, n: usize, known: &Uncertainty) -> f64 {
        if !known.dof.is_finite() {
            return NAMED;
        }
        let excess = (self.chi2 / self.dof.max(1) as f64).max(1.0);
        let t = student(1.0 - 0.5 * FALSE / n as f64, known.dof);
        NAMED.min(t * excess.sqrt())
    }
}

/// What the named gauges' readings come to: findings, and the readings without these gauges.
pub(super) fn check(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    known: &Uncertainty,
) -> (Vec<Finding>, Vec<Readings>) {
    let mut readings = readings.to_vec();
    let mut findings = Vec::new();
    // Where S does not tell the loads apart, strain of what it knows nothing of is no gauge's fault.
    let apart = |r: &Readings| estimate(s, r, errors, known).rank == s.loads.len();
    if !readings.iter().any(apart) {
        return (findings, readings);
    }
    for _ in 0..MOST {
        let (base, _) = chi2(s, &readings, errors, known);
        let mut order: Vec<Without> = (0..s.gauges.len())
            .into_par_iter()
            .map(|gauge| {
                let (chi2, dof) = chi2(s, &silent(&readings, gauge), errors, known);
                let runs = count(&readings, gauge).max(1) as f64;
                let fall = (base - chi2) / runs;
                Without {
                    gauge,
                    fall,
                    chi2,
                    dof,
                }
            })
            .collect();
        order.sort_by(|a, b| b.fall.total_cmp(&a.fall));
        let worst = order.first().map(|w| (w, w.limit(s.gauges.len(), known)));
        let Some((worst, limit)) = worst.filter(|(w, limit)| w.fall > limit * limit) else {
            break;
        };
        let g = worst.gauge;
        let sigmas = worst.fall.sqrt();
        let partners = order.iter().skip(1).take(PARTNERS).map(|w| w.gauge);
        let exchanged = partners
            .map(|h| {
                let both = chi2(s, &silent(&silent(&readings, g), h), errors, known).0;
                (h, chi2(s, &swapped(&readings, g, h), errors, known).0, both)
            })
            .filter(|(_, swapped, both)| {
                *swapped < AS_GOOD * both && *swapped < worst.chi2 / AS_GOOD
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((h, ..)) = exchanged {
            findings.push(exchange(&s.gauges[g], &s.gauges[h], [sigmas, limit]));
            readings = silent(&silent(&readings, g), h);
            continue;
        }
        let turned = chi2(s, &flipped(&readings, g), errors, known).0;
        let without = silent(&readings, g);
        let scale = scale_of(s, &readings, &without, g, errors, known);
        findings.push(name(
            &s.gauges[g],
            [sigmas, limit],
            turned < AS_GOOD * worst.chi2,
            scale,
        ));
        readings = without;
    }
    (findings, readings)
}

/// Sum of squares that is left of all runs, and its degrees of freedom.
fn chi2(
    s: &Sensitivity,
    readings: &[Readings],
    errors: ErrorModel,
    known: &Uncertainty,
) -> (f64, usize) {
    let runs = readings.iter().map(|r| estimate(s, r, errors, known));
    runs.fold((0.0, 0), |a, r| (a.0 + r.chi2, a.1 + r.dof))
}

fn count(readings: &[Readings], gauge: usize) -> usize {
    let read = |r: &&Readings| r.strain.get(gauge).is_some_and(|v| v.is_finite());
    readings.iter().filter(read).count()
}

fn changed(readings: &[Readings], change: impl Fn(&mut Vec<f64>)) -> Vec<Readings> {
    let mut out = readings.to_vec();
    out.iter_mut().for_each(|r| change(&mut r.strain));
    out
}

fn silent(readings: &[Readings], gauge: usize) -> Vec<Readings> {
    changed(readings, |v| v[gauge] = f64::NAN)
}

fn flipped(readings: &[Readings], gauge: usize) -> Vec<Readings> {
    changed(readings, |v| v[gauge] = -v[gauge])
}

fn swapped(readings: &[Readings], a: usize, b: usize) -> Vec<Readings> {
    changed(readings, |v| v.swap(a, b))
}

/// Reading over what the other gauges expect, in the last half of the runs, where a gauge that failed on the way has failed: the median.
fn scale_of(
    s: &Sensitivity,
    readings: &[Readings],
    without: &[Readings],
    gauge: usize,
    errors: ErrorModel,
    known: &Uncertainty,
) -> f64 {
    let ratio = |(r, w): (&Readings, &Readings)| -> f64 {
        let run: RunEstimate = estimate(s, w, errors, known);
        r.strain[gauge] / run.predicted[gauge]
    };
    let last = readings.iter().zip(without).skip(readings.len() / 2);
    let mut all: Vec<f64> = last.map(ratio).filter(|v| v.is_finite()).collect();
    all.sort_by(f64::total_cmp);
    all.get(all.len() / 2).copied().unwrap_or(f64::NAN)
}

fn exchange(a: &str, b: &str, [sigmas, limit]: [f64; 2]) -> Finding {
    Finding::new(
        Severity::Warning,
        "gauges-exchanged",
        format!("{a}, {b}"),
        format!("gauges `{a}` and `{b}` read each other's strain ({sigmas:.0} sigma): they are left out here"),
        "exchange their columns, or their plugs",
    )
    .with_numbers(sigmas, limit)
}

fn name(gauge: &str, [sigmas, limit]: [f64; 2], turned: bool, scale: f64) -> Finding {
    let (code, what, remedy) = if scale.abs() < NOTHING {
        (
            "gauge-dead",
            "reads nothing where the others expect strain".to_owned(),
            "check its wiring, or leave its column blank",
        )
    } else if turned && scale < 0.0 {
        (
            "gauge-wired-backwards",
            "reads with its sign turned".to_owned(),
            "check the wiring; if so, turn the sign of its column",
        )
    } else {
        (
            "gauge-suspect",
            format!("reads {scale:.2} of what the others expect"),
            "check its gain, its bridge factor and its zero, or leave its column blank",
        )
    };
    let message = format!(
        "gauge `{gauge}` {what} ({sigmas:.0} sigma by noise, scatter and the uncertainty of S): it is left out here"
    );
    Finding::new(Severity::Warning, code, gauge, message, remedy).with_numbers(sigmas, limit)
}
