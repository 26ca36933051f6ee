//! CONM1, CONM2, CMASS1 to CMASS4, PMASS, NSM, NSM1, NSML, NSML1.

use super::super::fields::Fields;
use super::ids::id_lists;
use super::springs::{end, scalar_end};
use crate::cards::{
    Cards, Conm1, Conm2, IdList, NonstructuralMass, Pmass, ScalarMass, ScalarMassValue,
};
use crate::place::PlacedCard;

pub(super) fn conm1(f: &mut Fields) -> Conm1 {
    Conm1 {
        id: f.id(0, "EID"),
        grid: f.id(1, "G"),
        cid: f.opt_id(2, "CID").unwrap_or(0),
        m: std::array::from_fn(|k| f.real_or(3 + k, "M", 0.0)),
    }
}

pub(super) fn conm2(f: &mut Fields) -> Conm2 {
    Conm2 {
        id: f.id(0, "EID"),
        grid: f.id(1, "G"),
        cid: f.opt_signed(2, "CID").unwrap_or(0),
        mass: f.real_or(3, "M", 0.0),
        offset: f.reals(4, ["X1", "X2", "X3"]),
        inertia: f.reals(8, ["I11", "I21", "I22", "I31", "I32", "I33"]),
    }
}

/// Reads the mass of a CMASS1 to CMASS4, or its PMASS, from field 3.
fn scalar_mass_value(f: &mut Fields) -> ScalarMassValue {
    match f.name {
        b"CMASS2" | b"CMASS4" => ScalarMassValue::Direct(f.real_or(1, "M", 0.0)),
        _ => ScalarMassValue::Property(f.opt_id(1, "PID")),
    }
}

pub(super) fn scalar_mass(f: &mut Fields) -> ScalarMass {
    ScalarMass {
        id: f.id(0, "EID"),
        mass: scalar_mass_value(f),
        ends: [end(f, 2), end(f, 4)],
    }
}

/// Reads CMASS3 and CMASS4: masses between scalar points, or between a point and ground.
pub(super) fn mass_of_points(f: &mut Fields) -> ScalarMass {
    ScalarMass {
        id: f.id(0, "EID"),
        mass: scalar_mass_value(f),
        ends: [scalar_end(f, 2), scalar_end(f, 3)],
    }
}

/// Reads the property of a PMASS that begins at field `first`.
pub(super) fn pmass(f: &mut Fields, first: usize) -> Pmass {
    Pmass {
        id: f.id(first, "PID"),
        mass: f.real_or(first + 1, "M", 0.0),
    }
}

/// Reads NSM and NSML (pairs of id and value, one entry for each pair), and NSM1 and NSML1 (one value for a list of ids).
pub(super) fn nonstructural(f: &mut Fields, cards: &mut Cards) {
    let lumped = f.name.starts_with(b"NSML");
    let (sid, of) = (f.id(0, "SID"), f.word(1).to_uppercase());
    let mut entries: Vec<(Option<Vec<IdList>>, f64)> = Vec::new();
    if f.name.ends_with(b"1") {
        let value = f.real_or(2, "VALUE", 0.0);
        let ids = if f.is_word(3, "ALL") {
            None
        } else {
            Some(id_lists(f, 3, "ID"))
        };
        entries.push((ids, value));
    } else {
        for i in (2..f.len()).step_by(2) {
            if !f.is_blank(i) {
                let id = f.id(i, "ID");
                let value = f.real_or(i + 1, "VALUE", 0.0);
                entries.push((Some(vec![IdList::Each(vec![id])]), value));
            }
        }
    }
    if f.unusable {
        return;
    }
    let card = |(ids, value)| NonstructuralMass {
        sid,
        lumped,
        of: of.clone(),
        ids,
        value,
    };
    let cards_of = entries.into_iter().map(|e| PlacedCard {
        card: card(e),
        at: f.at,
    });
    cards.nsms.extend(cards_of);
}
