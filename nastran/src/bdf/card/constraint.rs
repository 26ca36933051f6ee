//! MPC, SPC, SPC1, SPCADD, MPCADD, SUPORT, SUPORT1.

use super::super::fields::Fields;
use super::ids::id_lists;
use crate::cards::{Cards, IdList, Mpc, SetSum, Spc, Spc1, Suport};
use crate::place::PlacedCard;

/// Reads an MPC; its terms are in fields 3-5 and 6-8 of every line.
pub(super) fn mpc(f: &mut Fields) -> Mpc {
    let sid = f.id(0, "SID");
    let mut terms = Vec::new();
    for line in (0..f.len()).step_by(8) {
        for i in [line + 1, line + 4] {
            if !f.is_blank(i) {
                terms.push((
                    f.id(i, "G"),
                    f.component(i + 1, "C"),
                    f.real_or(i + 2, "A", 0.0),
                ));
            }
        }
    }
    Mpc { sid, terms }
}

pub(super) fn spc(f: &mut Fields) -> Spc {
    let sid = f.id(0, "SID");
    let mut terms = vec![(f.id(1, "G1"), f.dofs(2, "C1"), f.real_or(3, "D1", 0.0))];
    if !f.is_blank(4) {
        terms.push((f.id(4, "G2"), f.dofs(5, "C2"), f.real_or(6, "D2", 0.0)));
    }
    Spc { sid, terms }
}

/// Reads a card that may mix single ids and ranges; it then becomes several entries at one place.
pub(super) fn spc1(f: &mut Fields, cards: &mut Cards) {
    let sid = f.id(0, "SID");
    let dofs = f.dofs(1, "C");
    let mut lists = id_lists(f, 2, "G");
    if f.unusable {
        return;
    }
    if lists.is_empty() {
        lists.push(IdList::Each(Vec::new()));
    }
    for grids in lists {
        cards.spc1s.push(PlacedCard {
            card: Spc1 { sid, dofs, grids },
            at: f.at,
        });
    }
}

pub(super) fn set_sum(f: &mut Fields) -> SetSum {
    let sid = f.id(0, "SID");
    let sets = match super::ids::join_ids(f, 1, "S") {
        IdList::Each(ids) => ids,
        IdList::Thru(a, b) => f.written_out(1, "S", a..=b, 1),
    };
    SetSum { sid, sets }
}

pub(super) fn suport(f: &mut Fields) -> Suport {
    let (sid, first) = if f.name == b"SUPORT1" {
        (Some(f.id(0, "SID")), 1)
    } else {
        (None, 0)
    };
    let mut terms = Vec::new();
    let mut i = first;
    while i < f.len() {
        if f.is_blank(i) {
            i += 1;
            continue;
        }
        terms.push((f.id(i, "ID"), f.dofs(i + 1, "C")));
        i += 2;
    }
    Suport { sid, terms }
}
