//! CSHEAR: a panel that carries shear flow along its sides, and rods along them where PSHEAR has effectiveness factors.

use super::ElementMatrix;
use crate::fe::error::Refusal;
use crate::model::{MaterialKind, Model, ShearPanel, Vec3};

fn refuse(panel: &ShearPanel, reason: &str, remedy: &str) -> Refusal {
    Refusal::new(format!("CSHEAR {}", panel.id), panel.at, reason, remedy)
}

/// A panel in its mean plane: x along side 1-2, corner 1 at the origin.
struct Plane {
    /// Corners 2, 3, 4: x2; x3, y3; x4, y4.
    x: [f64; 3],
    y: [f64; 2],
    axes: [Vec3; 2],
    area: f64,
}

impl Plane {
    fn new(p: &[Vec3; 4]) -> Option<Self> {
        let (d1, d2) = (p[2] - p[0], p[3] - p[1]);
        let across = d1.cross(&d2);
        let normal = across.try_normalize(0.0)?;
        let side = p[1] - p[0];
        let i = (side - normal * side.dot(&normal)).try_normalize(0.0)?;
        let j = normal.cross(&i);
        let (x2, third, fourth) = (side.dot(&i), d1, p[3] - p[0]);
        let plane = Self {
            x: [x2, third.dot(&i), fourth.dot(&i)],
            y: [third.dot(&j), fourth.dot(&j)],
            axes: [i, j],
            area: 0.5 * across.norm(),
        };
        let ([x2, x3, x4], [y3, y4]) = (plane.x, plane.y);
        // Convex: all inner angles are below 180 degrees.
        let convex = y3 > 0.0 && y4 > 0.0 && x3 > y3 * x4 / y4 && x4 < x2 - (x2 - x3) * y4 / y3;
        convex.then_some(plane)
    }

    /// Returns the energy of a panel under unit average shear flow, times G t. In Garvey's distribution, the flow decreases with the distance from
    /// the line through the intersections of opposite sides.
    fn flexibility(&self, nu: f64) -> f64 {
        /// Tangent below which two sides count as parallel, because the general formulas lose digits to cancellation there. With this limit, shear
        /// flow agrees with the panels of a solver to 2e-6; with a limit of a tenth, only to 1e-3.
        const PARALLEL: f64 = 1e-4;
        let ([x2, x3, x4], [y3, y4]) = (self.x, self.y);
        let area = self.area;
        let back = x3 - x2;
        let nu1 = 1.0 / (1.0 + nu);
        let third = 2.0 / 3.0;
        let flat = (y3 - y4).abs() < (x3 - x4).abs() * PARALLEL;
        let upright = (y4 * back - y3 * x4).abs() < (x4 * back + y4 * y3).abs() * PARALLEL;
        let ratio = |p: [f64; 4]| p[0] * p[1] / (p[2] * p[3]);
        match (flat, upright) {
            (true, true) => {
                let lean = -0.5 * (x4 / y4 + back / y3 + (y3 - y4) / (x3 - x4));
                0.5 * area * (1.0 + 2.0 * lean * lean * nu1)
            }
            (true, false) => {
                let meet = y3 * x4 - y4 * back;
                let (xp, yp) = (x2 * y3 * x4 / meet, x2 * y3 * y4 / meet);
                let (a, c) = ((x2 - xp) / yp, -xp / yp);
                let p = [yp, yp, yp - y3, yp - y4];
                0.5 * ratio(p) * area * (1.0 + third * nu1 * (a * a + a * c + c * c))
            }
            (false, true) => {
                let d = -0.5 * (x4 / y4 + back / y3);
                let xq = x4 - y4 * (x3 - x4) / (y3 - y4);
                let s = 1.0 / (1.0 + d * d).sqrt();
                let p = [
                    xq * s,
                    (xq - x2) * s,
                    (xq - x3 - d * y3) * s,
                    (xq - x4 - d * y4) * s,
                ];
                let lead = xq - x4;
                let b = (lead * d + y4) / (lead - y4 * d);
                0.5 * ratio(p) * area * (1.0 + third * nu1 * (b * b + b * d + d * d))
            }
            (false, false) => {
                let xq = x4 - (x3 - x4) / (y3 - y4) * y4;
                let meet = y3 * x4 - y4 * back;
                let (xp, yp) = (x2 * y3 * x4 / meet, x2 * y3 * y4 / meet);
                let l = (xq - xp).hypot(yp);
                let d = (xq - xp) / yp;
                let s = yp / l;
                let p = [
                    xq * s,
                    (xq - x2) * s,
                    (xq - x3 - d * y3) * s,
                    (xq - x4 - d * y4) * s,
                ];
                let c = l / p[0] - d;
                let (a, b) = (l / p[1] - d, l / p[3] - c);
                let term = |u: f64, v: f64| {
                    let odd = |w: f64| w + third * w.powi(3) + 0.2 * w.powi(5);
                    (odd(u) + odd(v)) * (u + v).abs().ln()
                };
                let even = |k: i32, m: i32| {
                    (a.powi(k) - c.powi(k)) * (b.powi(m) - d.powi(m))
                        + (b.powi(k) - d.powi(k)) * (a.powi(m) - c.powi(m))
                };
                let sum = term(a, b) + term(c, d) - term(b, c) - term(d, a) + 0.1 * even(2, 3)
                    - 0.2 * even(1, 4);
                let f = 0.5 * p.iter().product::<f64>() / (l * l) * sum;
                0.5 * ratio(p) * (area + 4.0 * nu1 * (f - third * area))
            }
        }
    }

