//! Bars, beams, rods, bushes and springs.

use super::fields::Fields;
use crate::cards::{Bar, Beam, Bush, Conrod, Orientation, Rod, Spring, SpringStiffness};

/// Reads CBAR: `eid pid ga gb x1 x2 x3 f pa pb w1a w2a w3a w1b w2b w3b`; depending on f, G0 replaces x1.
pub(super) fn bar(f: &mut Fields<'_>) -> Option<Bar> {
    let (id, pid, grids) = (f.id()?, f.id()?, f.ids()?);
    let (orientation, offt) = orientation(f)?;
    rest_of_bar(
        f,
        Bar {
            id,
            pid: Some(pid),
            grids,
            orientation,
            offt,
            pins: Default::default(),
            offsets: [[0.0; 3]; 2],
        },
    )
}

/// Reads CBEAM: `eid pid ga gb sa sb`, then the remaining words of CBAR.
pub(super) fn beam(f: &mut Fields<'_>) -> Option<Beam> {
    let (id, pid, grids) = (f.id()?, f.id()?, f.ids()?);
    let warping = [f.blank_or_id()?, f.blank_or_id()?];
    let (orientation, offt) = orientation(f)?;
    let bar = Bar {
        id,
        pid: Some(pid),
        grids,
        orientation,
        offt,
        pins: Default::default(),
        offsets: [[0.0; 3]; 2],
    };
    Some(Beam {
        bar: rest_of_bar(f, bar)?,
        bit: None,
        warping,
    })
}

/// Reads the orientation and the offset flag f. Bits 1-2: 0 vector in basic, 1 vector in the displacement frame of A, 2 grid. Bits 3-4: offset at A
/// (0 G, 1 O, 2 B). Bits 5-6: offset at B. Bit 7: orientation vector in basic.
fn orientation(f: &mut Fields<'_>) -> Option<(Orientation, Option<[u8; 3]>)> {
    let mut grid = *f;
    let x = f.reals()?;
    let flag = f.int()?;
    let end = |bits: i64| match bits & 3 {
        0 => Some(b'G'),
        1 => Some(b'O'),
        2 => Some(b'B'),
        _ => None,
    };
    let (orientation, vector) = match flag & 3 {
        0 => (Orientation::Vector(x), b'B'),
        1 => (
            Orientation::Vector(x),
            if flag & 64 == 0 { b'G' } else { b'B' },
        ),
        2 => (Orientation::Grid(grid.id()?), b'G'),
        _ => return None,
    };
    Some((
        orientation,
        Some([vector, end(flag >> 2)?, end(flag >> 4)?]),
    ))
}

fn rest_of_bar(f: &mut Fields<'_>, mut bar: Bar) -> Option<Bar> {
    bar.pins = [
        f.blank_or_dofs()?.unwrap_or_default(),
        f.blank_or_dofs()?.unwrap_or_default(),
    ];
    bar.offsets = [f.reals()?, f.reals()?];
    Some(bar)
}

/// Reads CROD, CTUBE: `eid pid g1 g2`.
pub(super) fn rod(f: &mut Fields<'_>, is_tube: bool) -> Option<Rod> {
    Some(Rod {
        id: f.id()?,
        pid: Some(f.id()?),
        grids: f.ids()?,
        is_tube,
    })
}

/// Reads CONROD: `eid g1 g2 mid a j c nsm`.
pub(super) fn conrod(f: &mut Fields<'_>) -> Option<Conrod> {
    Some(Conrod {
        id: f.id()?,
        grids: f.ids()?,
        mid: f.id()?,
        area: f.read_real()?,
        torsion: f.read_real()?,
        c: f.read_real()?,
        nsm: f.read_real()?,
    })
}

/// Reads CBUSH: `eid pid ga gb x1 x2 x3 f cid s ocid s1 s2 s3`. f is -1 with a CID, 0 or 1 with a vector, 2 with a grid instead of x1.
pub(super) fn bush(f: &mut Fields<'_>) -> Option<Bush> {
    let (id, pid, a, b) = (f.id()?, f.id()?, f.id()?, f.blank_or_id()?);
    let mut grid = *f;
    let x: [f64; 3] = f.reals()?;
    let orientation = match f.int()? {
        -1 => Orientation::Blank,
        0 | 1 if x == [0.0; 3] => Orientation::Blank,
        0 | 1 => Orientation::Vector(x),
        2 => Orientation::Grid(grid.id()?),
        _ => return None,
    };
    let cid = f.int()?;
    let s = f.blank_or_real()?;
    let ocid = f.read_signed_id()?;
    Some(Bush {
        id,
        pid: Some(pid),
        grids: (a, b),
        orientation,
        cid: u32::try_from(cid).ok(),
        s,
        ocid: Some(ocid).filter(|c| *c >= 0),
        offset: f.reals()?,
    })
}

/// Reads CELAS1: `eid pid g1 g2 c1 c2`.
pub(super) fn celas1(f: &mut Fields<'_>) -> Option<Spring> {
    let (id, pid) = (f.id()?, f.id()?);
    Some(Spring {
        id,
        stiffness: SpringStiffness::Property(Some(pid)),
        ends: ends(f)?,
    })
}

/// Reads CELAS2: `eid k g1 g2 c1 c2 ge s`.
pub(super) fn celas2(f: &mut Fields<'_>) -> Option<Spring> {
    let (id, k) = (f.id()?, f.read_real()?);
    let ends = ends(f)?;
    Some(Spring {
        id,
        stiffness: SpringStiffness::Direct {
            k,
            damping: f.read_real()?,
            stress_coefficient: f.read_real()?,
        },
        ends,
    })
}

/// Reads CELAS3: `eid pid s1 s2`.
pub(super) fn celas3(f: &mut Fields<'_>) -> Option<Spring> {
    Some(Spring {
        id: f.id()?,
        stiffness: SpringStiffness::Property(Some(f.id()?)),
        ends: points(f)?,
    })
}

/// Reads CELAS4: `eid k s1 s2`.
pub(super) fn celas4(f: &mut Fields<'_>) -> Option<Spring> {
    Some(Spring {
        id: f.id()?,
        stiffness: SpringStiffness::Direct {
            k: f.read_real()?,
            damping: 0.0,
            stress_coefficient: 0.0,
        },
        ends: points(f)?,
    })
}

/// Reads two scalar points; 0 is ground.
pub(super) fn points(f: &mut Fields<'_>) -> Option<[Option<(u32, u8)>; 2]> {
    let points = [f.blank_or_id()?, f.blank_or_id()?];
    Some(points.map(|p| p.map(|p| (p, 0))))
}

/// Reads two grids, then a component of each.
pub(super) fn ends(f: &mut Fields<'_>) -> Option<[Option<(u32, u8)>; 2]> {
    let grids = [f.blank_or_id()?, f.blank_or_id()?];
    let mut ends = [None; 2];
    for (end, grid) in ends.iter_mut().zip(grids) {
        let component = u8::try_from(f.int()?).ok().filter(|c| *c <= 6)?;
        *end = grid.map(|g| (g, component));
    }
    Some(ends)
}
