//! The section types of PBARL and PBEAML.
//!
//! Element y points up in the manual's figures and z to the right; recovery points C D E F stand where the figures have them.
//! The element axis runs through the shear centre. Dimensions DIM1, DIM2 .. are `d[0]`, `d[1]` ..
//!
//! # Reference
//! MSC Nastran Quick Reference Guide, PBARL and PBEAML (figures of the types). Torsion: W. C. Young, Roark's Formulas for Stress
//! and Strain, table 20 (bar), Bredt's formula (box), sum of b t^3 / 3 (open walls). Shear factors: share of the walls that carry
//! the shear, 5/6 where it varies as in a rectangle; 0.9 for a solid and 0.5 for a hollow circle.

use super::super::types::Section;
use super::area::{Area, Rectangle, of_polygons, of_rectangles};
use super::thin::{Wall, shear_centre};
use std::f64::consts::PI;

/// A section and its shear factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) struct Shape {
    pub section: Section,
    /// K1, K2.
    pub k: [f64; 2],
}

/// Why dimensions give no section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) enum SectionFault {
    Unknown,
    Count { expected: usize },
    Shape,
}

const RECTANGLE_SHEAR: f64 = 5.0 / 6.0;

/// The section of that type.
pub(in super::super) fn bar_section(kind: &str, dims: &[f64]) -> Result<Shape, SectionFault> {
    let expected = match kind {
        "ROD" => 1,
        "TUBE" | "TUBE2" | "BAR" => 2,
        "HEXA" => 3,
        "BOX" | "CHAN" | "CHAN1" | "CHAN2" | "T" | "T1" | "T2" | "L" | "H" | "Z" | "HAT"
        | "CROSS" | "I1" => 4,
        "BOX1" | "I" => 6,
        _ => return Err(SectionFault::Unknown),
    };
    if dims.len() < expected {
        return Err(SectionFault::Count { expected });
    }
    let d = |i: usize| dims.get(i).copied().unwrap_or(0.0);
    let inner_may_be_zero = kind == "TUBE";
    let positive = dims
        .iter()
        .take(expected)
        .enumerate()
        .all(|(i, x)| *x > 0.0 || (inner_may_be_zero && i == 1 && *x == 0.0));
    if !positive || !dims.iter().all(|x| x.is_finite()) {
        return Err(SectionFault::Shape);
    }
    let shape = match kind {
        "ROD" => circle(d(0), 0.0),
        "TUBE" => circle(d(0), d(1)),
        "TUBE2" => circle(d(0), d(0) - d(1)),
        "BAR" => bar(d(0), d(1)),
        "BOX" => box1([d(0), d(1), d(2), d(2), d(3), d(3)]),
        "BOX1" => box1([d(0), d(1), d(2), d(3), d(4), d(5)]),
        "I" => i_section(d(0), d(1), d(2), d(3), d(4), d(5)),
        "I1" => {
            let (width, t) = (d(0) + d(1), (d(3) - d(2)) / 2.0);
            i_section(d(3), width, width, d(1), t, t)
        }
        "CHAN" => channel(d(0), d(1), d(2), d(3)),
        "CHAN1" => channel(d(0) + d(1), d(3), d(1), (d(3) - d(2)) / 2.0),
        "CHAN2" => channel2(d(0), d(1), d(2), d(3)),
        "T" => tee(d(0), d(1), d(2), d(3)),
        "T1" => tee1(d(0), d(1), d(2), d(3)),
        "T2" => tee2(d(0), d(1), d(2), d(3)),
        "L" => angle(d(0), d(1), d(2), d(3)),
        "H" => h_section(d(0), d(1) / 2.0, d(2), d(3)),
        "Z" => z_section(d(0), d(1), d(2), d(3)),
        "HAT" => hat(d(0), d(1), d(2), d(3)),
        "CROSS" => cross(d(0), d(1), d(2), d(3)),
        _ => hexagon(d(0), d(1), d(2)),
    };
    shape.ok_or(SectionFault::Shape)
}

fn rectangle(y: [f64; 2], z: [f64; 2]) -> Rectangle {
    Rectangle { y, z }
}

/// Torsion constant of thin open walls: sum of length times thickness cubed over three.
fn open_torsion(walls: &[(f64, f64)]) -> f64 {
    walls.iter().map(|(b, t)| b * t * t * t / 3.0).sum()
}

