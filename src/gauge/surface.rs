//! The point of the shells' surfaces nearest to a given one.

use crate::fe::from_results::surface_z;
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, Shell, ShellIx, Vec3};

/// A point on a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Which shell.
    pub shell: ShellIx,
    /// Weights of its corners: bilinear shape functions of a quadrilateral, area coordinates of a triangle.
    pub weights: [f64; 4],
    /// On the reference surface, basic frame.
    pub point: Vec3,
    /// Distance of the given point from it.
    pub distance: f64,
    /// The side that faces the given point.
    pub side: Surface,
}

/// Corners of a shell (a triangle repeats its third).
pub fn corners(model: &Model, shell: &Shell) -> Option<[Vec3; 4]> {
    let n = shell.shape.n_corners();
    let x = |i: usize| {
        model
            .grids
            .get(shell.grids.get(i.min(n - 1))?.us())
            .map(|g| g.x)
    };
    Some([x(0)?, x(1)?, x(2)?, x(3)?])
}

/// Mean of the corners.
pub fn centre(model: &Model, shell: &Shell) -> Option<Vec3> {
    let n = shell.shape.n_corners();
    Some(corners(model, shell)?.iter().take(n).sum::<Vec3>() / n as f64)
}

/// From the reference surface of a shell to its side: offset and fibre distance along the normal.
pub fn to_side(model: &Model, shell: &Shell, side: Surface) -> f64 {
    let z = surface_z(model, shell)[side.ix()];
    shell.zoffs + if z.is_finite() { z } else { 0.0 }
}

/// The nearest point of all shells, or of those that `among` accepts; `None` without shells.
///
/// Every shell is looked at: a bounding sphere excludes most at the cost of one distance.
pub fn nearest(model: &Model, x: Vec3, among: impl Fn(ShellIx) -> bool) -> Option<Foot> {
    let all = (0..model.shells.len() as u32).map(ShellIx);
    nearest_of(model, x, all.filter(|ix| among(*ix)))
}

/// The nearest point of these shells; `None` without shells.
pub fn nearest_of(
    model: &Model,
    x: Vec3,
    shells: impl IntoIterator<Item = ShellIx>,
) -> Option<Foot> {
    let mut best: Option<Foot> = None;
    for ix in shells {
        let Some(shell) = model.shells.get(ix.us()) else {
            continue;
        };
        let (Some(p), Some(c)) = (corners(model, shell), centre(model, shell)) else {
            continue;
        };
        let radius = p.iter().map(|q| (q - c).norm()).fold(0.0, f64::max);
        if best.is_some_and(|b| (x - c).norm() - radius > b.distance) {
            continue;
        }
        if let Some(foot) = foot_on(model, ix, x)
            && best.is_none_or(|b| foot.distance < b.distance)
        {
            best = Some(foot);
        }
    }
    best
}

/// The nearest point of one shell.
pub fn foot_on(model: &Model, ix: ShellIx, x: Vec3) -> Option<Foot> {
    let shell = model.shells.get(ix.us())?;
    let p = corners(model, shell)?;
    let weights = if shell.shape.n_corners() == 3 {
        on_triangle([p[0], p[1], p[2]], x)
    } else {
        on_quad(p, x)
    };
    let point = (0..4).map(|i| p[i] * weights[i]).sum::<Vec3>();
    let z = shell_axes(model, shell, ShellPlace::Centre)?
        .row(2)
        .transpose();
    let side = if (x - point).dot(&z) >= 0.0 {
        Surface::Top
    } else {
        Surface::Bottom
    };
    Some(Foot {
        shell: ix,
        weights,
        point,
        distance: (x - point).norm(),
        side,
    })
}

/// Area coordinates of the nearest point of a triangle.
fn on_triangle(p: [Vec3; 3], x: Vec3) -> [f64; 4] {
    let (a, b) = (p[1] - p[0], p[2] - p[0]);
    let d = x - p[0];
    let (aa, ab, bb) = (a.dot(&a), a.dot(&b), b.dot(&b));
    let det = aa * bb - ab * ab;
    let (da, db) = (d.dot(&a), d.dot(&b));
    let (u, v) = ((bb * da - ab * db) / det, (aa * db - ab * da) / det);
    if det > 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
        return [1.0 - u - v, u, v, 0.0];
    }
    let mut best = (f64::INFINITY, [1.0, 0.0, 0.0, 0.0]);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let t = on_segment(p[i], p[j], x);
        let distance = (p[i] + (p[j] - p[i]) * t - x).norm();
        if distance < best.0 {
            let mut w = [0.0; 4];
            w[i] = 1.0 - t;
            w[j] = t;
            best = (distance, w);
        }
    }
    best.1
}

fn on_segment(a: Vec3, b: Vec3, x: Vec3) -> f64 {
    let d = b - a;
    let l = d.dot(&d);
    if l > 0.0 {
        ((x - a).dot(&d) / l).clamp(0.0, 1.0)
    } else {
        0.0
    }
}

/// Bilinear shape functions at (xi, eta) in [-1, 1]^2.
fn bilinear(xi: f64, eta: f64) -> [f64; 4] {
    [
        0.25 * (1.0 - xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 + eta),
        0.25 * (1.0 - xi) * (1.0 + eta),
    ]
}

/// Shape functions at the nearest point of a bilinear quadrilateral, by Gauss and Newton, kept inside the element.
fn on_quad(p: [Vec3; 4], x: Vec3) -> [f64; 4] {
    let (mut xi, mut eta) = (0.0_f64, 0.0_f64);
    for _ in 0..ITERATIONS {
        let n = bilinear(xi, eta);
        let at = (0..4).map(|i| p[i] * n[i]).sum::<Vec3>();
        let r = 0.25 * ((p[1] - p[0]) * (1.0 - eta) + (p[2] - p[3]) * (1.0 + eta));
        let s = 0.25 * ((p[3] - p[0]) * (1.0 - xi) + (p[2] - p[1]) * (1.0 + xi));
        let d = x - at;
        let (rr, rs, ss) = (r.dot(&r), r.dot(&s), s.dot(&s));
        let det = rr * ss - rs * rs;
        if det <= 0.0 {
            break;
        }
        let (dr, ds) = (d.dot(&r), d.dot(&s));
        let mut next = (
            xi + (ss * dr - rs * ds) / det,
            eta + (rr * ds - rs * dr) / det,
        );
        // On an edge the other coordinate has an optimum of its own.
        if !(-1.0..=1.0).contains(&next.0) {
            next.0 = next.0.clamp(-1.0, 1.0);
            next.1 = eta + (ds - rs * (next.0 - xi)) / ss;
        }
        if !(-1.0..=1.0).contains(&next.1) {
            next.1 = next.1.clamp(-1.0, 1.0);
            next.0 = (xi + (dr - rs * (next.1 - eta)) / rr).clamp(-1.0, 1.0);
        }
        let moved = (next.0 - xi).abs() + (next.1 - eta).abs();
        (xi, eta) = next;
        if moved < 1e-12 {
            break;
        }
    }
    bilinear(xi, eta)
}

/// Gauss-Newton steps; flat elements need two or three.
const ITERATIONS: usize = 30;
