//! Solids: `eid pid` and the grids, corners first; a missing mid-side grid is 0.

use super::fields::Fields;
use crate::cards::{Solid, SolidShape};

/// Returns the reader of a solid of this shape: CTETRA has 12 words, CPENTA 17, CHEXA 22, CPYRAM 16 (13 grids and a spare word).
pub(super) fn solid(shape: SolidShape) -> impl Fn(&mut Fields<'_>) -> Option<Solid> {
    let n_grids = match shape {
        SolidShape::Tetra => 10,
        SolidShape::Pyram => 13,
        SolidShape::Penta => 15,
        SolidShape::Hexa => 20,
    };
    move |f| {
        let (id, pid) = (f.id()?, f.id()?);
        let mut grids = [0; 20];
        for (i, grid) in grids.iter_mut().take(n_grids).enumerate() {
            *grid = if i < shape.n_corners() {
                f.id()?
            } else {
                f.id_or_zero()?
            };
        }
        Some(Solid {
            id,
            pid: Some(pid),
            shape,
            grids,
        })
    }
}
