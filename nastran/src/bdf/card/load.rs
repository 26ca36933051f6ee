//! FORCE, MOMENT, PLOADs, GRAV, ACCEL, ACCEL1, RFORCE, RFORCE1, LOAD, TEMP, TEMPD, TEMPP1, TEMPRB.

use super::super::fault::DeckFaultKind;
use super::super::fields::Fields;
use super::ids::id_lists;
use crate::cards::{
    Accel, Accel1, Cards, Force, ForceAlong, Grav, IdList, LoadSum, Pload, Pload1, Pload2, Pload4,
    Rforce, Sload, Temp, Tempd, Tempp1, Temprb,
};
use crate::place::PlacedCard;

pub(super) fn force(f: &mut Fields) -> Force {
    Force {
        sid: f.id(0, "SID"),
        grid: f.id(1, "G"),
        cid: f.opt_id(2, "CID").unwrap_or(0),
        scale: f.real_or(3, "F", 0.0),
        n: f.reals(4, ["N1", "N2", "N3"]),
    }
}

pub(super) fn force_along(f: &mut Fields) -> ForceAlong {
    let four = f.name.ends_with(b"2");
    let mut points = [0; 4];
    for (k, point) in points.iter_mut().take(if four { 4 } else { 2 }).enumerate() {
        *point = f.id(3 + k, "G");
    }
    ForceAlong {
        sid: f.id(0, "SID"),
        grid: f.id(1, "G"),
        size: f.real_or(2, "F", 0.0),
        points,
        is_moment: f.name.starts_with(b"MOMENT"),
    }
}

pub(super) fn sload(f: &mut Fields, cards: &mut Cards) {
    let sid = f.id(0, "SID");
    for i in [1, 3, 5] {
        if i == 1 || !f.is_blank(i) {
            let card = Sload {
                sid,
                point: f.id(i, "S"),
                load: f.real_or(i + 1, "F", 0.0),
            };
            if !f.unusable {
                cards.sloads.push(PlacedCard { card, at: f.at });
            }
        }
    }
}

pub(super) fn pload(f: &mut Fields) -> Pload {
    Pload {
        sid: f.id(0, "SID"),
        pressure: f.real_or(1, "P", 0.0),
        grids: [
            f.id(2, "G1"),
            f.id(3, "G2"),
            f.id(4, "G3"),
            f.opt_id(5, "G4").unwrap_or(0),
        ],
    }
}

/// Returns up to four letters, padded with blanks.
fn letters(f: &mut Fields, i: usize, name: &'static str, allowed: &'static str) -> [u8; 4] {
    let word = f.word(i);
    if !allowed.split(", ").any(|w| w == word) {
        let what = if word.is_empty() {
            DeckFaultKind::Missing
        } else {
            DeckFaultKind::NotOneOf {
                found: word.clone(),
                allowed,
            }
        };
        f.fault(i, name, what);
    }
    let mut letters = [b' '; 4];
    for (to, from) in letters.iter_mut().zip(word.bytes()) {
        *to = from;
    }
    letters
}

pub(super) fn pload1(f: &mut Fields) -> Pload1 {
    Pload1 {
        sid: f.id(0, "SID"),
        element: f.id(1, "EID"),
        kind: letters(
            f,
            2,
            "TYPE",
            "FX, FY, FZ, FXE, FYE, FZE, MX, MY, MZ, MXE, MYE, MZE",
        ),
        scale: letters(f, 3, "SCALE", "LE, FR, LEPR, FRPR"),
        x1: f.real_or(4, "X1", 0.0),
        p1: f.real_or(5, "P1", 0.0),
        x2: f.opt_real(6, "X2"),
        p2: f.opt_real(7, "P2"),
    }
}

/// Reads a card that may mix single ids and ranges; it then becomes several entries at one place.
pub(super) fn pload2(f: &mut Fields, cards: &mut Cards) {
    let sid = f.id(0, "SID");
    let pressure = f.real_or(1, "P", 0.0);
    let lists = id_lists(f, 2, "EID");
    if lists.is_empty() {
        f.fault(2, "EID1", DeckFaultKind::Missing);
    }
    if f.unusable {
        return;
    }
    for elements in lists {
        cards.pload2s.push(PlacedCard {
            card: Pload2 {
                sid,
                pressure,
                elements,
            },
            at: f.at,
        });
    }
}

pub(super) fn pload4(f: &mut Fields) -> Pload4 {
    let sid = f.id(0, "SID");
    let first = f.id(1, "EID");
    let pressure = std::array::from_fn(|k| f.opt_real(2 + k, "P"));
    let (elements, face) = if f.is_word(6, "THRU") {
        let last = f.id(7, "EID2");
        (IdList::Thru(first, last), [None, None])
    } else {
        (
            IdList::Each(vec![first]),
            [
                f.opt_id(6, "G1").filter(|&g| g > 0),
                f.opt_id(7, "G3").filter(|&g| g > 0),
            ],
        )
    };
    let direction = if (9..12).any(|i| !f.is_blank(i)) {
        Some((
            f.opt_id(8, "CID").unwrap_or(0),
            f.reals(9, ["N1", "N2", "N3"]),
        ))
    } else {
        None
    };
    Pload4 {
        sid,
        elements,
        pressure,
        face,
        direction,
        sorl: f.word(12),
        ldir: f.word(13),
    }
}

