//! MPC, SPC, SUPORT: sets with their sums written out.

use super::build::Builder;
use super::fault::FaultKind;
use super::set_sum::{MOST_TERMS, SumOrder, sum_order};
use super::types::*;
use nastran::cards::{Dofs, IdList, SetSum};
use nastran::place::{Place, PlacedCard};
use std::collections::{BTreeMap, BTreeSet};

/// Terms of an equation: grid, dof (0-based), coefficient.
type Equation = (Vec<(GridIx, u8, f64)>, Place);

impl Builder<'_> {
    pub(super) fn constraints(&mut self) {
        self.mpcs();
        self.spcs();
        let cards = self.cards;
        for s in &cards.suports {
            let terms = s
                .terms
                .iter()
                .filter_map(|(g, d)| Some((self.grid(*g, "SUPORT", "ID", s.at)?, *d)))
                .collect();
            self.model.suports.push((s.sid, terms));
        }
    }

    fn mpcs(&mut self) {
        let cards = self.cards;
        let mut sets: BTreeMap<u32, Vec<Equation>> = BTreeMap::new();
        for m in &cards.mpcs {
            let name = format!("MPC {}", m.sid);
            let mut terms = Vec::with_capacity(m.terms.len());
            for (grid, component, a) in &m.terms {
                let Some(g) = self.grid(*grid, &name, "G", m.at) else {
                    continue;
                };
                match component {
                    1..=6 => terms.push((g, component - 1, *a)),
                    0 if self.is_scalar(g) => terms.push((g, 0, *a)),
                    c => {
                        let kind = FaultKind::Word {
                            found: c.to_string(),
                            expected: "a component 1 to 6 of a grid",
                        };
                        self.fault(name.clone(), "C", m.at, kind);
                    }
                }
            }
            if let Some((_, _, a)) = terms.first()
                && *a == 0.0
            {
                let kind = FaultKind::Word {
                    found: "0".into(),
                    expected: "a coefficient other than 0 for the first term",
                };
                self.fault(name.clone(), "A1", m.at, kind);
            }
            sets.entry(m.sid).or_default().push((terms, m.at));
        }
        let sums = self.sums(&cards.mpcadds, "MPCADD", &sets);
        sets.extend(sums);
        self.model.mpcs = sets
            .into_iter()
            .map(|(sid, equations)| MpcSet { sid, equations })
            .collect();
    }

    fn spcs(&mut self) {
        let cards = self.cards;
        let mut sets: BTreeMap<u32, Vec<(GridIx, Dofs, f64)>> = BTreeMap::new();
        for s in &cards.spcs {
            let name = format!("SPC {}", s.sid);
            for (grid, dofs, value) in &s.terms {
                if let Some(g) = self.grid(*grid, &name, "G", s.at) {
                    let dofs = self.dofs_of_point(g, *dofs);
                    sets.entry(s.sid).or_default().push((g, dofs, *value));
                }
            }
        }
        for s in &cards.spc1s {
            let name = format!("SPC1 {}", s.sid);
            let grids: Vec<GridIx> = match &s.grids {
                IdList::Each(ids) => ids
                    .iter()
                    .filter_map(|id| self.grid(*id, &name, "G", s.at))
                    .collect(),
                IdList::Thru(a, b) => self.grids_thru(*a, *b),
            };
            let terms: Vec<_> = grids
                .into_iter()
                .map(|g| (g, self.dofs_of_point(g, s.dofs), 0.0))
                .collect();
            sets.entry(s.sid).or_default().extend(terms);
        }
        let sums = self.sums(&cards.spcadds, "SPCADD", &sets);
        sets.extend(sums);
        self.model.spcs = sets
            .into_iter()
            .map(|(sid, terms)| SpcSet { sid, terms })
            .collect();
    }

    /// Returns the dofs that a constraint holds. A constraint on a scalar point states no dof and holds its only one.
    fn dofs_of_point(&self, g: GridIx, dofs: Dofs) -> Dofs {
        match self.is_scalar(g) {
            true => Dofs::from_digits(1).unwrap_or(dofs),
            false => dofs,
        }
    }

    /// Grids with ids from a to b.
    fn grids_thru(&self, a: u32, b: u32) -> Vec<GridIx> {
        let from = self.model.grids.partition_point(|g| g.id < a);
        let to = self.model.grids.partition_point(|g| g.id <= b);
        (from..to).map(|i| GridIx(i as u32)).collect()
    }

    /// Sets of single terms for the sums of a deck.
    fn sums<T: Clone>(
        &mut self,
        cards: &[PlacedCard<SetSum>],
        card: &str,
        sets: &BTreeMap<u32, Vec<T>>,
    ) -> BTreeMap<u32, Vec<T>> {
        let mut by_sid: BTreeMap<u32, Vec<&PlacedCard<SetSum>>> = BTreeMap::new();
        for sum in cards {
            by_sid.entry(sum.sid).or_default().push(sum);
        }
        let names: BTreeMap<u32, BTreeSet<u32>> = by_sid
            .iter()
            .map(|(sid, cards)| (*sid, cards.iter().flat_map(|c| c.sets.clone()).collect()))
            .collect();
        let SumOrder { ready, circles } = sum_order(&names);
        for circle in circles {
            if let Some(sum) = circle.first().and_then(|sid| by_sid.get(sid)?.first()) {
                let kind = FaultKind::SumCycle { sets: circle };
                self.fault(format!("{card} {}", sum.sid), "S", sum.at, kind);
            }
        }
        // Each set of single constraints is listed once, so that sums of sums stay small.
        let mut parts: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        let mut left = MOST_TERMS;
        for sum_sid in ready {
            let (mut all, mut seen) = (Vec::new(), BTreeSet::new());
            let mut add = |sid: u32| {
                if seen.insert(sid) {
                    all.push(sid);
                }
            };
            for sum in by_sid.get(&sum_sid).into_iter().flatten() {
                for sid in &sum.sets {
                    if let Some(inner) = parts.get(sid) {
                        inner.iter().copied().for_each(&mut add);
                    } else if sets.contains_key(sid) {
                        add(*sid);
                    } else {
                        let kind = FaultKind::Missing {
                            what: "set",
                            id: (*sid).into(),
                        };
                        self.fault(format!("{card} {}", sum.sid), "S", sum.at, kind);
                    }
                }
            }
            left = left.saturating_sub(all.len());
            if left == 0 {
                self.too_many_terms(card, sum_sid, &by_sid);
                break;
            }
            parts.insert(sum_sid, all);
        }
        parts
            .into_iter()
            .filter(|(_, parts)| !parts.is_empty())
            .map(|(sid, parts)| {
                let terms = parts.iter().filter_map(|p| sets.get(p)).flatten();
                (sid, terms.cloned().collect())
            })
            .collect()
    }

    fn too_many_terms(
        &mut self,
        card: &str,
        sid: u32,
        by_sid: &BTreeMap<u32, Vec<&PlacedCard<SetSum>>>,
    ) {
        if let Some(sum) = by_sid.get(&sid).and_then(|cards| cards.first()) {
            let what =
                format!("{card} that stands for more than {MOST_TERMS} sets with the others");
            let remedy = "write fewer sums that name sums";
            let kind = FaultKind::Unsupported { what, remedy };
            self.fault(format!("{card} {sid}"), "S", sum.at, kind);
        }
    }

    /// Adds notes on the grids that nothing uses.
    pub(super) fn attachments(&mut self) {
        let m = &self.model;
        let mut used = vec![false; m.grids.len()];
        let mut mark = |g: GridIx| {
            if let Some(u) = used.get_mut(g.us()) {
                *u = true;
            }
        };
        m.elements()
            .flat_map(|e| m.element_grids(e))
            .for_each(&mut mark);
        m.masses.iter().for_each(|c| mark(c.grid));
        m.scalar_masses
            .iter()
            .flat_map(|c| c.ends.iter().flatten())
            .for_each(|end| mark(end.0));
        m.mpcs
            .iter()
            .flat_map(|s| &s.equations)
            .flat_map(|e| &e.0)
            .for_each(|t| mark(t.0));
        m.rigids
            .iter()
            .flat_map(|r| r.kind.grids())
            .for_each(&mut mark);
        self.points.iter().copied().for_each(&mut mark);
        let free: Vec<(u32, Place)> = m
            .grids
            .iter()
            .zip(used)
            .filter(|(g, used)| !used && g.ps != Dofs::ALL && !g.is_scalar())
            .map(|(g, _)| (g.id, g.at))
            .collect();
        for (id, at) in free {
            self.fault(format!("GRID {id}"), "ID", at, FaultKind::Unattached);
        }
    }
}
