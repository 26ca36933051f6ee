//! The plane-stress law of a shell in its output frame, by the MID1 to MID4 rules of PSHELL.

use super::laminate::{self, Lamination, place_plies};
use super::plane_stress::{
    RIGID_SHEAR, plane_strain_matrix, plane_stress, rotate, rotate_shear, transverse_shear,
};
use super::types::ShellLaw;
use crate::model::{Model, ShellKind, ShellProperty};

impl ShellLaw {
    /// Computes the law of a PSHELL or laminate whose material x axis is at `angle_rad` from the element's output x axis.
    ///
    /// `None` if a material has no plane-stress law.
    pub(crate) fn new(model: &Model, property: &ShellProperty, angle_rad: f64) -> Option<Self> {
        let ShellKind::Homogeneous {
            membrane,
            bending,
            plane_strain,
            shear,
            coupling,
            bending_ratio,
            shear_ratio,
            ..
        } = &property.kind
        else {
            let ShellKind::Laminate { z0, plies, lam, .. } = &property.kind else {
                return None;
            };
            let placed = place_plies(model, plies, *z0, angle_rad)?;
            return laminate::law(&placed, Lamination::parse_lam(lam)?);
        };
        let material = |m: &crate::model::MaterialIx| model.materials.get(m.us());
        let plane = |m: &Option<crate::model::MaterialIx>| match m {
            None => Some(None),
            Some(m) => Some(Some(rotate(&plane_stress(material(m)?)?, angle_rad))),
        };
        let membrane_matrix = match (membrane, plane_strain) {
            (Some(m), true) => Some(plane_strain_matrix(material(m)?)?),
            _ => plane(membrane)?,
        };
        let bending_matrix = plane(bending)?.map(|g| g.map(|row| row.map(|v| v * bending_ratio)));
        let shear_matrix = match (shear, &bending_matrix) {
            (_, None) => None,
            (Some(m), Some(_)) => {
                let g = rotate_shear(&transverse_shear(material(m)?)?, angle_rad);
                Some(g.map(|row| row.map(|v| v * shear_ratio)))
            }
            (None, Some(b)) => Some([[RIGID_SHEAR * b[2][2], 0.0], [0.0, RIGID_SHEAR * b[2][2]]]),
        };
        // Nastran writes strain = e - z chi; the curvature here is -chi.
        let coupling_matrix = plane(coupling)?.map(|g| g.map(|row| row.map(|v| -v)));
        Some(Self {
            membrane: membrane_matrix,
            bending: bending_matrix,
            coupling: coupling_matrix,
            shear: shear_matrix,
        })
    }
}
