//! RBE1, RBE2, RBE3, RBAR, RBAR1, RTRPLT, RSPLINE.

use super::super::fault::DeckFaultKind;
use super::super::fields::{Fields, Value};
use super::ids::id_lists;
use crate::cards::{Dofs, IdList, Rbar, Rbe1, Rbe2, Rbe3, Rbe3Group, Rspline};

/// Reads grids up to the first real, which is ALPHA.
pub(super) fn rbe2(f: &mut Fields) -> Rbe2 {
    let id = f.id(0, "EID");
    let independent = f.id(1, "GN");
    let dofs = f.dofs(2, "CM");
    let end = (3..f.len())
        .find(|&i| matches!(f.value(i), Value::Real(_)))
        .unwrap_or(f.len());
    let alpha = f.real_or(end, "ALPHA", 0.0);
    let mut dependent = Vec::with_capacity(end.saturating_sub(3));
    if (3..end).any(|i| f.is_text(i)) {
        for list in id_lists(f, 3, "GM") {
            match list {
                IdList::Each(ids) => dependent.extend(ids),
                IdList::Thru(a, b) => dependent.extend(f.written_out(3, "GM", a..=b, 1)),
            }
        }
    } else {
        for i in 3..end {
            if !f.is_blank(i) {
                dependent.push(f.id(i, "GM"));
            }
        }
    }
    Rbe2 {
        id,
        independent,
        dofs,
        dependent,
        alpha,
    }
}

pub(super) fn rbe3(f: &mut Fields) -> Rbe3 {
    let id = f.id(0, "EID");
    let reference = f.id(2, "REFGRID");
    let refc = f.dofs(3, "REFC");
    let mut groups: Vec<Rbe3Group> = Vec::new();
    let end = f.len();
    let mut i = 4;
    while i < end && !f.is_word(i, "UM") && !f.is_word(i, "ALPHA") {
        match f.value(i) {
            Value::Blank => i += 1,
            Value::Real(weight) => {
                groups.push(Rbe3Group {
                    weight,
                    dofs: f.dofs(i + 1, "C"),
                    grids: Vec::new(),
                });
                i += 2;
            }
            Value::Integer(_) => {
                let grid = f.id(i, "G");
                match groups.last_mut() {
                    Some(group) => group.grids.push(grid),
                    None => {
                        f.required_real(i, "WT1");
                    }
                }
                i += 1;
            }
            Value::Text if f.is_word(i, "THRU") => {
                let upper = f.opt_id(i + 1, "G").unwrap_or(0);
                if let Some(group) = groups.last_mut()
                    && let Some(&lower) = group.grids.last()
                    && upper > lower
                {
                    group
                        .grids
                        .extend(f.written_out(i + 1, "G", lower + 1..=upper, 1));
                }
                i += 2;
            }
            Value::Text => {
                f.opt_real(i, "WT");
                i += 1;
            }
        }
    }
    if groups.iter().all(|g| g.grids.is_empty()) {
        f.fault(6, "G1,1", DeckFaultKind::Missing);
    }
    let mut um = Vec::new();
    let mut alpha = 0.0;
    while i < end {
        if f.is_blank(i) || f.is_word(i, "UM") {
            i += 1;
        } else if f.is_word(i, "ALPHA") {
            alpha = f.real_or(i + 1, "ALPHA", 0.0);
            break;
        } else {
            um.push((f.id(i, "GM"), f.dofs(i + 1, "CM")));
            i += 2;
        }
    }
    Rbe3 {
        id,
        reference,
        refc,
        groups,
        um,
        alpha,
    }
}

pub(super) fn rbe1(f: &mut Fields) -> Rbe1 {
    let mut card = Rbe1 {
        id: f.id(0, "EID"),
        independent: Vec::new(),
        dependent: Vec::new(),
        alpha: 0.0,
    };
    let mut in_um = false;
    let mut i = 1;
    while i < f.len() {
        match f.value(i) {
            Value::Blank => i += 1,
            Value::Text if f.is_word(i, "UM") => {
                in_um = true;
                i += 1;
            }
            Value::Text if f.is_word(i, "ALPHA") => i += 1,
            Value::Real(alpha) => {
                card.alpha = alpha;
                break;
            }
            _ => {
                let term: (u32, Dofs) = (f.id(i, "G"), f.dofs(i + 1, "C"));
                if in_um {
                    card.dependent.push(term)
                } else {
                    card.independent.push(term)
                }
                i += 2;
            }
        }
    }
    card
}

pub(super) fn rbar(f: &mut Fields) -> Rbar {
    Rbar {
        id: f.id(0, "EID"),
        grids: [f.id(1, "GA"), f.id(2, "GB")],
        independent: [f.dofs(3, "CNA"), f.dofs(4, "CNB")],
        dependent: [f.dofs(5, "CMA"), f.dofs(6, "CMB")],
        alpha: f.real_or(7, "ALPHA", 0.0),
    }
}

/// Reads RBAR1, an RBAR with six independent dofs at A. The dofs CB at B are dependent, or all dofs at B if CB is blank.
pub(super) fn rbar1(f: &mut Fields) -> Rbar {
    let of_b = Some(f.dofs(3, "CB")).filter(|d| !d.is_empty());
    Rbar {
        id: f.id(0, "EID"),
        grids: [f.id(1, "GA"), f.id(2, "GB")],
        independent: [Dofs::ALL, Dofs::default()],
        dependent: [Dofs::default(), of_b.unwrap_or(Dofs::ALL)],
        alpha: f.real_or(4, "ALPHA", 0.0),
    }
}

/// Reads RTRPLT, a rigid triangle. If CMA, CMB and CMC are blank, every dof that is not independent is dependent.
pub(super) fn rtrplt(f: &mut Fields) -> Rbe1 {
    let id = f.id(0, "EID");
    let grids = [f.id(1, "GA"), f.id(2, "GB"), f.id(3, "GC")];
    let independent = [f.dofs(4, "CNA"), f.dofs(5, "CNB"), f.dofs(6, "CNC")];
    let mut dependent = [f.dofs(8, "CMA"), f.dofs(9, "CMB"), f.dofs(10, "CMC")];
    if dependent.iter().all(|d| d.is_empty()) {
        dependent = independent.map(|d| Dofs(Dofs::ALL.0 & !d.0));
    }
    let terms = |dofs: [Dofs; 3]| {
        let all = grids.into_iter().zip(dofs);
        all.filter(|t| !t.1.is_empty()).collect()
    };
    Rbe1 {
        id,
        independent: terms(independent),
        dependent: terms(dependent),
        alpha: f.real_or(11, "ALPHA", 0.0),
    }
}

/// Reads RSPLINE: G1, then pairs of grid and dependent dofs.
pub(super) fn rspline(f: &mut Fields) -> Rspline {
    let id = f.id(0, "EID");
    let diameter = f.real_or(1, "D/L", 0.1);
    let mut grids = vec![(f.id(2, "G1"), Dofs::default())];
    let mut i = 3;
    while i < f.len() {
        if !f.is_blank(i) || !f.is_blank(i + 1) {
            grids.push((f.id(i, "G"), f.dofs(i + 1, "C")));
        }
        i += 2;
    }
    Rspline {
        id,
        diameter,
        grids,
    }
}
