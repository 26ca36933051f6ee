//! The point of the shells' surfaces, or of their skins, nearest to a given one.

use super::side::{opposite_side, shell_normal};
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, Shell, ShellIx, ShellKind, Vec3};

/// A point on a shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foot {
    /// Shell that contains the point.
    pub shell: ShellIx,
    /// Weights of the corners of the shell: bilinear shape functions of a quadrilateral, area coordinates of a triangle.
    pub weights: [f64; 4],
    /// Point on the reference surface, basic frame.
    pub point: Vec3,
    /// Distance of the given point from `point`, or from the skin of `side` ([`nearest_skin`]).
    pub distance: f64,
    /// Side that faces the given point, or whose skin is nearest to the given point ([`nearest_skin`]).
    pub side: Surface,
}

/// Returns the corners of a shell. For a triangle the fourth corner repeats the third.
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

/// Returns the mean of the corners.
pub fn centre(model: &Model, shell: &Shell) -> Option<Vec3> {
    let n = shell.shape.n_corners();
    Some(corners(model, shell)?.iter().take(n).sum::<Vec3>() / n as f64)
}

/// Returns the distance from the reference surface of a shell to the skin of a side, along the normal at its centre. It is the offset plus half of
/// the thickness at the centre. For a laminate it reaches to the outer face of the last ply. Z1 and Z2 state the fibres of the strain, which may be
/// at other heights.
pub fn to_side(model: &Model, shell: &Shell, side: Surface) -> f64 {
    let n = shell.shape.n_corners();
    let weights = std::array::from_fn(|i| if i < n { 1.0 / n as f64 } else { 0.0 });
    to_side_at(model, shell, side, weights)
}

/// [`to_side`] at the place of these weights of the corners.
fn to_side_at(model: &Model, shell: &Shell, side: Surface, weights: [f64; 4]) -> f64 {
    let property = model.shell_properties.get(shell.property.us());
    let homogeneous = property.is_some_and(|p| matches!(p.kind, ShellKind::Homogeneous { .. }));
    let n = shell.shape.n_corners();
    let corners = weights.iter().take(n);
    let thickness: f64 = (shell.thickness.iter().zip(corners.clone()))
        .map(|(t, w)| t * w)
        .sum();
    let z = if homogeneous && thickness.is_finite() && thickness > 0.0 {
        [-0.5 * thickness, 0.5 * thickness][side.ix()]
    } else {
        let fibres = model.fibres(shell).corners;
        fibres
            .iter()
            .zip(corners)
            .map(|(z, w)| z[side.ix()] * w)
            .sum()
    };
    shell.zoffs + if z.is_finite() { z } else { 0.0 }
}

/// Returns the distances of a point from the bottom and the top skin of a shell; `None` if it has no area.
pub fn from_skins(model: &Model, ix: ShellIx, x: Vec3) -> Option<[f64; 2]> {
    let z = shell_normal(model, ix)?;
    let shell = model.shells.get(ix.us())?;
    let from =
        |side: Surface| foot_on(model, ix, x - z * to_side(model, shell, side)).map(|f| f.distance);
    Some([from(Surface::Bottom)?, from(Surface::Top)?])
}

/// Returns the shell and the side whose skin is nearest to `x`; `None` without shells.
///
/// ZOFFS and half the thickness offset the skins from the reference surface. The reference surface alone therefore determines neither the plate nor
/// the side of a point. A point inside a plate belongs to that plate, because its middle surface counts as a skin. If skins are equally near, the
/// skin of side `stated` is taken, else the top.
///
/// [`Foot::distance`] is the distance from the skin of [`Foot::side`].
pub fn nearest_skin(model: &Model, x: Vec3, stated: Option<Surface>) -> Option<Foot> {
    let mut best: Option<Nearness> = None;
    for (i, shell) in model.shells.iter().enumerate() {
        let ix = ShellIx(i as u32);
        let (Some(p), Some(c)) = (corners(model, shell), centre(model, shell)) else {
            continue;
        };
        let depth = [Surface::Bottom, Surface::Top].map(|s| to_side(model, shell, s).abs());
        let radius = p.iter().map(|q| (q - c).norm()).fold(0.0, f64::max) + depth[0].max(depth[1]);
        let tolerance = SAME_PLACE * radius.max(x.norm());
        if best.is_some_and(|b| (x - c).norm() - radius > b.distance + tolerance) {
            continue;
        }
        if let Some(near) = nearness(model, ix, x, stated)
            && best.is_none_or(|b| near.is_before(&b, tolerance))
        {
            best = Some(near);
        }
    }
    best.map(|b| b.foot)
}

