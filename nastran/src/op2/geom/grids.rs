//! GRID, SPOINT and coordinate systems.

use super::fields::Fields;
use crate::cards::{Coord, CoordDefinition, CoordKind, Grid, IdList};

/// Reads GRID: `id cp x1 x2 x3 cd ps seid`, 8 words, or 11 if the coordinates are double.
pub(super) fn grid(f: &mut Fields<'_>) -> Option<Grid> {
    Some(Grid {
        id: f.id()?,
        cp: Some(f.id_or_zero()?),
        x: f.reals()?,
        cd: Some(f.read_signed_id().filter(|cd| *cd >= -1)?),
        ps: f.blank_or_dofs()?,
        seid: f.blank_or_id()?,
    })
}

/// Reads SPOINT: `id`.
pub(super) fn spoint(f: &mut Fields<'_>) -> Option<IdList> {
    Some(IdList::Each(vec![f.id()?]))
}

/// Reads CORD1R, CORD1C, CORD1S: `cid kind 1 g1 g2 g3`.
pub(super) fn cord1(f: &mut Fields<'_>) -> Option<Coord> {
    let (id, kind) = head(f, 1)?;
    Some(Coord {
        id,
        kind,
        definition: CoordDefinition::Grids(f.ids()?),
    })
}

/// Reads CORD2R, CORD2C, CORD2S: `cid kind 2 rid a b c`, 13 words, or 22 if the points are double.
pub(super) fn cord2(f: &mut Fields<'_>) -> Option<Coord> {
    let (id, kind) = head(f, 2)?;
    let rid = f.id_or_zero()?;
    Some(Coord {
        id,
        kind,
        definition: CoordDefinition::Points {
            rid,
            a: f.reals()?,
            b: f.reals()?,
            c: f.reals()?,
        },
    })
}

fn head(f: &mut Fields<'_>, form: i64) -> Option<(u32, CoordKind)> {
    let id = f.id()?;
    let kind = match f.int()? {
        1 => CoordKind::Rectangular,
        2 => CoordKind::Cylindrical,
        3 => CoordKind::Spherical,
        _ => return None,
    };
    (f.int()? == form).then_some((id, kind))
}
