//! Loads that act on mass: GRAV, ACCEL, ACCEL1, RFORCE, RFORCE1.

use crate::model::build::Builder;
use crate::model::fault::FaultKind;
use crate::model::load::Sets;
use crate::model::types::*;
use nastran::cards::{Accel, Accel1, CoordKind, IdList, Rforce};
use nastran::place::PlacedCard;

impl Builder<'_> {
    /// Adds accelerations and rotations. A positive acceleration gives forces along its direction, as GRAV does.
    ///
    /// # Reference
    /// MSC Nastran Quick Reference Guide, GRAV, ACCEL, ACCEL1, RFORCE, RFORCE1.
    pub(super) fn body_forces(&mut self, sets: &mut Sets) {
        let cards = self.cards;
        for g in &cards.gravs {
            let name = format!("GRAV {}", g.sid);
            let Some(f) = self.frame(g.cid.into(), &name, "CID", g.at) else {
                continue;
            };
            let n = self.rectangular(f, g.n);
            sets.entry(g.sid)
                .or_default()
                .push((1.0, Load::Gravity(n * g.scale)));
        }
        for a in &cards.accels {
            let load = self.accel(a);
            sets.entry(a.sid)
                .or_default()
                .extend(load.map(|l| (1.0, l)));
        }
        for a in &cards.accel1s {
            let load = self.accel1(a);
            sets.entry(a.sid)
                .or_default()
                .extend(load.map(|l| (1.0, l)));
        }
        for r in &cards.rforces {
            let load = self.rforce(r);
            sets.entry(r.sid)
                .or_default()
                .extend(load.map(|l| (1.0, l)));
        }
    }

    /// Returns the basic vector of components along the axes of a system.
    fn rectangular(&self, frame: FrameIx, n: [f64; 3]) -> Vec3 {
        let frame = self.model.frames.get(frame.us());
        frame.map_or_else(Vec3::zeros, |f| f.axes.tr_mul(&Vec3::from(n)))
    }

    /// Returns the load of an ACCEL. The factor is linear between locations and constant beyond the first and last one. Without DIR it is 1.
    fn accel(&mut self, card: &PlacedCard<Accel>) -> Option<Load> {
        let name = format!("ACCEL {}", card.sid);
        let f = self.frame(card.cid.into(), &name, "CID", card.at)?;
        let frame = *self.model.frames.get(f.us())?;
        let a = self.rectangular(f, card.n);
        let Some(axis) = ["X", "Y", "Z"].iter().position(|d| *d == card.direction) else {
            return Some(Load::Gravity(a));
        };
        if frame.kind != CoordKind::Rectangular {
            return Some(Load::Unsupported(
                "ACCEL along an axis of a curved system".to_owned(),
                card.at,
            ));
        }
        if card.table.is_empty() {
            let kind = FaultKind::Unsupported {
                what: "a DIR without locations and factors".to_owned(),
                remedy: "give LOC1 and VAL1, or leave DIR blank for an even acceleration",
            };
            self.fault(name, "LOC1", card.at, kind);
            return None;
        }
        let mut table = card.table.clone();
        table.sort_by(|a, b| a.0.total_cmp(&b.0));
        let along = frame.axes.row(axis).transpose();
        let grids = (0..).map(GridIx).zip(&self.model.grids);
        let grids = grids.filter(|(_, g)| !g.is_scalar()).map(|(ix, g)| {
            (
                ix,
                interpolate_table(&table, along.dot(&(g.x - frame.origin))),
            )
        });
        Some(Load::Acceleration {
            a,
            grids: grids.collect(),
        })
    }

    /// Returns the load of an ACCEL1. A range means the existing grids in it.
    fn accel1(&mut self, card: &PlacedCard<Accel1>) -> Option<Load> {
        let name = format!("ACCEL1 {}", card.sid);
        let f = self.frame(card.cid.into(), &name, "CID", card.at)?;
        let a = self.rectangular(f, card.n) * card.scale;
        let mut grids: Vec<GridIx> = Vec::new();
        for list in &card.grids {
            match list {
                IdList::Each(ids) => {
                    let found = ids
                        .iter()
                        .map(|id| self.grid(*id, &name, "GRIDID", card.at));
                    grids.extend(found.collect::<Vec<_>>().into_iter().flatten());
                }
                IdList::Thru(first, last) => {
                    let all = (0..).map(GridIx).zip(&self.model.grids);
                    let inside = all.filter(|(_, g)| (*first..=*last).contains(&g.id));
                    grids.extend(inside.map(|(ix, _)| ix));
                }
            }
        }
        grids.sort_unstable();
        grids.dedup();
        grids.retain(|g| !self.is_scalar(*g));
        Some(Load::Acceleration {
            a,
            grids: grids.into_iter().map(|g| (g, 1.0)).collect(),
        })
    }

    /// Returns the load of an RFORCE or RFORCE1. Only steady rotation of the whole structure is carried.
    ///
    /// The forces act at the true location of the mass. METHOD 1 does so for lumped mass, METHOD 2 for mass at grids alone. METHOD 2 omits the
    /// acceleration of mass at an offset from its grid, so it is refused with such mass. The default of RFORCE1 is METHOD 2.
    fn rforce(&mut self, card: &PlacedCard<Rforce>) -> Option<Load> {
        let word = if card.is_rforce1 { "RFORCE1" } else { "RFORCE" };
        let name = format!("{word} {}", card.sid);
        let f = self.frame(card.cid.into(), &name, "CID", card.at)?;
        let centre = match card.grid {
            0 => Vec3::zeros(),
            id => {
                let g = self.grid(id, &name, "G", card.at)?;
                self.x(g)
            }
        };
        let default = if card.is_rforce1 { 2 } else { 1 };
        let method = card.method.unwrap_or(default);
        if ![1, 2].contains(&method) {
            let kind = FaultKind::Word {
                found: method.to_string(),
                expected: "1 or 2",
            };
            self.fault(name, "METHOD", card.at, kind);
            return None;
        }
        let more = match (card.acceleration != 0.0, card.part != 0) {
            (true, _) => Some("with RACC"),
            (false, true) if card.is_rforce1 => Some("with GROUPID"),
            (false, true) => Some("with IDRF"),
            (false, false) if method == 2 && self.has_mass_off_grids() => {
                Some("with METHOD 2 and mass at an offset from its grid")
            }
            (false, false) => None,
        };
        if let Some(more) = more {
            return Some(Load::Unsupported(format!("{word} {more}"), card.at));
        }
        Some(Load::Spin {
            centre,
            omega: self.rectangular(f, card.r) * (card.speed * std::f64::consts::TAU),
        })
    }
}

impl Builder<'_> {
    /// Returns whether a point mass has an offset or a rotational inertia, or a shell, bar or beam has an offset.
    fn has_mass_off_grids(&self) -> bool {
        let model = &self.model;
        let is_off = |m: &PointMass| {
            let entries = m.matrix.iter().enumerate();
            let mut rotations = entries.filter(|(k, _)| k % 6 >= 3 || k / 6 >= 3);
            rotations.any(|(_, v)| *v != 0.0)
        };
        let ends = model.beams.iter().flat_map(|b| b.offsets);
        model.masses.iter().any(is_off)
            || model.shells.iter().any(|s| s.zoffs != 0.0)
            || ends.into_iter().any(|o| o != Vec3::zeros())
    }
}

/// Returns the value of an ascending table: linear between its points, constant beyond the first and last.
fn interpolate_table(table: &[(f64, f64)], x: f64) -> f64 {
    let after = table.partition_point(|p| p.0 < x);
    match (
        after.checked_sub(1).and_then(|i| table.get(i)),
        table.get(after),
    ) {
        (Some((x0, y0)), Some((x1, y1))) if x1 > x0 => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (_, Some((_, y))) | (Some((_, y)), None) => *y,
        (None, None) => 0.0,
    }
}
