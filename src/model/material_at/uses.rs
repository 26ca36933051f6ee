//! Temperatures of elements, and their materials at these temperatures.

use super::material_faults::MaterialFaults;
use super::temperature_dependence::TemperatureDependentMaterial;
use crate::model::ElementRef;
use crate::model::fault::FaultKind;
use crate::model::own_property::change_properties;
use crate::model::types::*;
use std::collections::{BTreeMap, BTreeSet};

/// Temperatures (as bits) of elements whose material depends on temperature, by kind of element. `None` for all other elements.
#[derive(Debug, Default)]
pub(super) struct Uses {
    shells: Vec<Option<u64>>,
    beams: Vec<Option<u64>>,
    rods: Vec<Option<u64>>,
    panels: Vec<Option<u64>>,
    solids: Vec<Option<u64>>,
}

impl Uses {
    /// Returns the temperatures of the elements with a material of `dependent`. A grid without a temperature is a fault.
    pub(super) fn from_temperatures(
        model: &Model,
        set: &TemperatureSet,
        dependent: &BTreeMap<u32, TemperatureDependentMaterial<'_>>,
        found: &mut MaterialFaults,
    ) -> Self {
        let mut at: Vec<Option<f64>> = vec![set.default; model.grids.len()];
        for (g, t) in &set.grids {
            if let Some(slot) = at.get_mut(g.us()) {
                *slot = Some(*t);
            }
        }
        let mut uses = Self::default();
        let mut cold: Option<(u32, u32)> = None;
        for element in model.elements() {
            let list = match element {
                ElementRef::Shell(_) => &mut uses.shells,
                ElementRef::Beam(_) => &mut uses.beams,
                ElementRef::Rod(_) => &mut uses.rods,
                ElementRef::ShearPanel(_) => &mut uses.panels,
                ElementRef::Solid(_) => &mut uses.solids,
                ElementRef::Bush(_) | ElementRef::Joint(_) | ElementRef::Spring(_) => continue,
            };
            let materials = materials_of(model, element);
            let material = materials.iter().find(|m| dependent.contains_key(&m.0));
            let t = material.and_then(|m| match mean(model, set, &at, element) {
                Ok(t) => Some(t.to_bits()),
                Err(grid) => {
                    cold.get_or_insert((m.0, grid));
                    None
                }
            });
            list.push(t);
        }
        if let Some((one, grid)) = cold.and_then(|(m, grid)| Some((dependent.get(&m)?, grid))) {
            let kind = FaultKind::Missing {
                what: "temperature of grid",
                id: grid.into(),
            };
            found.faults.push(one.fault("MID", kind));
        }
        uses
    }

    /// Returns the materials of `dependent`, each with every temperature at which an element uses it.
    pub(super) fn materials(
        &self,
        model: &Model,
        dependent: &BTreeMap<u32, TemperatureDependentMaterial<'_>>,
    ) -> BTreeSet<(u32, u64)> {
        let mut out = BTreeSet::new();
        for element in model.elements() {
            let Some(t) = self.temperature(element) else {
                continue;
            };
            let materials = materials_of(model, element).into_iter().map(|m| m.0);
            out.extend(
                materials
                    .filter(|m| dependent.contains_key(m))
                    .map(|m| (m, t)),
            );
        }
        out
    }

    fn temperature(&self, element: ElementRef) -> Option<u64> {
        let (list, i) = match element {
            ElementRef::Shell(i) => (&self.shells, i),
            ElementRef::Beam(i) => (&self.beams, i),
            ElementRef::Rod(i) => (&self.rods, i),
            ElementRef::ShearPanel(i) => (&self.panels, i),
            ElementRef::Solid(i) => (&self.solids, i),
            ElementRef::Bush(_) | ElementRef::Joint(_) | ElementRef::Spring(_) => return None,
        };
        list.get(i).copied().flatten()
    }

