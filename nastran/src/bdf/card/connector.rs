//! CWELD, PWELD, CFAST, PFAST, CGAP, PGAP.

use super::super::fields::Fields;
use super::line::orientation;
use crate::cards::{Fastener, Gap, Pfast, Pgap, Pweld, Weld, WeldPatches};

fn grid(f: &mut Fields, i: usize, name: &'static str) -> Option<u32> {
    f.opt_id(i, name).filter(|&g| g > 0)
}

fn point(f: &mut Fields, i: usize) -> Option<[f64; 3]> {
    let stated = (i..i + 3).any(|k| !f.is_blank(k));
    stated.then(|| f.reals(i, ["XS", "YS", "ZS"]))
}

/// Reads a CWELD. Depending on field 4, the second line contains grids, elements or properties. The third line contains a point.
pub(super) fn weld(f: &mut Fields) -> Weld {
    let id = f.id(0, "EID");
    let pid = f.opt_id(1, "PID");
    let gs = grid(f, 2, "GS");
    let format = f.word(3);
    let grids = [grid(f, 4, "GA"), grid(f, 5, "GB")];
    let mut mid_sides = false;
    let patches = match format.as_str() {
        "GRIDID" => {
            let mut side = |first: usize| -> Vec<u32> {
                mid_sides |= (first + 4..first + 8).any(|i| !f.is_blank(i) && !f.is_word(i, "0"));
                (first..first + 4).filter_map(|i| grid(f, i, "G")).collect()
            };
            WeldPatches::Grids([side(8), side(16)])
        }
        "ELEMID" => WeldPatches::Elements(f.id(8, "SHIDA"), grid(f, 9, "SHIDB")),
        "ELPAT" => WeldPatches::ElementPatches(f.id(8, "SHIDA"), f.id(9, "SHIDB")),
        "PARTPAT" => WeldPatches::Properties(f.id(8, "PIDA"), f.id(9, "PIDB")),
        "ALIGN" => WeldPatches::Align,
        _ => WeldPatches::Unknown(format),
    };
    let xs = match patches {
        WeldPatches::ElementPatches(..) | WeldPatches::Properties(..) => point(f, 16),
        _ => None,
    };
    Weld {
        id,
        pid,
        gs,
        patches,
        grids,
        xs,
        mid_sides,
    }
}

pub(super) fn pweld(f: &mut Fields) -> Pweld {
    Pweld {
        id: f.id(0, "PID"),
        mid: f.id(1, "MID"),
        d: f.required_real(2, "D"),
        spot: (3..8).any(|i| f.is_word(i, "SPOT")),
        ld: [f.real_or(8, "LDMIN", 0.2), f.real_or(9, "LDMAX", 5.0)],
    }
}

pub(super) fn fastener(f: &mut Fields) -> Fastener {
    Fastener {
        id: f.id(0, "EID"),
        pid: f.opt_id(1, "PID"),
        kind: f.word(2),
        patches: [f.id(3, "IDA"), f.id(4, "IDB")],
        gs: grid(f, 5, "GS"),
        grids: [grid(f, 6, "GA"), grid(f, 7, "GB")],
        xs: point(f, 8),
    }
}

pub(super) fn pfast(f: &mut Fields) -> Pfast {
    Pfast {
        id: f.id(0, "PID"),
        d: f.required_real(1, "D"),
        mcid: f
            .opt_signed(2, "MCID")
            .and_then(|cid| u32::try_from(cid).ok()),
        absolute: f.opt_id(3, "MFLAG") == Some(1),
        k: f.reals(4, ["KT1", "KT2", "KT3", "KR1", "KR2", "KR3"]),
        mass: f.real_or(10, "MASS", 0.0),
    }
}

pub(super) fn gap(f: &mut Fields) -> Gap {
    Gap {
        id: f.id(0, "EID"),
        pid: f.opt_id(1, "PID"),
        grids: [f.id(2, "GA"), f.id(3, "GB")],
        orientation: orientation(f, 4),
        cid: f.opt_id(7, "CID"),
    }
}

pub(super) fn pgap(f: &mut Fields) -> Pgap {
    Pgap {
        id: f.id(0, "PID"),
        u0: f.real_or(1, "U0", 0.0),
        f0: f.real_or(2, "F0", 0.0),
        ka: f.real_or(3, "KA", 1e8),
        kb: f.opt_real(4, "KB"),
        kt: f.opt_real(5, "KT"),
        mu1: f.real_or(6, "MU1", 0.0),
    }
}
