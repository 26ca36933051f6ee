//! Coordinate systems and grids; each may be defined by the other.

use super::build::Builder;
use super::fault::FaultKind;
use super::types::*;
use nastran::cards::{self, CoordDefinition, Dofs, IdList};
use nastran::place::{Place, PlacedCard};
use std::collections::{BTreeMap, HashMap, VecDeque};

/// Longest SPOINT range that is written out; a longer one is a slip of the pen.
const MOST_SCALAR_POINTS: u32 = 100_000;

impl Grid {
    /// Returns whether the grid is a scalar point.
    pub fn is_scalar(&self) -> bool {
        self.kind == PointKind::Scalar
    }
}

impl<'a> Builder<'a> {
    pub(super) fn frames_and_grids(&mut self) {
        let cards = self.cards;
        let grids = self.unique_grids();
        let grid_of: HashMap<u32, &PlacedCard<cards::Grid>> =
            grids.iter().map(|g| (g.id, *g)).collect();
        let default_cp = cards.grdset.as_ref().and_then(|g| g.cp).unwrap_or(0);
        let cp = |g: &cards::Grid| g.cp.unwrap_or(default_cp);
        self.frames(&grid_of, &cp);
        let default = cards.grdset.as_ref().map(|g| g.card).unwrap_or_default();
        let mut out = Vec::with_capacity(grids.len());
        for g in &grids {
            let name = || format!("GRID {}", g.id);
            let x = match self
                .frame_ix
                .get(&cp(g))
                .and_then(|f| self.model.frames.get(f.us()))
            {
                Some(f) => f.to_basic(g.x),
                None => {
                    self.fault(
                        name(),
                        "CP",
                        g.at,
                        FaultKind::Missing {
                            what: "coordinate system",
                            id: cp(g).into(),
                        },
                    );
                    Vec3::from(g.x)
                }
            };
            // Sums of fourth powers of coordinates must stay finite.
            if !x.iter().all(|v| v.abs() < 1e15) {
                self.fault(
                    name(),
                    "X1",
                    g.at,
                    FaultKind::Degenerate {
                        what: "location within 1e15 of the origin",
                    },
                );
            }
            let cd = g.cd.or(default.cd).unwrap_or(0);
            let mut ps = g.ps.or(default.ps).unwrap_or_default();
            let cd = if cd == -1 {
                // A fluid grid has one pressure and no displacements.
                ps = Dofs::ALL;
                FrameIx(0)
            } else {
                self.frame(cd.into(), &name(), "CD", g.at)
                    .unwrap_or(FrameIx(0))
            };
            out.push(Grid {
                id: g.id,
                kind: PointKind::Grid,
                x,
                cd,
                ps,
                at: g.at,
            });
        }
        self.scalar_points(&grid_of, &mut out);
        out.sort_by_key(|g: &Grid| g.id);
        self.grid_ix = out
            .iter()
            .enumerate()
            .map(|(i, g)| (g.id, GridIx(i as u32)))
            .collect();
        self.model.grids = out;
    }

