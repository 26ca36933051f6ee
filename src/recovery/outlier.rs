//! A gauge whose error stands out of the others', and what it does to the loads.

use super::interval::NORMAL_95;
use super::residuals::{GaugeTest, Joint};
use super::solved::Solved;
use super::types::{GAUGE_SUSPECT, Shift, ShiftKind, Widening};
use crate::finding::{Finding, Severity};
use crate::linalg::tail::student_tail;
use crate::sensitivity::Sensitivity;
use crate::units::MICROSTRAIN;
use statrs::distribution::{ContinuousCDF, Normal};

/// Chance, over all gauges of a job, under which the largest of their errors counts as real: half of the 1 % of right jobs that may be
/// stopped.
pub const ALARM: f64 = 0.005;
/// The same chance under which it is said, and the intervals are widened: one right job in twenty is so noted.
const NOTE: f64 = 0.05;
/// Share of what the residuals have too much that one gauge must account for: with less, something else is wrong as well, and the
/// gauge nearest to it would be blamed.
const ACCOUNTS_FOR: f64 = 0.5;

/// What stands out.
pub(super) struct Suspects {
    pub findings: Vec<Finding>,
    pub shifts: Vec<Shift>,
}

/// The gauge whose gain or zero error stands out most, where chance doesn't make it so: an error where it shifts a wanted load by more
/// than the half width of its interval, else a warning, or a note where chance is not quite ruled out. Either way the intervals are widened
/// by what it does.
pub(super) fn check(s: &Sensitivity, solved: &Solved, joint: Option<&Joint>) -> Suspects {
    let mut out = Suspects {
        findings: Vec::new(),
        shifts: Vec::new(),
    };
    let Some(joint) = joint.filter(|j| j.dof > 1) else {
        return out;
    };
    let Some(test) = joint
        .gauges
        .iter()
        .max_by(|a, b| a.t.abs().total_cmp(&b.t.abs()))
    else {
        return out;
    };
    let excess = joint.chi2 - joint.dof as f64;
    let p = joint.gauges.len() as f64 * chance(joint, test);
    let found = p < NOTE && test.t * test.t > ACCOUNTS_FOR * excess;
    if !found {
        return out;
    }
    let shift = Shift {
        gauge: test.gauge,
        kind: test.kind,
        size: test.size,
    };
    let (ratio, load) = worst_shift(s, solved, &shift);
    let name = s.gauges.get(test.gauge).map_or("", String::as_str);
    let half = NORMAL_95 * (test.size / test.t).abs();
    let size = match test.kind {
        ShiftKind::Gain => format!(
            "{:+.1} % (+- {:.1} %) of the strain that the others make of it",
            100.0 * test.size,
            100.0 * half
        ),
        ShiftKind::Offset => format!(
            "{:+.1} (+- {:.1}) microstrain from what the others make of it",
            test.size / MICROSTRAIN,
            half / MICROSTRAIN
        ),
    };
    let (severity, then) = if p < ALARM && ratio > 1.0 {
        let then = format!(
            "that shifts load `{load}` by {ratio:.1} times the half width of its 95 % interval"
        );
        (Severity::Error, then)
    } else {
        let then = "the intervals are widened by what that does to the loads".to_owned();
        let severity = if p < ALARM {
            Severity::Warning
        } else {
            Severity::Info
        };
        (severity, then)
    };
    out.findings.push(
        Finding::new(
            severity,
            GAUGE_SUSPECT,
            name,
            format!("gauge `{name}` is off by {size}: {then}"),
            "check its position, direction, gauge and bridge factor and wiring; state a known error in [[correction]], or leave it out there \
             with `ignore = true`",
        )
        .with_numbers(ratio, 1.0),
    );
    out.shifts.push(shift);
    out
}

/// Chance of an error as large by a gauge that is right; where the residuals without it are larger than stated, by their own scale.
fn chance(joint: &Joint, test: &GaugeTest) -> f64 {
    let free = (joint.dof - 1) as f64;
    let rest = (joint.chi2 - test.t * test.t) / free;
    let tail = if rest > 1.0 {
        let t = test.t.abs() / rest.sqrt();
        student_tail(t, free)
    } else {
        Normal::new(0.0, 1.0).map_or(1.0, |d| d.sf(test.t.abs()))
    };
    2.0 * tail
}

/// The largest shift of a wanted load over the half width of its interval as stated errors make it, and that load.
fn worst_shift<'a>(s: &'a Sensitivity, solved: &Solved, shift: &Shift) -> (f64, &'a str) {
    let mut worst = (0.0, "");
    for (pattern, gain) in &solved.patterns {
        let Some(gain) = gain else { continue };
        for r in pattern.runs.iter().filter_map(|&i| solved.runs.get(i)) {
            let f = &r.estimate.values;
            let Some(by_load) = gain.shift(f, shift) else {
                continue;
            };
            let sigma = gain.sigma(f, &Widening::none());
            for ((load, d), sd) in s.loads.iter().zip(&by_load).zip(&sigma) {
                let ratio = d.abs() / (NORMAL_95 * sd);
                if load.wanted && ratio > worst.0 {
                    worst = (ratio, load.name.as_str());
                }
            }
        }
    }
    worst
}