/// Torsion constant of a rectangle (Roark, table 20, case 4).
fn rectangle_torsion(w: f64, h: f64) -> f64 {
    let (long, short) = if w > h { (w, h) } else { (h, w) };
    let r = short / long;
    long * short.powi(3) * (1.0 / 3.0 - 0.21 * r * (1.0 - r.powi(4) / 12.0))
}

/// Puts a section together: recovery points and neutral axis from the shear centre.
fn finish(a: Area, centre: [f64; 2], j: f64, k: [f64; 2], points: [[f64; 2]; 4]) -> Option<Shape> {
    let from = |p: [f64; 2]| [p[0] - centre[0], p[1] - centre[1]];
    if !(a.area > 0.0 && a.yy > 0.0 && a.zz > 0.0 && j > 0.0) {
        return None;
    }
    let section = Section {
        area: a.area,
        i1: a.yy,
        i2: a.zz,
        i12: a.yz,
        j,
        recovery: points.map(from),
        neutral: from(a.centroid),
        nsm_centre: from(a.centroid),
        ..Section::default()
    };
    Some(Shape { section, k })
}

fn circle(outer: f64, inner: f64) -> Option<Shape> {
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

/// Corners: C upper right, D lower right, E lower left, F upper left.
fn corners(y: [f64; 2], z: [f64; 2]) -> [[f64; 2]; 4] {
    [[y[1], z[1]], [y[0], z[1]], [y[0], z[0]], [y[1], z[0]]]
}

fn bar(w: f64, h: f64) -> Option<Shape> {
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

/// Width, height, thickness of top, bottom, right, left wall.
fn box1([w, h, top, bottom, right, left]: [f64; 6]) -> Option<Shape> {
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
    // Closed walls of like thickness: the shear centre is the centroid.
    finish(a, a.centroid, j, k, corners([0.0, h], [0.0, w]))
}

/// Height, width of bottom and top flange, thickness of web, bottom and top flange.
fn i_section(
    h: f64,
    bottom_w: f64,
    top_w: f64,
    web: f64,
    bottom_t: f64,
    top_t: f64,
) -> Option<Shape> {
    if !(h > bottom_t + top_t && bottom_w > web && top_w > web && bottom_t > 0.0) {
        return None;
    }
    let across = |w: f64| [-w / 2.0, w / 2.0];
    let a = of_rectangles(&[
        rectangle([0.0, bottom_t], across(bottom_w)),
        rectangle([bottom_t, h - top_t], across(web)),
        rectangle([h - top_t, h], across(top_w)),
    ]);
    let (y0, y1) = (bottom_t / 2.0, h - top_t / 2.0);
    let points = [
        [y0, 0.0],
        [y1, 0.0],
        [y0, bottom_w / 2.0],
        [y0, -bottom_w / 2.0],
        [y1, top_w / 2.0],
        [y1, -top_w / 2.0],
    ];
    let wall = |from, to, t| Wall { from, to, t };
    let walls = [
        wall(0, 1, web),
        wall(0, 2, bottom_t),
        wall(0, 3, bottom_t),
        wall(1, 4, top_t),
        wall(1, 5, top_t),
    ];
    let centre = shear_centre(&points, &walls)?;
    let j = open_torsion(&[(bottom_w, bottom_t), (top_w, top_t), (y1 - y0, web)]);
    let flanges = bottom_w * bottom_t + top_w * top_t;
    let k = [
        (a.area - flanges) / a.area,
        RECTANGLE_SHEAR * flanges / a.area,
    ];
    let recovery = [
        [h, top_w / 2.0],
        [0.0, bottom_w / 2.0],
        [0.0, -bottom_w / 2.0],
        [h, -top_w / 2.0],
    ];
    finish(a, centre, j, k, recovery)
}

/// Web on the left, flanges to the right: width, height, thickness of web and flanges.
fn channel(w: f64, h: f64, web: f64, flange: f64) -> Option<Shape> {
    if !(h > 2.0 * flange && w > web && flange > 0.0) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h], [0.0, web]),
        rectangle([0.0, flange], [web, w]),
        rectangle([h - flange, h], [web, w]),
    ]);
    let (y0, y1, z0) = (flange / 2.0, h - flange / 2.0, web / 2.0);
    let centre = shear_centre(
        &[[y0, w], [y0, z0], [y1, z0], [y1, w]],
        &[
            Wall {
                from: 0,
                to: 1,
                t: flange,
            },
            Wall {
                from: 1,
                to: 2,
                t: web,
            },
            Wall {
                from: 2,
                to: 3,
                t: flange,
            },
        ],
    )?;
    let j = open_torsion(&[(w - z0, flange), (w - z0, flange), (y1 - y0, web)]);
    let k = [
        (y1 - y0) * web / a.area,
        RECTANGLE_SHEAR * 2.0 * w * flange / a.area,
    ];
    finish(a, centre, j, k, corners([0.0, h], [0.0, w]))
}

