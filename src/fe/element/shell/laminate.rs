//! Laminates (PCOMP, PCOMPG) by classical theory: stiffness A, B, D about the reference plane, transverse shear from the equilibrium
//! of the plies.
//!
//! # Reference
//! Jones, Mechanics of Composite Materials, chapter 4; MSC Nastran Linear Static Analysis User's Guide, composites: transverse shear
//! flexibility by the energy of the shear stress that balances bending.

use super::plane_stress::{RIGID_SHEAR, plane_stress, rotate, rotate_shear, transverse_shear};
use super::types::ShellLaw;
use crate::model::{Model, ModelPly};

/// Three-point Gauss rule on 0..1: exact for the square of a parabola.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Parts of a laminate's stiffness that LAM selects.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Lamination {
    /// All parts.
    Full,
    /// MEM: membrane only.
    Membrane,
    /// BEND: bending only.
    Bending,
    /// SMEAR: plies smeared over the thickness, no coupling.
    Smeared,
}

impl Lamination {
    /// Returns the LAM option in its written form. `None` for unsupported options (SMCORE ..).
    pub(crate) fn parse_lam(lam: &str) -> Option<Self> {
        match lam {
            "" | "SYM" => Some(Self::Full),
            "MEM" | "SYMEM" => Some(Self::Membrane),
            "BEND" | "SYBEND" => Some(Self::Bending),
            "SMEAR" | "SYSMEAR" => Some(Self::Smeared),
            _ => None,
        }
    }
}

/// A ply in place: plane-stress law in the element's output frame between two heights.
pub(super) struct LaminatePly {
    pub(super) q: [[f64; 3]; 3],
    /// Transverse shear moduli along the output axes; 0 is rigid.
    shear: [f64; 2],
    pub(super) z: [f64; 2],
}

/// Returns the plies of a laminate whose material x axis is at `angle_rad` from the output x axis. `None` if a material has no plane-stress law.
pub(super) fn place_plies(
    model: &Model,
    plies: &[ModelPly],
    z0: f64,
    angle_rad: f64,
) -> Option<Vec<LaminatePly>> {
    let mut z = z0;
    plies
        .iter()
        .map(|ply| {
            let material = model.materials.get(ply.material.us())?;
            let angle = angle_rad + ply.theta_rad;
            let moduli = transverse_shear(material)?;
            let turned = rotate_shear(&moduli, angle);
            let bottom = z;
            z += ply.t;
            Some(LaminatePly {
                q: rotate(&plane_stress(material)?, angle),
                shear: [turned[0][0], turned[1][1]],
                z: [bottom, z],
            })
        })
        .collect()
}

/// Returns the law of a laminate, with the scaling of a shell law.
pub(super) fn law(plies: &[LaminatePly], lamination: Lamination) -> Option<ShellLaw> {
    let (bottom, top) = (plies.first()?.z[0], plies.last()?.z[1]);
    let t = top - bottom;
    if !(t > 0.0) {
        return None;
    }
    let moment = |power: i32| {
        let mut sum = [[0.0; 3]; 3];
        for p in plies {
            let k = f64::from(power + 1);
            let share = (p.z[1].powi(power + 1) - p.z[0].powi(power + 1)) / k;
            for (row, q) in sum.iter_mut().zip(&p.q) {
                row.iter_mut().zip(q).for_each(|(s, q)| *s += q * share);
            }
        }
        sum
    };
    let scaled = |m: [[f64; 3]; 3], by: f64| m.map(|row| row.map(|v| v / by));
    let a = scaled(moment(0), t);
    let (b, d) = (
        scaled(moment(1), t * t),
        scaled(moment(2), t * t * t / 12.0),
    );
    let shear = [0, 1].map(|i| transverse_shear_stiffness(plies, i) / t);
    let shear = Some([[shear[0], 0.0], [0.0, shear[1]]]);
    let coupled = b.iter().flatten().any(|v| v.abs() > 1e-12 * a[0][0].abs());
    Some(match lamination {
        Lamination::Full => ShellLaw {
            membrane: Some(a),
            bending: Some(d),
            coupling: coupled.then_some(b),
            shear,
        },
        Lamination::Membrane => ShellLaw {
            membrane: Some(a),
            bending: None,
            coupling: None,
            shear: None,
        },
        Lamination::Bending => ShellLaw {
            membrane: None,
            bending: Some(d),
            coupling: None,
            shear,
        },
        Lamination::Smeared => ShellLaw {
            membrane: Some(a),
            bending: Some(a),
            coupling: None,
            shear,
        },
    })
}

/// Computes the transverse shear stiffness along axis `i`: (EI)^2 over the integral of g^2 / G. g is the first moment about the neutral axis of the
/// stiffness beyond a height.
fn transverse_shear_stiffness(plies: &[LaminatePly], i: usize) -> f64 {
    let e = |p: &LaminatePly| p.q[i][i];
    let (mut area, mut first) = (0.0, 0.0);
    for p in plies {
        area += e(p) * (p.z[1] - p.z[0]);
        first += e(p) * (p.z[1].powi(2) - p.z[0].powi(2)) / 2.0;
    }
    let neutral = if area > 0.0 { first / area } else { 0.0 };
    let (mut inertia, mut flexibility, mut g) = (0.0, 0.0, 0.0);
    let mut rigid = 0.0_f64;
    for p in plies {
        let [low, high] = p.z.map(|z| z - neutral);
        inertia += e(p) * (high.powi(3) - low.powi(3)) / 3.0;
        rigid = rigid.max(p.q[2][2]);
        if p.shear[i] > 0.0 {
            for (s, w) in GAUSS {
                let z = low + s * (high - low);
                let g = g + e(p) * (z * z - low * low) / 2.0;
                flexibility += w * (high - low) * g * g / p.shear[i];
            }
        }
        g += e(p) * (high * high - low * low) / 2.0;
    }
    let thickness = plies.iter().map(|p| p.z[1] - p.z[0]).sum::<f64>();
    let stiffest = RIGID_SHEAR * rigid * thickness;
    if flexibility > 0.0 {
        (inertia * inertia / flexibility).min(stiffest)
    } else {
        stiffest
    }
}
