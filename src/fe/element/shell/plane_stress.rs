//! Laws of a material in a plane, and in turned axes.

use crate::model::{Material, MaterialKind};

/// Factor on the elastic shear stiffness that makes a shell without MID3 rigid in transverse shear.
pub(super) const RIGID_SHEAR: f64 = 1e3;

/// Returns G11 G12 G13 / G22 G23 / G33 of plane stress.
pub(super) fn plane_stress(m: &Material) -> Option<[[f64; 3]; 3]> {
    Some(match m.kind {
        MaterialKind::Isotropic { e, g, nu, .. } => {
            let c = e / (1.0 - nu * nu);
            [[c, nu * c, 0.0], [nu * c, c, 0.0], [0.0, 0.0, g]]
        }
        MaterialKind::Anisotropic2d {
            g: [a, b, c, d, e, f],
            ..
        } => [[a, b, c], [b, d, e], [c, e, f]],
        MaterialKind::Orthotropic {
            e1, e2, nu12, g12, ..
        } => {
            let c = 1.0 / (1.0 - nu12 * nu12 * e2 / e1);
            [
                [e1 * c, nu12 * e2 * c, 0.0],
                [nu12 * e2 * c, e2 * c, 0.0],
                [0.0, 0.0, g12],
            ]
        }
        MaterialKind::Anisotropic3d { .. } => return None,
    })
}

/// Returns G11 G12 G13 / G22 G23 / G33 of plane strain.
pub(super) fn plane_strain_matrix(m: &Material) -> Option<[[f64; 3]; 3]> {
    let MaterialKind::Isotropic { e, g, nu, .. } = m.kind else {
        return None;
    };
    let c = e / ((1.0 + nu) * (1.0 - 2.0 * nu));
    Some([
        [c * (1.0 - nu), c * nu, 0.0],
        [c * nu, c * (1.0 - nu), 0.0],
        [0.0, 0.0, g],
    ])
}

/// Returns the transverse shear moduli in material axes.
pub(super) fn transverse_shear(m: &Material) -> Option<[[f64; 2]; 2]> {
    Some(match m.kind {
        MaterialKind::Isotropic { g, .. } => [[g, 0.0], [0.0, g]],
        // A MAT2 used as MID3 gives the transverse shear moduli in G11, G12, G22.
        MaterialKind::Anisotropic2d {
            g: [a, b, _, d, ..],
            ..
        } => [[a, b], [b, d]],
        MaterialKind::Orthotropic { g12, g1z, g2z, .. } => {
            let or_rigid = |g: f64| if g > 0.0 { g } else { RIGID_SHEAR * g12 };
            [[or_rigid(g1z), 0.0], [0.0, or_rigid(g2z)]]
        }
        MaterialKind::Anisotropic3d { .. } => return None,
    })
}

/// Returns `T' G T`, with T the strain transformation to axes turned by `angle`.
pub(super) fn rotate(g: &[[f64; 3]; 3], angle: f64) -> [[f64; 3]; 3] {
    let (s, c) = angle.sin_cos();
    let t = [
        [c * c, s * s, c * s],
        [s * s, c * c, -c * s],
        [-2.0 * c * s, 2.0 * c * s, c * c - s * s],
    ];
    let mut out = [[0.0; 3]; 3];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, v) in row.iter_mut().enumerate() {
            for k in 0..3 {
                for l in 0..3 {
                    *v += t[k][i] * g[k][l] * t[l][j];
                }
            }
        }
    }
    out
}

/// Returns the transverse shear moduli in axes turned by `angle`.
pub(super) fn rotate_shear(g: &[[f64; 2]; 2], angle: f64) -> [[f64; 2]; 2] {
    let (s, c) = angle.sin_cos();
    let t = [[c, s], [-s, c]];
    let mut out = [[0.0; 2]; 2];
    for (i, row) in out.iter_mut().enumerate() {
        for (j, v) in row.iter_mut().enumerate() {
            for k in 0..2 {
                for l in 0..2 {
                    *v += t[k][i] * g[k][l] * t[l][j];
                }
            }
        }
    }
    out
}