    /// Assigns materials to the elements. `own` contains the materials by material and temperature.
    pub(super) fn apply(&self, model: &mut Model, own: &BTreeMap<(u32, u64), MaterialIx>) {
        let heat = |material: &mut MaterialIx, t: u64| {
            if let Some(hot) = own.get(&(material.0, t)) {
                *material = *hot;
            }
        };
        let keys = pair_with_temperatures(model.shells.iter().map(|s| s.property.0), &self.shells);
        let new = change_properties(&mut model.shell_properties, &keys, |p, t| {
            if let ShellKind::Homogeneous {
                membrane,
                bending,
                shear,
                coupling,
                ..
            } = &mut p.kind
            {
                let all = [membrane, bending, shear, coupling].into_iter().flatten();
                all.for_each(|m| heat(m, t));
            }
        });
        for (s, property) in model.shells.iter_mut().zip(new) {
            s.property = ShellPropertyIx(property);
        }
        let keys = pair_with_temperatures(model.beams.iter().map(|b| b.property.0), &self.beams);
        let new = change_properties(&mut model.beam_properties, &keys, |p, t| {
            heat(&mut p.material, t);
        });
        for (b, property) in model.beams.iter_mut().zip(new) {
            b.property = BeamPropertyIx(property);
        }
        let keys = pair_with_temperatures(model.solids.iter().map(|s| s.property), &self.solids);
        let new = change_properties(&mut model.solid_properties, &keys, |p, t| {
            heat(&mut p.material, t);
        });
        for (s, property) in model.solids.iter_mut().zip(new) {
            s.property = property;
        }
        for (r, t) in model.rods.iter_mut().zip(&self.rods) {
            t.iter().for_each(|t| heat(&mut r.material, *t));
        }
        for (p, t) in model.shear_panels.iter_mut().zip(&self.panels) {
            t.iter().for_each(|t| heat(&mut p.material, *t));
        }
    }
}

fn pair_with_temperatures(
    properties: impl Iterator<Item = u32>,
    temperatures: &[Option<u64>],
) -> Vec<(u32, Option<u64>)> {
    properties.zip(temperatures.iter().copied()).collect()
}

/// Returns the materials of an element, none for a laminate.
fn materials_of(model: &Model, element: ElementRef) -> Vec<MaterialIx> {
    match element {
        ElementRef::Shell(i) => {
            let property = model.shell_properties.get(model.shells[i].property.us());
            match property.map(|p| &p.kind) {
                Some(ShellKind::Homogeneous {
                    membrane,
                    bending,
                    shear,
                    coupling,
                    ..
                }) => [membrane, bending, shear, coupling]
                    .into_iter()
                    .flatten()
                    .copied()
                    .collect(),
                _ => Vec::new(),
            }
        }
        ElementRef::Beam(i) => {
            let property = model.beam_properties.get(model.beams[i].property.us());
            property.map(|p| p.material).into_iter().collect()
        }
        ElementRef::Rod(i) => vec![model.rods[i].material],
        ElementRef::ShearPanel(i) => vec![model.shear_panels[i].material],
        ElementRef::Solid(i) => {
            let property = model
                .solid_properties
                .get(model.solids[i].property as usize);
            property.map(|p| p.material).into_iter().collect()
        }
        ElementRef::Bush(_) | ElementRef::Joint(_) | ElementRef::Spring(_) => Vec::new(),
    }
}

/// Returns the temperature of an element: its own, else the mean of its grids.
///
/// # Errors
/// The id of a grid without a temperature.
fn mean(
    model: &Model,
    set: &TemperatureSet,
    at: &[Option<f64>],
    element: ElementRef,
) -> Result<f64, u32> {
    match set.elements.get(&model.element_id(element)) {
        Some(ElementTemperature::Plate { mean, .. }) => return Ok(*mean),
        Some(ElementTemperature::Line { ends, .. }) => return Ok(0.5 * (ends[0] + ends[1])),
        None => {}
    }
    let mut list = Vec::new();
    for g in model.element_grids(element) {
        if model.grids.get(g.us()).is_some_and(Grid::is_scalar) {
            continue;
        }
        let id = model.grids.get(g.us()).map_or(0, |g| g.id);
        list.push(at.get(g.us()).copied().flatten().ok_or(id)?);
    }
    // The mean of equal temperatures is exactly that temperature, without rounding.
    match list.first() {
        Some(first) if list.iter().all(|t| t == first) => Ok(*first),
        _ => Ok(list.iter().sum::<f64>() / list.len().max(1) as f64),
    }
}
