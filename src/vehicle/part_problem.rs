//! The equations of one connected part of a vehicle over a record, with what its parameters may be.

use super::equations::{Equation, equations};
use super::fit::ParameterRange;
use super::identification::IdentifyTask;
use super::layout::{Parameter, Vehicle};
use super::motion::{Motion, motion, resolve_constants};
use super::treatment::{Treatment, VehicleError};
use crate::series::channels::Channels;

/// A part to fit.
pub(super) struct PartProblem {
    /// Parameters of the part.
    pub names: Vec<Parameter>,
    /// Motion in the record.
    pub motion: Motion,
    /// Equations of the part.
    pub equations: Vec<Equation>,
    /// Range of each parameter.
    pub allowed: Vec<ParameterRange>,
    /// Reference parameter, to which all other parameters are relative if no force sets the scale.
    pub reference: Option<usize>,
}

impl PartProblem {
    /// Builds the equations of a part.
    ///
    /// # Errors
    /// Errors of [`motion`].
    pub fn from_part(
        task: &IdentifyTask,
        part: &Vehicle,
        record: &Channels,
        treatment: &Treatment,
    ) -> Result<Self, VehicleError> {
        let names = part.parameters();
        let motion = motion(part, record, treatment)?;
        let equations = equations(part, &motion);
        let mut allowed = allowed_ranges(task, &names);
        let reference = reference(part, &equations, &allowed);
        if let Some(r) = reference {
            allowed[r] = ParameterRange::Known(1.0);
        }
        Ok(Self {
            names,
            motion,
            equations,
            allowed,
            reference,
        })
    }

    /// Returns whether there are equations and something that sets their scale.
    pub fn is_solvable(&self) -> bool {
        let has_scale = self.reference.is_some()
            || self
                .equations
                .iter()
                .any(|e| e.target.iter().any(|t| *t != 0.0))
            || self
                .allowed
                .iter()
                .any(|a| matches!(a, ParameterRange::Known(_)));
        has_scale && !self.equations.is_empty()
    }
}

/// Returns how the record is treated, and the vehicle with the sensors that the record has.
///
/// # Errors
/// Errors of [`super::identify::identify`].
pub(super) fn prepare_identification(
    task: &IdentifyTask,
    record: &Channels,
) -> Result<(Treatment, Vehicle), VehicleError> {
    let treatment = Treatment {
        adjust: task.corrections.clone(),
        ..Treatment::from_band(task.band)
    };
    let measured = with_measured_sensors(&task.vehicle, record);
    let vehicle = resolve_constants(&measured, record, &treatment)?;
    let all = vehicle.parameters();
    let mut named = task.known.keys().chain(task.bounds.keys());
    if let Some(name) = named.find(|k| all.iter().all(|p| p.name != **k)) {
        return Err(VehicleError::Known {
            name: name.clone(),
            present: all.iter().map(|p| p.name.clone()).collect(),
        });
    }
    let against_nature = |p: &&Parameter| {
        let high = task.bounds.get(&p.name).map(|b| b[1]);
        p.positive && high.is_some_and(|high| high <= 0.0)
    };
    match all.iter().find(against_nature) {
        Some(p) => Err(VehicleError::Bounds {
            name: p.name.clone(),
            high: task.bounds.get(&p.name).map_or(0.0, |b| b[1]),
        }),
        None => Ok((treatment, vehicle)),
    }
}

/// Returns the vehicle without the sensors whose channels the record lacks. A body keeps all its sensors if the present ones do not determine its
/// motion.
fn with_measured_sensors(vehicle: &Vehicle, record: &Channels) -> Vehicle {
    let mut out = vehicle.clone();
    let enough = |b: usize| {
        let present = vehicle
            .sensors
            .iter()
            .filter(|s| s.at.body == b && record.has(&s.channel))
            .count();
        present >= vehicle.bodies[b].shape.n()
    };
    out.sensors
        .retain(|s| record.has(&s.channel) || !enough(s.at.body));
    out
}

fn allowed_ranges(task: &IdentifyTask, parameters: &[Parameter]) -> Vec<ParameterRange> {
    parameters
        .iter()
        .map(
            |p| match (task.known.get(&p.name), task.bounds.get(&p.name)) {
                (Some(v), _) => ParameterRange::Known(*v),
                (None, Some([lo, hi])) if p.positive => ParameterRange::Within(lo.max(0.0), *hi),
                (None, Some([lo, hi])) => ParameterRange::Within(*lo, *hi),
                (None, None) if p.positive => ParameterRange::Within(0.0, f64::INFINITY),
                (None, None) => ParameterRange::Free,
            },
        )
        .collect()
}

/// Index of the parameter that all others are measured by when no force sets the scale.
fn reference(part: &Vehicle, equations: &[Equation], allowed: &[ParameterRange]) -> Option<usize> {
    let occurs = |i: usize| equations.iter().any(|e| e.columns.iter().any(|c| c.0 == i));
    let driven = equations
        .iter()
        .any(|e| e.driven && e.target.iter().any(|t| *t != 0.0));
    let held = (0..allowed.len())
        .any(|i| matches!(allowed[i], ParameterRange::Known(v) if v != 0.0) && occurs(i));
    if driven || held {
        return None;
    }
    let mut bodies: Vec<usize> = (0..part.bodies.len()).collect();
    bodies.sort_by_key(|&b| !part.bodies[b].sprung);
    part.masses(&bodies).into_iter().find(|&i| occurs(i))
}
