//! Solids and shear panels.

use super::build::Builder;
use super::fault::FaultKind;
use super::shell::shell_normal;
use super::types::*;
use std::collections::HashMap;

/// Words that fields 5 to 8 of a PSOLID allow.
///
/// # Reference
/// PSOLID in the quick reference guides of MSC Nastran, Simcenter Nastran and OptiStruct.
const OPTIONS: [(&str, &[&str]); 4] = [
    ("IN", &["BUBBLE", "TWO", "THREE", "0", "1", "2", "3"]),
    ("STRESS", &["GRID", "GAUSS", "GAUS", "BOTH", "0", "1"]),
    (
        "ISOP",
        &[
            "REDUCED", "FULL", "MODPLAST", "URI", "SRI", "AURI", "0", "1", "2", "3",
        ],
    ),
    (
        "FCTN",
        &[
            "SMECH", "PFLUID", "FFLUID", "FLUID", "PORO", "SPORO", "FRIGID",
        ],
    ),
];

impl Builder<'_> {
    pub(super) fn solids(&mut self) {
        let cards = self.cards;
        let by_id = self.by_id(&cards.psolids, |p| p.id, "PSOLID");
        let mut ids: Vec<u32> = by_id.keys().copied().collect();
        ids.sort_unstable();
        let mut ix: HashMap<u32, u32> = HashMap::new();
        for id in ids {
            let Some(p) = by_id.get(&id) else { continue };
            let Some(material) = self.material(p.mid, &format!("PSOLID {id}"), "MID", p.at) else {
                continue;
            };
            ix.insert(id, self.model.solid_properties.len() as u32);
            let options = p.options.clone();
            for (found, (field, known)) in options.iter().zip(OPTIONS) {
                let expected = known.join(", ");
                // The geometry tables of an OP2 file contain only the first four letters of a word.
                let is = |w: &str, k: &str| k == w || w.len() == 4 && k.starts_with(w);
                let unknown = |w: &String| !known.iter().any(|k| is(w, k));
                if let Some(found) = found.clone().filter(unknown) {
                    let kind = FaultKind::Unsupported {
                        what: format!("`{found}` (not one of {expected})"),
                        remedy: "write a word of the quick reference guide",
                    };
                    self.fault(format!("PSOLID {id}"), field, p.at, kind);
                }
            }
            self.model.solid_properties.push(SolidProperty {
                id,
                material,
                cordm: p.cordm,
                options,
                at: p.at,
            });
        }
        let mut out = Vec::with_capacity(cards.solids.len());
        for s in &cards.solids {
            let card = s.shape.card();
            if !self.element(s.id, card, s.at) {
                continue;
            }
            let name = format!("{card} {}", s.id);
            let pid = s.pid.unwrap_or(s.id);
            if !by_id.contains_key(&pid) {
                self.fault(
                    name.clone(),
                    "PID",
                    s.at,
                    FaultKind::Missing {
                        what: "PSOLID",
                        id: pid.into(),
                    },
                );
            }
            let mut grids = [None; 20];
            let mut complete = true;
            for (i, (id, slot)) in s.grids.iter().zip(&mut grids).enumerate() {
                if *id == 0 {
                    complete &= i >= s.shape.n_corners();
                    continue;
                }
                *slot = self.grid(*id, &name, "G", s.at);
                complete &= slot.is_some();
            }
            if let (Some(property), true) = (ix.get(&pid).copied(), complete) {
                out.push(Solid {
                    id: s.id,
                    shape: s.shape,
                    grids,
                    property,
                    at: s.at,
                });
            }
        }
        out.sort_by_key(|s| s.id);
        self.model.solids = out;
    }

    pub(super) fn shear_panels(&mut self) {
        let cards = self.cards;
        let properties = self.by_id(&cards.pshears, |p| p.id, "PSHEAR");
        let mut out = Vec::new();
        for s in &cards.shear_panels {
            if !self.element(s.id, "CSHEAR", s.at) {
                continue;
            }
            let name = format!("CSHEAR {}", s.id);
            let pid = s.pid.unwrap_or(s.id);
            let Some(p) = properties.get(&pid).copied() else {
                self.fault(
                    name,
                    "PID",
                    s.at,
                    FaultKind::Missing {
                        what: "PSHEAR",
                        id: pid.into(),
                    },
                );
                continue;
            };
            if !(p.t > 0.0) {
                self.fault(
                    format!("PSHEAR {pid}"),
                    "T",
                    p.at,
                    FaultKind::NotPositive {
                        what: "thickness",
                        value: p.t,
                    },
                );
            }
            let found = s.grids.map(|id| self.grid(id, &name, "G", s.at));
            let [Some(a), Some(b), Some(c), Some(d)] = found else {
                continue;
            };
            let grids = [a, b, c, d];
            if shell_normal(&grids.map(|g| self.x(g))).is_none() {
                self.fault(name, "G", s.at, FaultKind::Degenerate { what: "area" });
                continue;
            }
            let Some(material) = self.material(p.mid, &name, "MID", s.at) else {
                continue;
            };
            out.push(ShearPanel {
                id: s.id,
                grids,
                material,
                t: p.t,
                nsm: p.nsm,
                f1: p.f1,
                f2: p.f2,
                at: s.at,
            });
        }
        out.sort_by_key(|s| s.id);
        self.model.shear_panels = out;
    }
}
