//! Thermal expansion of shells: stress resultants of a held shell and free strain at its surfaces.

use super::laminate::{Lamination, place_plies};
use super::plane_stress::{plane_stress, rotate};
use super::types::{Expansion, Heat};
use crate::model::{Material, MaterialKind, Model, ShellKind, ShellProperty};

impl Heat {
    /// Returns the membrane force and moment per length of the held shell at the temperature rise `rise`.
    pub(crate) fn resultants(&self, rise: f64) -> ([f64; 3], [f64; 3]) {
        let x = &self.expansion;
        let sum = |p: &[[f64; 3]; 2]| -> [f64; 3] {
            std::array::from_fn(|i| rise * p[0][i] + self.gradient * p[1][i])
        };
        (sum(&x.force), sum(&x.moment))
    }

    /// Returns the free strain at the heights `z` of the surfaces. `rise` is the temperature rise of the reference plane.
    pub(crate) fn free_strain(&self, rise: f64, z: [f64; 2]) -> [[f64; 3]; 2] {
        std::array::from_fn(|s| {
            self.expansion.surface[s].map(|a| a * (rise + self.gradient * z[s]))
        })
    }
}

/// Expansion coefficients exx, eyy, gxy in material axes; `None` for laws that are not of plane stress.
fn coefficients(m: &Material) -> Option<[f64; 3]> {
    match m.kind {
        MaterialKind::Isotropic { alpha, .. } => Some([alpha, alpha, 0.0]),
        MaterialKind::Anisotropic2d { alpha, .. } => Some(alpha),
        MaterialKind::Orthotropic { alpha, .. } => Some([alpha[0], alpha[1], 0.0]),
        MaterialKind::Anisotropic3d { .. } => None,
    }
}

/// Transforms a strain from axes at `angle` from x to the axes x and y.
pub(super) fn turn_strain([e1, e2, g]: [f64; 3], angle: f64) -> [f64; 3] {
    let (s, c) = angle.sin_cos();
    [
        c * c * e1 + s * s * e2 - c * s * g,
        s * s * e1 + c * c * e2 + c * s * g,
        2.0 * c * s * (e1 - e2) + (c * c - s * s) * g,
    ]
}

/// Returns the strain in axes at `angle` (radians) from x, from the strain in x and y.
pub(crate) fn in_axes_at(strain: [f64; 3], angle: f64) -> [f64; 3] {
    turn_strain(strain, -angle)
}

fn times(q: &[[f64; 3]; 3], e: &[f64; 3]) -> [f64; 3] {
    q.map(|row| row.iter().zip(e).map(|(a, b)| a * b).sum())
}

/// Computes the thermal expansion of a property whose material x axis is at `angle_rad` from the output x axis; `None` without a law.
pub(crate) fn expansion(
    model: &Model,
    property: &ShellProperty,
    t: f64,
    angle_rad: f64,
) -> Option<Expansion> {
    let mut out = Expansion::default();
    let add = |to: &mut [f64; 3], v: [f64; 3], by: f64| {
        to.iter_mut().zip(v).for_each(|(t, v)| *t += v * by);
    };
    match &property.kind {
        ShellKind::Homogeneous {
            membrane,
            bending,
            bending_ratio,
            ..
        } => {
            let material =
                |m: &Option<crate::model::MaterialIx>| m.and_then(|m| model.materials.get(m.us()));
            let stress = |m: &Material| -> Option<[f64; 3]> {
                let alpha = turn_strain(coefficients(m)?, angle_rad);
                Some(times(&rotate(&plane_stress(m)?, angle_rad), &alpha))
            };
            if let Some(m) = material(membrane) {
                add(&mut out.force[0], stress(m)?, t);
                out.tref = m.tref;
            }
            if let Some(m) = material(bending) {
                let inertia = bending_ratio * t * t * t / 12.0;
                add(&mut out.moment[1], stress(m)?, inertia);
                if membrane.is_none() {
                    out.tref = m.tref;
                }
            }
            let surface = material(membrane).or(material(bending))?;
            out.surface = [turn_strain(coefficients(surface)?, angle_rad); 2];
        }
        ShellKind::Laminate {
            z0,
            plies,
            lam,
            tref,
            ..
        } => {
            let places = place_plies(model, plies, *z0, angle_rad)?;
            let alphas: Option<Vec<[f64; 3]>> = plies
                .iter()
                .map(|p| {
                    let m = model.materials.get(p.material.us())?;
                    Some(turn_strain(coefficients(m)?, angle_rad + p.theta_rad))
                })
                .collect();
            let alphas = alphas?;
            for (p, alpha) in places.iter().zip(&alphas) {
                let stress = times(&p.q, alpha);
                let moment = |k: i32| (p.z[1].powi(k) - p.z[0].powi(k)) / f64::from(k);
                add(&mut out.force[0], stress, moment(1));
                add(&mut out.force[1], stress, moment(2));
                add(&mut out.moment[0], stress, moment(2));
                add(&mut out.moment[1], stress, moment(3));
            }
            match Lamination::parse_lam(lam)? {
                Lamination::Full => {}
                Lamination::Membrane => out.moment = [[0.0; 3]; 2],
                Lamination::Bending => out.force = [[0.0; 3]; 2],
                Lamination::Smeared => {
                    // No coupling: a temperature gradient bends the laminate like a homogeneous plate of the mean law.
                    let inertia = t * t / 12.0;
                    out.moment = [[0.0; 3], out.force[0].map(|f| f * inertia)];
                    out.force[1] = [0.0; 3];
                }
            }
            out.surface = [*alphas.first()?, *alphas.last()?];
            let first = model.materials.get(plies.first()?.material.us())?;
            out.tref = tref.unwrap_or(first.tref);
        }
    }
    Some(out)
}
