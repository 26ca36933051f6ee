//! Checks on identified parameters that are not part of the fit.

use super::layout::Parameter;
use crate::finding::{Finding, Severity};
use crate::units::number;
use serde::Serialize;

/// Comparison of identified mass and weighed mass.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MassClosure {
    /// Identified sum of sprung and unsprung mass.
    pub identified: f64,
    /// Standard deviation of the identified mass.
    pub sigma: f64,
    /// Mean wheel force divided by gravity.
    pub weighed: f64,
    /// Identified mass divided by weighed mass. The ratio is 1 if dynamics and statics agree.
    pub ratio: f64,
}

/// Departure of the mass ratio from 1 above which a finding is reported.
const CLOSURE_LIMIT: f64 = 0.05;
/// Difference between sides of a vehicle above which a finding is reported.
const SIDES_LIMIT: f64 = 0.2;

/// Compares identified sprung and unsprung mass with the mean wheel force over gravity.
///
/// Without net vertical motion, the mean vertical force on a vehicle is its weight. The result is `None` without a static part.
pub fn check_mass_closure(
    identified: f64,
    sigma: f64,
    mean_force: f64,
    gravity: f64,
) -> Option<(MassClosure, Option<Finding>)> {
    let weighed = mean_force / gravity;
    if !is_static(weighed, identified) {
        return None;
    }
    let ratio = identified / weighed;
    let closure = MassClosure {
        identified,
        sigma,
        weighed,
        ratio,
    };
    if (ratio - 1.0).abs() < CLOSURE_LIMIT.max(3.0 * sigma / weighed) {
        return Some((closure, None));
    }
    let message = format!(
        "Identified sprung and unsprung mass {identified:.1} is {:+.0} % off the mean wheel force over gravity, {weighed:.1}. \
         Masses, stiffness and forces share that error.",
        100.0 * (ratio - 1.0)
    );
    let remedy = "Possible causes: accelerometers with a low gain; a wheel force channel with a high gain or a zero under load; load transfer from the \
     other side or axle (roll, pitch); friction or a delay that fits as mass. Weigh the axle and check the gains.";
    let finding = Finding::new(
        Severity::Warning,
        "mass-closure",
        "wheel forces",
        message,
        remedy,
    )
    .with_numbers(ratio, 1.0 + CLOSURE_LIMIT);
    Some((closure, Some(finding)))
}

/// Returns whether a mean wheel force, or its mass, contains the static load. Below a twentieth of the identified weight, the channel was zeroed.
pub(super) fn is_static(weighed: f64, identified: f64) -> bool {
    weighed > 0.05 * identified && identified > 0.0
}

/// Returns the parameters of the two sides of a vehicle that differ by more than wear would explain.
///
/// Pairs are names that differ by `_other`, or by `l` against `r` before the axle letter.
pub fn check_sides(parameters: &[Parameter], values: &[f64], sigmas: &[f64]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (i, p) in parameters.iter().enumerate() {
        let Some(j) =
            mirror_name(&p.name).and_then(|m| parameters.iter().position(|q| q.name == m))
        else {
            continue;
        };
        let (a, b) = (values[i], values[j]);
        let spread = sigmas[i].hypot(sigmas[j]);
        let share = 2.0 * (a - b) / (a.abs() + b.abs());
        if share.abs() > SIDES_LIMIT && (a - b).abs() > 3.0 * spread {
            let message = format!(
                "{} is {a:.5e} and {} is {b:.5e}: they differ by {:.0} %.",
                p.name,
                parameters[j].name,
                100.0 * share.abs()
            );
            let remedy = "Both sides of an axle are usually equal: check gain and place of the sensors of either side, or a worn part.";
            findings.push(
                Finding::new(Severity::Warning, "sides-differ", &p.name, message, remedy)
                    .with_numbers(share.abs(), SIDES_LIMIT),
            );
        }
    }
    findings
}

fn mirror_name(name: &str) -> Option<String> {
    if !name.ends_with("_other") && !name.contains("_sl") {
        return Some(format!("{name}_other"));
    }
    name.contains("_sl").then(|| name.replacen("_sl", "_sr", 1))
}

/// Returns a finding on a parameter that ended at its bound. Without the bound, its value would be physically impossible.
pub fn at_bound(name: &str, bound: f64, is_damping: bool) -> Finding {
    let what = if is_damping {
        "Damping is indistinguishable from zero, or another effect changes the phase."
    } else {
        "The data require a value beyond the bound."
    };
    let remedy = "Check for a delay between channels, friction that fits as damping, a wrong sign or gain; run `reconcile`.";
    Finding::new(
        Severity::Warning,
        "parameter-at-bound",
        name,
        format!("`{name}` reached its bound {}. {what}", number(bound)),
        remedy,
    )
    .with_numbers(bound, bound)
}
