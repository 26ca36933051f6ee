//! Cards of a deck that act in a subcase in addition to forces and moments at grids.

use crate::fe::{LoadCase, is_heated};
use crate::model::Load;
use crate::strain_chain::deck::DeckModel;
use nastran::bdf::Subcase;
use nastran::cards::Cards;
use nastran::place::Place;
use std::collections::BTreeSet;

/// Card or statement of a deck that acts in a subcase.
pub(super) struct OtherLoad {
    name: String,
    at: Place,
}

impl OtherLoad {
    /// Returns name and place: "PLOAD4 78 (`deck.bdf`:66)".
    pub(super) fn words(&self, deck: &DeckModel) -> String {
        format!(
            "{} (`{}`:{})",
            self.name,
            deck.deck.path(self.at),
            self.at.line
        )
    }
}

/// Returns the pressures, accelerations, enforced displacements and loads without a struct that the LOAD of a subcase selects.
pub(super) fn other_loads(deck: &DeckModel, subcase: &Subcase) -> Vec<OtherLoad> {
    let Some(sid) = subcase.load else {
        return Vec::new();
    };
    let cards = &deck.deck.cards;
    let mut all = loads_with_a_struct(cards, &selected_sets(cards, sid));
    let sets = deck.model.load_sets.iter().filter(|s| s.sid == sid);
    all.extend(sets.flat_map(|s| &s.loads).filter_map(|(factor, load)| {
        match load {
            // Temperatures act only if TEMPERATURE selects them.
            Load::Unsupported(name, at) if *factor != 0.0 && !name.starts_with("TEMP") => {
                Some(OtherLoad {
                    name: name.clone(),
                    at: *at,
                })
            }
            _ => None,
        }
    }));
    all
}

/// Returns the temperatures and the deformation of a subcase that strain the structure in addition to its LOAD.
pub(super) fn thermal_loads(deck: &DeckModel, subcase: &Subcase) -> Vec<OtherLoad> {
    let case = LoadCase::of_subcase(&deck.model, subcase, String::new());
    let stated = |word: &str| {
        let at = deck.deck.case_control.place_of(word, Some(subcase.id));
        at.unwrap_or(subcase.at)
    };
    // Equal temperature sets before and after cause no thermal strain.
    let heat = subcase.temperature_load.filter(|_| {
        subcase.temperature_initial != subcase.temperature_load
            && is_heated(&deck.model, &case).unwrap_or(false)
    });
    let heat = heat.map(|sid| OtherLoad {
        name: format!("TEMPERATURE(LOAD) = {sid}"),
        at: stated("TEMPERATURE"),
    });
    let deform = subcase.deform.map(|sid| OtherLoad {
        name: format!("DEFORM = {sid}"),
        at: stated("DEFORM"),
    });
    heat.into_iter().chain(deform).collect()
}

/// Returns the cards that enforce a displacement other than zero in the SPC set of a subcase.
pub(super) fn moved_supports(deck: &DeckModel, subcase: &Subcase) -> Vec<OtherLoad> {
    let cards = &deck.deck.cards;
    let Some(sid) = subcase.spc else {
        return Vec::new();
    };
    let sets = sets_of(sid, |sid| {
        let sums = cards.spcadds.iter().filter(|s| s.sid == sid);
        sums.flat_map(|s| s.sets.iter().copied()).collect()
    });
    let moves = |s: &&nastran::place::PlacedCard<nastran::cards::Spc>| {
        sets.contains(&s.sid) && s.terms.iter().any(|t| t.2 != 0.0)
    };
    let found = cards.spcs.iter().filter(moves);
    found
        .map(|s| OtherLoad {
            name: format!("SPC {} with a displacement", s.sid),
            at: s.at,
        })
        .collect()
}

/// Returns the load sets that a set contains: itself, and the sets that LOAD cards add up.
fn selected_sets(cards: &Cards, sid: u32) -> BTreeSet<u32> {
    sets_of(sid, |sid| {
        let sums = cards.loads.iter().filter(|l| l.sid == sid);
        let terms = sums.flat_map(|l| l.terms.iter().map(move |t| (t.0 * l.scale, t.1)));
        terms.filter(|t| t.0 != 0.0).map(|t| t.1).collect()
    })
}

/// Returns the set `sid` and all sets that its sums contain, directly or through other sums. `named` returns the sets in the sum of an id.
fn sets_of(sid: u32, named: impl Fn(u32) -> Vec<u32>) -> BTreeSet<u32> {
    let (mut all, mut next) = (BTreeSet::new(), vec![sid]);
    while let Some(sid) = next.pop() {
        if all.insert(sid) {
            next.extend(named(sid));
        }
    }
    all
}

/// Returns the loads of these sets that are neither forces nor moments at grids, and are not zero.
fn loads_with_a_struct(cards: &Cards, sets: &BTreeSet<u32>) -> Vec<OtherLoad> {
    let mut all = Vec::new();
    let mut add = |name: &str, sid: u32, size: f64, at: Place| {
        if size != 0.0 && sets.contains(&sid) {
            let name = format!("{name} {sid}");
            all.push(OtherLoad { name, at });
        }
    };
    let largest = |v: &[f64]| v.iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    for p in &cards.ploads {
        add("PLOAD", p.sid, p.pressure, p.at);
    }
    for p in &cards.pload1s {
        add("PLOAD1", p.sid, largest(&[p.p1, p.p2.unwrap_or(0.0)]), p.at);
    }
    for p in &cards.pload2s {
        add("PLOAD2", p.sid, p.pressure, p.at);
    }
    for p in &cards.pload4s {
        let pressure = p.pressure.map(|p| p.unwrap_or(0.0));
        add("PLOAD4", p.sid, largest(&pressure), p.at);
    }
    for g in &cards.gravs {
        add("GRAV", g.sid, g.scale * largest(&g.n), g.at);
    }
    for a in &cards.accels {
        add("ACCEL", a.sid, largest(&a.n), a.at);
    }
    for a in &cards.accel1s {
        add("ACCEL1", a.sid, a.scale * largest(&a.n), a.at);
    }
    for r in &cards.rforces {
        let name = if r.is_rforce1 { "RFORCE1" } else { "RFORCE" };
        add(name, r.sid, largest(&[r.speed, r.acceleration]), r.at);
    }
    for s in &cards.spcds {
        let moved = s.terms.iter().fold(0.0_f64, |a, t| a.max(t.2.abs()));
        add("SPCD", s.sid, moved, s.at);
    }
    all
}
