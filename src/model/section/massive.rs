//! Massive and closed section types: ROD, TUBE, BAR, BOX, CROSS, HEXA.

use super::area::{Area, of_polygons, of_rectangles};
use super::parts::{
    RECTANGLE_SHEAR, Shape, corners, finish, open_torsion, rectangle, rectangle_torsion,
};
use std::f64::consts::PI;

pub(super) fn circle(outer: f64, inner: f64) -> Option<Shape> {
    if !(inner >= 0.0 && inner < outer) {
        return None;
    }
    let i = PI / 4.0 * (outer.powi(4) - inner.powi(4));
    let a = Area {
        area: PI * (outer * outer - inner * inner),
        centroid: [0.0; 2],
        yy: i,
        zz: i,
        yz: 0.0,
    };
    let k = if inner > 0.0 { 0.5 } else { 0.9 };
    finish(
        a,
        [0.0; 2],
        2.0 * i,
        [k, k],
        [[outer, 0.0], [0.0, outer], [-outer, 0.0], [0.0, -outer]],
    )
}

pub(super) fn bar(w: f64, h: f64) -> Option<Shape> {
    let (y, z) = ([-h / 2.0, h / 2.0], [-w / 2.0, w / 2.0]);
    let a = of_rectangles(&[rectangle(y, z)]);
    finish(
        a,
        [0.0; 2],
        rectangle_torsion(w, h),
        [RECTANGLE_SHEAR; 2],
        corners(y, z),
    )
}

/// Computes a box from width, height, and thickness of top, bottom, right and left wall.
pub(super) fn box1([w, h, top, bottom, right, left]: [f64; 6]) -> Option<Shape> {
    if !(w > left + right && h > top + bottom) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h], [0.0, left]),
        rectangle([0.0, h], [w - right, w]),
        rectangle([0.0, bottom], [left, w - right]),
        rectangle([h - top, h], [left, w - right]),
    ]);
    let (hm, wm) = (h - (top + bottom) / 2.0, w - (left + right) / 2.0);
    let enclosed = hm * wm;
    let j = 4.0 * enclosed * enclosed
        / (hm * (1.0 / left + 1.0 / right) + wm * (1.0 / top + 1.0 / bottom));
    let k = [hm * (left + right) / a.area, wm * (top + bottom) / a.area];
    // The shear centre of closed walls is taken as the centroid, which is right for walls of similar thickness.
    finish(a, a.centroid, j, k, corners([0.0, h], [0.0, w]))
}

/// Computes a cross of a horizontal bar and a vertical bar. `free` is the width that the horizontal bar projects on both sides together.
/// `standing` is the thickness of the vertical bar, `h` the height, and `lying` the thickness of the horizontal bar.
pub(super) fn cross(free: f64, standing: f64, h: f64, lying: f64) -> Option<Shape> {
    if !(h > lying) {
        return None;
    }
    let (z0, z1) = (standing / 2.0, (free + standing) / 2.0);
    let y = [-lying / 2.0, lying / 2.0];
    let a = of_rectangles(&[
        rectangle([-h / 2.0, h / 2.0], [-z0, z0]),
        rectangle(y, [-z1, -z0]),
        rectangle(y, [z0, z1]),
    ]);
    let j = open_torsion(&[(h, standing), (free, lying)]);
    let k = [
        RECTANGLE_SHEAR * h * standing / a.area,
        RECTANGLE_SHEAR * 2.0 * z1 * lying / a.area,
    ];
    finish(
        a,
        [0.0; 2],
        j,
        k,
        [[h / 2.0, 0.0], [0.0, z1], [-h / 2.0, 0.0], [0.0, -z1]],
    )
}

/// Computes a hexagon from the width of a pointed side, overall width and height. The torsion constant is the constant of the rectangle of mean
/// width.
pub(super) fn hexagon(point: f64, w: f64, h: f64) -> Option<Shape> {
    if !(w > 2.0 * point) {
        return None;
    }
    let (half, inner, top) = (w / 2.0, w / 2.0 - point, h / 2.0);
    let outline = vec![
        [top, inner],
        [0.0, half],
        [-top, inner],
        [-top, -inner],
        [0.0, -half],
        [top, -inner],
    ];
    let a = of_polygons(&[outline]);
    let j = rectangle_torsion(w - point, h);
    finish(
        a,
        [0.0; 2],
        j,
        [RECTANGLE_SHEAR; 2],
        [[top, 0.0], [-top, 0.0], [0.0, half], [0.0, -half]],
    )
}
