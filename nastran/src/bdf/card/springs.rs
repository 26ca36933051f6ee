//! CBUSH, CELAS1 to CELAS4, PBUSH, PELAS.

use super::super::fault::DeckFaultKind;
use super::super::fields::Fields;
use super::line::orientation;
use crate::cards::{Bush, Pbush, Pelas, Spring, SpringStiffness};

pub(super) fn bush(f: &mut Fields) -> Bush {
    Bush {
        id: f.id(0, "EID"),
        pid: f.opt_id(1, "PID"),
        grids: (f.id(2, "GA"), f.opt_id(3, "GB").filter(|&g| g > 0)),
        orientation: orientation(f, 4),
        cid: f.opt_id(7, "CID"),
        s: f.opt_real(8, "S"),
        ocid: f.opt_signed(9, "OCID"),
        offset: f.reals(10, ["S1", "S2", "S3"]),
    }
}

/// Reads a grid and its component from field `i` on; `None` is ground.
pub(super) fn end(f: &mut Fields, i: usize) -> Option<(u32, u8)> {
    let grid = f.opt_id(i, "G").filter(|&g| g > 0)?;
    Some((grid, f.component(i + 1, "C")))
}

/// Reads a scalar point from field `i`; `None` is ground.
pub(super) fn scalar_end(f: &mut Fields, i: usize) -> Option<(u32, u8)> {
    f.opt_id(i, "S").filter(|&s| s > 0).map(|s| (s, 0))
}

pub(super) fn spring(f: &mut Fields) -> Spring {
    let id = f.id(0, "EID");
    let stiffness = if f.name == b"CELAS2" {
        SpringStiffness::Direct {
            k: f.required_real(1, "K"),
            damping: f.real_or(6, "GE", 0.0),
            stress_coefficient: f.real_or(7, "S", 0.0),
        }
    } else {
        SpringStiffness::Property(f.opt_id(1, "PID"))
    };
    Spring {
        id,
        stiffness,
        ends: [end(f, 2), end(f, 4)],
    }
}

/// Reads CELAS3 and CELAS4, which join two scalar points, or a scalar point and ground.
pub(super) fn scalar_spring(f: &mut Fields) -> Spring {
    let id = f.id(0, "EID");
    let stiffness = if f.name == b"CELAS4" {
        SpringStiffness::Direct {
            k: f.required_real(1, "K"),
            damping: 0.0,
            stress_coefficient: 0.0,
        }
    } else {
        SpringStiffness::Property(f.opt_id(1, "PID"))
    };
    Spring {
        id,
        stiffness,
        ends: [scalar_end(f, 2), scalar_end(f, 3)],
    }
}

/// Reads PBUSH. Field 3 of a line states the kind of its values: K, B, GE, RCV, M.
pub(super) fn pbush(f: &mut Fields) -> Pbush {
    let mut p = Pbush {
        id: f.id(0, "PID"),
        k: [0.0; 6],
        rigid: [false; 6],
        b: [0.0; 6],
        ge: [0.0; 6],
        recovery: [1.0; 4],
        mass: 0.0,
    };
    for line in (0..f.len()).step_by(8) {
        let first = line + 2;
        if f.is_blank(line + 1) {
            continue;
        }
        match f.word(line + 1).as_str() {
            "K" => {
                for (k, (stiffness, rigid)) in p.k.iter_mut().zip(&mut p.rigid).enumerate() {
                    *rigid = f.is_word(first + k, "RIGID");
                    *stiffness = if *rigid {
                        0.0
                    } else {
                        f.real_or(first + k, "K", 0.0)
                    };
                }
            }
            "B" => p.b = f.reals(first, ["B1", "B2", "B3", "B4", "B5", "B6"]),
            "GE" => {
                p.ge = f.reals(first, ["GE1", "GE2", "GE3", "GE4", "GE5", "GE6"]);
                // If only GE1 is given, it applies to all components.
                if (first + 1..first + 6).all(|i| f.is_blank(i)) {
                    p.ge = [p.ge[0]; 6];
                }
            }
            "RCV" => {
                for (k, r) in p.recovery.iter_mut().enumerate() {
                    *r = f.real_or(first + k, "RCV", 1.0);
                }
            }
            "M" => p.mass = f.real_or(first, "M", 0.0),
            "T" | "ALPHA" => {}
            found => {
                let found = found.to_owned();
                f.fault(
                    line + 1,
                    "TYPE",
                    DeckFaultKind::NotOneOf {
                        found,
                        allowed: "K, B, GE, RCV, M",
                    },
                );
            }
        }
    }
    p
}

/// Reads the property of a PELAS that begins at field `first`.
pub(super) fn pelas(f: &mut Fields, first: usize) -> Pelas {
    Pelas {
        id: f.id(first, "PID"),
        k: f.real_or(first + 1, "K", 0.0),
        ge: f.real_or(first + 2, "GE", 0.0),
        s: f.real_or(first + 3, "S", 0.0),
    }
}
