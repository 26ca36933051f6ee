//! Rods, bushes, springs.

use super::beam::line_axes;
use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use nastran::cards::{self, Orientation, Pbush, Prod, Ptube, SpringStiffness};
use nastran::place::{Place, PlacedCard};
use std::collections::HashMap;
use std::f64::consts::PI;

impl<'a> Builder<'a> {
    /// Returns the cards by id. A second card with the same id is a fault.
    pub(super) fn by_id<T>(
        &mut self,
        list: &'a [PlacedCard<T>],
        id: impl Fn(&T) -> u32,
        card: &str,
    ) -> HashMap<u32, &'a PlacedCard<T>> {
        let mut out: HashMap<u32, &'a PlacedCard<T>> = HashMap::with_capacity(list.len());
        for p in list {
            let key = id(&p.card);
            match out.get(&key).map(|f| f.at) {
                None => {
                    out.insert(key, p);
                }
                Some(first) => {
                    let kind = FaultKind::Duplicate {
                        what: "property id",
                        first,
                    };
                    self.fault(format!("{card} {key}"), "PID", p.at, kind);
                }
            }
        }
        out
    }

    pub(super) fn rods(&mut self) {
        let cards = self.cards;
        let prods = self.by_id(&cards.prods, |p: &Prod| p.id, "PROD");
        let ptubes = self.by_id(&cards.ptubes, |p: &Ptube| p.id, "PTUBE");
        self.rod_sections();
        let mut out = Vec::new();
        for r in &cards.rods {
            let (card, kind) = if r.is_tube {
                ("CTUBE", RodCard::Ctube)
            } else {
                ("CROD", RodCard::Crod)
            };
            if !self.element(r.id, card, r.at) {
                continue;
            }
            let name = format!("{card} {}", r.id);
            let pid = r.pid.unwrap_or(r.id);
            let section = if r.is_tube {
                ptubes.get(&pid).map(|p| tube(p))
            } else {
                prods.get(&pid).map(|p| (p.mid, p.area, p.j, p.c, p.nsm))
            };
            let Some((mid, area, torsion, c, nsm)) = section else {
                let what = if r.is_tube { "PTUBE" } else { "PROD" };
                self.fault(
                    name,
                    "PID",
                    r.at,
                    FaultKind::Missing {
                        what,
                        id: pid.into(),
                    },
                );
                continue;
            };
            let Some(grids) = self.ends(r.grids, &name, r.at) else {
                continue;
            };
            let Some(material) = self.material(mid, &name, "MID", r.at) else {
                continue;
            };
            out.push(Rod {
                id: r.id,
                card: kind,
                grids,
                material,
                area,
                torsion,
                c,
                nsm,
                at: r.at,
            });
        }
        for r in &cards.conrods {
            if !self.element(r.id, "CONROD", r.at) {
                continue;
            }
            let name = format!("CONROD {}", r.id);
            let Some(grids) = self.ends(r.grids, &name, r.at) else {
                continue;
            };
            let Some(material) = self.material(r.mid, &name, "MID", r.at) else {
                continue;
            };
            let (area, torsion, c, nsm) = (r.area, r.torsion, r.c, r.nsm);
            out.push(Rod {
                id: r.id,
                card: RodCard::Conrod,
                grids,
                material,
                area,
                torsion,
                c,
                nsm,
                at: r.at,
            });
        }
        out.sort_by_key(|r| r.id);
        self.model.rods = out;
    }

    /// Adds a fault for each rod section without axial and torsional stiffness.
    fn rod_sections(&mut self) {
        let cards = self.cards;
        let rods = cards.prods.iter();
        let rods = rods.map(|p| (format!("PROD {}", p.id), "A", p.at, [p.area, p.j]));
        let tubes = cards.ptubes.iter().map(|p| {
            let (_, area, torsion, ..) = tube(p);
            (format!("PTUBE {}", p.id), "OD", p.at, [area, torsion])
        });
        let conrods = cards.conrods.iter();
        let conrods = conrods.map(|r| (format!("CONROD {}", r.id), "A", r.at, [r.area, r.torsion]));
        for (name, field, at, section) in rods.chain(tubes).chain(conrods) {
            if section == [0.0; 2] {
                let kind = FaultKind::Unsupported {
                    what: "a rod whose A and J are both 0".into(),
                    remedy: "state one of them above 0, or delete the rod",
                };
                self.fault(name, field, at, kind);
            }
        }
    }

    /// Two grids that are apart.
    fn ends(&mut self, grids: [u32; 2], name: &str, at: Place) -> Option<[GridIx; 2]> {
        let a = self.grid(grids[0], name, "G1", at);
        let b = self.grid(grids[1], name, "G2", at);
        let (a, b) = (a?, b?);
        let length = (self.x(b) - self.x(a)).norm();
        if !(length > 0.0) {
            self.fault(name.to_owned(), "G2", at, FaultKind::ZeroLength { length });
            return None;
        }
        Some([a, b])
    }

    pub(super) fn springs(&mut self) {
        let cards = self.cards;
        let pelas = self.by_id(&cards.pelas, |p| p.id, "PELAS");
        let mut out = Vec::new();
        for s in &cards.springs {
            let card = match s.stiffness {
                SpringStiffness::Property(_) => "CELAS1",
                SpringStiffness::Direct { .. } => "CELAS2",
            };
            if !self.element(s.id, card, s.at) {
                continue;
            }
            let name = format!("{card} {}", s.id);
            let (k, stress_coefficient) = match s.stiffness {
                SpringStiffness::Direct {
                    k,
                    stress_coefficient,
                    ..
                } => (k, stress_coefficient),
                SpringStiffness::Property(pid) => {
                    let pid = pid.unwrap_or(s.id);
                    match pelas.get(&pid) {
                        Some(p) => (p.k, p.s),
                        None => {
                            self.fault(
                                name,
                                "PID",
                                s.at,
                                FaultKind::Missing {
                                    what: "PELAS",
                                    id: pid.into(),
                                },
                            );
                            continue;
                        }
                    }
                }
            };
            if let Some(ends) = self.ends_of(&s.ends, &name, s.at) {
                out.push(Spring {
                    id: s.id,
                    k,
                    stress_coefficient,
                    ends,
                    at: s.at,
                });
            }
        }
        out.sort_by_key(|s| s.id);
        self.model.springs = out;
    }

    /// Returns the dofs (0-based) that a scalar element joins. An invalid dof gives a fault and `None`.
    pub(super) fn ends_of(
        &mut self,
        stated: &[Option<(u32, u8)>; 2],
        name: &str,
        at: Place,
    ) -> Option<[Option<(GridIx, u8)>; 2]> {
        let mut ends = [None; 2];
        let mut complete = true;
        for (end, slot) in stated.iter().zip(&mut ends) {
            let Some((grid, component)) = *end else {
                continue;
            };
            match (self.grid(grid, name, "G", at), component) {
                (Some(g), c @ 1..=6) => *slot = Some((g, c - 1)),
                (Some(g), 0) if self.is_scalar(g) => *slot = Some((g, 0)),
                (Some(_), c) => {
                    let kind = FaultKind::Word {
                        found: c.to_string(),
                        expected: "a component 1 to 6 of a grid",
                    };
                    self.fault(name.to_owned(), "C", at, kind);
                    complete = false;
                }
                (None, _) => complete = false,
            }
        }
        complete.then_some(ends)
    }

    pub(super) fn bushes(&mut self) {
        let cards = self.cards;
        let properties = self.by_id(&cards.pbushes, |p: &Pbush| p.id, "PBUSH");
        let mut out = Vec::new();
        for b in &cards.bushes {
            if !self.element(b.id, "CBUSH", b.at) {
                continue;
            }
            let name = format!("CBUSH {}", b.id);
            let pid = b.pid.unwrap_or(b.id);
            let Some(p) = properties.get(&pid).copied() else {
                self.fault(
                    name,
                    "PID",
                    b.at,
                    FaultKind::Missing {
                        what: "PBUSH",
                        id: pid.into(),
                    },
                );
                continue;
            };
            out.extend(self.bush(b, p, &name));
        }
        out.sort_by_key(|b: &Bush| b.id);
        self.model.bushes = out;
    }

    /// Returns the bush with its frame. The frame is CID if stated. Otherwise it follows from the line and the orientation. Without an orientation it
    /// follows from the line alone, which is sufficient for stiffness along and about the line only.
    ///
    /// Between coincident grids, or to ground, a bush without CID has the basic frame. The frame has no effect if the stiffness is equal in all
    /// directions; otherwise the bush records that its frame is assumed. An orientation vector without a line is a fault.
    ///
    /// # Reference
    /// MSC Nastran Quick Reference Guide, CBUSH, remarks 3 to 7.
    fn bush(&mut self, b: &PlacedCard<cards::Bush>, p: &Pbush, name: &str) -> Option<Bush> {
        let ga = self.grid(b.grids.0, name, "GA", b.at)?;
        let gb = match b.grids.1 {
            Some(g) => Some(self.grid(g, name, "GB", b.at)?),
            None => None,
        };
        if gb == Some(ga) {
            let kind = FaultKind::Unsupported {
                what: "a bush from a grid to itself".into(),
                remedy: "name two grids, which may coincide, or leave GB blank for ground",
            };
            self.fault(name.to_owned(), "GB", b.at, kind);
            return None;
        }
        let xa = self.x(ga);
        let xb = gb.map_or(xa, |g| self.x(g));
        let length = (xb - xa).norm();
        let apart = length > 1e-9 * xa.norm().max(xb.norm());
        let v = match b.orientation {
            Orientation::Vector(v) => Some(self.cd_axes(ga).tr_mul(&Vec3::from(v))),
            Orientation::Grid(g0) => {
                let g0 = self.grid(g0, name, "GO", b.at)?;
                Some(self.x(g0) - xa)
            }
            Orientation::Blank => None,
        };
        let mut frame_assumed = false;
        let axes = match (b.cid, v) {
            (Some(cid), _) => {
                let f = self.frame(cid.into(), name, "CID", b.at)?;
                self.model.frames.get(f.us())?.axes_at(xa)
            }
            (None, Some(v)) if apart => match line_axes(xa, xb, v) {
                Some(axes) => axes,
                None => {
                    self.fault(name.to_owned(), "X1", b.at, FaultKind::Orientation);
                    return None;
                }
            },
            (None, None) if apart => {
                let across = [1, 2, 4, 5].iter().any(|i| {
                    p.k.get(*i).is_some_and(|k| *k != 0.0) || p.rigid.get(*i) == Some(&true)
                });
                if across {
                    self.fault(name.to_owned(), "X1", b.at, FaultKind::Orientation);
                    return None;
                }
                any_axes(xb - xa)?
            }
            (None, stated) => {
                let [k1, k2, k3, k4, k5, k6] = p.k;
                let [r1, r2, r3, r4, r5, r6] = p.rigid;
                let alike = k1 == k2 && k2 == k3 && k4 == k5 && k5 == k6;
                let rigid_alike = r1 == r2 && r2 == r3 && r4 == r5 && r5 == r6;
                frame_assumed = !(alike && rigid_alike);
                if frame_assumed && stated.is_some() {
                    let kind = FaultKind::Unsupported {
                        what: "a bush between coincident grids, or to ground, with a vector and without CID".into(),
                        remedy: "state CID (0 for the basic frame)",
                    };
                    self.fault(name.to_owned(), "CID", b.at, kind);
                    return None;
                }
                Mat3::identity()
            }
        };
        let location = match b.ocid {
            Some(cid) if cid >= 0 => {
                let f = self.frame(cid.into(), name, "OCID", b.at)?;
                xa + self.model.frames.get(f.us())?.vector_to_basic(b.offset, xa)
            }
            _ => xa + b.s.unwrap_or(0.5) * (xb - xa),
        };
        Some(Bush {
            id: b.id,
            grids: (ga, gb),
            axes,
            location,
            k: p.k,
            rigid: p.rigid,
            frame_assumed,
            recovery: p.recovery,
            at: b.at,
        })
    }
}

/// Material, area, torsion constant, torsional stress coefficient and non-structural mass of a tube; a tapered one counts with
/// its mean outer diameter.
fn tube(p: &Ptube) -> (u32, f64, f64, f64, f64) {
    let od = (p.od + p.od2.unwrap_or(p.od)) / 2.0;
    let id = match p.t {
        Some(t) if t > 0.0 => (od - 2.0 * t).max(0.0),
        _ => 0.0,
    };
    let area = PI / 4.0 * (od * od - id * id);
    let torsion = PI / 32.0 * (od.powi(4) - id.powi(4));
    (p.mid, area, torsion, od / 2.0, p.nsm)
}

/// Axes with x along `line`; y across it, wherever.
fn any_axes(line: Vec3) -> Option<Mat3> {
    let smallest = line.iamin();
    let mut v = Vec3::zeros();
    v[smallest] = 1.0;
    line_axes(Vec3::zeros(), line, v)
}
