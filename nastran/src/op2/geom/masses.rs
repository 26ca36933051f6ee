//! CONM1 and CONM2.

use super::fields::Fields;
use crate::cards::{Conm1, Conm2};

/// CONM1: `eid g cid m1..m21`.
pub(super) fn conm1(f: &mut Fields<'_>) -> Option<Conm1> {
    Some(Conm1 {
        id: f.id()?,
        grid: f.id()?,
        cid: f.id_or_zero()?,
        m: f.reals()?,
    })
}

/// CONM2: `eid g cid m x1 x2 x3 i11 i21 i22 i31 i32 i33`.
pub(super) fn conm2(f: &mut Fields<'_>) -> Option<Conm2> {
    Some(Conm2 {
        id: f.id()?,
        grid: f.id()?,
        cid: f.signed().filter(|c| *c >= -1)?,
        mass: f.real()?,
        offset: f.reals()?,
        inertia: f.reals()?,
    })
}
