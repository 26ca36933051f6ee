//! GRID, GRDSET, SPOINT, CORD1x, CORD2x.

use super::super::fields::{Fields, Value};
use crate::cards::{Cards, Coord, CoordDefinition, CoordKind, Grdset, Grid};
use crate::place::PlacedCard;

pub(super) fn grid(f: &mut Fields) -> Grid {
    Grid {
        id: f.id(0, "ID"),
        cp: f.opt_id(1, "CP"),
        x: f.reals(2, ["X1", "X2", "X3"]),
        cd: f.opt_signed(5, "CD"),
        ps: f.opt_dofs(6, "PS"),
        seid: f.opt_id(7, "SEID"),
    }
}

pub(super) fn grdset(f: &mut Fields) -> Grdset {
    Grdset {
        cp: f.opt_id(1, "CP"),
        cd: f.opt_signed(5, "CD"),
        ps: f.opt_dofs(6, "PS"),
        seid: f.opt_id(7, "SEID"),
    }
}

pub(super) fn spoint(f: &mut Fields, cards: &mut Cards) {
    for card in super::ids::id_lists(f, 0, "ID1") {
        cards.spoints.push(PlacedCard { card, at: f.at });
    }
}

/// Reads the ends of CMASSi and CDAMPi that may be scalar points: those without a component.
pub(in super::super) fn connected_points(f: &Fields) -> Vec<u32> {
    let ends: &[(usize, Option<usize>)] = match f.name.last() {
        Some(b'1' | b'2') => &[(2, Some(3)), (4, Some(5))],
        _ => &[(2, None), (3, None)],
    };
    let id = |i| match f.value(i) {
        Value::Integer(n) => u32::try_from(n).ok().filter(|n| *n > 0),
        _ => None,
    };
    let is_scalar = |i| matches!(f.value(i), Value::Blank | Value::Integer(0));
    ends.iter()
        .filter(|(_, component)| component.is_none_or(is_scalar))
        .filter_map(|(end, _)| id(*end))
        .collect()
}

fn kind(name: &[u8]) -> CoordKind {
    match name.last() {
        Some(b'C') => CoordKind::Cylindrical,
        Some(b'S') => CoordKind::Spherical,
        _ => CoordKind::Rectangular,
    }
}

pub(super) fn cord2(f: &mut Fields) -> Coord {
    let id = f.id(0, "CID");
    let definition = CoordDefinition::Points {
        rid: f.opt_id(1, "RID").unwrap_or(0),
        a: f.reals(2, ["A1", "A2", "A3"]),
        b: f.reals(5, ["B1", "B2", "B3"]),
        c: f.reals(8, ["C1", "C2", "C3"]),
    };
    Coord {
        id,
        kind: kind(f.name),
        definition,
    }
}

/// Reads the system of a CORD1R, CORD1C or CORD1S that begins at field `first`.
pub(super) fn cord1(f: &mut Fields, first: usize) -> Coord {
    let id = f.id(first, "CID");
    let grids = [
        f.id(first + 1, "G1"),
        f.id(first + 2, "G2"),
        f.id(first + 3, "G3"),
    ];
    Coord {
        id,
        kind: kind(f.name),
        definition: CoordDefinition::Grids(grids),
    }
}
