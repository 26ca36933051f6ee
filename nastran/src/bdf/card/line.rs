//! CBAR, CBEAM, BAROR, BEAMOR, CROD, CTUBE, CONROD.

use super::super::fault::DeckFaultKind;
use super::super::fields::{Fields, Value};
use crate::cards::{Bar, BarDefaults, Beam, Conrod, Orientation, Rod};

/// Reads X1 X2 X3 or G0 from field `i` on; a single integer is a grid.
pub(super) fn orientation(f: &mut Fields, i: usize) -> Orientation {
    if (i..i + 3).all(|k| f.is_blank(k)) {
        return Orientation::Blank;
    }
    if let Value::Integer(g0) = f.value(i)
        && f.is_blank(i + 1)
        && f.is_blank(i + 2)
    {
        return match u32::try_from(g0) {
            Ok(g0 @ 1..) => Orientation::Grid(g0),
            _ => {
                let found = f.word(i);
                f.fault(
                    i,
                    "G0",
                    DeckFaultKind::OutOfRange {
                        found,
                        allowed: "1 and more",
                    },
                );
                Orientation::Blank
            }
        };
    }
    Orientation::Vector(f.reals(i, ["X1", "X2", "X3"]))
}

/// Reads OFFT. NASTRAN-95 has an integer there (1 vector, 2 grid), which adds no information.
fn offt(f: &mut Fields, i: usize) -> Option<[u8; 3]> {
    match f.value(i) {
        Value::Blank | Value::Integer(_) => None,
        Value::Real(_) => None,
        Value::Text => match *f.bytes_at(i).to_ascii_uppercase().as_slice() {
            [a @ (b'G' | b'B'), b @ (b'G' | b'O'), c @ (b'G' | b'O')] => Some([a, b, c]),
            // NX and newer MSC: E is an offset in the element frame, B in the basic frame.
            [
                a @ (b'G' | b'B'),
                b @ (b'G' | b'O' | b'B' | b'E'),
                c @ (b'G' | b'O' | b'B' | b'E'),
            ] => Some([a, b, c]),
            _ => {
                let found = f.word(i);
                f.fault(
                    i,
                    "OFFT",
                    DeckFaultKind::NotOneOf {
                        found,
                        allowed: "GGG, BGG, GGO, BGO, GOG, BOG, GOO, BOO",
                    },
                );
                None
            }
        },
    }
}

pub(super) fn bar(f: &mut Fields) -> Bar {
    Bar {
        id: f.id(0, "EID"),
        pid: f.opt_id(1, "PID"),
        grids: [f.id(2, "GA"), f.id(3, "GB")],
        orientation: orientation(f, 4),
        offt: offt(f, 7),
        pins: [f.dofs(8, "PA"), f.dofs(9, "PB")],
        offsets: [
            f.reals(10, ["W1A", "W2A", "W3A"]),
            f.reals(13, ["W1B", "W2B", "W3B"]),
        ],
    }
}

pub(super) fn beam(f: &mut Fields) -> Beam {
    let bit = match f.value(7) {
        Value::Real(x) => Some(x),
        _ => None,
    };
    Beam {
        bar: bar(f),
        bit,
        warping: [f.opt_id(16, "SA"), f.opt_id(17, "SB")],
    }
}

pub(super) fn bar_defaults(f: &mut Fields) -> BarDefaults {
    BarDefaults {
        pid: f.opt_id(1, "PID"),
        orientation: orientation(f, 4),
        offt: offt(f, 7),
    }
}

pub(super) fn rod(f: &mut Fields) -> Rod {
    Rod {
        id: f.id(0, "EID"),
        pid: f.opt_id(1, "PID"),
        grids: [f.id(2, "G1"), f.id(3, "G2")],
        is_tube: f.name == b"CTUBE",
    }
}

pub(super) fn conrod(f: &mut Fields) -> Conrod {
    Conrod {
        id: f.id(0, "EID"),
        grids: [f.id(1, "G1"), f.id(2, "G2")],
        mid: f.id(3, "MID"),
        area: f.real_or(4, "A", 0.0),
        torsion: f.real_or(5, "J", 0.0),
        c: f.real_or(6, "C", 0.0),
        nsm: f.real_or(7, "NSM", 0.0),
    }
}
