//! CROD, CTUBE, CONROD: axial and torsional stiffness along a line.

use super::ElementMatrix;
use crate::fe::error::Refusal;
use crate::model::{MaterialKind, Model, Rod, RodCard};

fn name(rod: &Rod) -> &'static str {
    match rod.card {
        RodCard::Crod => "CROD",
        RodCard::Ctube => "CTUBE",
        RodCard::Conrod => "CONROD",
    }
}

/// Returns the stiffness of rod `i`, basic frame: EA/L along the axis, GJ/L about the axis.
///
/// # Errors
/// A rod without length, or a material that is not MAT1.
pub(super) fn rod_stiffness(model: &Model, i: usize) -> Result<ElementMatrix, Refusal> {
    let rod = &model.rods[i];
    let refuse = |reason: String, remedy: &str| Refusal {
        card: format!("{} {}", name(rod), rod.id),
        at: rod.at,
        reason,
        remedy: remedy.to_owned(),
    };
    let d = model.grids[rod.grids[1].us()].x - model.grids[rod.grids[0].us()].x;
    let length = d.norm();
    if !(length > 0.0) {
        return Err(refuse(
            format!("length: {length}"),
            "its grids must not coincide",
        ));
    }
    let Some(MaterialKind::Isotropic { e, g, .. }) =
        model.materials.get(rod.material.us()).map(|m| m.kind)
    else {
        return Err(refuse(
            "its material is not a MAT1".to_owned(),
            "rods need a MAT1",
        ));
    };
    let x = d / length;
    let mut k = ElementMatrix::zeros(rod.grids.to_vec());
    for (at, stiffness) in [(0, e * rod.area / length), (3, g * rod.torsion / length)] {
        for (a, sa) in [(at, 1.0), (at + 6, -1.0)] {
            for (b, sb) in [(at, 1.0), (at + 6, -1.0)] {
                for r in 0..3 {
                    for c in 0..3 {
                        k.values[(a + r) * 12 + b + c] = sa * sb * stiffness * x[r] * x[c];
                    }
                }
            }
        }
    }
    Ok(k)
}

/// Returns the mass of rod `i`, before WTMASS.
pub(crate) fn rod_mass(model: &Model, i: usize) -> f64 {
    let rod = &model.rods[i];
    let length = (model.grids[rod.grids[1].us()].x - model.grids[rod.grids[0].us()].x).norm();
    let rho = model
        .materials
        .get(rod.material.us())
        .map_or(0.0, |m| m.rho);
    (rho * rod.area + rod.nsm) * length
}

/// Returns the force on the second grid of rod `i` that is equivalent to a temperature rise, basic frame. The force on the first grid is opposite.
/// Zero for a rod that the stiffness refuses.
pub(crate) fn rod_thermal_force(model: &Model, i: usize, rise: f64) -> crate::model::Vec3 {
    let rod = &model.rods[i];
    let d = model.grids[rod.grids[1].us()].x - model.grids[rod.grids[0].us()].x;
    let material = model.materials.get(rod.material.us());
    let (Some(MaterialKind::Isotropic { e, alpha, .. }), Some(x)) =
        (material.map(|m| m.kind), d.try_normalize(0.0))
    else {
        return crate::model::Vec3::zeros();
    };
    x * (e * rod.area * alpha * rise)
}
