//! Isotropic material of a MAT1. Blank fields of E, G and nu follow from the stated fields.

use super::fault::FaultKind;
use super::types::*;
use nastran::cards::Mat1;
use nastran::place::Place;

/// E, G and nu of a MAT1 whose blank one follows from the other two: E = 2 (1 + nu) G. With E alone G and nu are 0, with G
/// alone E and nu are.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, MAT1, remarks on blank fields.
fn complete_moduli(m: &Mat1) -> Option<(f64, f64, f64)> {
    match (m.e, m.g, m.nu) {
        (Some(e), Some(g), Some(nu)) => Some((e, g, nu)),
        (Some(e), None, Some(nu)) => Some((e, e / (2.0 * (1.0 + nu)), nu)),
        (Some(e), None, None) => Some((e, 0.0, 0.0)),
        (Some(e), Some(g), None) if g != 0.0 => Some((e, g, e / (2.0 * g) - 1.0)),
        (Some(e), Some(g), None) => Some((e, g, 0.0)),
        (None, Some(g), Some(nu)) => Some((2.0 * (1.0 + nu) * g, g, nu)),
        (None, Some(g), None) => Some((0.0, g, 0.0)),
        (None, None, _) => None,
    }
}

/// Returns the material of a MAT1. `None` if E, G and nu do not define it.
pub(super) fn isotropic_material(m: &Mat1, at: Place) -> Option<Material> {
    let (e, g, nu) = complete_moduli(m)?;
    let kind = MaterialKind::Isotropic {
        e,
        g,
        nu,
        alpha: m.alpha,
    };
    Some(Material {
        id: m.id,
        kind,
        rho: m.rho,
        tref: m.tref,
        at,
    })
}

/// Returns the faults in E and nu of a MAT1, each with its field.
pub(super) fn moduli_faults(m: &Mat1) -> Vec<(&'static str, FaultKind)> {
    let Some((_, _, nu)) = complete_moduli(m) else {
        return vec![("E", FaultKind::Underdetermined)];
    };
    let mut out = Vec::new();
    if let Some(value) = m.e.filter(|e| *e < 0.0) {
        let what = "Young's modulus";
        out.push(("E", FaultKind::NotPositive { what, value }));
    }
    // If E, G and nu are all stated, nu may have any value.
    if !(-1.0 < nu && nu <= 0.5) && m.g.is_none() {
        out.push(("NU", FaultKind::Poisson { nu }));
    }
    out
}
