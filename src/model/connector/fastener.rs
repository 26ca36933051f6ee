//! CFAST with its PFAST.

use super::patch::Patches;
use super::place::{StatedConnector, Where};
use crate::linalg::Matrix6;
use crate::model::build::Builder;
use crate::model::fault::FaultKind;
use crate::model::types::*;
use nastran::cards::{Fastener, Pfast};
use nastran::place::PlacedCard;
use std::collections::HashSet;

impl Builder<'_> {
    pub(super) fn fasteners(
        &mut self,
        patches: &mut Patches,
        tied: &mut HashSet<GridIx>,
        out: &mut Vec<Joint>,
    ) {
        let cards = self.cards;
        let properties = self.by_id(&cards.pfasts, |p: &Pfast| p.id, "PFAST");
        for c in &cards.fasteners {
            if !self.element(c.id, "CFAST", c.at) {
                continue;
            }
            let name = format!("CFAST {}", c.id);
            let pid = c.pid.unwrap_or(c.id);
            let Some(p) = properties.get(&pid).copied() else {
                let kind = FaultKind::Missing {
                    what: "PFAST",
                    id: pid.into(),
                };
                self.fault(name, "PID", c.at, kind);
                continue;
            };
            out.extend(self.fastener(patches, tied, c, p, &name));
        }
    }

    fn fastener(
        &mut self,
        patches: &mut Patches,
        tied: &mut HashSet<GridIx>,
        c: &PlacedCard<Fastener>,
        p: &PlacedCard<Pfast>,
        name: &str,
    ) -> Option<Joint> {
        if !(p.d > 0.0) {
            let kind = FaultKind::NotPositive {
                what: "diameter",
                value: p.d,
            };
            self.fault(format!("PFAST {}", p.id), "D", p.at, kind);
            return None;
        }
        let mut on = Vec::with_capacity(2);
        for (id, field) in c.patches.into_iter().zip(["IDA", "IDB"]) {
            on.push(match c.kind.as_str() {
                "PROP" => self.named_property(id, (name, field, c.at)),
                "ELEM" => self.named_shell(id, Where::Around, (name, field, c.at)),
                found => {
                    let kind = FaultKind::Word {
                        found: found.to_owned(),
                        expected: "PROP or ELEM",
                    };
                    self.fault(name.to_owned(), "TYPE", c.at, kind);
                    return None;
                }
            });
        }
        let point = self.connector_point((c.gs, c.xs), name, c.at);
        let grids = self.find_piercing_grids(c.grids, name, c.at);
        let on: Option<Vec<Where>> = on.into_iter().collect();
        let stated = StatedConnector {
            name,
            at: c.at,
            id: c.id,
            diameter: p.d,
            point: point?,
            grids: grids?,
            patches: <[Where; 2]>::try_from(on?).ok()?,
        };
        let pierced = self.pierce(patches, &stated)?;
        self.tie_piercing("CFAST", &stated, &pierced.ends, tied);
        let [a, b] = &pierced.ends;
        let location = (a.x + b.x) / 2.0;
        let axes = self.stiffness_axes(p, pierced.axes, location)?;
        if p.mass != 0.0 {
            self.fastener_mass(c, p.mass, &pierced.ends);
        }
        Some(Joint {
            id: c.id,
            card: JointCard::Cfast,
            ends: pierced.ends,
            axes,
            location,
            k: p.k,
            placed: pierced.placed,
            at: c.at,
        })
    }

    /// Returns the axes of the stiffnesses: the element axes, or with MFLAG 1 the axes of MCID. With MFLAG 0, MCID turns the element about its axis.
    /// This matters if KT2 and KT3, or KR2 and KR3, differ, and such an element is refused.
    fn stiffness_axes(&mut self, p: &PlacedCard<Pfast>, own: Mat3, at: Vec3) -> Option<Mat3> {
        let Some(cid) = p.mcid else { return Some(own) };
        let name = format!("PFAST {}", p.id);
        let frame = self.frame(cid.into(), &name, "MCID", p.at)?;
        if p.absolute {
            return self.model.frames.get(frame.us()).map(|f| f.axes_at(at));
        }
        let [_, t2, t3, _, r2, r3] = p.k;
        if t2 != t3 || r2 != r3 {
            self.refuse(
                &name,
                "MCID",
                p.at,
                "MCID with MFLAG 0 and stiffnesses that differ across the axis",
                "give MFLAG 1 with axes of the fastener, or KT2 = KT3 and KR2 = KR3",
            );
            return None;
        }
        Some(own)
    }

    /// Half the mass at each end, shared out as its translation is.
    fn fastener_mass(&mut self, c: &PlacedCard<Fastener>, mass: f64, ends: &[JointEnd; 2]) {
        for (g, m) in ends.iter().flat_map(|e| &e.motion) {
            let share = mass / 2.0 * (m[(0, 0)] + m[(1, 1)] + m[(2, 2)]) / 3.0;
            let mut matrix = Matrix6::zeros();
            matrix.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(share);
            self.model.masses.push(PointMass {
                id: c.id,
                grid: *g,
                matrix,
                offset: Vec3::zeros(),
                at: c.at,
            });
        }
    }
}
