//! Temperatures of a load case and the forces of the thermal strain they give.

use super::UnitLoad;
use super::element::beam::{Interior, beam_end_forces};
use super::element::shell::shell_thermal_force;
use super::element::solid::{solid_grids, solid_thermal_force};
use super::element::{Prepared, rod_thermal_force};
use super::error::FeError;
use super::line_load::beam_expansion;
use super::solve::LoadCase;
use crate::model::{ElementTemperature, GridIx, Model, Shell};
use rayon::prelude::*;
use std::collections::HashMap;

/// Rises at both ends, and gradients along y and along z at both ends.
type LineRise = ([f64; 2], [[f64; 2]; 2]);

/// Temperatures of a load case.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Temperatures {
    /// By grid.
    at: Vec<f64>,
    /// By grid, where TEMPERATURE(INITIAL) is given: thermal strain counts from these, not from TREF.
    initial: Option<Vec<f64>>,
    /// By element id: TEMPP1 and TEMPRB.
    elements: HashMap<u32, ElementTemperature>,
}

impl Temperatures {
    /// The temperatures of a case; `None` where it has none.
    ///
    /// # Errors
    /// A temperature set that the deck lacks.
    pub(crate) fn of(model: &Model, case: &LoadCase) -> Result<Option<Self>, FeError> {
        let Some((set, initial)) = case.loads.iter().find_map(|l| match l {
            UnitLoad::Temperature { set, initial } => Some((*set, *initial)),
            _ => None,
        }) else {
            return Ok(None);
        };
        let find = |sid: u32| {
            model
                .temperatures
                .iter()
                .find(|t| t.sid == sid)
                .ok_or(FeError::MissingSet {
                    kind: "TEMPERATURE",
                    sid,
                    subcase: case.subcase,
                })
        };
        let set = find(set)?;
        Ok(Some(Self {
            at: set.by_grid(model.grids.len()),
            elements: set.elements.clone(),
            initial: match initial {
                None => None,
                Some(sid) => Some(find(sid)?.by_grid(model.grids.len())),
            },
        }))
    }

    /// How much warmer a grid is than where thermal strain counts from; `tref` is the material's reference.
    pub(crate) fn rise(&self, g: GridIx, tref: f64) -> f64 {
        self.at[g.us()] - self.from(g, tref)
    }

    fn from(&self, g: GridIx, tref: f64) -> f64 {
        self.initial.as_ref().map_or(tref, |i| i[g.us()])
    }

    /// The rise of a shell's reference plane at its corners, and the gradient through its thickness.
    pub(crate) fn shell_rise(&self, shell: &Shell, tref: f64) -> ([f64; 4], f64) {
        let corner = |k: usize| shell.grids[k.min(shell.shape.n_corners() - 1)];
        if let Some(ElementTemperature::Plate { mean, gradient }) = self.elements.get(&shell.id) {
            let rise = std::array::from_fn(|k| mean - self.from(corner(k), tref));
            return (rise, *gradient);
        }
        (std::array::from_fn(|k| self.rise(corner(k), tref)), 0.0)
    }

    /// The rise of a bar, beam or rod at its ends, and its gradients across.
    pub(crate) fn line_rise(&self, id: u32, grids: [GridIx; 2], tref: f64) -> LineRise {
        if let Some(ElementTemperature::Line { ends, gradient }) = self.elements.get(&id) {
            let rise = [0, 1].map(|k| ends[k] - self.from(grids[k], tref));
            return (rise, *gradient);
        }
        (grids.map(|g| self.rise(g, tref)), [[0.0; 2]; 2])
    }

    /// The rise of the grids of solid `i`.
    pub(crate) fn solid_rise(&self, model: &Model, i: usize, grids: &[GridIx]) -> Vec<f64> {
        let tref = model
            .solid_properties
            .get(model.solids[i].property as usize)
            .and_then(|p| model.materials.get(p.material.us()))
            .map_or(0.0, |m| m.tref);
        grids.iter().map(|g| self.rise(*g, tref)).collect()
    }
}

/// Adds the forces that hold the thermal strain of every element back.
///
/// # Errors
/// Elements that can't be formed.
pub(crate) fn thermal_forces(
    prepared: &Prepared<'_>,
    t: &Temperatures,
    f: &mut [[f64; 6]],
) -> Result<(), FeError> {
    let model = prepared.model;
    let refused = |r| FeError::Refused(vec![r]);
    let solids: Vec<_> = (0..model.solids.len())
        .into_par_iter()
        .map(|i| {
            let grids = solid_grids(&model.solids[i]);
            solid_thermal_force(model, i, &t.solid_rise(model, i, &grids))
        })
        .collect();
    for solid in solids {
        for (g, v) in solid.map_err(refused)? {
            (0..3).for_each(|i| f[g.us()][i] += v[i]);
        }
    }
    let shells: Vec<_> = (0..model.shells.len())
        .into_par_iter()
        .map(|i| shell_thermal_force(prepared, i, t))
        .collect();
    for (shell, forces) in model.shells.iter().zip(shells) {
        for (g, v) in shell
            .grids
            .iter()
            .zip(forces.map_err(refused)?.chunks_exact(6))
        {
            f[g.us()].iter_mut().zip(v).for_each(|(f, v)| *f += v);
        }
    }
    for (i, beam) in model.beams.iter().enumerate() {
        let interior = Interior {
            thermal: beam_expansion(model, i, t),
            ..Interior::default()
        };
        let ends = beam_end_forces(model, i, &interior).map_err(refused)?;
        for (g, v) in beam.grids.iter().zip(ends.chunks_exact(6)) {
            f[g.us()].iter_mut().zip(v).for_each(|(f, v)| *f += v);
        }
    }
    for (i, rod) in model.rods.iter().enumerate() {
        let tref = model
            .materials
            .get(rod.material.us())
            .map_or(0.0, |m| m.tref);
        let (ends, _) = t.line_rise(rod.id, rod.grids, tref);
        let force = rod_thermal_force(model, i, 0.5 * (ends[0] + ends[1]));
        for (g, sign) in rod.grids.iter().zip([-1.0, 1.0]) {
            (0..3).for_each(|k| f[g.us()][k] += sign * force[k]);
        }
    }
    Ok(())
}
