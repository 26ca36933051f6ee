//! Displacement frames of grids.

use crate::model::{Frame, Grid, Mat3, Model, Vec3};
use nastran::cards::CoordKind;

/// Returns the axes of a coordinate system at a point. The rows are the first, second and third direction in basic.
///
/// Cylindrical: radial, tangential, axial. Spherical: r, theta (down from the axis), phi. On the axis the azimuth is zero.
pub(crate) fn axes_at(frame: &Frame, x: &Vec3) -> Mat3 {
    let local = frame.axes * (x - frame.origin);
    let planar = local.x.hypot(local.y);
    let (c, s) = if planar > 1e-12 * (1.0 + local.norm()) {
        (local.x / planar, local.y / planar)
    } else {
        (1.0, 0.0)
    };
    let turned = match frame.kind {
        CoordKind::Rectangular => return frame.axes,
        CoordKind::Cylindrical => Mat3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0),
        CoordKind::Spherical => {
            let r = local.norm();
            let (st, ct) = if r > 0.0 {
                (planar / r, local.z / r)
            } else {
                (0.0, 1.0)
            };
            Mat3::new(st * c, st * s, ct, ct * c, ct * s, -st, -s, c, 0.0)
        }
    };
    turned * frame.axes
}

/// Returns the axes of each grid's displacement frame. `None` stands for the basic frame.
pub(super) fn grid_axes(model: &Model) -> Vec<Option<Mat3>> {
    let axes = |g: &Grid| match g.cd.0 {
        0 => None,
        _ => model.frames.get(g.cd.us()).map(|f| axes_at(f, &g.x)),
    };
    model.grids.iter().map(axes).collect()
}

/// Transforms six components from the grid's displacement frame to basic.
pub(crate) fn to_basic(axes: &Option<Mat3>, u: [f64; 6]) -> [f64; 6] {
    match axes {
        None => u,
        Some(r) => turn(&r.transpose(), u),
    }
}

/// Transforms six components from basic to the grid's displacement frame.
pub(super) fn to_local(axes: &Option<Mat3>, u: [f64; 6]) -> [f64; 6] {
    match axes {
        None => u,
        Some(r) => turn(r, u),
    }
}

fn turn(r: &Mat3, u: [f64; 6]) -> [f64; 6] {
    let (a, b) = (
        r * Vec3::new(u[0], u[1], u[2]),
        r * Vec3::new(u[3], u[4], u[5]),
    );
    [a.x, a.y, a.z, b.x, b.y, b.z]
}