/// Web at the bottom, legs up: thickness of legs and web, height, width.
fn channel2(leg: f64, web: f64, h: f64, w: f64) -> Option<Shape> {
    if !(w > 2.0 * leg && h > web) {
        return None;
    }
    let half = w / 2.0;
    let a = of_rectangles(&[
        rectangle([0.0, web], [-half, half]),
        rectangle([web, h], [-half, -half + leg]),
        rectangle([web, h], [half - leg, half]),
    ]);
    let (y0, z1) = (web / 2.0, half - leg / 2.0);
    let centre = shear_centre(
        &[[h, -z1], [y0, -z1], [y0, z1], [h, z1]],
        &[
            Wall {
                from: 0,
                to: 1,
                t: leg,
            },
            Wall {
                from: 1,
                to: 2,
                t: web,
            },
            Wall {
                from: 2,
                to: 3,
                t: leg,
            },
        ],
    )?;
    let j = open_torsion(&[(h - y0, leg), (h - y0, leg), (2.0 * z1, web)]);
    let k = [
        RECTANGLE_SHEAR * 2.0 * h * leg / a.area,
        2.0 * z1 * web / a.area,
    ];
    finish(a, centre, j, k, corners([0.0, h], [-half, half]))
}

/// Flange on top: width, height, thickness of flange and web. C top middle, D right end of the flange, E foot, F left end.
fn tee(w: f64, h: f64, flange: f64, web: f64) -> Option<Shape> {
    if !(h > flange && w > web) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h - flange], [-web / 2.0, web / 2.0]),
        rectangle([h - flange, h], [-w / 2.0, w / 2.0]),
    ]);
    let centre = [h - flange / 2.0, 0.0];
    let j = open_torsion(&[(w, flange), (h - flange / 2.0, web)]);
    let k = [
        (h - flange / 2.0) * web / a.area,
        RECTANGLE_SHEAR * w * flange / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [[h, 0.0], [h, w / 2.0], [0.0, 0.0], [h, -w / 2.0]],
    )
}

/// Flange standing on the right, web to the left: height of the flange, length of the web, thickness of flange and web.
fn tee1(h: f64, reach: f64, flange: f64, web: f64) -> Option<Shape> {
    if !(h > web) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([-web / 2.0, web / 2.0], [0.0, reach]),
        rectangle([-h / 2.0, h / 2.0], [reach, reach + flange]),
    ]);
    let centre = [0.0, reach + flange / 2.0];
    let j = open_torsion(&[(h, flange), (reach + flange / 2.0, web)]);
    let k = [
        RECTANGLE_SHEAR * h * flange / a.area,
        (reach + flange / 2.0) * web / a.area,
    ];
    let right = reach + flange;
    finish(
        a,
        centre,
        j,
        k,
        [
            [0.0, right],
            [-h / 2.0, right],
            [0.0, 0.0],
            [h / 2.0, right],
        ],
    )
}

/// Flange at the bottom: width, height, thickness of flange and web.
fn tee2(w: f64, h: f64, flange: f64, web: f64) -> Option<Shape> {
    if !(h > flange && w > web) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([flange, h], [-web / 2.0, web / 2.0]),
        rectangle([0.0, flange], [-w / 2.0, w / 2.0]),
    ]);
    let centre = [flange / 2.0, 0.0];
    let j = open_torsion(&[(w, flange), (h - flange / 2.0, web)]);
    let k = [
        (h - flange / 2.0) * web / a.area,
        RECTANGLE_SHEAR * w * flange / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [
            [h, web / 2.0],
            [0.0, w / 2.0],
            [0.0, -w / 2.0],
            [h, -web / 2.0],
        ],
    )
}

