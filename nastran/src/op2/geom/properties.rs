//! Properties of shells, rods, bushes, springs and solids.

use super::fields::Fields;
use crate::cards::{Pbush, Pcomp, Pelas, Ply, Prod, Pshear, Pshell, Psolid, Ptube};

/// Reads PSHELL: `pid mid1 t mid2 12i/t3 mid3 ts/t nsm z1 z2 mid4`.
pub(super) fn pshell(f: &mut Fields<'_>) -> Option<Pshell> {
    Some(Pshell {
        id: f.id()?,
        mid1: f.blank_or_id()?,
        t: f.blank_or_real()?,
        mid2: Some(f.read_signed_id()?).filter(|mid| *mid != 0),
        bending_ratio: f.blank_or_real()?,
        mid3: f.blank_or_id()?,
        shear_ratio: f.blank_or_real()?,
        nsm: f.blank_or_real()?,
        z1: f.blank_or_real()?,
        z2: f.blank_or_real()?,
        mid4: f.blank_or_id()?,
    })
}

/// Reads PCOMP: `pid n z0 nsm sb ft tref ge`, then n times `mid t theta sout`. A negative n means symmetric. If n is 0, the plies end with four words
/// -1.
pub(super) fn pcomp(f: &mut Fields<'_>) -> Option<Pcomp> {
    let id = f.id()?;
    let n = f.int()?;
    let mut pcomp = laminate(f, id)?;
    pcomp.symmetric = n < 0;
    pcomp.lam = if n < 0 {
        "SYM".to_owned()
    } else {
        String::new()
    };
    let n = if n == 0 { u64::MAX } else { n.unsigned_abs() };
    while (pcomp.plies.len() as u64) < n && f.words_left() > 0 && f.peek() != Some(-1) {
        pcomp.plies.push(ply(f)?);
    }
    if f.words_left() >= 4 && f.peek() == Some(-1) {
        f.skip(4)?;
    }
    (n == u64::MAX || pcomp.plies.len() as u64 == n).then_some(pcomp)
}

/// Reads PCOMPG: `pid lam z0 nsm sb ft tref ge`, then `ply mid t theta sout` for each ply, up to five words -1.
pub(super) fn pcompg(f: &mut Fields<'_>) -> Option<Pcomp> {
    let id = f.id()?;
    f.skip(1)?;
    let mut pcomp = laminate(f, id)?;
    while f.peek()? != -1 {
        f.skip(1)?;
        pcomp.plies.push(ply(f)?);
    }
    f.skip(5)?;
    Some(pcomp)
}

fn laminate(f: &mut Fields<'_>, id: u32) -> Option<Pcomp> {
    let z0 = f.blank_or_real()?;
    let nsm = f.read_real()?;
    let sb = f.blank_or_real()?.filter(|sb| *sb != 0.0);
    f.skip(1)?;
    Some(Pcomp {
        id,
        z0,
        nsm,
        sb,
        tref: f.blank_or_real()?,
        ge: f.read_real()?,
        symmetric: false,
        lam: String::new(),
        plies: Vec::new(),
    })
}

fn ply(f: &mut Fields<'_>) -> Option<Ply> {
    Some(Ply {
        mid: f.id()?,
        t: f.read_real()?,
        theta_deg: f.read_real()?,
        output: f.int()? != 0,
    })
}

/// Reads PSHEAR: `pid mid t nsm f1 f2`.
pub(super) fn pshear(f: &mut Fields<'_>) -> Option<Pshear> {
    Some(Pshear {
        id: f.id()?,
        mid: f.id()?,
        t: f.read_real()?,
        nsm: f.read_real()?,
        f1: f.read_real()?,
        f2: f.read_real()?,
    })
}

/// Reads PROD: `pid mid a j c nsm`.
pub(super) fn prod(f: &mut Fields<'_>) -> Option<Prod> {
    Some(Prod {
        id: f.id()?,
        mid: f.id()?,
        area: f.read_real()?,
        j: f.read_real()?,
        c: f.read_real()?,
        nsm: f.read_real()?,
    })
}

/// Reads PTUBE: `pid mid od t nsm`, and od2 in some versions.
pub(super) fn ptube(f: &mut Fields<'_>) -> Option<Ptube> {
    let (id, mid, od, t, nsm) = (
        f.id()?,
        f.id()?,
        f.read_real()?,
        f.read_real()?,
        f.read_real()?,
    );
    let od2 = if f.words_left() > 0 {
        f.blank_or_real()?.filter(|d| *d != 0.0)
    } else {
        None
    };
    Some(Ptube {
        id,
        mid,
        od,
        t: Some(t).filter(|t| *t != 0.0),
        nsm,
        od2,
    })
}

/// Reads PBUSH: `pid k1..k6 b1..b6`, then `ge1 sa st ea et` (18 words) or `ge1..ge6 sa st ea et` (23 words). With 24 words or more the mass follows.
pub(super) fn pbush(f: &mut Fields<'_>) -> Option<Pbush> {
    let n = f.words_left();
    let (id, k, b) = (f.id()?, f.reals()?, f.reals()?);
    let ge = if n < 23 {
        [f.read_real()?; 6]
    } else {
        f.reals()?
    };
    let recovery = f.reals()?;
    let mass = if n > 23 {
        f.blank_or_real()?.unwrap_or(0.0)
    } else {
        0.0
    };
    Some(Pbush {
        id,
        k,
        rigid: [false; 6],
        b,
        ge,
        recovery,
        mass,
    })
}

/// Reads PELAS: `pid k ge s`.
pub(super) fn pelas(f: &mut Fields<'_>) -> Option<Pelas> {
    Some(Pelas {
        id: f.id()?,
        k: f.read_real()?,
        ge: f.read_real()?,
        s: f.read_real()?,
    })
}

/// Reads PSOLID: `pid mid cordm in stress isop fctn`; options as numbers, 0 where blank.
pub(super) fn psolid(f: &mut Fields<'_>) -> Option<Psolid> {
    let (id, mid, cordm) = (f.id()?, f.id_or_zero()?, f.read_signed_id()?);
    let mut options: [Option<String>; 4] = Default::default();
    for option in options.iter_mut().take(3) {
        *option = Some(f.int()?).filter(|v| *v != 0).map(|v| v.to_string());
    }
    if let Some(fctn) = options.last_mut() {
        *fctn = Some(f.text(1)?).filter(|t| !t.is_empty());
    }
    Some(Psolid {
        id,
        mid,
        cordm: Some(cordm).filter(|c| *c != 0),
        options,
    })
}
