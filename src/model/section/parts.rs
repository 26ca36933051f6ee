//! Common parts of all section types: shapes, torsion constants, corners.

use super::area::{Area, Rectangle};
use crate::model::types::Section;

/// A section with its shear factors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::model) struct Shape {
    pub section: Section,
    /// K1, K2.
    pub k: [f64; 2],
    /// Warping constant; 0 for massive and closed sections and for walls that meet in one point.
    pub cw: f64,
}

impl Shape {
    pub(super) fn with_warping(self, cw: f64) -> Self {
        Self { cw, ..self }
    }
}

/// Share of a rectangle that carries its transverse shear.
pub(super) const RECTANGLE_SHEAR: f64 = 5.0 / 6.0;

/// Returns a rectangle between two heights and two widths.
pub(super) fn rectangle(y: [f64; 2], z: [f64; 2]) -> Rectangle {
    Rectangle { y, z }
}

/// Returns the torsion constant of thin open walls: sum of length times thickness cubed over three.
pub(super) fn open_torsion(walls: &[(f64, f64)]) -> f64 {
    walls.iter().map(|(b, t)| b * t * t * t / 3.0).sum()
}

/// Returns the torsion constant of a rectangle (Roark, table 20, case 4).
pub(super) fn rectangle_torsion(w: f64, h: f64) -> f64 {
    let (long, short) = if w > h { (w, h) } else { (h, w) };
    let r = short / long;
    long * short.powi(3) * (1.0 / 3.0 - 0.21 * r * (1.0 - r.powi(4) / 12.0))
}

/// Completes a section: recovery points and neutral axis from the shear centre.
pub(super) fn finish(
    a: Area,
    centre: [f64; 2],
    j: f64,
    k: [f64; 2],
    points: [[f64; 2]; 4],
) -> Option<Shape> {
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
    Some(Shape {
        section,
        k,
        cw: 0.0,
    })
}

/// Returns the corners: C upper right, D lower right, E lower left, F upper left.
pub(super) fn corners(y: [f64; 2], z: [f64; 2]) -> [[f64; 2]; 4] {
    [[y[1], z[1]], [y[0], z[1]], [y[0], z[0]], [y[1], z[0]]]
}
