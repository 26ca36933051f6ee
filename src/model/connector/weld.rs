//! CWELD with its PWELD.

use super::patch::{Patch, Patches};
use super::place::{ConnectorGeometry, StatedConnector, Where, between_deg};
use super::{COINCIDENT, connector_axes, tie};
use crate::model::build::Builder;
use crate::model::fault::FaultKind;
use crate::model::types::*;
use nastran::cards::{Pweld, Weld, WeldPatches};
use nastran::place::{Place, PlacedCard};
use std::collections::HashSet;
use std::f64::consts::PI;

/// Share of a solid circle that carries its transverse shear.
const CIRCLE_SHEAR: f64 = 0.9;

/// Fields of the corners of a named patch.
const CORNERS_A: [&str; 4] = ["GA1", "GA2", "GA3", "GA4"];
const CORNERS_B: [&str; 4] = ["GB1", "GB2", "GB3", "GB4"];

const OTHER_FORMAT: &str =
    "use GRIDID, ELEMID, ELPAT, PARTPAT or ALIGN, or a CBUSH between grids of the plates";

impl Builder<'_> {
    pub(super) fn welds(
        &mut self,
        patches: &mut Patches,
        tied: &mut HashSet<GridIx>,
        out: &mut Vec<Joint>,
    ) {
        let cards = self.cards;
        let properties = self.by_id(&cards.pwelds, |p: &Pweld| p.id, "PWELD");
        for w in &cards.welds {
            if !self.element(w.id, "CWELD", w.at) {
                continue;
            }
            let name = format!("CWELD {}", w.id);
            let pid = w.pid.unwrap_or(w.id);
            let Some(p) = properties.get(&pid).copied() else {
                let kind = FaultKind::Missing {
                    what: "PWELD",
                    id: pid.into(),
                };
                self.fault(name, "PID", w.at, kind);
                continue;
            };
            out.extend(self.weld(patches, tied, w, p, &name));
        }
    }

    fn weld(
        &mut self,
        patches: &mut Patches,
        tied: &mut HashSet<GridIx>,
        w: &PlacedCard<Weld>,
        p: &PlacedCard<Pweld>,
        name: &str,
    ) -> Option<Joint> {
        let pweld = format!("PWELD {}", p.id);
        if !(p.d > 0.0) {
            let kind = FaultKind::NotPositive {
                what: "diameter",
                value: p.d,
            };
            self.fault(pweld, "D", p.at, kind);
            return None;
        }
        for (value, field) in p.ld.into_iter().zip(["LDMIN", "LDMAX"]) {
            self.not_negative("bound of length over diameter", value, &pweld, field, p.at)?;
        }
        let material = self.material(p.mid, &pweld, "MID", p.at)?;
        let law = self.model.materials.get(material.us()).map(|m| m.kind);
        let Some(MaterialKind::Isotropic { e, g, .. }) = law else {
            self.refuse(
                &pweld,
                "MID",
                p.at,
                "a weld of other than MAT1",
                "use a MAT1",
            );
            return None;
        };
        let pierced = self.weld_ends(patches, tied, w, p, name)?;
        let [a, b] = &pierced.ends;
        let length = if p.spot && pierced.thickness.iter().any(|t| *t > 0.0) {
            pierced.thickness.iter().sum::<f64>() / 2.0
        } else {
            let [least, most] = p.ld;
            (b.x - a.x)
                .norm()
                .clamp(least * p.d, (most * p.d).max(least * p.d))
        };
        if !(length > 0.0) {
            let kind = FaultKind::Unsupported {
                what: format!("length 0 of CWELD {}", w.id),
                remedy: "give LDMIN above 0, or move the ends apart",
            };
            self.fault(pweld, "LDMIN", p.at, kind);
            return None;
        }
        let location = (a.x + b.x) / 2.0;
        Some(Joint {
            id: w.id,
            card: JointCard::Cweld,
            ends: pierced.ends,
            axes: pierced.axes,
            location,
            k: round_beam(e, g, p.d, length),
            placed: pierced.placed,
            at: w.at,
        })
    }

    fn weld_ends(
        &mut self,
        patches: &mut Patches,
        tied: &mut HashSet<GridIx>,
        w: &PlacedCard<Weld>,
        p: &Pweld,
        name: &str,
    ) -> Option<ConnectorGeometry> {
        let point = self.connector_point((w.gs, w.xs), name, w.at);
        let grids = self.find_piercing_grids(w.grids, name, w.at);
        let (point, grids) = (point?, grids?);
        let mut on_shells = |b: &mut Self, patches_of: [Where; 2]| {
            let stated = StatedConnector {
                name,
                at: w.at,
                id: w.id,
                diameter: p.d,
                point,
                grids,
                patches: patches_of,
            };
            let pierced = b.pierce(patches, &stated)?;
            b.tie_piercing("CWELD", &stated, &pierced.ends, tied);
            Some(pierced)
        };
        match &w.patches {
            WeldPatches::Properties(a, b) => {
                let a = self.named_property(*a, (name, "PIDA", w.at));
                let b = self.named_property(*b, (name, "PIDB", w.at));
                on_shells(self, [a?, b?])
            }
            WeldPatches::ElementPatches(a, b) => {
                let a = self.named_shell(*a, Where::Around, (name, "SHIDA", w.at));
                let b = self.named_shell(*b, Where::Around, (name, "SHIDB", w.at));
                on_shells(self, [a?, b?])
            }
            WeldPatches::Elements(a, Some(b)) => {
                let a = self.named_shell(*a, Where::Shell, (name, "SHIDA", w.at));
                let b = self.named_shell(*b, Where::Shell, (name, "SHIDB", w.at));
                on_shells(self, [a?, b?])
            }
            WeldPatches::Elements(a, None) => {
                let on = self.named_shell(*a, Where::Shell, (name, "SHIDA", w.at))?;
                let Where::Shell(a) = on else { return None };
                let shell = *self.model.shells.get(a)?;
                let patch = Patch::of_shell(&self.model, &shell);
                self.patch_and_grid(patch, point, grids, w, p, name, tied)
            }
            WeldPatches::Grids(lists) => {
                if w.mid_sides {
                    self.refuse(
                        name,
                        "GA5",
                        w.at,
                        "a patch with mid-side grids",
                        "name its three or four corners alone",
                    );
                    return None;
                }
                self.on_grids(lists, point, grids, w, p, name, tied)
            }
            WeldPatches::Align => {
                let [Some(a), Some(b)] = grids else {
                    self.refuse(
                        name,
                        "GA",
                        w.at,
                        "ALIGN without GA and GB",
                        "name both grids",
                    );
                    return None;
                };
                let (xa, xb) = (self.x(a), self.x(b));
                if !((xb - xa).norm() > COINCIDENT * p.d) {
                    let length = (xb - xa).norm();
                    self.fault(
                        name.to_owned(),
                        "GB",
                        w.at,
                        FaultKind::ZeroLength { length },
                    );
                    return None;
                }
                Some(ConnectorGeometry {
                    axes: connector_axes(xa, xb, xb - xa, p.d)?,
                    ends: [JointEnd::grid(a, xa), JointEnd::grid(b, xb)],
                    thickness: [0.0; 2],
                    placed: Placement::default(),
                })
            }
            WeldPatches::Unknown(word) => {
                let what = format!("format `{word}` of a CWELD");
                self.refuse(name, "FORMAT", w.at, what, OTHER_FORMAT);
                None
            }
        }
    }

    /// GRIDID: patches of named grids.
    #[allow(clippy::too_many_arguments, reason = "the parts of one card")]
    fn on_grids(
        &mut self,
        lists: &[Vec<u32>; 2],
        point: Option<Vec3>,
        grids: [Option<GridIx>; 2],
        w: &PlacedCard<Weld>,
        p: &Pweld,
        name: &str,
        tied: &mut HashSet<GridIx>,
    ) -> Option<ConnectorGeometry> {
        let [list_a, list_b] = lists;
        let a = self.patch_of_grids(list_a, &CORNERS_A, (name, w.at));
        if list_b.is_empty() {
            return self.patch_and_grid(Some(a?), point, grids, w, p, name, tied);
        }
        let b = self.patch_of_grids(list_b, &CORNERS_B, (name, w.at));
        let (a, b) = (a?, b?);
        let within = |a: &Patch, b: &Patch| a.grids.iter().all(|g| b.grids.contains(g));
        if within(&a, &b) || within(&b, &a) {
            self.refuse(
                name,
                "GB1",
                w.at,
                "a connector with both ends on one patch",
                "name the corners of the other sheet",
            );
            return None;
        }
        let x = |g: Option<GridIx>| g.map(|g| self.x(g));
        let [ga, gb] = grids.map(x);
        let (Some(pa), Some(pb)) = (ga.or(point).or(gb), gb.or(point).or(ga)) else {
            self.refuse(
                name,
                "GS",
                w.at,
                "a connector without GS and without GA and GB",
                "state the point that is projected onto the patches",
            );
            return None;
        };
        let stated = StatedConnector {
            name,
            at: w.at,
            id: w.id,
            diameter: p.d,
            point,
            grids,
            patches: [Where::Shell(0); 2],
        };
        let (Some(fa), Some(fb)) = (a.foot(pa), b.foot(pb)) else {
            let side = if a.foot(pa).is_none() { 'A' } else { 'B' };
            let kind = FaultKind::OffPatch {
                what: "its point",
                side,
            };
            self.fault(name.to_owned(), "GS", w.at, kind);
            return None;
        };
        let axes = connector_axes(fa.x, fb.x, fa.normal, p.d)?;
        let ends = [tie::by_slopes(&a, &fa)?, tie::by_slopes(&b, &fb)?];
        self.tie_piercing("CWELD", &stated, &ends, tied);
        Some(ConnectorGeometry {
            ends,
            axes,
            thickness: [0.0; 2],
            placed: Placement {
                halvings: 0,
                angle_deg: between_deg(fa.normal, fb.normal),
            },
        })
    }

    /// From a patch to the grid GB (GS where GB is blank).
    #[allow(clippy::too_many_arguments, reason = "the parts of one card")]
    fn patch_and_grid(
        &mut self,
        patch: Option<Patch>,
        point: Option<Vec3>,
        grids: [Option<GridIx>; 2],
        w: &PlacedCard<Weld>,
        p: &Pweld,
        name: &str,
        tied: &mut HashSet<GridIx>,
    ) -> Option<ConnectorGeometry> {
        let far = match (grids[1], w.gs) {
            (Some(g), _) => Some(g),
            (None, Some(gs)) => self.grid(gs, name, "GS", w.at),
            _ => None,
        };
        let (Some(far), Some(patch)) = (far, patch) else {
            self.refuse(
                name,
                "GB",
                w.at,
                "a weld from a patch to nothing",
                "name a second patch, or the grid GB; shells with mid-side grids are no patch",
            );
            return None;
        };
        if patch.grids.contains(&far) {
            self.refuse(
                name,
                "GB",
                w.at,
                "a weld from a patch to one of its corners",
                "name a grid of the other sheet",
            );
            return None;
        }
        let xb = self.x(far);
        let start = grids[0].map(|g| self.x(g)).or(point).unwrap_or(xb);
        let Some(foot) = patch.foot(start) else {
            let kind = FaultKind::OffPatch {
                what: "its point",
                side: 'A',
            };
            self.fault(name.to_owned(), "GS", w.at, kind);
            return None;
        };
        let axes = connector_axes(foot.x, xb, foot.normal, p.d)?;
        let ends = [tie::by_slopes(&patch, &foot)?, JointEnd::grid(far, xb)];
        let stated = StatedConnector {
            name,
            at: w.at,
            id: w.id,
            diameter: p.d,
            point,
            grids: [grids[0], None],
            patches: [Where::Shell(0); 2],
        };
        self.tie_piercing("CWELD", &stated, &ends, tied);
        Some(ConnectorGeometry {
            ends,
            axes,
            thickness: [0.0; 2],
            placed: Placement::default(),
        })
    }

    fn patch_of_grids(
        &mut self,
        list: &[u32],
        fields: &[&'static str; 4],
        (name, at): (&str, Place),
    ) -> Option<Patch> {
        let [field, .., last] = *fields;
        let of = fields.iter().copied().chain(std::iter::repeat(last));
        let grids: Vec<GridIx> = list
            .iter()
            .zip(of)
            .filter_map(|(g, field)| self.grid(*g, name, field, at))
            .collect();
        if grids.len() != list.len() {
            return None;
        }
        if !(3..=4).contains(&grids.len()) {
            let what = format!("a patch of {} grids", grids.len());
            self.refuse(name, field, at, what, "name its three or four corners");
            return None;
        }
        let x = grids.iter().map(|g| self.x(*g)).collect();
        Some(Patch {
            grids,
            x,
            thickness: 0.0,
        })
    }
}

/// Returns the six springs at the middle of a beam of round section. They are EA / L, 12 EI / L^3 (1 + phi) twice, GJ / L and EI / L twice. Here phi
/// = 12 EI / (k G A L^2). With rigid arms of half the length to both ends the springs are equivalent to the beam.
fn round_beam(e: f64, g: f64, d: f64, length: f64) -> [f64; 6] {
    let area = PI * d * d / 4.0;
    let i = PI * d.powi(4) / 64.0;
    let phi = 12.0 * e * i / (CIRCLE_SHEAR * g * area * length * length);
    let shear = 12.0 * e * i / (length.powi(3) * (1.0 + phi));
    let bending = e * i / length;
    [
        e * area / length,
        shear,
        shear,
        2.0 * g * i / length,
        bending,
        bending,
    ]
}
