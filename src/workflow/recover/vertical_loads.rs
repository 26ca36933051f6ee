//! Whether all vertical loads pull: the sign of all readings may be reversed.

use crate::finding::{Finding, Severity};
use crate::job::{Component, Job, LoadActs, LoadRole};
use crate::strain_chain::LoadUnits;
use crate::units::number;

/// Vertical loads that must all be negative: fewer may pull by chance or by their function.
const LEAST_LOADS: usize = 3;

/// Returns the warning that all forces FZ in basic axes are negative, with their intervals, in all states. Wheels, axles and mounts carry a structure
/// and push it upwards. `high` is the high end of the interval of each load of the job over all states, job units; infinite if a state does not
/// determine the load.
pub(super) fn check_vertical_sign(
    job: &Job,
    states: &str,
    high: &[f64],
    units: &[LoadUnits],
) -> Option<Finding> {
    let is_vertical = |l: &usize| {
        let load = &job.loads[*l];
        let component = Component::FZ;
        let vertical =
            matches!(load.acts, LoadActs::AtGrid { component: c, cid: 0, .. } if c == component);
        vertical && load.role == LoadRole::Wanted
    };
    let vertical: Vec<usize> = (0..job.loads.len().min(high.len()))
        .filter(is_vertical)
        .collect();
    if vertical.len() < LEAST_LOADS || !vertical.iter().all(|l| high[*l] < 0.0) {
        return None;
    }
    let nearest = vertical
        .into_iter()
        .max_by(|a, b| high[*a].total_cmp(&high[*b]))?;
    let (name, unit) = (&job.loads[nearest].name, units.get(nearest)?);
    Some(Finding::new(
        Severity::Warning,
        "input-sign-reversed",
        "all",
        format!(
            "all forces FZ are negative {states}; the nearest to zero is {name} with at most {} {}. All readings may have the opposite sign",
            number(high[nearest] * unit.factor),
            unit.name
        ),
        "check the wiring and the sign convention of the logger. If it is reversed, state [[correction]] sign = -1 for every gauge. If FZ points \
         down, or the wheels are unloaded, the readings are right",
    ))
}
