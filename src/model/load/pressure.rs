//! PLOAD2 and PLOAD4.

use crate::model::build::Builder;
use crate::model::face::solid_face;
use crate::model::fault::FaultKind;
use crate::model::frame::unit;
use crate::model::types::*;
use nastran::cards::{IdList, Pload4};
use nastran::place::{Place, PlacedCard};

impl Builder<'_> {
    /// Returns the shells of a list. Each shell named alone must exist. From a range, the existing shells are used.
    pub(super) fn shells_of(&mut self, ids: &IdList, name: &str, at: Place) -> Vec<ShellIx> {
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

    /// Adds the pressure of a PLOAD4 on shells, or on faces of solids.
    pub(super) fn pload4(&mut self, p: &PlacedCard<Pload4>) -> Vec<Load> {
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
                Some(Direction {
                    frame: f,
                    components: n,
                })
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
                    let word = |g: Option<u32>| g.map_or("blank".to_owned(), |g| g.to_string());
                    let [first, other] = p.face.map(word);
                    let found = format!("G1 {first}, G3 or G4 {other}");
                    let kind = FaultKind::Word {
                        found,
                        expected: "corners that determine a face of the element",
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

    /// Returns the grids of `face` in the order in which its normal points into the solid. A solid may be numbered as its mirror image.
    pub(super) fn inward(&self, s: &Solid, face: [Option<GridIx>; 4]) -> [Option<GridIx>; 4] {
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
}

impl Direction {
    /// Returns the unit vector at the basic location `x`. It is zero if the vector has no length.
    pub fn vector_at(&self, model: &Model, x: Vec3) -> Vec3 {
        let frame = model.frames.get(self.frame.us());
        frame
            .and_then(|f| unit(f.vector_to_basic(self.components, x)))
            .unwrap_or_default()
    }
}
