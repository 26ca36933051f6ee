//! MAT1, MAT2, MAT8, MAT9.

use super::build::Builder;
use super::fault::FaultKind;
use super::isotropic::{isotropic_material, moduli_faults};
use super::types::*;
use nastran::cards::Mat1;

impl Builder<'_> {
    pub(super) fn materials(&mut self) {
        let cards = self.cards;
        let mut out: Vec<Material> = Vec::new();
        for m in &cards.mat1s {
            let name = format!("MAT1 {}", m.id);
            for (field, kind) in moduli_faults(m) {
                self.fault(name.clone(), field, m.at, kind);
            }
            let nothing = Mat1 {
                e: Some(0.0),
                g: Some(0.0),
                nu: Some(0.0),
                ..m.card
            };
            out.extend(isotropic_material(m, m.at).or_else(|| isotropic_material(&nothing, m.at)));
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