    /// Scalar points: of SPOINT, and those that springs, masses and dampers name without a component where there is no grid of that id.
    fn scalar_points(
        &mut self,
        grid_of: &HashMap<u32, &PlacedCard<cards::Grid>>,
        out: &mut Vec<Grid>,
    ) {
        let cards = self.cards;
        let mut named: BTreeMap<u32, Place> = BTreeMap::new();
        for s in &cards.spoints {
            let ids = match &s.card {
                IdList::Each(ids) => ids.clone(),
                IdList::Thru(a, b) if b.saturating_sub(*a) < MOST_SCALAR_POINTS => {
                    (*a..=*b).collect()
                }
                IdList::Thru(a, b) => {
                    let kind = FaultKind::Unsupported {
                        what: format!("a range of {} scalar points", b - a),
                        remedy: "name the points that are used",
                    };
                    self.fault("SPOINT".into(), "THRU", s.at, kind);
                    continue;
                }
            };
            for id in ids {
                match grid_of.get(&id) {
                    None => {
                        named.entry(id).or_insert(s.at);
                    }
                    Some(g) => {
                        let kind = FaultKind::Duplicate {
                            what: "id of a grid and a scalar point",
                            first: g.at,
                        };
                        self.fault(format!("SPOINT {id}"), "ID", s.at, kind);
                    }
                }
            }
        }
        let springs = cards.springs.iter().map(|s| (s.ends, s.at));
        let masses = cards.scalar_masses.iter().map(|m| (m.ends, m.at));
        for (ends, at) in springs.chain(masses) {
            for (id, component) in ends.iter().flatten() {
                if *component == 0 && !grid_of.contains_key(id) {
                    named.entry(*id).or_insert(at);
                }
            }
        }
        for p in &cards.connected_points {
            if !grid_of.contains_key(&p.card) {
                named.entry(p.card).or_insert(p.at);
            }
        }
        out.extend(named.into_iter().map(|(id, at)| Grid {
            id,
            kind: PointKind::Scalar,
            x: Vec3::zeros(),
            cd: FrameIx(0),
            ps: Dofs::from_digits(23456).unwrap_or_default(),
            at,
        }));
    }

