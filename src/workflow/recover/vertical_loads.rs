//! Whether all vertical loads pull: the sign of all readings may be reversed.

use crate::finding::{Finding, Severity};
use crate::job::{Component, Job, LoadActs, LoadRole};
use crate::strain_chain::LoadUnits;
use crate::units::number;

/// Vertical loads that must all be negative: fewer may pull by chance or by their function.
const LEAST_LOADS: usize = 3;

/// Wanted forces FZ in basic axes of a job, by number and name, except a payload, which pushes down. If S is given and a load has only a name, a
/// name that ends with `FZ` after a separator counts.
#[derive(Clone, Debug)]
pub(crate) struct VerticalLoads(Vec<(usize, String)>);

impl VerticalLoads {
    /// Returns the vertical loads of a job.
    pub fn of_job(job: &Job) -> Self {
        let payload = job.payload.as_ref().and_then(|p| p.grid);
        let vertical = job.loads.iter().enumerate().filter(|(_, load)| {
            let is_vertical = match load.acts {
                LoadActs::AtGrid {
                    grid,
                    component,
                    cid,
                } => component == Component::FZ && cid == 0 && Some(grid) != payload,
                LoadActs::Named => load
                    .name
                    .split(|c: char| !c.is_alphanumeric())
                    .skip(1)
                    .last()
                    .is_some_and(|last| last.eq_ignore_ascii_case("FZ")),
                LoadActs::Set(_) => false,
            };
            let is_payload = load.name.to_lowercase().contains("payload");
            is_vertical && !is_payload && load.role == LoadRole::Wanted
        });
        Self(vertical.map(|(l, load)| (l, load.name.clone())).collect())
    }

    /// Returns the warning that all these loads are negative, with their intervals, in all states. Wheels, axles and mounts carry a structure and
    /// push it upwards. `high` is the high end of the interval of each load of the job over all states, job units; infinite if a state does not
    /// determine the load.
    pub fn check_sign(&self, states: &str, high: &[f64], units: &[LoadUnits]) -> Option<Finding> {
        let high_of = |l: usize| high.get(l).copied().unwrap_or(f64::INFINITY);
        let pulls = |load: &(usize, String)| high_of(load.0) < 0.0;
        if self.0.len() < LEAST_LOADS || !self.0.iter().all(pulls) {
            return None;
        }
        let nearest = self.0.iter();
        let (l, name) = nearest.max_by(|a, b| high_of(a.0).total_cmp(&high_of(b.0)))?;
        let unit = units.get(*l)?;
        Some(Finding::new(
            Severity::Warning,
            "input-sign-reversed",
            "all",
            format!(
                "all forces FZ are negative {states}; the nearest to zero is {name} with at most {} {}. All readings may have the opposite sign",
                number(high_of(*l) * unit.factor),
                unit.name
            ),
            "check the wiring and the sign convention of the logger. If it is reversed, state [[correction]] sign = -1 for every gauge. If FZ points \
             down, or the wheels are unloaded, the readings are right",
        ))
    }
}
