//! CTETRA, CPENTA, CHEXA, CPYRAM.

use super::super::fields::Fields;
use crate::cards::{Solid, SolidShape};

pub(super) fn solid(f: &mut Fields) -> Solid {
    let (shape, n_grids) = match f.name {
        b"CTETRA" => (SolidShape::Tetra, 10),
        b"CPENTA" => (SolidShape::Penta, 15),
        b"CPYRAM" => (SolidShape::Pyram, 13),
        _ => (SolidShape::Hexa, 20),
    };
    let id = f.id(0, "EID");
    let pid = f.opt_id(1, "PID");
    let n_corners = shape.n_corners();
    let mut grids = [0; 20];
    for (k, grid) in grids.iter_mut().take(n_grids).enumerate() {
        *grid = if k < n_corners {
            f.id(2 + k, "G")
        } else {
            f.opt_id(2 + k, "G").unwrap_or(0)
        };
    }
    Solid {
        id,
        pid,
        shape,
        grids,
    }
}
