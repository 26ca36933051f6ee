//! Shells and their properties.

use super::build::Builder;
use super::fault::FaultKind;
use super::frame::unit;
use super::types::*;
use nastran::cards::{self, MaterialAngle, Pcomp, Pshell};
use nastran::place::{Place, PlacedCard};
use std::collections::{HashMap, HashSet};

/// Default of TS/T: 5/6 as the manual prints it.
const SHEAR_RATIO: f64 = 0.833333;

impl Builder<'_> {
    pub(super) fn shells(&mut self) {
        let mut properties = self.shell_properties();
        let mut ix: HashMap<u32, ShellPropertyIx> = properties
            .iter()
            .enumerate()
            .map(|(i, p)| (p.id, ShellPropertyIx(i as u32)))
            .collect();
        let cards = self.cards;
        let blank_t: HashSet<u32> = cards
            .pshells
            .iter()
            .filter(|p| p.t.is_none())
            .map(|p| p.id)
            .collect();
        let mut out = Vec::with_capacity(cards.shells.len());
        for s in &cards.shells {
            let card = s.shape.card();
            if !self.element(s.id, card, s.at) {
                continue;
            }
            let name = format!("{card} {}", s.id);
            let pid = s.pid.unwrap_or(s.id);
            let property = *ix.entry(pid).or_insert_with(|| {
                let kind = FaultKind::Missing {
                    what: "shell property",
                    id: pid.into(),
                };
                self.faults.push(super::ModelFault {
                    card: name.clone(),
                    field: "PID",
                    at: s.at,
                    kind,
                });
                properties.push(without_stiffness(pid, s.at));
                ShellPropertyIx(properties.len() as u32 - 1)
            });
            if let Some(shell) = self.shell(s, &name, property, &properties, &blank_t) {
                out.push(shell);
            }
        }
        // Properties that the deck does not contain were appended. Sort by id again.
        let mut order: Vec<usize> = (0..properties.len()).collect();
        order.sort_by_key(|i| properties.get(*i).map(|p| p.id));
        let mut new_ix = vec![ShellPropertyIx(0); properties.len()];
        for (new, old) in order.iter().enumerate() {
            if let Some(n) = new_ix.get_mut(*old) {
                *n = ShellPropertyIx(new as u32);
            }
        }
        for s in &mut out {
            s.property = new_ix.get(s.property.us()).copied().unwrap_or(s.property);
        }
        properties.sort_by_key(|p| p.id);
        out.sort_by_key(|s| s.id);
        self.model.shell_properties = properties;
        self.model.shells = out;
    }

    fn shell(
        &mut self,
        s: &PlacedCard<cards::Shell>,
        name: &str,
        property: ShellPropertyIx,
        properties: &[ShellProperty],
        blank_t: &HashSet<u32>,
    ) -> Option<Shell> {
        let pid = s.pid.unwrap_or(s.id);
        let n = s.shape.n_grids();
        let corners = s.shape.n_corners();
        let mut grids = [GridIx(0); 8];
        let mut complete = true;
        for (i, id) in s.grids.iter().enumerate().take(n) {
            if i >= corners && *id == 0 {
                // A missing mid-side grid repeats its first corner.
                grids[i] = grids[(i - corners) % corners];
                continue;
            }
            match self.grid(*id, name, "G", s.at) {
                Some(g) => grids[i] = g,
                None => complete = false,
            }
        }
        if !complete {
            return None;
        }
        let x: Vec<Vec3> = grids.iter().take(corners).map(|g| self.x(*g)).collect();
        let Some(normal) = shell_normal(&x) else {
            self.fault(
                name.to_owned(),
                "G",
                s.at,
                FaultKind::Degenerate { what: "area" },
            );
            return None;
        };
        let p = properties.get(property.us());
        let t = match p.map(|p| &p.kind) {
            Some(ShellKind::Homogeneous { t, .. }) => *t,
            Some(ShellKind::Laminate { plies, .. }) => plies.iter().map(|p| p.t).sum(),
            None => 0.0,
        };
        let mut thickness = [t; 4];
        // The thickness of a laminate is the sum of its plies. Thicknesses of the element have no effect.
        let layered = matches!(p.map(|p| &p.kind), Some(ShellKind::Laminate { .. }));
        let stated = if layered { &[] } else { &s.thickness[..] };
        for (ti, slot) in stated.iter().zip(&mut thickness).take(corners) {
            if let Some(ti) = ti {
                *slot = if s.tflag { ti * t } else { *ti };
                if !(*slot > 0.0) {
                    let kind = FaultKind::NotPositive {
                        what: "thickness",
                        value: *slot,
                    };
                    self.fault(name.to_owned(), "T", s.at, kind);
                }
            } else if blank_t.contains(&pid) {
                let kind = FaultKind::NotPositive {
                    what: "thickness",
                    value: 0.0,
                };
                self.fault(name.to_owned(), "T", s.at, kind);
                break;
            }
        }
        let material_angle_rad = match s.angle {
            MaterialAngle::Theta(deg) => deg.to_radians(),
            MaterialAngle::Mcid(cid) => {
                let frame = self
                    .frame(cid.into(), name, "MCID", s.at)
                    .unwrap_or(FrameIx(0));
                let centre = x.iter().sum::<Vec3>() / x.len() as f64;
                let axes = self
                    .model
                    .frames
                    .get(frame.us())
                    .map_or_else(Mat3::identity, |f| f.axes_at(centre));
                projected_angle(&axes, &x, normal)
            }
        };
        Some(Shell {
            id: s.id,
            shape: s.shape,
            grids,
            property,
            material_angle_rad,
            zoffs: s.zoffs.unwrap_or(0.0),
            thickness,
            at: s.at,
        })
    }

    fn shell_properties(&mut self) -> Vec<ShellProperty> {
        let cards = self.cards;
        let mut out: Vec<ShellProperty> = Vec::new();
        for p in &cards.pshells {
            out.push(self.pshell(p));
        }
        for p in &cards.pcomps {
            out.push(self.pcomp(p));
        }
        out.sort_by_key(|p| (p.id, p.at));
        for pair in out.windows(2) {
            if let [a, b] = pair
                && a.id == b.id
            {
                let kind = FaultKind::Duplicate {
                    what: "shell property id",
                    first: a.at,
                };
                self.faults.push(super::ModelFault {
                    card: format!("shell property {}", b.id),
                    field: "PID",
                    at: b.at,
                    kind,
                });
            }
        }
        out.dedup_by_key(|p| p.id);
        out
    }

    fn pshell(&mut self, p: &PlacedCard<Pshell>) -> ShellProperty {
        let name = format!("PSHELL {}", p.id);
        if let Some(value) = p.t.filter(|t| !(*t > 0.0)) {
            self.fault(
                name.clone(),
                "T",
                p.at,
                FaultKind::NotPositive {
                    what: "thickness",
                    value,
                },
            );
        }
        let t = p.t.unwrap_or(0.0);
        let membrane = p.mid1.and_then(|m| self.material(m, &name, "MID1", p.at));
        let plane_strain = p.mid2 == Some(-1);
        let bending = p
            .mid2
            .and_then(|m| u32::try_from(m).ok())
            .filter(|m| *m > 0);
        let bending = bending.and_then(|m| self.material(m, &name, "MID2", p.at));
        // Transverse shear needs bending, so MID3 has no effect without MID2.
        let shear = p
            .mid3
            .filter(|m| *m > 0)
            .and_then(|m| self.material(m, &name, "MID3", p.at));
        let coupling = p
            .mid4
            .filter(|m| *m > 0)
            .and_then(|m| self.material(m, &name, "MID4", p.at));
        let kind = ShellKind::Homogeneous {
            t,
            membrane,
            bending: if plane_strain { membrane } else { bending },
            plane_strain,
            shear: shear.filter(|_| bending.is_some()),
            coupling,
            bending_ratio: p.bending_ratio.unwrap_or(1.0),
            shear_ratio: p.shear_ratio.unwrap_or(SHEAR_RATIO),
        };
        ShellProperty {
            id: p.id,
            kind,
            nsm: p.nsm.unwrap_or(0.0),
            z: [p.z1, p.z2],
            at: p.at,
        }
    }

    fn pcomp(&mut self, p: &PlacedCard<Pcomp>) -> ShellProperty {
        let name = format!("PCOMP {}", p.id);
        let mut plies = Vec::with_capacity(2 * p.plies.len());
        for ply in &p.plies {
            if !(ply.t > 0.0) {
                let kind = FaultKind::NotPositive {
                    what: "ply thickness",
                    value: ply.t,
                };
                self.fault(name.clone(), "T", p.at, kind);
            }
            if let Some(material) = self.material(ply.mid, &name, "MID", p.at) {
                plies.push(ModelPly {
                    material,
                    t: ply.t,
                    theta_rad: ply.theta_deg.to_radians(),
                });
            }
        }
        if p.symmetric {
            let mirrored: Vec<ModelPly> = plies.iter().rev().copied().collect();
            plies.extend(mirrored);
        }
        let total: f64 = plies.iter().map(|p| p.t).sum();
        let z0 = p.z0.unwrap_or(-total / 2.0);
        let kind = ShellKind::Laminate {
            z0,
            plies,
            lam: p.lam.clone(),
            tref: p.tref,
        };
        ShellProperty {
            id: p.id,
            kind,
            nsm: p.nsm,
            z: [Some(z0), Some(z0 + total)],
            at: p.at,
        }
    }
}

