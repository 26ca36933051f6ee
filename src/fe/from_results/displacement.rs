//! Displacements from the displacement frames of the grids to basic.

use super::ids::Ids;
use crate::model::{Frame, Mat3, Model, Vec3};
use nastran::cards::CoordKind;
use nastran::results::Rows;

/// The axes of `frame` at the point `x` (basic): rows are the local directions in basic. A point on the axis of a cylindrical or
/// spherical frame has theta (phi) 0.
pub fn local_axes(frame: &Frame, x: &Vec3) -> Mat3 {
    let local = frame.axes * (x - frame.origin);
    let rho = local.x.hypot(local.y);
    let (cos, sin) = if rho > 0.0 {
        (local.x / rho, local.y / rho)
    } else {
        (1.0, 0.0)
    };
    let turn = match frame.kind {
        CoordKind::Rectangular => return frame.axes,
        CoordKind::Cylindrical => Mat3::new(cos, sin, 0.0, -sin, cos, 0.0, 0.0, 0.0, 1.0),
        CoordKind::Spherical => {
            let r = local.norm();
            // theta is the angle from the z axis.
            let (ct, st) = if r > 0.0 {
                (local.z / r, rho / r)
            } else {
                (1.0, 0.0)
            };
            Mat3::new(
                st * cos,
                st * sin,
                ct,
                ct * cos,
                ct * sin,
                -st,
                -sin,
                cos,
                0.0,
            )
        }
    };
    turn * frame.axes
}

/// Displacements by grid index in basic, NaN where the block has none: `basic = R' local` for translation and rotation alike.
pub(super) fn to_basic(model: &Model, rows: &Rows) -> Vec<[f64; 6]> {
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
            Some(frame) if grid.cd.0 != 0 => {
                let back = local_axes(frame, &grid.x).transpose();
                let (u, r) = (back * Vec3::new(a, b, c), back * Vec3::new(d, e, f));
                [u.x, u.y, u.z, r.x, r.y, r.z]
            }
            _ => [a, b, c, d, e, f],
        };
    }
    all
}
