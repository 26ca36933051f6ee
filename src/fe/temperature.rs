//! Temperatures of a load case and the forces of the thermal strain they give.

use super::UnitLoad;
use super::element::Prepared;
use super::element::solid::{solid_grids, solid_thermal_force};
use super::error::FeError;
use super::solve::LoadCase;
use crate::model::{GridIx, Model, TemperatureSet};
use rayon::prelude::*;

/// Temperatures of a load case.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Temperatures {
    /// By grid.
    at: Vec<f64>,
    /// By grid, where TEMPERATURE(INITIAL) is given: thermal strain counts from these, not from TREF.
    initial: Option<Vec<f64>>,
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
        Ok(Some(Self {
            at: by_grid(model, find(set)?),
            initial: match initial {
                None => None,
                Some(sid) => Some(by_grid(model, find(sid)?)),
            },
        }))
    }

    /// How much warmer a grid is than where thermal strain counts from; `tref` is the material's reference.
    pub(crate) fn rise(&self, g: GridIx, tref: f64) -> f64 {
        let from = self.initial.as_ref().map_or(tref, |i| i[g.us()]);
        self.at[g.us()] - from
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

fn by_grid(model: &Model, set: &TemperatureSet) -> Vec<f64> {
    let mut all = vec![set.default.unwrap_or(0.0); model.grids.len()];
    for (g, t) in &set.grids {
        all[g.us()] = *t;
    }
    all
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
    Ok(())
}
