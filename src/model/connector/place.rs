//! The ends of connectors on shells: a point, projected, tied by slopes or by auxiliary points.

use super::patch::{Foot, Patch, Patches};
use super::{connector_axes, tie};
use crate::model::build::Builder;
use crate::model::fault::FaultKind;
use crate::model::types::*;
use nastran::place::Place;
use std::collections::HashSet;
use std::f64::consts::PI;

/// Largest number of halvings of the diameter until the auxiliary points find the patch (NREDIA of SWLDPRM, which allows up to 4).
const HALVINGS: u8 = 4;

/// Shells that an end of a connector may pierce.
#[derive(Clone, Copy, Debug)]
pub(super) enum Where {
    /// A shell, by index.
    Shell(usize),
    /// A shell, or shells that share a grid with it.
    Around(usize),
    /// Shells of a property, by id.
    Property(u32),
}

/// A connector on shells, as its card states it.
pub(super) struct StatedConnector<'a> {
    pub(super) name: &'a str,
    pub(super) at: Place,
    pub(super) id: u32,
    pub(super) diameter: f64,
    /// GS or XS, YS, ZS.
    pub(super) point: Option<Vec3>,
    /// GA, GB.
    pub(super) grids: [Option<GridIx>; 2],
    pub(super) patches: [Where; 2],
}

/// Both ends and the axes of a connector, the thicknesses of its plates, and the way in which it was placed.
pub(super) struct ConnectorGeometry {
    pub(super) ends: [JointEnd; 2],
    pub(super) axes: Mat3,
    pub(super) thickness: [f64; 2],
    pub(super) placed: Placement,
}

/// Returns the angle between two sheets of these normals, degrees, whichever way the normals point.
pub(super) fn between_deg(a: Vec3, b: Vec3) -> f64 {
    a.dot(&b).abs().min(1.0).acos().to_degrees()
}

