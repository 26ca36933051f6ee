//! Shear centre and torsion constant of thin walls that close cells.

use super::thin::Wall;
use crate::linalg::{DMatrix, DVector};

/// Shear centre and torsion constant of closed walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cells {
    /// Shear centre (y, z).
    pub centre: [f64; 2],
    /// Part of the torsion constant that shear flow around cells gives.
    pub torsion: f64,
}

/// Returns the shear centre of walls on midline points (y, z), joined in any way, and the torsion constant of their cells.
///
/// Under unit twist about a pole, wall e of length l sweeps the sectorial area s_e between its ends. The warping w at the points minimises sum t / l
/// (w_to - w_from - s_e)^2. The minimum is the torsion constant of the cells (Bredt; zero for open walls). The shear centre makes the sectorial
/// moments of w vanish, as for open walls.
///
/// # Reference
/// W. D. Pilkey, Analysis and Design of Elastic Beams (2002), chapters 6 and 7; E. Trefftz (1935), shear centre.
pub(super) fn of_cells(points: &[[f64; 2]], walls: &[Wall]) -> Option<Cells> {
    let mut area = 0.0;
    let mut first = [0.0; 2];
    let mut lengths = Vec::with_capacity(walls.len());
    for w in walls {
        let (a, b) = (points.get(w.from)?, points.get(w.to)?);
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        let da = length * w.t;
        area += da;
        (0..2).for_each(|k| first[k] += da * (a[k] + b[k]) / 2.0);
        lengths.push(length);
    }
    if !(area > 0.0) || lengths.iter().any(|l| !(*l > 0.0)) {
        return None;
    }
    let centroid = first.map(|s| s / area);
    let at = |i: usize| -> Option<[f64; 2]> {
        points
            .get(i)
            .map(|p| [p[0] - centroid[0], p[1] - centroid[1]])
    };
    let n = points.len();
    // The warping of the first point is set to zero. A constant has no effect, because the mean is subtracted below.
    let mut k = DMatrix::zeros(n, n);
    let mut f = DVector::zeros(n);
    let mut swept = Vec::with_capacity(walls.len());
    for (w, l) in walls.iter().zip(&lengths) {
        let (a, b) = (at(w.from)?, at(w.to)?);
        let s = a[0] * (b[1] - a[1]) - a[1] * (b[0] - a[0]);
        let c = w.t / l;
        k[(w.from, w.from)] += c;
        k[(w.to, w.to)] += c;
        k[(w.from, w.to)] -= c;
        k[(w.to, w.from)] -= c;
        f[w.to] += c * s;
        f[w.from] -= c * s;
        swept.push(s);
    }
    k.row_mut(0).fill(0.0);
    k.column_mut(0).fill(0.0);
    k[(0, 0)] = 1.0;
    f[0] = 0.0;
    let warping = k.lu().solve(&f)?;
    let mut torsion = 0.0;
    let (mut yy, mut zz, mut yz, mut wy, mut wz) = (0.0, 0.0, 0.0, 0.0, 0.0);
    let product = |l: f64, u: [f64; 2], v: [f64; 2]| {
        l / 6.0 * (2.0 * u[0] * v[0] + u[0] * v[1] + u[1] * v[0] + 2.0 * u[1] * v[1])
    };
    for ((w, l), s) in walls.iter().zip(&lengths).zip(&swept) {
        let (a, b) = (at(w.from)?, at(w.to)?);
        let omega = [*warping.get(w.from)?, *warping.get(w.to)?];
        torsion += w.t / l * (omega[1] - omega[0] - s).powi(2);
        let da = l * w.t;
        let (y, z) = ([a[0], b[0]], [a[1], b[1]]);
        yy += product(da, y, y);
        zz += product(da, z, z);
        yz += product(da, y, z);
        wy += product(da, omega, y);
        wz += product(da, omega, z);
    }
    let det = yy * zz - yz * yz;
    if !(det.abs() > 0.0) {
        return None;
    }
    // The pole is the centroid.
    let a = (wz * yy - wy * yz) / det;
    let b = (wz * yz - wy * zz) / det;
    Some(Cells {
        centre: [centroid[0] + a, centroid[1] + b],
        torsion,
    })
}
