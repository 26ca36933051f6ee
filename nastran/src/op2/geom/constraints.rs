//! Single-point constraints and supports.

use super::fields::Fields;
use crate::cards::{IdList, SetSum, Spc, Spc1, Suport};

/// Reads SPC: `sid g c d`, 4 words; 5 with an unused word before d, 6 if d is double.
pub(super) fn spc(f: &mut Fields<'_>) -> Option<Spc> {
    let (sid, grid, dofs) = (f.id()?, f.id()?, f.dofs()?);
    if f.words_left() > 1 {
        (f.int()? == 0).then_some(())?;
    }
    Some(Spc {
        sid,
        terms: vec![(grid, dofs, f.read_real()?)],
    })
}

/// Reads SPC1: `sid c 0 g .. -1`, or `sid c 1 first last`.
pub(super) fn spc1(f: &mut Fields<'_>) -> Option<Spc1> {
    let (sid, dofs) = (f.id()?, f.dofs()?);
    let grids = match f.int()? {
        0 => IdList::Each(f.ids_until_mark()?.0),
        1 => IdList::Thru(f.id()?, f.id()?),
        _ => return None,
    };
    Some(Spc1 { sid, dofs, grids })
}

/// Reads SPCADD, MPCADD: `sid s .. -1`.
pub(super) fn set_sum(f: &mut Fields<'_>) -> Option<SetSum> {
    Some(SetSum {
        sid: f.id()?,
        sets: f.ids_until_mark()?.0,
    })
}

/// Reads SUPORT: `g c`.
pub(super) fn suport(f: &mut Fields<'_>) -> Option<Suport> {
    Some(Suport {
        sid: None,
        terms: vec![(f.id()?, f.dofs()?)],
    })
}

/// Reads SUPORT1: `sid (g c) .. -1 -1`.
pub(super) fn suport1(f: &mut Fields<'_>) -> Option<Suport> {
    Some(Suport {
        sid: Some(f.id()?),
        terms: super::rigid::pairs(f, -1)?,
    })
}
