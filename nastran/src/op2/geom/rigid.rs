//! Rigid elements and multi-point constraints.

use super::fields::Fields;
use super::records::Record;
use crate::cards::{Dofs, Mpc, Rbar, Rbe1, Rbe2, Rbe3, Rbe3Group};

/// Reads RBAR: `eid ga gb cna cnb cma cmb`, 7 words; 8 and 9 with alpha and a reference temperature.
pub(super) fn rbar(f: &mut Fields<'_>) -> Option<Rbar> {
    let (id, grids) = (f.id()?, f.ids()?);
    let mut c = [Dofs(0); 4];
    for c in &mut c {
        *c = f.blank_or_dofs()?.unwrap_or_default();
    }
    let [cna, cnb, cma, cmb] = c;
    let alpha = if f.words_left() > 0 {
        f.read_real()?
    } else {
        0.0
    };
    Some(Rbar {
        id,
        grids,
        independent: [cna, cnb],
        dependent: [cma, cmb],
        alpha,
    })
}

/// Reads RBE1: `eid (gn cn) .. -2 -2 (gm cm) .. -1 -1`, and further words in newer versions (alpha first).
pub(super) fn rbe1(record: Record<'_>) -> impl Fn(&mut Fields<'_>) -> Option<Rbe1> {
    let tail = record.tail(-1);
    move |f| {
        Some(Rbe1 {
            id: f.id()?,
            independent: pairs(f, -2)?,
            dependent: pairs(f, -1)?,
            alpha: alpha(f, tail)?,
        })
    }
}

/// Reads RBE2: `eid gn cm gm .. -1`. Newer versions add alpha, and the newest also a reference temperature.
pub(super) fn rbe2(record: Record<'_>) -> impl Fn(&mut Fields<'_>) -> Option<Rbe2> {
    let tail = record.tail(-1);
    move |f| {
        let (id, independent, dofs) = (f.id()?, f.id()?, f.dofs()?);
        let (dependent, mark) = f.ids_until_mark()?;
        (mark == -1).then_some(())?;
        Some(Rbe2 {
            id,
            independent,
            dofs,
            dependent,
            alpha: alpha(f, tail)?,
        })
    }
}

/// Reads RBE3: `eid refg refc, (wt c g .. -1) .., -2, (gm cm) .., -3`, then the end of RBE2. Old versions omit -2 in files without UM.
pub(super) fn rbe3(record: Record<'_>) -> impl Fn(&mut Fields<'_>) -> Option<Rbe3> {
    let tail = record.tail(-3);
    move |f| {
        let (id, reference, refc) = (f.id()?, f.id()?, f.dofs()?);
        let (mut groups, mut um, mut mark) = (Vec::new(), Vec::new(), -1);
        while mark == -1 {
            if let Some(end @ (-2 | -3)) = f.peek() {
                f.skip(1)?;
                mark = end;
                break;
            }
            let (weight, dofs) = (f.read_real()?, f.dofs()?);
            let (grids, end) = f.ids_until_mark()?;
            mark = end;
            groups.push(Rbe3Group {
                weight,
                dofs,
                grids,
            });
        }
        if mark == -2 {
            while f.peek()? != -3 {
                um.push((f.id()?, f.dofs()?));
            }
            f.skip(1)?;
        }
        Some(Rbe3 {
            id,
            reference,
            refc,
            groups,
            um,
            alpha: alpha(f, tail)?,
        })
    }
}

/// Reads MPC: `sid (g c a) .. -1 -1 -1`.
pub(super) fn mpc(f: &mut Fields<'_>) -> Option<Mpc> {
    let sid = f.id()?;
    let mut terms = Vec::new();
    loop {
        if f.peek()? == -1 {
            f.skip(3)?;
            return Some(Mpc { sid, terms });
        }
        terms.push((
            f.id()?,
            u8::try_from(f.int()?).ok().filter(|c| *c <= 6)?,
            f.read_real()?,
        ));
    }
}

/// Reads pairs of grid and component up to a pair of marks.
pub(super) fn pairs(f: &mut Fields<'_>, mark: i64) -> Option<Vec<(u32, Dofs)>> {
    let mut pairs = Vec::new();
    while f.peek()? != mark {
        pairs.push((f.id()?, f.dofs()?));
    }
    f.skip(2)?;
    Some(pairs)
}

fn alpha(f: &mut Fields<'_>, tail: usize) -> Option<f64> {
    let mut values = *f;
    f.skip(tail)?;
    if tail == 0 {
        Some(0.0)
    } else {
        values.read_real()
    }
}
