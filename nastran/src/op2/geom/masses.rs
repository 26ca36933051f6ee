//! CONM1, CONM2, CMASS1 to CMASS4, PMASS.

use super::fields::Fields;
use super::lines::{ends, points};
use crate::cards::{Conm1, Conm2, Pmass, ScalarMass, ScalarMassValue};

/// Reads CONM1: `eid g cid m1..m21`.
pub(super) fn conm1(f: &mut Fields<'_>) -> Option<Conm1> {
    Some(Conm1 {
        id: f.id()?,
        grid: f.id()?,
        cid: f.id_or_zero()?,
        m: f.reals()?,
    })
}

/// Reads CONM2: `eid g cid m x1 x2 x3 i11 i21 i22 i31 i32 i33`.
pub(super) fn conm2(f: &mut Fields<'_>) -> Option<Conm2> {
    Some(Conm2 {
        id: f.id()?,
        grid: f.id()?,
        cid: f.read_signed_id().filter(|c| *c >= -1)?,
        mass: f.read_real()?,
        offset: f.reals()?,
        inertia: f.reals()?,
    })
}

/// Reads CMASS1: `eid pid g1 g2 c1 c2`.
pub(super) fn cmass1(f: &mut Fields<'_>) -> Option<ScalarMass> {
    mass(f, property, ends)
}

/// Reads CMASS2: `eid m g1 g2 c1 c2`.
pub(super) fn cmass2(f: &mut Fields<'_>) -> Option<ScalarMass> {
    mass(f, value, ends)
}

/// Reads CMASS3: `eid pid s1 s2`.
pub(super) fn cmass3(f: &mut Fields<'_>) -> Option<ScalarMass> {
    mass(f, property, points)
}

/// Reads CMASS4: `eid m s1 s2`.
pub(super) fn cmass4(f: &mut Fields<'_>) -> Option<ScalarMass> {
    mass(f, value, points)
}

/// Reads the id of a scalar mass, then its value or property with `value`, and its ends with `ends`.
fn mass(
    f: &mut Fields<'_>,
    value: fn(&mut Fields<'_>) -> Option<ScalarMassValue>,
    ends: fn(&mut Fields<'_>) -> Option<[Option<(u32, u8)>; 2]>,
) -> Option<ScalarMass> {
    Some(ScalarMass {
        id: f.id()?,
        mass: value(f)?,
        ends: ends(f)?,
    })
}

fn property(f: &mut Fields<'_>) -> Option<ScalarMassValue> {
    Some(ScalarMassValue::Property(Some(f.id()?)))
}

fn value(f: &mut Fields<'_>) -> Option<ScalarMassValue> {
    Some(ScalarMassValue::Direct(f.read_real()?))
}

/// Reads PMASS: `pid m`.
pub(super) fn pmass(f: &mut Fields<'_>) -> Option<Pmass> {
    Some(Pmass {
        id: f.id()?,
        mass: f.read_real()?,
    })
}