    /// Forces at the corners, along the diagonals, of a unit shear flow.
    fn pulls(&self) -> [Vec3; 4] {
        let ([x2, x3, x4], [y3, y4]) = (self.x, self.y);
        let [i, j] = self.axes;
        let (d13, d24) = (x3.hypot(y3), (x4 - x2).hypot(y4));
        let long = (i * x3 + j * y3) / d13;
        let cross = (i * (x4 - x2) + j * y4) / d24;
        let skew = x4 * y3 - x3 * y4;
        let first = long * (-0.5 * x2 * y4 * d13 / skew);
        let second = cross * (0.5 * x2 * y3 * d24 / (skew - x2 * (y3 - y4)));
        [first, second, -first, -second]
    }
}

/// Computes the stiffness of shear panel `i`, basic frame. Rotations have no stiffness.
///
/// # Reference
/// Garvey, The quadrilateral shear panel, Aircraft Engineering 23 (1951) 134; NASTRAN Theoretical Manual, section 5.3 (the flexibility
/// of the panel under the flow that its four corner forces balance).
///
/// # Errors
/// Panels whose corners do not form a convex quadrilateral; a material that is not a MAT1; a thickness that is not above zero.
pub(super) fn shear_panel_stiffness(model: &Model, i: usize) -> Result<ElementMatrix, Refusal> {
    let panel = &model.shear_panels[i];
    let Some(MaterialKind::Isotropic { e, g, nu, .. }) =
        model.materials.get(panel.material.us()).map(|m| m.kind)
    else {
        return Err(refuse(
            panel,
            "its material is not a MAT1",
            "shear panels need a MAT1",
        ));
    };
    if !(panel.t > 0.0 && g > 0.0) {
        return Err(refuse(
            panel,
            "it has no thickness or no shear modulus",
            "give both a value above zero",
        ));
    }
    let x = panel.grids.map(|g| model.grids[g.us()].x);
    let plane = Plane::new(&x).ok_or_else(|| {
        refuse(
            panel,
            "its corners do not form a convex quadrilateral",
            "check their order",
        )
    })?;
    let stiffness = g * panel.t / (2.0 * plane.flexibility(nu));
    let pulls = plane.pulls();
    let mut k = ElementMatrix::zeros(panel.grids.to_vec());
    let n = k.n();
    let mut add = |a: usize, b: usize, u: &Vec3, v: &Vec3, by: f64| {
        for r in 0..3 {
            for c in 0..3 {
                k.values[(6 * a + r) * n + 6 * b + c] += by * u[r] * v[c];
            }
        }
    };
    for a in 0..4 {
        for b in 0..4 {
            add(a, b, &pulls[a], &pulls[b], stiffness);
        }
    }
    for (sides, factor) in [([(0, 1), (2, 3)], panel.f1), ([(1, 2), (3, 0)], panel.f2)] {
        let lengths = sides.map(|(a, b): (usize, usize)| (x[b] - x[a]).norm());
        let area = rod_area(panel, factor, plane.area, lengths[0] + lengths[1]);
        for ((a, b), length) in sides.into_iter().zip(lengths) {
            let along = (x[b] - x[a]) / length;
            let axial = e * area / length;
            for (p, q, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
                add(p, q, &along, &along, sign * axial);
            }
        }
    }
    Ok(k)
}

/// Area of the rods along a pair of sides.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, PSHEAR, remarks on F1 and F2.
fn rod_area(panel: &ShearPanel, factor: f64, area: f64, lengths: f64) -> f64 {
    if factor <= 0.0 {
        0.0
    } else if factor <= 1.01 {
        factor * panel.t * area / lengths
    } else {
        0.5 * factor * panel.t * panel.t
    }
}

/// Returns the mass at the corners of shear panel `i`, before WTMASS. Each triangle of corners gives a third of its mass to each of its corners. The
/// two ways to divide the panel into triangles have equal weight.
pub(crate) fn shear_panel_mass(model: &Model, i: usize) -> [f64; 4] {
    let panel = &model.shear_panels[i];
    let x = panel.grids.map(|g| model.grids[g.us()].x);
    let rho = model
        .materials
        .get(panel.material.us())
        .map_or(0.0, |m| m.rho);
    let per_area = rho * panel.t + panel.nsm;
    let mut shares = [0.0; 4];
    for triangle in [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]] {
        let [a, b, c] = triangle.map(|k: usize| x[k]);
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        for k in triangle {
            shares[k] += per_area * area / 6.0;
        }
    }
    shares
}

#[cfg(test)]
mod tests;
