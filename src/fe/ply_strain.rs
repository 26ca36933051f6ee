//! Strain of the plies of a laminate.

use super::PlaneStrain;
use super::element::shell::{in_axes_at, material_angle};
use crate::model::{Model, ShellIx, ShellKind};

/// Returns the strain in the middle of every ply from the bottom up, in ply axes: along the fibres, across, engineering shear.
///
/// `surfaces` contains the strain of the shell at Z1 and Z2 in its output frame. Between them strain is linear. The result is empty if the shell is
/// not a laminate.
pub fn ply_strains(model: &Model, shell: ShellIx, surfaces: &[PlaneStrain; 2]) -> Vec<PlaneStrain> {
    let Some(shell) = model.shells.get(shell.us()) else {
        return Vec::new();
    };
    let property = model.shell_properties.get(shell.property.us());
    let (Some(ShellKind::Laminate { z0, plies, .. }), Some(angle)) =
        (property.map(|p| &p.kind), material_angle(model, shell))
    else {
        return Vec::new();
    };
    let total: f64 = plies.iter().map(|p| p.t).sum();
    let mut bottom = *z0;
    plies
        .iter()
        .map(|ply| {
            let middle = (bottom + ply.t / 2.0 - z0) / total;
            bottom += ply.t;
            let here: PlaneStrain = std::array::from_fn(|c| {
                surfaces[0][c] + middle * (surfaces[1][c] - surfaces[0][c])
            });
            in_axes_at(here, angle + ply.theta_rad)
        })
        .collect()
}
