//! CONM1, CONM2.

use super::super::fields::Fields;
use crate::cards::{Conm1, Conm2};

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
