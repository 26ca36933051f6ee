//! Gauges that look wired backwards, dead, or wrong: each one tried, exactly, on all runs together.

use super::errors::ErrorModel;
use super::solved::solve;
use super::types::{GAUGE_SUSPECT, Readings, RunEstimate};
use crate::finding::{Finding, Severity};
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;
use rayon::prelude::*;

/// `chi2 / dof` that a repaired set of readings must fall under, as a share of what it was.
pub const REPAIR: f64 = 0.2;
/// `chi2 / dof` under which stated errors explain the readings.
pub const EXPLAINED: f64 = 2.0;
/// A dead gauge reads less than this many noise sd while the others expect more than [`LIVE`].
const DEAD: f64 = 3.0;
/// See [`DEAD`].
const LIVE: f64 = 10.0;
/// Faults looked for one after the other.
const MOST: usize = 3;

struct Trial {
    gauge: usize,
    flip: f64,
    drop: f64,
    /// Root mean squares over runs: reading, and what the other gauges predict.
    reading: f64,
    predicted: f64,
}

/// Runs that every gauge is tried on at most: more say no more of it.
const TRIED: usize = 200;

/// Findings that name gauges whose reading, turned or left out, makes the rest agree.
pub fn check(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> Vec<Finding> {
    let mut findings = Vec::new();
    let step = readings.len().div_ceil(TRIED).max(1);
    let mut readings: Vec<Readings> = readings.iter().step_by(step).cloned().collect();
    for _ in 0..MOST {
        let (chi2, dof) = sum_of_squares(s, &readings, errors);
        if dof == 0 {
            break;
        }
        let base = chi2 / dof as f64;
        if base < EXPLAINED {
            break;
        }
        let trials: Vec<Trial> = (0..s.gauges.len())
            .into_par_iter()
            .map(|g| try_gauge(s, &readings, errors, g))
            .collect();
        let Some(best) = trials
            .iter()
            .min_by(|a, b| a.flip.min(a.drop).total_cmp(&b.flip.min(b.drop)))
        else {
            break;
        };
        let name = &s.gauges[best.gauge];
        let dead = best.reading < DEAD * errors.noise && best.predicted > LIVE * errors.noise;
        if dead && best.drop < REPAIR * base {
            findings.push(
                Finding::new(
                    Severity::Error,
                    "gauge-dead",
                    name,
                    format!(
                        "gauge `{name}` reads nothing ({:.1} microstrain) where the other gauges expect {:.1} microstrain",
                        best.reading / MICROSTRAIN,
                        best.predicted / MICROSTRAIN
                    ),
                    "check its wiring, or leave it out: [[correction]] ignore = true",
                )
                .with_numbers(best.reading / MICROSTRAIN, DEAD * errors.noise / MICROSTRAIN),
            );
            silence(&mut readings, best.gauge);
        } else if best.flip < REPAIR * base && best.flip < 2.0 * best.drop.max(1.0) {
            findings.push(
                Finding::new(
                    Severity::Error,
                    "gauge-wired-backwards",
                    name,
                    format!(
                        "gauge `{name}` looks wired backwards: with its sign turned the residual sum of squares falls to {:.1} % of what it is",
                        100.0 * best.flip / base
                    ),
                    "check the wiring; if so, state it: [[correction]] sign = -1",
                )
                .with_numbers(best.flip / base, REPAIR),
            );
            for r in &mut readings {
                r.strain[best.gauge] = -r.strain[best.gauge];
            }
        } else if best.drop < REPAIR * base {
            findings.push(
                Finding::new(
                    Severity::Warning,
                    GAUGE_SUSPECT,
                    name,
                    format!(
                        "gauge `{name}` contradicts the others: without it the residual sum of squares falls to {:.1} % of what it is",
                        100.0 * best.drop / base
                    ),
                    "check its position, direction, bridge factor and wiring, or leave it out: [[correction]] ignore = true",
                )
                .with_numbers(best.drop / base, REPAIR),
            );
            silence(&mut readings, best.gauge);
        } else {
            break;
        }
    }
    findings
}

fn silence(readings: &mut [Readings], gauge: usize) {
    readings.iter_mut().for_each(|r| r.strain[gauge] = f64::NAN);
}

/// Returns the sum of squares that is left of all runs, in units of stated errors, and its degrees of freedom.
pub fn sum_of_squares(s: &Sensitivity, readings: &[Readings], errors: ErrorModel) -> (f64, usize) {
    sum_of(&solve(s, readings, errors).runs)
}

fn sum_of(runs: &[RunEstimate]) -> (f64, usize) {
    runs.iter()
        .fold((0.0, 0), |a, e| (a.0 + e.chi2, a.1 + e.dof))
}

fn try_gauge(s: &Sensitivity, readings: &[Readings], errors: ErrorModel, gauge: usize) -> Trial {
    let mut turned = readings.to_vec();
    turned
        .iter_mut()
        .for_each(|r| r.strain[gauge] = -r.strain[gauge]);
    let (flip, flip_dof) = sum_of_squares(s, &turned, errors);
    silence(&mut turned, gauge);
    let without = solve(s, &turned, errors).runs;
    let (drop, drop_dof) = sum_of(&without);
    let (mut reading, mut predicted, mut n) = (0.0, 0.0, 0usize);
    for (e, r) in without.iter().zip(readings) {
        if r.strain[gauge].is_finite() && e.predicted[gauge].is_finite() {
            reading += r.strain[gauge].powi(2);
            predicted += e.predicted[gauge].powi(2);
            n += 1;
        }
    }
    let per = |chi2: f64, dof: usize| {
        if dof > 0 {
            chi2 / dof as f64
        } else {
            f64::INFINITY
        }
    };
    let rms = |q: f64| if n > 0 { (q / n as f64).sqrt() } else { 0.0 };
    Trial {
        gauge,
        flip: per(flip, flip_dof),
        drop: per(drop, drop_dof),
        reading: rms(reading),
        predicted: rms(predicted),
    }
}