/// Share of the size of coordinates up to which two distances count as equal, to allow for rounding.
const SAME_PLACE: f64 = 1e-10;

/// Distance of a point from a shell, with the place there.
#[derive(Clone, Copy)]
struct Nearness {
    /// Distance from the nearest of both skins and the middle surface.
    distance: f64,
    /// Order among equal distances: skin of the stated side, other skin, middle surface.
    rank: usize,
    foot: Foot,
}

impl Nearness {
    fn is_before(&self, other: &Self, tolerance: f64) -> bool {
        let nearer = self.distance - other.distance;
        nearer < -tolerance || (nearer <= tolerance && self.rank < other.rank)
    }
}

fn nearness(model: &Model, ix: ShellIx, x: Vec3, stated: Option<Surface>) -> Option<Nearness> {
    let z = shell_normal(model, ix)?;
    let shell = model.shells.get(ix.us())?;
    let layer = |height: f64| foot_on(model, ix, x - z * height);
    let first = stated.unwrap_or(Surface::Top);
    let sides = [first, opposite_side(first)];
    let mut height = sides.map(|s| to_side(model, shell, s));
    if shell.thickness[..shell.shape.n_corners()]
        .windows(2)
        .any(|t| t[0] != t[1])
    {
        // The skins of a tapered shell depend on the thickness at the place.
        let local = |s: Surface, h: f64| Some(to_side_at(model, shell, s, layer(h)?.weights));
        height = [local(sides[0], height[0])?, local(sides[1], height[1])?];
    }
    let skins = [layer(height[0])?, layer(height[1])?];
    let middle = layer(0.5 * (height[0] + height[1]))?.distance;
    let tolerance = SAME_PLACE * (height[0] - height[1]).abs().max(x.norm());
    let nearer = usize::from(skins[1].distance < skins[0].distance - tolerance);
    let skin = skins[nearer].distance;
    let inside = middle < skin - tolerance;
    Some(Nearness {
        distance: if inside { middle } else { skin },
        rank: if inside { 2 } else { nearer },
        foot: Foot {
            side: if nearer == 0 {
                first
            } else {
                opposite_side(first)
            },
            ..skins[nearer]
        },
    })
}

/// Returns the point of the reference surfaces of these shells that is nearest to `x`; `None` without shells.
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

/// Returns the point of the reference surface of one shell that is nearest to `x`.
pub fn foot_on(model: &Model, ix: ShellIx, x: Vec3) -> Option<Foot> {
    let shell = model.shells.get(ix.us())?;
    let p = corners(model, shell)?;
    let weights = if shell.shape.n_corners() == 3 {
        on_triangle([p[0], p[1], p[2]], x)
    } else {
        on_quad(p, x)
    };
    let point = (0..4).map(|i| p[i] * weights[i]).sum::<Vec3>();
    let side = if (x - point).dot(&shell_normal(model, ix)?) >= 0.0 {
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
fn bilinear_shape_functions(xi: f64, eta: f64) -> [f64; 4] {
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
        let n = bilinear_shape_functions(xi, eta);
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
        // On an edge the other coordinate has a separate optimum.
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
    bilinear_shape_functions(xi, eta)
}

/// Gauss-Newton steps; flat elements need two or three.
const ITERATIONS: usize = 30;
