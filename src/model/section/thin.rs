//! Shear centre and warping constant of an open thin-walled section.

/// A straight wall between two points of the midline (indices), with its thickness. The walls form a tree: each wall begins at a point of an earlier
/// wall, and the first wall begins anywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Wall {
    pub from: usize,
    pub to: usize,
    pub t: f64,
}

/// Returns the shear centre (y, z) of walls on the midline points (y, z).
///
/// The sectorial coordinate w is dw = (y - yB) dz - (z - zB) dy along the midline from a pole B. The shear centre is B + (a, b). The sectorial
/// moments about it vanish: S_wy - a I_yz + b I_yy = 0 and S_wz - a I_zz + b I_yz = 0. Here S_wy = integral w y dA about the centroid and I_yy =
/// integral y^2 dA.
///
/// # Reference
/// W. D. Pilkey, Analysis and Design of Elastic Beams (2002), chapter 7 (thin-walled beams, open sections).
pub(super) fn shear_centre(points: &[[f64; 2]], walls: &[Wall]) -> Option<[f64; 2]> {
    let length = |w: &Wall| -> Option<f64> {
        let (a, b) = (points.get(w.from)?, points.get(w.to)?);
        Some((b[0] - a[0]).hypot(b[1] - a[1]))
    };
    // Centroid of the walls.
    let mut area = 0.0;
    let mut first = [0.0; 2];
    for w in walls {
        let (a, b) = (points.get(w.from)?, points.get(w.to)?);
        let da = length(w)? * w.t;
        area += da;
        (0..2).for_each(|k| first[k] += da * (a[k] + b[k]) / 2.0);
    }
    let centroid = first.map(|s| s / area);
    let at = |i: usize| -> Option<[f64; 2]> {
        points
            .get(i)
            .map(|p| [p[0] - centroid[0], p[1] - centroid[1]])
    };
    // Pole B: the first point.
    let pole = at(walls.first()?.from)?;
    let mut sectorial = vec![0.0; points.len()];
    for w in walls {
        let (a, b) = (at(w.from)?, at(w.to)?);
        let swept = (a[0] - pole[0]) * (b[1] - a[1]) - (a[1] - pole[1]) * (b[0] - a[0]);
        *sectorial.get_mut(w.to)? = sectorial.get(w.from)? + swept;
    }
    // Products of two linear functions along a wall.
    let product = |l: f64, u: [f64; 2], v: [f64; 2]| {
        l / 6.0 * (2.0 * u[0] * v[0] + u[0] * v[1] + u[1] * v[0] + 2.0 * u[1] * v[1])
    };
    let (mut yy, mut zz, mut yz, mut wy, mut wz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for w in walls {
        let (a, b) = (at(w.from)?, at(w.to)?);
        let da = length(w)? * w.t;
        let (y, z) = ([a[0], b[0]], [a[1], b[1]]);
        let s = [*sectorial.get(w.from)?, *sectorial.get(w.to)?];
        yy += product(da, y, y);
        zz += product(da, z, z);
        yz += product(da, y, z);
        wy += product(da, s, y);
        wz += product(da, s, z);
    }
    let det = yy * zz - yz * yz;
    if !(det.abs() > 0.0) {
        return None;
    }
    // -a yz + b yy = -wy ; -a zz + b yz = -wz
    let a = (wz * yy - wy * yz) / det;
    let b = (wz * yz - wy * zz) / det;
    Some([centroid[0] + pole[0] + a, centroid[1] + pole[1] + b])
}

/// Returns the shear centre (y, z) and warping constant: integral over the walls of w^2 dA, w the sectorial coordinate about the shear centre less
/// its mean.
pub(super) fn open_walls(points: &[[f64; 2]], walls: &[Wall]) -> Option<([f64; 2], f64)> {
    let centre = shear_centre(points, walls)?;
    let mut sectorial = vec![0.0; points.len()];
    let (mut area, mut first, mut second) = (0.0, 0.0, 0.0);
    for w in walls {
        let (a, b) = (points.get(w.from)?, points.get(w.to)?);
        let swept = (a[0] - centre[0]) * (b[1] - a[1]) - (a[1] - centre[1]) * (b[0] - a[0]);
        let (from, to) = (*sectorial.get(w.from)?, sectorial.get(w.from)? + swept);
        *sectorial.get_mut(w.to)? = to;
        let da = (b[0] - a[0]).hypot(b[1] - a[1]) * w.t;
        area += da;
        first += da * (from + to) / 2.0;
        second += da * (from * from + from * to + to * to) / 3.0;
    }
    Some((centre, second - first * first / area))
}
