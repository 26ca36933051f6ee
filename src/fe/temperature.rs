//! Temperatures of a load case and the strain they give.

use super::UnitLoad;
use super::element::beam::LineStrain;
use super::error::FeError;
use super::load_case::LoadCase;
use crate::model::{
    ElementTemperature, GridIx, Material, MaterialIx, MaterialKind, Model, Shell, ShellKind,
};
use std::collections::HashMap;

/// Rises at both ends, and gradients along y and along z at both ends.
type LineRise = ([f64; 2], [[f64; 2]; 2]);

/// Temperatures of a load case.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Temperatures {
    /// Temperature of each grid.
    at: Vec<f64>,
    /// Temperature of each grid in TEMPERATURE(INITIAL), if given. Thermal strain is then relative to these temperatures, not to TREF.
    initial: Option<Vec<f64>>,
    /// TEMPP1 and TEMPRB, by element id.
    elements: HashMap<u32, ElementTemperature>,
}

impl Temperatures {
    /// Returns the temperatures of a case. `None` if the case has no temperatures.
    ///
    /// # Errors
    /// A temperature set that the deck lacks.
    pub(crate) fn from_case(model: &Model, case: &LoadCase) -> Result<Option<Self>, FeError> {
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

    /// Returns the temperature of a grid minus the temperature of zero thermal strain. `tref` is the reference temperature of the material.
    pub(crate) fn rise(&self, g: GridIx, tref: f64) -> f64 {
        self.at[g.us()] - self.initial_temperature(g, tref)
    }

    fn initial_temperature(&self, g: GridIx, tref: f64) -> f64 {
        self.initial.as_ref().map_or(tref, |i| i[g.us()])
    }

    /// Returns the temperature rise of a shell's reference plane at the corners, and the gradient through the thickness.
    pub(super) fn shell_rise(&self, shell: &Shell, tref: f64) -> ([f64; 4], f64) {
        let corner = |k: usize| shell.grids[k.min(shell.shape.n_corners() - 1)];
        if let Some(ElementTemperature::Plate { mean, gradient }) = self.elements.get(&shell.id) {
            let rise = std::array::from_fn(|k| mean - self.initial_temperature(corner(k), tref));
            return (rise, *gradient);
        }
        (std::array::from_fn(|k| self.rise(corner(k), tref)), 0.0)
    }

    /// Returns the temperature rise of a bar, beam or rod at both ends, and the gradients across.
    pub(super) fn line_rise(&self, id: u32, grids: [GridIx; 2], tref: f64) -> LineRise {
        if let Some(ElementTemperature::Line { ends, gradient }) = self.elements.get(&id) {
            let rise = [0, 1].map(|k| ends[k] - self.initial_temperature(grids[k], tref));
            return (rise, *gradient);
        }
        (grids.map(|g| self.rise(g, tref)), [[0.0; 2]; 2])
    }

    /// Returns the temperature rise at the grids of solid `i`.
    pub(super) fn solid_rise(&self, model: &Model, i: usize, grids: &[GridIx]) -> Vec<f64> {
        let tref = model
            .solid_properties
            .get(model.solids[i].property as usize)
            .and_then(|p| model.materials.get(p.material.us()))
            .map_or(0.0, |m| m.tref);
        grids.iter().map(|g| self.rise(*g, tref)).collect()
    }
}

/// Returns the free thermal strain of beam `i`. `None` if its material is not a MAT1.
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

/// Rises of temperature up to this one are rounding of the cards.
const NO_RISE: f64 = 1e-9;

/// Returns whether the temperatures of a case cause thermal strain: an element whose material expands is warmer or colder than its reference
/// temperature.
///
/// # Errors
/// A temperature set that the deck lacks.
pub(crate) fn is_heated(model: &Model, case: &LoadCase) -> Result<bool, FeError> {
    let Some(t) = Temperatures::from_case(model, case)? else {
        return Ok(false);
    };
    let acts = |rise: f64| rise.abs() > NO_RISE;
    let material = |ix: MaterialIx| model.materials.get(ix.us()).filter(|m| expands(m));
    let on_line = |id: u32, grids: [GridIx; 2], ix: MaterialIx| {
        material(ix).is_some_and(|m| {
            let (ends, gradients) = t.line_rise(id, grids, m.tref);
            ends.into_iter()
                .chain(gradients.into_iter().flatten())
                .any(acts)
        })
    };
    let shells = model.shells.iter().any(|shell| {
        let property = model.shell_properties.get(shell.property.us());
        let references = property.map_or(Vec::new(), |p| match &p.kind {
            ShellKind::Homogeneous {
                membrane,
                bending,
                coupling,
                ..
            } => [membrane, bending, coupling]
                .into_iter()
                .filter_map(|ix| Some(material((*ix)?)?.tref))
                .collect(),
            ShellKind::Laminate { plies, tref, .. } => plies
                .iter()
                .filter_map(|p| material(p.material))
                .map(|m| tref.unwrap_or(m.tref))
                .collect(),
        });
        references.into_iter().any(|tref| {
            let (corners, gradient) = t.shell_rise(shell, tref);
            corners.into_iter().any(acts) || acts(gradient)
        })
    });
    let beams = || {
        model.beams.iter().any(|b| {
            let property = model.beam_properties.get(b.property.us());
            property.is_some_and(|p| on_line(b.id, b.grids, p.material))
        })
    };
    let rods = || {
        let mut rods = model.rods.iter();
        rods.any(|r| on_line(r.id, r.grids, r.material))
    };
    let solids = || {
        model.solids.iter().enumerate().any(|(i, s)| {
            let property = model.solid_properties.get(s.property as usize);
            let grids: Vec<GridIx> = s.grids.iter().flatten().copied().collect();
            property.is_some_and(|p| material(p.material).is_some())
                && t.solid_rise(model, i, &grids).into_iter().any(acts)
        })
    };
    Ok(shells || beams() || rods() || solids())
}

fn expands(material: &Material) -> bool {
    match material.kind {
        MaterialKind::Isotropic { alpha, .. } => alpha != 0.0,
        MaterialKind::Anisotropic2d { alpha, .. } => alpha != [0.0; 3],
        MaterialKind::Orthotropic { alpha, .. } => alpha != [0.0; 2],
        MaterialKind::Anisotropic3d { alpha, .. } => alpha != [0.0; 6],
    }
}