impl Builder<'_> {
    /// Returns the shell that a field names, to be pierced with its neighbours or alone (`on`); adds a fault if it is missing.
    pub(super) fn named_shell(
        &mut self,
        id: u32,
        on: impl Fn(usize) -> Where,
        (name, field, at): (&str, &'static str, Place),
    ) -> Option<Where> {
        let found = self.model.shell_ix(id).map(|s| on(s.us()));
        if found.is_none() {
            let (what, id) = ("shell", id.into());
            self.fault(name.to_owned(), field, at, FaultKind::Missing { what, id });
        }
        found
    }

    /// Returns the shells of the property that a field names; adds a fault if it is missing.
    pub(super) fn named_property(
        &mut self,
        id: u32,
        (name, field, at): (&str, &'static str, Place),
    ) -> Option<Where> {
        if self.model.shell_properties.iter().any(|p| p.id == id) {
            return Some(Where::Property(id));
        }
        let (what, id) = ("shell property", id.into());
        self.fault(name.to_owned(), field, at, FaultKind::Missing { what, id });
        None
    }

    /// Returns the point of GS, or of XS, YS, ZS, if one is stated. `None`, with a fault, if GS names a missing grid.
    pub(super) fn connector_point(
        &mut self,
        (gs, xs): (Option<u32>, Option<[f64; 3]>),
        name: &str,
        at: Place,
    ) -> Option<Option<Vec3>> {
        match (gs, xs) {
            (Some(gs), _) => {
                let g = self.grid(gs, name, "GS", at)?;
                self.points.push(g);
                Some(Some(self.x(g)))
            }
            (None, xs) => Some(xs.map(Vec3::from)),
        }
    }

    /// Returns the grids GA and GB if they are stated. `None`, with a fault for each missing grid, if a grid is missing.
    pub(super) fn find_piercing_grids(
        &mut self,
        grids: [Option<u32>; 2],
        name: &str,
        at: Place,
    ) -> Option<[Option<GridIx>; 2]> {
        let found = grids.map(|g| g.and_then(|g| self.grid_ix.get(&g).copied()));
        for ((id, found), field) in grids.iter().zip(found).zip(["GA", "GB"]) {
            if let (Some(id), None) = (id, found) {
                self.grid(*id, name, field, at);
            }
        }
        let whole = grids
            .iter()
            .zip(found)
            .all(|(g, f)| g.is_none() || f.is_some());
        whole.then_some(found)
    }

    fn foot(&self, patches: &mut Patches, on: Where, p: Vec3) -> Option<(Patch, Foot)> {
        match on {
            Where::Shell(i) => {
                let patch = Patch::of_shell(&self.model, self.model.shells.get(i)?)?;
                let foot = patch.foot(p)?;
                Some((patch, foot))
            }
            Where::Around(i) => patches.find_foot_near_shell(&self.model, i, p),
            Where::Property(pid) => patches.on_property(&self.model, pid, p),
        }
    }

    /// Projects the connector and ties each end. It adds a fault if a point finds no patch.
    pub(super) fn pierce(
        &mut self,
        patches: &mut Patches,
        stated: &StatedConnector<'_>,
    ) -> Option<ConnectorGeometry> {
        let mut feet = Vec::with_capacity(2);
        for side in 0..2 {
            let Some(p) = self.start(stated, side) else {
                self.refuse(
                    stated.name,
                    "GS",
                    stated.at,
                    "a connector without GS, GA and GB, or XS, YS, ZS",
                    "state the point that is projected onto the patches",
                );
                return None;
            };
            let on = stated.patches.get(side).copied()?;
            let Some(found) = self.foot(patches, on, p) else {
                self.off_patch(stated, side, "its point");
                return None;
            };
            feet.push(found);
        }
        let [(patch_a, a), (patch_b, b)] = <[(Patch, Foot); 2]>::try_from(feet).ok()?;
        if patch_a.grids == patch_b.grids {
            self.refuse(
                stated.name,
                "GS",
                stated.at,
                "a connector with both ends on one shell",
                "name the shell of each side (ELEM, ELPAT), or give the sheets different properties",
            );
            return None;
        }
        let axes = connector_axes(a.x, b.x, a.normal, stated.diameter)?;
        let thickness = [patch_a.thickness, patch_b.thickness];
        let mut placed = Placement {
            halvings: 0,
            angle_deg: between_deg(a.normal, b.normal),
        };
        let mut ends = Vec::with_capacity(2);
        for (side, (patch, foot)) in [(patch_a, a), (patch_b, b)].into_iter().enumerate() {
            let on = stated.patches.get(side).copied()?;
            let end = match on {
                Where::Shell(_) => tie::by_slopes(&patch, &foot).map(|end| (end, 0)),
                _ => self.by_auxiliary_points(patches, on, &foot, &axes, stated.diameter),
            };
            let Some((end, halvings)) = end else {
                self.off_patch(stated, side, "an auxiliary point about it");
                return None;
            };
            placed.halvings = placed.halvings.max(halvings);
            ends.push(end);
        }
        let ends = <[JointEnd; 2]>::try_from(ends).ok()?;
        Some(ConnectorGeometry {
            ends,
            axes,
            thickness,
            placed,
        })
    }

    /// The point to project onto a side: its own piercing grid, or the common one, or the other side's grid.
    fn start(&self, stated: &StatedConnector<'_>, side: usize) -> Option<Vec3> {
        let grid = |i: usize| stated.grids.get(i).copied().flatten().map(|g| self.x(g));
        grid(side).or(stated.point).or_else(|| grid(1 - side))
    }

    fn off_patch(&mut self, stated: &StatedConnector<'_>, side: usize, what: &'static str) {
        let kind = FaultKind::OffPatch {
            what,
            side: if side == 0 { 'A' } else { 'B' },
        };
        self.fault(stated.name.to_owned(), "GS", stated.at, kind);
    }

    /// Attaches a weld by four auxiliary points around its foot, each projected onto the patch. The points are the corners of a square with the area
    /// of the weld across its axis. Also returns how often the diameter was halved until all points were on the patch.
    fn by_auxiliary_points(
        &self,
        patches: &mut Patches,
        on: Where,
        foot: &Foot,
        axes: &Mat3,
        diameter: f64,
    ) -> Option<(JointEnd, u8)> {
        let (y, z) = (axes.row(1).transpose(), axes.row(2).transpose());
        let mut half = PI.sqrt() / 4.0 * diameter;
        for halvings in 0..=HALVINGS {
            let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let points: Option<Vec<(Patch, Foot)>> = corners
                .iter()
                .map(|(a, b)| self.foot(patches, on, foot.x + y * (a * half) + z * (b * half)))
                .collect();
            if let Some(points) = points {
                return tie::by_points(foot.x, &points).map(|end| (end, halvings));
            }
            half /= 2.0;
        }
        None
    }

    /// Makes the piercing grids follow their ends. A grid that is a grid of its patch, or that already follows a patch, is not changed.
    pub(super) fn tie_piercing(
        &mut self,
        card: &'static str,
        stated: &StatedConnector<'_>,
        ends: &[JointEnd; 2],
        tied: &mut HashSet<GridIx>,
    ) {
        let mut equations = Vec::new();
        for (g, end) in stated.grids.iter().zip(ends) {
            let Some(g) = *g else { continue };
            if end.motion.iter().any(|m| m.0 == g) || !tied.insert(g) {
                continue;
            }
            equations.extend(tie::equations(&self.model, g, end));
        }
        if !equations.is_empty() {
            self.model.rigids.push(RigidElement {
                id: stated.id,
                kind: RigidKind::Equations { card, equations },
                at: stated.at,
            });
        }
    }
}