/// Corner at the lower left: width, height, thickness of the lying and of the standing leg.
fn angle(w: f64, h: f64, lying: f64, standing: f64) -> Option<Shape> {
    if !(w > standing && h > lying) {
        return None;
    }
    let a = of_rectangles(&[
        rectangle([0.0, h], [0.0, standing]),
        rectangle([0.0, lying], [standing, w]),
    ]);
    let centre = [lying / 2.0, standing / 2.0];
    let (long_y, long_z) = (h - lying / 2.0, w - standing / 2.0);
    let j = open_torsion(&[(long_y, standing), (long_z, lying)]);
    let k = [
        RECTANGLE_SHEAR * h * standing / a.area,
        RECTANGLE_SHEAR * w * lying / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [[h, standing], [0.0, w], [0.0, 0.0], [h, 0.0]],
    )
}

/// Two standing flanges joined by a lying web: inner width, thickness of a flange, height, thickness of the web.
fn h_section(inner: f64, flange: f64, h: f64, web: f64) -> Option<Shape> {
    if !(h > web) {
        return None;
    }
    let (half, y) = (inner / 2.0, [-h / 2.0, h / 2.0]);
    let a = of_rectangles(&[
        rectangle(y, [-half - flange, -half]),
        rectangle(y, [half, half + flange]),
        rectangle([-web / 2.0, web / 2.0], [-half, half]),
    ]);
    let j = open_torsion(&[(h, flange), (h, flange), (inner + flange, web)]);
    let k = [
        RECTANGLE_SHEAR * 2.0 * h * flange / a.area,
        inner * web / a.area,
    ];
    finish(
        a,
        [0.0; 2],
        j,
        k,
        corners(y, [-half - flange, half + flange]),
    )
}

/// Top flange to the left, bottom flange to the right: free width of a flange, thickness of the web, inner and outer height.
fn z_section(free: f64, web: f64, inner: f64, h: f64) -> Option<Shape> {
    let t = (h - inner) / 2.0;
    if !(t > 0.0) {
        return None;
    }
    let (top, half) = (h / 2.0, web / 2.0);
    let a = of_rectangles(&[
        rectangle([-inner / 2.0, inner / 2.0], [-half, half]),
        rectangle([inner / 2.0, top], [-half - free, half]),
        rectangle([-top, -inner / 2.0], [-half, half + free]),
    ]);
    let j = open_torsion(&[(free + half, t), (free + half, t), (h - t, web)]);
    let flanges = 2.0 * (free + web) * t;
    let k = [
        (a.area - flanges) / a.area,
        RECTANGLE_SHEAR * flanges / a.area,
    ];
    finish(
        a,
        [0.0; 2],
        j,
        k,
        [
            [top, half],
            [-top, half + free],
            [-top, -half],
            [top, -half - free],
        ],
    )
}

/// Crown on top, brims at the bottom: height, wall thickness, width of the crown, width of a brim.
fn hat(h: f64, t: f64, crown: f64, brim: f64) -> Option<Shape> {
    if !(h > 2.0 * t && crown > 2.0 * t) {
        return None;
    }
    let (half, wide) = (crown / 2.0, crown / 2.0 + brim);
    let a = of_rectangles(&[
        rectangle([h - t, h], [-half + t, half - t]),
        rectangle([0.0, h], [-half, -half + t]),
        rectangle([0.0, h], [half - t, half]),
        rectangle([0.0, t], [-wide, -half]),
        rectangle([0.0, t], [half, wide]),
    ]);
    let (y0, y1, z) = (t / 2.0, h - t / 2.0, half - t / 2.0);
    let wall = |from| Wall {
        from,
        to: from + 1,
        t,
    };
    let centre = shear_centre(
        &[
            [y0, -wide],
            [y0, -z],
            [y1, -z],
            [y1, z],
            [y0, z],
            [y0, wide],
        ],
        &[wall(0), wall(1), wall(2), wall(3), wall(4)],
    )?;
    let j = open_torsion(&[(2.0 * (wide - z) + 2.0 * (y1 - y0) + 2.0 * z, t)]);
    let k = [
        2.0 * (y1 - y0) * t / a.area,
        RECTANGLE_SHEAR * (crown + 2.0 * brim) * t / a.area,
    ];
    finish(
        a,
        centre,
        j,
        k,
        [[h, half], [0.0, wide], [0.0, -wide], [h, -half]],
    )
}

/// Free width of the lying bar (both sides together), thickness of the standing one, height, thickness of the lying one.
fn cross(free: f64, standing: f64, h: f64, lying: f64) -> Option<Shape> {
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

/// Width of a pointed side, overall width, height. Torsion as the rectangle of the mean width.
fn hexagon(point: f64, w: f64, h: f64) -> Option<Shape> {
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
