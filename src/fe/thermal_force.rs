//! Forces of the thermal strain of elements.

use super::element::beam::{Interior, beam_end_forces};
use super::element::rod_thermal_force;
use super::element::shell::shell_thermal_force;
use super::element::solid::solid_thermal_force;
use super::error::FeError;
use super::prepared_model::PreparedModel;
use super::temperature::{Temperatures, beam_expansion};
use rayon::prelude::*;

/// Adds the forces that hold the thermal strain of every element back.
///
/// # Errors
/// Elements that can't be formed.
pub(super) fn thermal_forces(
    prepared: &PreparedModel<'_>,
    t: &Temperatures,
    f: &mut [[f64; 6]],
) -> Result<(), FeError> {
    let model = prepared.model;
    let refused = |r| FeError::Refused(vec![r]);
    let solids: Vec<_> = (0..model.solids.len())
        .into_par_iter()
        .map(|i| {
            let grids = model.solids[i].all_grids();
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
    for i in 0..model.beams.len() {
        let interior = Interior {
            thermal: beam_expansion(model, i, t),
            ..Interior::default()
        };
        for (g, v) in beam_end_forces(model, i, &interior).map_err(refused)? {
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
