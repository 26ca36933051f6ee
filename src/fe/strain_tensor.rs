//! From strain in an element's output frame to the tensor in the basic frame, to other fibres and to a direction.

use super::PlaneStrain;
use crate::model::{Mat3, MaterialKind, Model, ShellKind, ShellProperty, Vec3};

/// A face of a shell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Surface {
    /// Fibre distance Z1.
    Bottom,
    /// Fibre distance Z2.
    Top,
}

impl Surface {
    /// Both surfaces, bottom first.
    pub const BOTH: [Surface; 2] = [Surface::Bottom, Surface::Top];

    /// Returns the name in files and reports.
    pub fn word(self) -> &'static str {
        match self {
            Self::Bottom => "bottom",
            Self::Top => "top",
        }
    }

    /// Returns 0 for bottom and 1 for top.
    pub fn ix(self) -> usize {
        match self {
            Self::Bottom => 0,
            Self::Top => 1,
        }
    }
}

/// Returns the symmetric strain tensor in the basic frame, tensor shear: `E = R' e R`.
///
/// `strain` is exx, eyy, gxy in the frame with rows `axes` (R); gxy is engineering shear and is halved here. `ezz` is the normal strain
/// across the thickness, see [`normal_strain_ratio`]. Shear across the thickness is zero at a free surface.
///
/// # Example
/// ```
/// use strainbridge::fe::strain_tensor::{basic_tensor, principal_in_plane, strain_along};
/// use strainbridge::model::{Mat3, Vec3};
///
/// // The x axis of the element is the y axis of the basic frame.
/// let axes = Mat3::new(0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0);
/// let strain = [300e-6, 100e-6, 200e-6];
/// let tensor = basic_tensor(strain, -50e-6, &axes);
/// assert!((strain_along(&tensor, &Vec3::y()) - 300e-6).abs() < 1e-18);
/// assert!((strain_along(&tensor, &Vec3::x()) - 100e-6).abs() < 1e-18);
/// // Trace and principal strains do not depend on the frame.
/// assert!((tensor.trace() - 350e-6).abs() < 1e-18);
/// let largest = tensor.symmetric_eigenvalues().max();
/// assert!((largest - principal_in_plane(strain)[0]).abs() < 1e-15);
/// ```
pub fn basic_tensor(strain: PlaneStrain, ezz: f64, axes: &Mat3) -> Mat3 {
    let [exx, eyy, gxy] = strain;
    let local = Mat3::new(exx, gxy / 2.0, 0.0, gxy / 2.0, eyy, 0.0, 0.0, 0.0, ezz);
    axes.transpose() * local * axes
}

/// Returns the normal strain along `direction` (any length) of tensor `e`: `n' E n`.
pub fn strain_along(e: &Mat3, direction: &Vec3) -> f64 {
    let n = direction.normalize();
    n.dot(&(e * n))
}

/// Returns the principal strains of exx, eyy, gxy (engineering shear), the larger first: `(exx + eyy)/2 +- sqrt(((exx - eyy)/2)^2 + (gxy/2)^2)`.
pub fn principal_in_plane([exx, eyy, gxy]: PlaneStrain) -> [f64; 2] {
    let (mean, radius) = ((exx + eyy) / 2.0, ((exx - eyy) / 2.0).hypot(gxy / 2.0));
    [mean + radius, mean - radius]
}

/// Returns the principal strain with the largest magnitude, from exx, eyy, gxy.
pub fn largest_in_plane(strain: PlaneStrain) -> f64 {
    let [most, least] = principal_in_plane(strain);
    if most + least < 0.0 { least } else { most }
}

/// Returns the principal strains of xx yy zz xy yz zx (engineering shear), the largest first. They are NaN if a component is NaN.
pub fn principal_strains(strain: &[f64; 6]) -> [f64; 3] {
    if strain.iter().any(|v| !v.is_finite()) {
        return [f64::NAN; 3];
    }
    let [xx, yy, zz, xy, yz, zx] = *strain;
    let (xy, yz, zx) = (xy / 2.0, yz / 2.0, zx / 2.0);
    let tensor = Mat3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz);
    let mut p: [f64; 3] = tensor.symmetric_eigenvalues().into();
    p.sort_by(|a, b| b.total_cmp(a));
    p
}

/// Returns the principal strain with the largest magnitude, from xx yy zz xy yz zx.
pub fn largest_principal(strain: &[f64; 6]) -> f64 {
    let [most, _, least] = principal_strains(strain);
    if most + least < 0.0 { least } else { most }
}

/// Returns the strain at fibre `z` from curvature form: `row1 - z row2`, row2 being MINUS the derivative along z.
pub fn strain_from_curvature(row1: PlaneStrain, row2: PlaneStrain, z: f64) -> PlaneStrain {
    std::array::from_fn(|i| row1[i] - z * row2[i])
}

/// Returns the strain of plane stress in an isotropic material: `exx = (oxx - nu oyy) / e`, `gxy = txy / g`. It contains no thermal strain.
///
/// # Example
/// Equal tension on both axes of steel strains both axes by `o (1 - nu) / e`:
/// ```
/// use strainbridge::fe::strain_tensor::strain_from_stress;
///
/// let (e, nu) = (210e9, 0.3);
/// let g = e / (2.0 * (1.0 + nu));
/// let strain = strain_from_stress([100e6, 100e6, 0.0], e, g, nu);
/// assert!((strain[0] - 100e6 * 0.7 / e).abs() < 1e-15 && strain[0] == strain[1]);
/// // Pure shear `t` is tension `t` and pressure `t` at 45 degrees, so gxy / 2 = t (1 + nu) / e.
/// let shear = strain_from_stress([0.0, 0.0, 50e6], e, g, nu);
/// assert!((shear[2] / 2.0 - 50e6 * 1.3 / e).abs() < 1e-15);
/// ```
pub fn strain_from_stress(stress: PlaneStrain, e: f64, g: f64, nu: f64) -> PlaneStrain {
    let [oxx, oyy, txy] = stress;
    [(oxx - nu * oyy) / e, (oyy - nu * oxx) / e, txy / g]
}

/// `ezz / (exx + eyy)` at a surface of a shell: `-nu / (1 - nu)` of plane stress in the isotropic material there.
///
/// Laminates take the ply at the surface. 0 for plane strain (MID2 -1). `None` for materials whose law along the thickness is not given
/// (MAT2, MAT8, MAT9) and for shells without material.
pub fn normal_strain_ratio(
    model: &Model,
    property: &ShellProperty,
    surface: Surface,
) -> Option<f64> {
    let material = match &property.kind {
        ShellKind::Homogeneous {
            plane_strain: true, ..
        } => return Some(0.0),
        ShellKind::Homogeneous {
            membrane, bending, ..
        } => membrane.or(*bending)?,
        ShellKind::Laminate { plies, .. } => match surface {
            Surface::Bottom => plies.first()?.material,
            Surface::Top => plies.last()?.material,
        },
    };
    match model.materials.get(material.us())?.kind {
        MaterialKind::Isotropic { nu, .. } => Some(-nu / (1.0 - nu)),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
