//! Displacements from the displacement frames of the grids to basic.

use super::ids::Ids;
use crate::model::{Model, Vec3};
use nastran::results::{Block, Rows};

/// Returns the displacements by grid index in the basic frame, NaN at grids that the block lacks: `basic = R' local` for translation and rotation. A
/// table that is already in basic stays unchanged.
pub(super) fn to_basic(model: &Model, block: &Block, rows: &Rows) -> Vec<[f64; 6]> {
    let mut all = vec![[f64::NAN; 6]; model.grids.len()];
    let mut ids = Ids::new(&model.grids, |g| g.id);
    for (i, id) in rows.ids.iter().enumerate() {
        let &[a, b, c, d, e, f] = rows.row(i) else {
            continue;
        };
        let Some(ix) = ids.find(id.entity) else {
            continue;
        };
        let (Some(grid), Some(place)) = (model.grids.get(ix), all.get_mut(ix)) else {
            continue;
        };
        *place = match model.frames.get(grid.cd.us()) {
            Some(frame) if grid.cd.0 != 0 && !block.is_in_basic() => {
                let back = frame.axes_at(grid.x).transpose();
                let (u, r) = (back * Vec3::new(a, b, c), back * Vec3::new(d, e, f));
                [u.x, u.y, u.z, r.x, r.y, r.z]
            }
            _ => [a, b, c, d, e, f],
        };
    }
    all
}
