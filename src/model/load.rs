//! Load sets: primitive loads in the basic frame, LOAD combinations written out, temperatures apart.

use super::build::Builder;
use super::face::solid_face;
use super::fault::FaultKind;
use super::frame::unit;
use super::types::*;
use nastran::cards::{IdList, Pload1, Pload4};
use nastran::place::{Place, Placed};
use std::collections::{BTreeMap, HashMap};

pub(super) type Sets = BTreeMap<u32, Vec<(f64, Load)>>;

impl Builder<'_> {
    pub(super) fn loads(&mut self) {
        let mut sets: Sets = BTreeMap::new();
        self.nodal(&mut sets);
        self.along_grids(&mut sets);
        self.pressures(&mut sets);
        self.body_forces(&mut sets);
        for card in self.uncarried_loads.iter() {
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
            // The first component, of the displacement frame where it is a grid.
            let v = self.cd_axes(g).row(0).transpose() * s.load;
            sets.entry(s.sid)
                .or_default()
                .push((1.0, Load::Force(g, v)));
        }
    }

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

    /// A load along a bar or beam in its own axes.
    ///
    /// # Reference
    /// MSC Nastran Quick Reference Guide, PLOAD1: LE and LEPR give places as lengths, FR and FRPR as shares; the PR scales count
    /// intensity per length projected across the direction of the load.
    fn pload1(&mut self, p: &Placed<Pload1>) -> Option<Load> {
        let name = format!("PLOAD1 {}", p.sid);
        let Some(beam) = self.model.beam_ix(p.element) else {
            let kind = FaultKind::Missing {
                what: "CBAR or CBEAM",
                id: p.element.into(),
            };
            self.fault(name, "EID", p.at, kind);
            return None;
        };
        let b = *self.model.beams.get(beam.us())?;
        let end = |i: usize| -> Option<Vec3> { Some(self.x(*b.grids.get(i)?) + b.offsets.get(i)?) };
        let length = (end(1)? - end(0)?).norm();
        let mut basic = Vec3::zeros();
        let axis = match p.kind[1] {
            b'X' => 0,
            b'Y' => 1,
            _ => 2,
        };
        basic[axis] = 1.0;
        let along_element = p.kind[2] == b'E';
        let direction = if along_element { basic } else { b.axes * basic };
        let projected = p.scale[2] == b'P';
        let factor = if projected && !along_element {
            (1.0 - direction.x * direction.x).max(0.0).sqrt()
        } else {
            1.0
        };
        let share = |x: f64| if p.scale[0] == b'L' { x / length } else { x };
        let from = share(p.x1);
        let to = p.x2.map_or(from, share);
        let values = if from == to {
            [p.p1, 0.0]
        } else {
            [p.p1, p.p2.unwrap_or(p.p1)].map(|v| v * factor)
        };
        // Against the rounding of lengths given to a few digits.
        const BEYOND: f64 = 1e-6;
        let inside = |x: f64| (-BEYOND..=1.0 + BEYOND).contains(&x);
        if !(inside(from) && inside(to) && from <= to) {
            let kind = FaultKind::Word {
                found: format!("X1 {}, X2 {:?}", p.x1, p.x2),
                expected: "places on the element, the first no farther than the second",
            };
            self.fault(name, "X1", p.at, kind);
            return None;
        }
        let vectors = values.map(|v| direction * v);
        let none = [Vec3::zeros(); 2];
        let (force, moment) = if p.kind[0] == b'F' {
            (vectors, none)
        } else {
            (none, vectors)
        };
        Some(Load::Line {
            beam,
            span: [from.clamp(0.0, 1.0), to.clamp(0.0, 1.0)],
            force,
            moment,
        })
    }

    /// The shells of a list: each named one must exist, of a range those that do.
    fn shells_of(&mut self, ids: &IdList, name: &str, at: Place) -> Vec<ShellIx> {
        match ids {
            IdList::Thru(a, b) => {
                let from = self.model.shells.partition_point(|s| s.id < *a);
                let to = self.model.shells.partition_point(|s| s.id <= *b);
                (from..to).map(|i| ShellIx(i as u32)).collect()
            }
            IdList::Each(list) => {
                let mut out = Vec::with_capacity(list.len());
                for id in list {
                    match self.model.shell_ix(*id) {
                        Some(ix) => out.push(ix),
                        None => self.fault(
                            name.to_owned(),
                            "EID",
                            at,
                            FaultKind::Missing {
                                what: "shell",
                                id: (*id).into(),
                            },
                        ),
                    }
                }
                out
            }
        }
    }

    fn pload4(&mut self, p: &Placed<Pload4>) -> Vec<Load> {
        let name = format!("PLOAD4 {}", p.sid);
        if !(p.sorl.is_empty() || p.sorl == "SURF") {
            return vec![Load::Unsupported("PLOAD4 with SORL".into(), p.at)];
        }
        let p1 = p.pressure[0].unwrap_or(0.0);
        let pressure = p.pressure.map(|x| x.unwrap_or(p1));
        let direction = match p.direction {
            Some((cid, n)) if n != [0.0; 3] => {
                let Some(f) = self.frame(cid.into(), &name, "CID", p.at) else {
                    return Vec::new();
                };
                let Some(frame) = self.model.frames.get(f.us()) else {
                    return Vec::new();
                };
                if frame.kind != nastran::cards::CoordKind::Rectangular {
                    return vec![Load::Unsupported(
                        "PLOAD4 in a cylindrical or spherical system".into(),
                        p.at,
                    )];
                }
                unit(frame.vector_to_basic(n, Vec3::zeros()))
            }
            _ => None,
        };
        let mut shells = Vec::new();
        let mut out = Vec::new();
        let ids: Vec<u32> = match &p.elements {
            IdList::Each(ids) => ids.clone(),
            IdList::Thru(a, b) => {
                let (shells, solids) = (&self.model.shells, &self.model.solids);
                let range = |from: usize, to: usize| from..to.max(from);
                let shells_in = range(
                    shells.partition_point(|s| s.id < *a),
                    shells.partition_point(|s| s.id <= *b),
                );
                let solids_in = range(
                    solids.partition_point(|s| s.id < *a),
                    solids.partition_point(|s| s.id <= *b),
                );
                let shell_ids = shells.get(shells_in).unwrap_or(&[]).iter().map(|s| s.id);
                shell_ids
                    .chain(solids.get(solids_in).unwrap_or(&[]).iter().map(|s| s.id))
                    .collect()
            }
        };
        for id in ids {
            if let Some(ix) = self.model.shell_ix(id) {
                shells.push(ix);
                continue;
            }
            let Ok(solid) = self.model.solids.binary_search_by_key(&id, |s| s.id) else {
                self.fault(
                    name.clone(),
                    "EID",
                    p.at,
                    FaultKind::Missing {
                        what: "shell or solid",
                        id: id.into(),
                    },
                );
                continue;
            };
            let corner = p
                .face
                .map(|g| g.and_then(|g| self.grid_ix.get(&g).copied()));
            let face = self
                .model
                .solids
                .get(solid)
                .and_then(|s| Some(self.inward(s, solid_face(s, corner)?)));
            match face {
                Some(grids) => out.push(Load::FacePressure {
                    grids,
                    pressure,
                    direction,
                }),
                None => {
                    let found = format!("G1 {:?}, G3 or G4 {:?}", p.face[0], p.face[1]);
                    let kind = FaultKind::Word {
                        found,
                        expected: "corners that tell a face of the element",
                    };
                    self.fault(name.clone(), "G1", p.at, kind);
                }
            }
        }
        if !shells.is_empty() {
            out.push(Load::ShellPressure {
                shells,
                pressure,
                direction,
            });
        }
        out
    }

    /// A face whose normal points into its solid, one numbered as its mirror image too.
    fn inward(&self, s: &Solid, face: [Option<GridIx>; 4]) -> [Option<GridIx>; 4] {
        let mean = |list: &mut dyn Iterator<Item = GridIx>| {
            let x: Vec<Vec3> = list.map(|g| self.x(g)).collect();
            x.iter().sum::<Vec3>() / x.len().max(1) as f64
        };
        let middle = mean(&mut s.grids.iter().take(s.shape.n_corners()).flatten().copied());
        let on_face = mean(&mut face.iter().flatten().copied());
        let [Some(a), Some(b), Some(c), d] = face else {
            return face;
        };
        let last = d.unwrap_or(c);
        let normal = (self.x(b) - self.x(a)).cross(&(self.x(last) - self.x(a)));
        if normal.dot(&(middle - on_face)) >= 0.0 {
            return face;
        }
        match d {
            Some(d) => [Some(a), Some(d), Some(c), Some(b)],
            None => [Some(a), Some(c), Some(b), None],
        }
    }

    fn body_forces(&mut self, sets: &mut Sets) {
        let cards = self.cards;
        for g in &cards.gravs {
            let name = format!("GRAV {}", g.sid);
            let Some(f) = self.frame(g.cid.into(), &name, "CID", g.at) else {
                continue;
            };
            let n = self
                .model
                .frames
                .get(f.us())
                .map_or_else(Vec3::zeros, |f| f.axes.tr_mul(&Vec3::from(g.n)));
            sets.entry(g.sid)
                .or_default()
                .push((1.0, Load::Gravity(n * g.scale)));
        }
        for r in &cards.rforces {
            let axes = self
                .frame_ix
                .get(&r.cid)
                .and_then(|f| self.model.frames.get(f.us()));
            let centre = match r.grid {
                0 => Some(Vec3::zeros()),
                id => self.grid_ix.get(&id).map(|g| self.model.grids[g.us()].x),
            };
            let load = match (axes, centre) {
                (Some(frame), Some(centre)) if r.acceleration == 0.0 => Load::Spin {
                    centre,
                    omega: frame.axes.tr_mul(&Vec3::from(r.r)) * (r.speed * std::f64::consts::TAU),
                },
                _ => Load::Unsupported("RFORCE".into(), r.at),
            };
            sets.entry(r.sid).or_default().push((1.0, load));
        }
    }

    /// The elements of a list; of a range those that exist.
    fn written_out<'s>(&'s self, ids: &'s IdList) -> Box<dyn Iterator<Item = u32> + 's> {
        match ids {
            IdList::Each(list) => Box::new(list.iter().copied()),
            IdList::Thru(a, b) => {
                let (a, b) = (*a, *b);
                let known = self.element_ids.keys().copied();
                Box::new(known.filter(move |id| (a..=b).contains(id)))
            }
        }
    }

    fn temperatures(&mut self) {
        let cards = self.cards;
        let mut sets: BTreeMap<u32, TemperatureSet> = BTreeMap::new();
        let fresh = |sid: u32, at: Place| TemperatureSet {
            sid,
            default: None,
            grids: Vec::new(),
            elements: HashMap::new(),
            unsupported: Vec::new(),
            at,
        };
        for t in &cards.tempds {
            sets.entry(t.sid)
                .or_insert_with(|| fresh(t.sid, t.at))
                .default = Some(t.t);
        }
        for t in &cards.temps {
            let Some(g) = self.grid(t.grid, &format!("TEMP {}", t.sid), "G", t.at) else {
                continue;
            };
            sets.entry(t.sid)
                .or_insert_with(|| fresh(t.sid, t.at))
                .grids
                .push((g, t.t));
        }
        for t in &cards.tempp1s {
            let set = sets.entry(t.sid).or_insert_with(|| fresh(t.sid, t.at));
            if t.at_surfaces {
                set.unsupported
                    .push(("TEMPP1 with TS1, TS2".to_owned(), t.at));
            }
            let plate = ElementTemperature::Plate {
                mean: t.mean,
                gradient: t.gradient,
            };
            set.elements
                .extend(self.written_out(&t.elements).map(|id| (id, plate)));
        }
        for t in &cards.temprbs {
            let set = sets.entry(t.sid).or_insert_with(|| fresh(t.sid, t.at));
            if t.at_points {
                set.unsupported
                    .push(("TEMPRB with temperatures of points".to_owned(), t.at));
            }
            let line = ElementTemperature::Line {
                ends: t.ends,
                gradient: t.gradient,
            };
            set.elements
                .extend(self.written_out(&t.elements).map(|id| (id, line)));
        }
        self.model.temperatures = sets.into_values().collect();
    }
}
