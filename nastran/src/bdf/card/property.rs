//! PSHELL, PCOMP, PCOMPG, PSHEAR, PBAR, PROD, PTUBE, PSOLID.

use super::super::fault::DeckFaultKind;
use super::super::fields::Fields;
use crate::cards::{Pbar, Pcomp, Ply, Prod, Pshear, Pshell, Psolid, Ptube};

pub(super) fn pshell(f: &mut Fields) -> Pshell {
    Pshell {
        id: f.id(0, "PID"),
        mid1: f.opt_id(1, "MID1").filter(|&m| m > 0),
        t: f.opt_real(2, "T"),
        mid2: f.opt_signed(3, "MID2").filter(|&m| m != 0),
        bending_ratio: f.opt_real(4, "12I/T**3"),
        mid3: f.opt_id(5, "MID3").filter(|&m| m > 0),
        shear_ratio: f.opt_real(6, "TS/T"),
        nsm: f.opt_real(7, "NSM"),
        z1: f.opt_real(8, "Z1"),
        z2: f.opt_real(9, "Z2"),
        mid4: f.opt_id(10, "MID4").filter(|&m| m > 0),
    }
}

pub(super) fn pcomp(f: &mut Fields) -> Pcomp {
    let id = f.id(0, "PID");
    let z0 = f.opt_real(1, "Z0");
    let nsm = f.real_or(2, "NSM", 0.0);
    let sb = f.opt_real(3, "SB");
    let tref = f.opt_real(5, "TREF");
    let ge = f.real_or(6, "GE", 0.0);
    let lam = f.word(7);
    let mut plies: Vec<Ply> = Vec::new();
    // A PCOMPG has one ply on each line, which begins with the ply's global number.
    let (step, offset) = if f.name == b"PCOMPG" { (8, 1) } else { (4, 0) };
    for i in (8..f.len()).step_by(step).map(|i| i + offset) {
        if (i..i + 4).all(|k| f.is_blank(k)) {
            continue;
        }
        let last = plies.last().copied();
        let mid = f
            .opt_id(i, "MID")
            .filter(|&m| m > 0)
            .or(last.map(|p| p.mid));
        let t = f.opt_real(i + 1, "T").or(last.map(|p| p.t));
        if mid.is_none() {
            f.fault(i, "MID1", DeckFaultKind::Missing);
        }
        if t.is_none() {
            f.fault(i + 1, "T1", DeckFaultKind::Missing);
        }
        let theta_deg = f.real_or(i + 2, "THETA", 0.0);
        plies.push(Ply {
            mid: mid.unwrap_or(0),
            t: t.unwrap_or(0.0),
            theta_deg,
            output: f.is_word(i + 3, "YES"),
        });
    }
    if plies.is_empty() {
        f.fault(8, "MID1", DeckFaultKind::Missing);
    }
    // SYMEM, SYBEND and SYSMEAR are symmetric laminates, too.
    let symmetric = lam.starts_with("SY");
    Pcomp {
        id,
        z0,
        nsm,
        sb,
        tref,
        ge,
        symmetric,
        lam,
        plies,
    }
}

pub(super) fn pshear(f: &mut Fields) -> Pshear {
    Pshear {
        id: f.id(0, "PID"),
        mid: f.id(1, "MID"),
        t: f.required_real(2, "T"),
        nsm: f.real_or(3, "NSM", 0.0),
        f1: f.real_or(4, "F1", 0.0),
        f2: f.real_or(5, "F2", 0.0),
    }
}

/// Reads the points C D E F, each (y, z), from field `i` on.
pub(super) fn recovery(f: &mut Fields, i: usize) -> [[f64; 2]; 4] {
    const NAMES: [[&str; 2]; 4] = [["C1", "C2"], ["D1", "D2"], ["E1", "E2"], ["F1", "F2"]];
    let mut points = [[0.0; 2]; 4];
    for (k, (point, names)) in points.iter_mut().zip(NAMES).enumerate() {
        *point = f.reals(i + 2 * k, names);
    }
    points
}

pub(super) fn pbar(f: &mut Fields) -> Pbar {
    Pbar {
        id: f.id(0, "PID"),
        mid: f.id(1, "MID"),
        area: f.real_or(2, "A", 0.0),
        i1: f.real_or(3, "I1", 0.0),
        i2: f.real_or(4, "I2", 0.0),
        j: f.real_or(5, "J", 0.0),
        nsm: f.real_or(6, "NSM", 0.0),
        recovery: recovery(f, 8),
        k: [f.opt_real(16, "K1"), f.opt_real(17, "K2")],
        i12: f.real_or(18, "I12", 0.0),
    }
}

pub(super) fn prod(f: &mut Fields) -> Prod {
    Prod {
        id: f.id(0, "PID"),
        mid: f.id(1, "MID"),
        area: f.real_or(2, "A", 0.0),
        j: f.real_or(3, "J", 0.0),
        c: f.real_or(4, "C", 0.0),
        nsm: f.real_or(5, "NSM", 0.0),
    }
}

pub(super) fn ptube(f: &mut Fields) -> Ptube {
    Ptube {
        id: f.id(0, "PID"),
        mid: f.id(1, "MID"),
        od: f.required_real(2, "OD"),
        t: f.opt_real(3, "T"),
        nsm: f.real_or(4, "NSM", 0.0),
        od2: f.opt_real(5, "OD2"),
    }
}

pub(super) fn psolid(f: &mut Fields) -> Psolid {
    let option = |f: &Fields, i| Some(f.word(i)).filter(|w| !w.is_empty());
    Psolid {
        id: f.id(0, "PID"),
        mid: f.id(1, "MID"),
        cordm: f.opt_signed(2, "CORDM"),
        options: [option(f, 3), option(f, 4), option(f, 5), option(f, 6)],
    }
}
