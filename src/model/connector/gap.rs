//! CGAP with its PGAP, linear: closed or open as its initial opening has it.

use crate::model::beam::line_axes;
use crate::model::build::Builder;
use crate::model::fault::FaultKind;
use crate::model::types::*;
use nastran::cards::{Gap, Orientation, Pgap};
use nastran::place::PlacedCard;

/// KB over KA where KB is blank.
const OPEN: f64 = 1e-14;

const TWO_GRIDS: &str = "name two grids; they may coincide";

impl Builder<'_> {
    pub(super) fn gaps(&mut self, out: &mut Vec<Joint>) {
        let cards = self.cards;
        let properties = self.by_id(&cards.pgaps, |p: &Pgap| p.id, "PGAP");
        for g in &cards.gaps {
            if !self.element(g.id, "CGAP", g.at) {
                continue;
            }
            let name = format!("CGAP {}", g.id);
            let pid = g.pid.unwrap_or(g.id);
            let Some(p) = properties.get(&pid).copied() else {
                let kind = FaultKind::Missing {
                    what: "PGAP",
                    id: pid.into(),
                };
                self.fault(name, "PID", g.at, kind);
                continue;
            };
            out.extend(self.gap(g, p, &name));
        }
    }

    /// Returns the springs of a gap between the translations of its grids. A closed gap has KA along the axis and KT (MU1 KA if blank) across it. An
    /// open gap has KB along the axis. Rotations have no springs: a grid of solids has no rotational stiffness.
    ///
    /// # Reference
    /// MSC Nastran Quick Reference Guide, CGAP and PGAP: linear solutions use the stiffness of the initial state.
    fn gap(&mut self, g: &PlacedCard<Gap>, p: &PlacedCard<Pgap>, name: &str) -> Option<Joint> {
        let [ga, gb] = g.grids;
        let (a, b) = (
            self.grid(ga, name, "GA", g.at)?,
            self.grid(gb, name, "GB", g.at)?,
        );
        if a == b {
            self.refuse(name, "GB", g.at, "a gap from a grid to itself", TWO_GRIDS);
            return None;
        }
        let pgap = format!("PGAP {}", p.id);
        let stated = [(Some(p.ka), "KA"), (p.kb, "KB"), (p.kt, "KT")];
        for (k, field) in stated {
            self.not_negative("stiffness", k.unwrap_or(0.0), &pgap, field, p.at)?;
        }
        let (xa, xb) = (self.x(a), self.x(b));
        let open = p.u0 > 0.0;
        let (along, across) = if open {
            (p.kb.unwrap_or(OPEN * p.ka), 0.0)
        } else {
            (p.ka, p.kt.unwrap_or(p.mu1 * p.ka))
        };
        let axes = match g.cid {
            Some(cid) => {
                let f = self.frame(cid.into(), name, "CID", g.at)?;
                self.model.frames.get(f.us())?.axes_at(xa)
            }
            None => {
                let v = match g.orientation {
                    Orientation::Vector(v) => self.cd_axes(a).tr_mul(&Vec3::from(v)),
                    Orientation::Grid(g0) => {
                        let g0 = self.grid(g0, name, "GO", g.at)?;
                        self.x(g0) - xa
                    }
                    // The stiffness is equal in all directions across the axis, so any direction will do.
                    Orientation::Blank => {
                        let mut v = Vec3::zeros();
                        v[(xb - xa).iamin()] = 1.0;
                        v
                    }
                };
                match line_axes(xa, xb, v) {
                    Some(axes) => axes,
                    None if (xb - xa).norm() > 0.0 => {
                        self.fault(name.to_owned(), "X1", g.at, FaultKind::Orientation);
                        return None;
                    }
                    None => {
                        self.refuse(
                            name,
                            "CID",
                            g.at,
                            "a gap between coincident grids without CID",
                            "state CID: its x axis is the direction of the gap",
                        );
                        return None;
                    }
                }
            }
        };
        Some(Joint {
            id: g.id,
            card: JointCard::Cgap {
                open,
                preload: p.f0,
            },
            ends: [JointEnd::translations(a, xa), JointEnd::translations(b, xb)],
            axes,
            location: (xa + xb) / 2.0,
            k: [along, across, across, 0.0, 0.0, 0.0],
            placed: Placement::default(),
            at: g.at,
        })
    }
}