    /// Returns the grids in file order, the first of each id; adds a fault if a second one differs.
    fn unique_grids(&mut self) -> Vec<&'a PlacedCard<cards::Grid>> {
        let cards = self.cards;
        let mut first: HashMap<u32, &PlacedCard<cards::Grid>> =
            HashMap::with_capacity(cards.grids.len());
        let mut out = Vec::with_capacity(cards.grids.len());
        for g in &cards.grids {
            match first.get(&g.id) {
                None => {
                    first.insert(g.id, g);
                    out.push(g);
                }
                Some(f) if f.card == g.card => {}
                Some(f) => {
                    let kind = FaultKind::Duplicate {
                        what: "grid id",
                        first: f.at,
                    };
                    self.fault(format!("GRID {}", g.id), "ID", g.at, kind);
                }
            }
        }
        out
    }

    /// Every coordinate system to basic, those first that others are defined in.
    fn frames(
        &mut self,
        grid_of: &HashMap<u32, &PlacedCard<cards::Grid>>,
        cp: &dyn Fn(&cards::Grid) -> u32,
    ) {
        self.model.frames.push(Frame::basic());
        self.frame_ix.insert(0, FrameIx(0));
        let mut card_of: HashMap<u32, &'a PlacedCard<cards::Coord>> = HashMap::new();
        let cards = self.cards;
        for c in &cards.coords {
            match card_of.get(&c.id) {
                None => {
                    card_of.insert(c.id, c);
                }
                Some(f) if f.card == c.card => {}
                Some(f) => {
                    let kind = FaultKind::Duplicate {
                        what: "coordinate system id",
                        first: f.at,
                    };
                    self.fault(format!("coordinate system {}", c.id), "CID", c.at, kind);
                }
            }
        }
        let mut waiting: HashMap<u32, usize> = HashMap::new();
        let mut users: HashMap<u32, Vec<u32>> = HashMap::new();
        let mut ready: VecDeque<u32> = VecDeque::new();
        let mut order: Vec<&'a PlacedCard<cards::Coord>> = card_of.values().copied().collect();
        order.sort_by_key(|c| c.id);
        for c in &order {
            let name = format!("coordinate system {}", c.id);
            let mut needs: Vec<u32> = match c.definition {
                CoordDefinition::Points { rid, .. } => vec![rid],
                CoordDefinition::Grids(ids) => {
                    for id in ids.iter().filter(|id| !grid_of.contains_key(id)) {
                        self.fault(
                            name.clone(),
                            "G",
                            c.at,
                            FaultKind::Missing {
                                what: "grid",
                                id: (*id).into(),
                            },
                        );
                    }
                    ids.iter()
                        .filter_map(|id| grid_of.get(id))
                        .map(|g| cp(g))
                        .collect()
                }
            };
            needs.retain(|id| *id != 0);
            needs.sort_unstable();
            needs.dedup();
            for id in &needs {
                if !card_of.contains_key(id) {
                    let kind = FaultKind::Missing {
                        what: "coordinate system",
                        id: (*id).into(),
                    };
                    self.fault(name.clone(), "RID", c.at, kind);
                }
                users.entry(*id).or_default().push(c.id);
            }
            waiting.insert(c.id, needs.len());
            if needs.is_empty() {
                ready.push_back(c.id);
            }
        }
        let mut done = Vec::new();
        while let Some(id) = ready.pop_front() {
            let Some(c) = card_of.get(&id) else { continue };
            if let Some(frame) = self.resolve(c, grid_of, cp, &done) {
                done.push(frame);
                self.frame_ix.insert(id, FrameIx(done.len() as u32));
            }
            for user in users.get(&id).into_iter().flatten() {
                if let Some(n) = waiting.get_mut(user) {
                    *n = n.saturating_sub(1);
                    if *n == 0 {
                        ready.push_back(*user);
                    }
                }
            }
            waiting.remove(&id);
        }
        for c in order.iter().filter(|c| waiting.contains_key(&c.id)) {
            // A system that refers to a missing system is already reported. The remaining systems refer to each other in a circle.
            if circle(c.id, &card_of, grid_of, cp) {
                self.fault(
                    format!("coordinate system {}", c.id),
                    "RID",
                    c.at,
                    FaultKind::FrameCycle,
                );
            }
        }
        // Sorted by id, so that the order does not depend on the references between systems.
        done.sort_by_key(|f| f.id);
        self.model.frames.extend(done);
        self.frame_ix = self
            .model
            .frames
            .iter()
            .enumerate()
            .map(|(i, f)| (f.id, FrameIx(i as u32)))
            .collect();
    }

    fn resolve(
        &mut self,
        c: &PlacedCard<cards::Coord>,
        grid_of: &HashMap<u32, &PlacedCard<cards::Grid>>,
        cp: &dyn Fn(&cards::Grid) -> u32,
        done: &[Frame],
    ) -> Option<Frame> {
        let basic = Frame::basic();
        let frame = |id: u32| match id {
            0 => Some(&basic),
            _ => self
                .frame_ix
                .get(&id)
                .and_then(|ix| done.get(ix.us().checked_sub(1)?)),
        };
        let [a, b, p] = match c.definition {
            CoordDefinition::Points { rid, a, b, c } => {
                let f = frame(rid)?;
                [f.to_basic(a), f.to_basic(b), f.to_basic(c)]
            }
            CoordDefinition::Grids([a, b, c]) => {
                let at = |id: u32| {
                    let g = grid_of.get(&id)?;
                    Some(frame(cp(g))?.to_basic(g.x))
                };
                [at(a)?, at(b)?, at(c)?]
            }
        };
        let made = Frame::from_points(c.id, c.kind, a, b, p);
        if made.is_none() {
            self.fault(
                format!("coordinate system {}", c.id),
                "C",
                c.at,
                FaultKind::CollinearFrame,
            );
        }
        made
    }
}

/// Returns whether the system is reached again from itself.
fn circle(
    start: u32,
    card_of: &HashMap<u32, &PlacedCard<cards::Coord>>,
    grid_of: &HashMap<u32, &PlacedCard<cards::Grid>>,
    cp: &dyn Fn(&cards::Grid) -> u32,
) -> bool {
    let mut seen = std::collections::HashSet::new();
    let mut stack = vec![start];
    while let Some(id) = stack.pop() {
        let next: Vec<u32> = match card_of.get(&id).map(|c| c.definition) {
            None => continue,
            Some(CoordDefinition::Points { rid, .. }) => vec![rid],
            Some(CoordDefinition::Grids(ids)) => ids
                .iter()
                .filter_map(|g| grid_of.get(g))
                .map(|g| cp(g))
                .collect(),
        };
        for n in next {
            if n == start {
                return true;
            }
            if seen.insert(n) {
                stack.push(n);
            }
        }
    }
    false
}