/// Returns a property without stiffness in place of a property that the deck lacks, so that the mesh is complete.
fn without_stiffness(id: u32, at: Place) -> ShellProperty {
    let kind = ShellKind::Homogeneous {
        t: 0.0,
        membrane: None,
        bending: None,
        plane_strain: false,
        shear: None,
        coupling: None,
        bending_ratio: 1.0,
        shear_ratio: SHEAR_RATIO,
    };
    ShellProperty {
        id,
        kind,
        nsm: 0.0,
        z: [None, None],
        at,
    }
}

/// Returns the unit normal of a shell's corners: d13 x d24 of a quadrilateral, side 12 x side 13 of a triangle. `None` without area.
pub(super) fn shell_normal(x: &[Vec3]) -> Option<Vec3> {
    let (u, v) = match x {
        [a, b, c] => (b - a, c - a),
        [a, b, c, d] => (c - a, d - b),
        _ => return None,
    };
    let n = u.cross(&v);
    // Tolerance for the rounding of coordinates far from the origin.
    if n.norm() > 1e-12 * u.norm() * v.norm() {
        unit(n)
    } else {
        None
    }
}

/// Angle from side 1-2 to the first of the axes projected on the element, right-handed about the normal. Where the first axis is normal to the
/// element (a cylinder meshed on its own system), the second is taken.
fn projected_angle(axes: &Mat3, x: &[Vec3], normal: Vec3) -> f64 {
    let (Some(a), Some(b)) = (x.first(), x.get(1)) else {
        return 0.0;
    };
    let flat = |v: Vec3| v - normal * v.dot(&normal);
    let Some(e1) = unit(flat(b - a)) else {
        return 0.0;
    };
    let e2 = normal.cross(&e1);
    // An axis within half a degree of the normal has no meaningful projection.
    const MIN_PROJECTION: f64 = 0.01;
    let first = flat(axes.row(0).transpose());
    let axis = if first.norm() > MIN_PROJECTION {
        first
    } else {
        flat(axes.row(1).transpose())
    };
    axis.dot(&e2).atan2(axis.dot(&e1))
}
