//! The law of a solid in the basic frame.

use crate::linalg::{Matrix3, Matrix6, Vector6};
use crate::model::{Mat3, Material, MaterialKind, Model, Solid, Vec3};
use nastran::cards::SolidShape;

/// stress = G (strain - alpha dT); order xx yy zz xy yz zx, engineering shear, basic frame.
#[derive(Clone, Debug)]
pub(super) struct SolidLaw {
    pub(super) g: Matrix6<f64>,
    pub(super) alpha: Vector6<f64>,
    /// Axes of the material if they differ from the basic axes. Strain is then in these axes.
    pub(super) axes: Option<Mat3>,
}

impl SolidLaw {
    /// Returns the law of a solid at its centre; `Err` states why the solid has no law.
    pub(super) fn new(
        model: &Model,
        solid: &Solid,
        corners: &[Vec3],
    ) -> Result<Self, &'static str> {
        let property = model
            .solid_properties
            .get(solid.property as usize)
            .ok_or("it has no PSOLID")?;
        let material = model
            .materials
            .get(property.material.us())
            .ok_or("its material is missing")?;
        let axes = match property.cordm {
            None | Some(0) => None,
            Some(-1) => Some(element_axes(solid.shape, corners).ok_or(
                "the built-in solver has the element coordinate system of bricks and tetrahedra only",
            )?),
            Some(id) => {
                let frame = u32::try_from(id)
                    .ok()
                    .and_then(|id| model.frames.iter().find(|f| f.id == id))
                    .ok_or("its material coordinate system CORDM is missing")?;
                let centre = corners.iter().sum::<Vec3>() / corners.len() as f64;
                Some(frame.axes_at(centre))
            }
        };
        let (g, alpha) = three_dimensional(material)
            .ok_or("a solid needs a MAT1 with -1 < NU < 0.5, or a MAT9")?;
        let (g, alpha) = match &axes {
            None => (g, alpha),
            Some(axes) => {
                // `t` transforms strain from the basic axes to the material axes.
                let t = strain_rotation(axes);
                let back = strain_rotation(&axes.transpose());
                (t.transpose() * g * t, back * alpha)
            }
        };
        Ok(Self { g, alpha, axes })
    }
}

/// Six-vector of strain (engineering shear) in the axes with these rows: `R e R'` written out.
pub(super) fn strain_rotation(r: &Mat3) -> Matrix6<f64> {
    const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
    Matrix6::from_fn(|i, j| {
        let ((a, b), (c, d)) = (PAIRS[i], PAIRS[j]);
        let both = if c == d {
            r[(a, c)] * r[(b, c)]
        } else {
            // Tensor shear is half of the engineering shear, and occurs twice in the tensor.
            0.5 * (r[(a, c)] * r[(b, d)] + r[(a, d)] * r[(b, c)])
        };
        if a == b { both } else { 2.0 * both }
    })
}

fn three_dimensional(m: &Material) -> Option<(Matrix6<f64>, Vector6<f64>)> {
    Some(match m.kind {
        MaterialKind::Isotropic { e, g, nu, alpha } => {
            let bulk = (1.0 + nu) * (1.0 - 2.0 * nu);
            if !(bulk > 0.0 && e > 0.0 && g > 0.0) {
                return None;
            }
            let c = e / bulk;
            let mut law = Matrix6::zeros();
            for i in 0..3 {
                for j in 0..3 {
                    law[(i, j)] = c * if i == j { 1.0 - nu } else { nu };
                }
                law[(3 + i, 3 + i)] = g;
            }
            (law, Vector6::new(alpha, alpha, alpha, 0.0, 0.0, 0.0))
        }
        MaterialKind::Anisotropic3d { g, alpha } => {
            let mut law = Matrix6::zeros();
            let mut upper = g.iter();
            for i in 0..6 {
                for j in i..6 {
                    let v = *upper.next()?;
                    law[(i, j)] = v;
                    law[(j, i)] = v;
                }
            }
            (law, Vector6::from(alpha))
        }
        _ => return None,
    })
}

/// The orthonormal axes nearest to the three lines that join opposite faces of a brick, or opposite edges of a tetrahedron.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, CHEXA and CTETRA, element coordinate system.
fn element_axes(shape: SolidShape, x: &[Vec3]) -> Option<Mat3> {
    let mean = |list: &[usize]| -> Option<Vec3> {
        let sum: Option<Vec<Vec3>> = list.iter().map(|i| x.get(*i).copied()).collect();
        Some(sum?.iter().sum::<Vec3>() / list.len() as f64)
    };
    let pairs: [(&[usize], &[usize]); 3] = match shape {
        SolidShape::Hexa => [
            (&[0, 3, 4, 7], &[1, 2, 5, 6]),
            (&[0, 1, 4, 5], &[2, 3, 6, 7]),
            (&[0, 1, 2, 3], &[4, 5, 6, 7]),
        ],
        SolidShape::Tetra => [(&[0, 3], &[1, 2]), (&[0, 1], &[2, 3]), (&[0, 2], &[1, 3])],
        _ => return None,
    };
    let mut rows = Matrix3::zeros();
    for (i, (a, b)) in pairs.into_iter().enumerate() {
        let line = (mean(b)? - mean(a)?).try_normalize(0.0)?;
        rows.set_row(i, &line.transpose());
    }
    let svd = rows.svd(true, true);
    let axes = svd.u? * svd.v_t?;
    (axes.determinant() > 0.0).then_some(axes)
}
