//! MAT1, MAT2, MAT8, MAT9.

use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use nastran::cards::Mat1;

/// E, G and nu of a MAT1 whose blank one follows from the other two: E = 2 (1 + nu) G. With E alone G and nu are 0, with G
/// alone E and nu are.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, MAT1, remarks on blank fields.
fn isotropic(m: &Mat1) -> Option<(f64, f64, f64)> {
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

impl Builder<'_> {
    pub(super) fn materials(&mut self) {
        let cards = self.cards;
        let mut out: Vec<Material> = Vec::new();
        for m in &cards.mat1s {
            let name = format!("MAT1 {}", m.id);
            let (e, g, nu) = match isotropic(m) {
                Some(v) => v,
                None => {
                    self.fault(name.clone(), "E", m.at, FaultKind::Underdetermined);
                    (0.0, 0.0, 0.0)
                }
            };
            if m.e.is_some_and(|e| e < 0.0) {
                self.fault(
                    name.clone(),
                    "E",
                    m.at,
                    FaultKind::NotPositive {
                        what: "Young's modulus",
                        value: e,
                    },
                );
            }
            // A stated nu is what the card says; with E and G both stated too it may be anything that the solver accepts.
            if !(-1.0 < nu && nu <= 0.5) && m.g.is_none() {
                self.fault(name, "NU", m.at, FaultKind::Poisson { nu });
            }
            let kind = MaterialKind::Isotropic {
                e,
                g,
                nu,
                alpha: m.alpha,
            };
            out.push(Material {
                id: m.id,
                kind,
                rho: m.rho,
                tref: m.tref,
                at: m.at,
            });
        }
        for m in &cards.mat2s {
            let kind = MaterialKind::Anisotropic2d {
                g: m.g,
                alpha: m.alpha,
            };
            out.push(Material {
                id: m.id,
                kind,
                rho: m.rho,
                tref: m.tref,
                at: m.at,
            });
        }
        for m in &cards.mat8s {
            let kind = MaterialKind::Orthotropic {
                e1: m.e1,
                e2: m.e2,
                nu12: m.nu12,
                g12: m.g12,
                g1z: m.g1z.unwrap_or(0.0),
                g2z: m.g2z.unwrap_or(0.0),
                alpha: m.alpha,
            };
            out.push(Material {
                id: m.id,
                kind,
                rho: m.rho,
                tref: m.tref,
                at: m.at,
            });
        }
        for m in &cards.mat9s {
            let kind = MaterialKind::Anisotropic3d {
                g: m.g,
                alpha: m.alpha,
            };
            out.push(Material {
                id: m.id,
                kind,
                rho: m.rho,
                tref: m.tref,
                at: m.at,
            });
        }
        out.sort_by_key(|m| (m.id, m.at));
        for pair in out.windows(2) {
            if let [a, b] = pair
                && a.id == b.id
            {
                let kind = FaultKind::Duplicate {
                    what: "material id",
                    first: a.at,
                };
                self.fault(format!("material {}", b.id), "MID", b.at, kind);
            }
        }
        out.dedup_by_key(|m| m.id);
        self.material_ix = out
            .iter()
            .enumerate()
            .map(|(i, m)| (m.id, MaterialIx(i as u32)))
            .collect();
        self.model.materials = out;
    }
}