pub(super) fn grav(f: &mut Fields) -> Grav {
    Grav {
        sid: f.id(0, "SID"),
        cid: f.opt_id(1, "CID").unwrap_or(0),
        scale: f.real_or(2, "A", 0.0),
        n: f.reals(3, ["N1", "N2", "N3"]),
    }
}

pub(super) fn accel(f: &mut Fields) -> Accel {
    let (sid, cid) = (f.id(0, "SID"), f.opt_id(1, "CID").unwrap_or(0));
    let n = f.reals(2, ["N1", "N2", "N3"]);
    let direction = f.word(5);
    let allowed = "X, Y, Z";
    if !["", "X", "Y", "Z"].contains(&direction.as_str()) {
        let found = direction.clone();
        f.fault(5, "DIR", DeckFaultKind::NotOneOf { found, allowed });
    }
    let mut table = Vec::new();
    for i in (8..f.len()).step_by(2) {
        if !f.is_blank(i) || !f.is_blank(i + 1) {
            table.push((f.required_real(i, "LOC"), f.required_real(i + 1, "VAL")));
        }
    }
    if direction.is_empty() && !table.is_empty() {
        f.fault(5, "DIR", DeckFaultKind::Missing);
    }
    Accel {
        sid,
        cid,
        n,
        direction,
        table,
    }
}

pub(super) fn accel1(f: &mut Fields) -> Accel1 {
    let card = Accel1 {
        sid: f.id(0, "SID"),
        cid: f.opt_id(1, "CID").unwrap_or(0),
        scale: f.real_or(2, "A", 0.0),
        n: f.reals(3, ["N1", "N2", "N3"]),
        grids: id_lists(f, 8, "GRIDID"),
    };
    if card.grids.is_empty() {
        f.fault(8, "GRIDID1", DeckFaultKind::Missing);
    }
    card
}

pub(super) fn rforce(f: &mut Fields) -> Rforce {
    Rforce {
        is_rforce1: f.name == b"RFORCE1",
        sid: f.id(0, "SID"),
        grid: f.opt_id(1, "G").unwrap_or(0),
        cid: f.opt_id(2, "CID").unwrap_or(0),
        speed: f.real_or(3, "A", 0.0),
        r: f.reals(4, ["R1", "R2", "R3"]),
        method: f.opt_id(7, "METHOD"),
        acceleration: f.real_or(8, "RACC", 0.0),
        part: f.opt_id(10, "IDRF").unwrap_or(0),
    }
}

pub(super) fn load(f: &mut Fields) -> LoadSum {
    let sid = f.id(0, "SID");
    let scale = f.required_real(1, "S");
    let mut terms = Vec::new();
    for i in (2..f.len()).step_by(2) {
        if !f.is_blank(i) || !f.is_blank(i + 1) {
            terms.push((f.required_real(i, "S"), f.id(i + 1, "L")));
        }
    }
    LoadSum { sid, scale, terms }
}

pub(super) fn temp(f: &mut Fields, cards: &mut Cards) {
    let sid = f.id(0, "SID");
    for i in [1, 3, 5] {
        if i == 1 || !f.is_blank(i) {
            let card = Temp {
                sid,
                grid: f.id(i, "G"),
                t: f.required_real(i + 1, "T"),
            };
            if !f.unusable {
                cards.temps.push(PlacedCard { card, at: f.at });
            }
        }
    }
}

pub(super) fn tempd(f: &mut Fields, cards: &mut Cards) {
    for i in [0, 2, 4, 6] {
        if i == 0 || !f.is_blank(i) {
            let card = Tempd {
                sid: f.id(i, "SID"),
                t: f.required_real(i + 1, "T"),
            };
            if !f.unusable {
                cards.tempds.push(PlacedCard { card, at: f.at });
            }
        }
    }
}

/// Reads the element of field 2 and the elements from field `more` on.
fn first_and_more(f: &mut Fields, more: usize) -> Vec<IdList> {
    let mut lists = vec![IdList::Each(vec![f.id(1, "EID1")])];
    lists.extend(id_lists(f, more, "EID"));
    lists
}

pub(super) fn tempp1(f: &mut Fields, cards: &mut Cards) {
    let sid = f.id(0, "SID");
    let mean = f.real_or(2, "TBAR", 0.0);
    let gradient = f.real_or(3, "TPRIME", 0.0);
    let at_surfaces = !f.is_blank(5) || !f.is_blank(6);
    let lists = first_and_more(f, 8);
    if f.unusable {
        return;
    }
    for elements in lists {
        let card = Tempp1 {
            sid,
            elements,
            mean,
            gradient,
            at_surfaces,
        };
        cards.tempp1s.push(PlacedCard { card, at: f.at });
    }
}

pub(super) fn temprb(f: &mut Fields, cards: &mut Cards) {
    let sid = f.id(0, "SID");
    let ends = f.reals(2, ["TA", "TB"]);
    let gradient = [f.reals(4, ["TP1A", "TP1B"]), f.reals(6, ["TP2A", "TP2B"])];
    let at_points = (8..16).any(|i| !f.is_blank(i));
    let lists = first_and_more(f, 16);
    if f.unusable {
        return;
    }
    for elements in lists {
        let card = Temprb {
            sid,
            elements,
            ends,
            gradient,
            at_points,
        };
        cards.temprbs.push(PlacedCard { card, at: f.at });
    }
}
