//! Temperatures of a load case and the strain they give.

use super::UnitLoad;
use super::element::beam::LineStrain;
use super::error::FeError;
use super::load_case::LoadCase;
use crate::model::{ElementTemperature, GridIx, MaterialKind, Model, Shell};
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
    pub(super) fn shell_rise(&self, shell: &Shell, tref: f64) -> ([f64; 4], f64) {
        let corner = |k: usize| shell.grids[k.min(shell.shape.n_corners() - 1)];
        if let Some(ElementTemperature::Plate { mean, gradient }) = self.elements.get(&shell.id) {
            let rise = std::array::from_fn(|k| mean - self.from(corner(k), tref));
            return (rise, *gradient);
        }
        (std::array::from_fn(|k| self.rise(corner(k), tref)), 0.0)
    }

    /// The rise of a bar, beam or rod at its ends, and its gradients across.
    pub(super) fn line_rise(&self, id: u32, grids: [GridIx; 2], tref: f64) -> LineRise {
        if let Some(ElementTemperature::Line { ends, gradient }) = self.elements.get(&id) {
            let rise = [0, 1].map(|k| ends[k] - self.from(grids[k], tref));
            return (rise, *gradient);
        }
        (grids.map(|g| self.rise(g, tref)), [[0.0; 2]; 2])
    }

    /// The rise of the grids of solid `i`.
    pub(super) fn solid_rise(&self, model: &Model, i: usize, grids: &[GridIx]) -> Vec<f64> {
        let tref = model
            .solid_properties
            .get(model.solids[i].property as usize)
            .and_then(|p| model.materials.get(p.material.us()))
            .map_or(0.0, |m| m.tref);
        grids.iter().map(|g| self.rise(*g, tref)).collect()
    }
}

/// Free thermal strain of beam `i`; `None` where its material is no MAT1.
pub(super) fn beam_expansion(model: &Model, i: usize, t: &Temperatures) -> Option<LineStrain> {
    let beam = model.beams.get(i)?;
    let property = model.beam_properties.get(beam.property.us())?;
    let material = model.materials.get(property.material.us())?;
    let MaterialKind::Isotropic { alpha, .. } = material.kind else {
        return None;
    };
    let (ends, gradient) = t.line_rise(beam.id, beam.grids, material.tref);
    Some(LineStrain {
        axial: ends.map(|t| alpha * t),
        per_y: gradient[0].map(|t| alpha * t),
        per_z: gradient[1].map(|t| alpha * t),
    })
}
