//! Load sets: primitive loads in the basic frame, LOAD combinations written out, temperatures apart.

mod inertia;
mod line;
mod pressure;
mod temperature;

use super::build::Builder;
use super::fault::FaultKind;
use super::frame::unit;
use super::types::*;
use std::collections::BTreeMap;

pub(super) type Sets = BTreeMap<u32, Vec<(f64, Load)>>;

impl Builder<'_> {
    pub(super) fn loads(&mut self) {
        let mut sets: Sets = BTreeMap::new();
        self.nodal(&mut sets);
        self.along_grids(&mut sets);
        self.pressures(&mut sets);
        self.body_forces(&mut sets);
        for card in self.unsupported_loads.iter() {
            if let Some(sid) = card.id {
                let load = Load::Unsupported(card.card.clone(), card.at);
                sets.entry(sid).or_default().push((1.0, load));
            }
        }
        let sums = self.combinations(&sets);
        for (sid, loads) in sums {
            sets.entry(sid).or_default().extend(loads);
        }
        self.model.load_sets = sets
            .into_iter()
            .map(|(sid, loads)| LoadSet { sid, loads })
            .collect();
        self.temperatures();
    }

    fn nodal(&mut self, sets: &mut Sets) {
        let cards = self.cards;
        let forces = cards.forces.iter().map(|f| ("FORCE", f));
        for (card, f) in forces.chain(cards.moments.iter().map(|f| ("MOMENT", f))) {
            let name = format!("{card} {}", f.sid);
            let Some(g) = self.grid(f.grid, &name, "G", f.at) else {
                continue;
            };
            let Some(frame) = self.frame(f.cid.into(), &name, "CID", f.at) else {
                continue;
            };
            let x = self.x(g);
            let v = self
                .model
                .frames
                .get(frame.us())
                .map_or_else(Vec3::zeros, |fr| fr.vector_to_basic(f.n, x))
                * f.scale;
            let load = if card == "FORCE" {
                Load::Force(g, v)
            } else {
                Load::Moment(g, v)
            };
            sets.entry(f.sid).or_default().push((1.0, load));
        }
    }

    /// Loads whose direction grids give, and loads on scalar points.
    fn along_grids(&mut self, sets: &mut Sets) {
        let cards = self.cards;
        for f in &cards.forces_along {
            let moment = if f.is_moment { "MOMENT" } else { "FORCE" };
            let four = f.points[2] != 0;
            let name = format!("{moment}{} {}", if four { 2 } else { 1 }, f.sid);
            let Some(g) = self.grid(f.grid, &name, "G", f.at) else {
                continue;
            };
            let n = if four { 4 } else { 2 };
            let named: Vec<Option<GridIx>> = f
                .points
                .iter()
                .take(n)
                .map(|id| self.grid(*id, &name, "G", f.at))
                .collect();
            let x: Vec<Vec3> = named.into_iter().flatten().map(|g| self.x(g)).collect();
            let direction = match x.as_slice() {
                [a, b] => b - a,
                [a, b, c, d] => (b - a).cross(&(d - c)),
                _ => continue,
            };
            let Some(direction) = unit(direction) else {
                let kind = FaultKind::Degenerate { what: "direction" };
                self.fault(name, "G1", f.at, kind);
                continue;
            };
            let v = direction * f.size;
            let load = if f.is_moment {
                Load::Moment(g, v)
            } else {
                Load::Force(g, v)
            };
            sets.entry(f.sid).or_default().push((1.0, load));
        }
        for s in &cards.sloads {
            let name = format!("SLOAD {}", s.sid);
            let Some(g) = self.grid(s.point, &name, "S", s.at) else {
                continue;
            };
            // SLOAD acts on the first component of a point. For a grid, this is a force along the first axis of its displacement frame.
            let v = self.cd_axes(g).row(0).transpose() * s.load;
            sets.entry(s.sid)
                .or_default()
                .push((1.0, Load::Force(g, v)));
        }
    }

    /// Pressures, line loads and enforced displacements.
    fn pressures(&mut self, sets: &mut Sets) {
        let cards = self.cards;
        for p in &cards.ploads {
            let name = format!("PLOAD {}", p.sid);
            let mut grids = [None; 4];
            for (id, slot) in p.grids.iter().zip(&mut grids) {
                *slot = if *id == 0 {
                    None
                } else {
                    self.grid(*id, &name, "G", p.at)
                };
            }
            if grids.iter().take(3).all(Option::is_some) {
                let load = Load::FacePressure {
                    grids,
                    pressure: [p.pressure; 4],
                    direction: None,
                };
                sets.entry(p.sid).or_default().push((1.0, load));
            }
        }
        for p in &cards.pload2s {
            let name = format!("PLOAD2 {}", p.sid);
            let shells = self.shells_of(&p.elements, &name, p.at);
            let load = Load::ShellPressure {
                shells,
                pressure: [p.pressure; 4],
                direction: None,
            };
            sets.entry(p.sid).or_default().push((1.0, load));
        }
        for p in &cards.pload4s {
            let loads = self.pload4(p);
            sets.entry(p.sid)
                .or_default()
                .extend(loads.into_iter().map(|l| (1.0, l)));
        }
        for p in &cards.pload1s {
            let load = self.pload1(p);
            sets.entry(p.sid)
                .or_default()
                .extend(load.map(|l| (1.0, l)));
        }
        for p in &cards.spcds {
            let name = format!("SPCD {}", p.sid);
            for (id, dofs, value) in &p.terms {
                let Some(grid) = self.grid(*id, &name, "G", p.at) else {
                    continue;
                };
                let load = Load::Enforced {
                    grid,
                    dofs: *dofs,
                    value: *value,
                };
                sets.entry(p.sid).or_default().push((1.0, load));
            }
        }
    }
}
