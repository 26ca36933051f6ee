//! Loads along the bars and beams of a load case: PLOAD1, temperature, inertia of coupled mass.

use super::UnitLoad;
use super::element::beam::{Interior, LineLoad, beam_inertia};
use super::load_case::LoadCase;
use super::mass::add_acceleration;
use super::rigid_motion::rigid_displacement;
use super::temperature::{Temperatures, beam_expansion};
use crate::model::{Load, Model, Vec3};
use std::collections::HashMap;

/// Loads along beams, and temperatures, of one case.
#[derive(Debug, Default)]
pub(crate) struct BeamLoads<'a> {
    loads: HashMap<usize, Vec<LineLoad>>,
    temperatures: Option<&'a Temperatures>,
    /// Acceleration by grid, basic frame, WTMASS applied, if coupled mass has inertia loads.
    acceleration: Option<Vec<[f64; 6]>>,
}

/// Returns the load if it is a single PLOAD1. Other loads give an empty list.
pub(crate) fn as_line_load(load: &Load) -> Interior {
    Interior {
        loads: scale_line_load(load, 1.0)
            .into_iter()
            .map(|l| l.1)
            .collect(),
        ..Interior::default()
    }
}

fn scale_line_load(load: &Load, factor: f64) -> Option<(usize, LineLoad)> {
    let Load::Line {
        beam,
        span,
        force,
        moment,
    } = load
    else {
        return None;
    };
    let line = LineLoad {
        span: *span,
        force: force.map(|f| f * factor),
        moment: moment.map(|m| m * factor),
    };
    Some((beam.us(), line))
}

impl<'a> BeamLoads<'a> {
    /// Returns the loads along the beams in a case. `relief` is the rigid acceleration of inertia relief and the centre of gravity it refers to.
    pub(crate) fn new(
        model: &Model,
        case: &LoadCase,
        temperatures: Option<&'a Temperatures>,
        relief: Option<([f64; 6], Vec3)>,
    ) -> Self {
        let mut loads: HashMap<usize, Vec<LineLoad>> = HashMap::new();
        for load in &case.loads {
            let UnitLoad::Set(sid) = load else { continue };
            for set in model.load_sets.iter().filter(|s| s.sid == *sid) {
                for (factor, load) in &set.loads {
                    if let Some((beam, line)) = scale_line_load(load, *factor) {
                        loads.entry(beam).or_default().push(line);
                    }
                }
            }
        }
        Self {
            loads,
            temperatures,
            acceleration: acceleration(model, case, relief),
        }
    }

    /// Returns the loads along beams by beam, including the loads of their coupled mass.
    pub(crate) fn loads_by_beam(&self, model: &Model) -> HashMap<usize, Vec<LineLoad>> {
        let mut loads = self.loads.clone();
        if let Some(acceleration) = &self.acceleration {
            for i in 0..model.beams.len() {
                let inertia = beam_inertia(model, i, acceleration).0;
                let acts =
                    |l: &LineLoad| [l.force, l.moment].iter().flatten().any(|v| v.amax() > 0.0);
                if inertia.iter().any(acts) {
                    loads.entry(i).or_default().extend(inertia);
                }
            }
        }
        loads
    }

    /// Returns the loads along beam `i`.
    pub(crate) fn loads_on_beam(&self, model: &Model, i: usize) -> Interior {
        Interior {
            loads: self.loads.get(&i).cloned().unwrap_or_default(),
            thermal: self.temperatures.and_then(|t| beam_expansion(model, i, t)),
            inertia: (self.acceleration.as_ref()).map(|a| beam_inertia(model, i, a).1),
        }
    }
}

/// Returns the acceleration of coupled mass in a case: GRAV, ACCEL, ACCEL1, RFORCE, minus the acceleration of inertia relief.
/// `None` if mass is lumped, or nothing accelerates it.
fn acceleration(
    model: &Model,
    case: &LoadCase,
    relief: Option<([f64; 6], Vec3)>,
) -> Option<Vec<[f64; 6]>> {
    if !model.params.coupmass || model.beams.is_empty() {
        return None;
    }
    let mut field = vec![[0.0; 6]; model.grids.len()];
    for load in &case.loads {
        let UnitLoad::Set(sid) = load else { continue };
        let sets = model.load_sets.iter().filter(|s| s.sid == *sid);
        for (factor, load) in sets.flat_map(|s| &s.loads) {
            add_acceleration(model, *factor, load, &mut field);
        }
    }
    if let Some((amounts, centre)) = relief {
        for (grid, u) in model.grids.iter().zip(&mut field) {
            for (mode, amount) in amounts.iter().enumerate() {
                let motion = rigid_displacement(mode, &grid.x, &centre);
                (0..6).for_each(|i| u[i] -= amount * motion[i]);
            }
        }
    }
    let wtmass = model.params.wtmass;
    field.iter_mut().flatten().for_each(|v| *v *= wtmass);
    field.iter().flatten().any(|v| *v != 0.0).then_some(field)
}
