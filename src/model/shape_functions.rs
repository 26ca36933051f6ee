//! Elements with mid-side grids: their shape functions, and areas of shells.
//!
//! The map from parameters to space is isoparametric (serendipity family). It is the linear map of the corners plus one term for every edge with a
//! mid-side grid. The term is the edge function times the vector from the middle of the edge to the grid: `x(p) = sum N_c(p) x_c + sum 4 N_edge(p)
//! (x_m - (x_a + x_b) / 2)`. In every single parameter its degree is at most two. A central difference over a whole step is therefore its exact
//! derivative.
//!
//! # Reference
//! O. C. Zienkiewicz, R. L. Taylor, The Finite Element Method, volume 1, chapter 8: serendipity families.

use super::types::Vec3;
use nastran::cards::{ShellShape, SolidShape};
use std::sync::OnceLock;

/// Parameter domains: products of segments, triangles and a tetrahedron, all with coordinates from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Domain {
    Triangle,
    Square,
    Tetrahedron,
    Wedge,
    Cube,
}

/// Edges by their corners, in the order of the mid-side grids on the card.
const TRIANGLE: [(usize, usize); 3] = [(0, 1), (1, 2), (2, 0)];
const SQUARE: [(usize, usize); 4] = [(0, 1), (1, 2), (2, 3), (3, 0)];
const TETRAHEDRON: [(usize, usize); 6] = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)];
const WEDGE: [(usize, usize); 9] = [
    (0, 1),
    (1, 2),
    (2, 0),
    (0, 3),
    (1, 4),
    (2, 5),
    (3, 4),
    (4, 5),
    (5, 3),
];
const CUBE: [(usize, usize); 12] = [
    (0, 1),
    (1, 2),
    (2, 3),
    (3, 0),
    (0, 4),
    (1, 5),
    (2, 6),
    (3, 7),
    (4, 5),
    (5, 6),
    (6, 7),
    (7, 4),
];

/// Map of an element: its corners, and for every edge the vector from its middle to its mid-side grid.
struct Map {
    domain: Domain,
    corners: Vec<Vec3>,
    /// Index of the edge in the domain, and the vector from its middle to the mid-side grid.
    edges: Vec<(usize, Vec3)>,
}

/// Returns the area of a shell; `None` without all its corners. `x`: corners, then mid-side grids (`None`: a straight edge).
pub(super) fn shell_area(shape: ShellShape, x: &[Option<Vec3>]) -> Option<f64> {
    let n = shape.n_corners();
    let domain = if n == 3 {
        Domain::Triangle
    } else {
        Domain::Square
    };
    Some(Map::from_node_locations(domain, face_edges(n), x)?.area())
}

/// Value, then exact derivatives: every function is of second degree at most in each parameter.
fn with_slopes(f: &dyn Fn([f64; 3]) -> f64, p: [f64; 3]) -> [f64; 4] {
    let slope = |k: usize| {
        let (mut a, mut b) = (p, p);
        a[k] += 0.5;
        b[k] -= 0.5;
        f(a) - f(b)
    };
    [f(p), slope(0), slope(1), slope(2)]
}

/// Returns the edges of an element by their corners, in the order of the mid-side grids on the card; a pyramid has none here.
pub(crate) fn solid_edges(shape: SolidShape) -> &'static [(usize, usize)] {
    match shape {
        SolidShape::Tetra => &TETRAHEDRON,
        SolidShape::Penta => &WEDGE,
        SolidShape::Hexa => &CUBE,
        SolidShape::Pyram => &[],
    }
}

/// Returns the value and derivatives of every linear corner function and every edge function of a solid. The three parameters run from 0 to 1. An
/// edge function is largest in the middle of its edge. A pyramid is a brick whose upper four corners coincide.
pub(crate) fn solid_functions(shape: SolidShape, p: [f64; 3]) -> (Vec<[f64; 4]>, Vec<[f64; 4]>) {
    let domain = match shape {
        SolidShape::Tetra => Domain::Tetrahedron,
        SolidShape::Penta => Domain::Wedge,
        SolidShape::Hexa | SolidShape::Pyram => Domain::Cube,
    };
    let mut corners = domain.corner_functions(p);
    if shape == SolidShape::Pyram {
        let upper = corners.split_off(4);
        corners.push(std::array::from_fn(|k| upper.iter().map(|n| n[k]).sum()));
        return (corners, Vec::new());
    }
    (corners, domain.edge_functions(p))
}

/// Returns corner and edge functions of a triangle or square with their derivatives, third parameter 0; they define a shell with mid-side grids.
pub(crate) fn face_functions(n_corners: usize, p: [f64; 2]) -> (Vec<[f64; 4]>, Vec<[f64; 4]>) {
    let domain = if n_corners == 3 {
        Domain::Triangle
    } else {
        Domain::Square
    };
    let p = [p[0], p[1], 0.0];
    (domain.corner_functions(p), domain.edge_functions(p))
}

/// Returns the edges of a triangle or square by their corners, in the order of the mid-side grids.
pub(crate) fn face_edges(n_corners: usize) -> &'static [(usize, usize)] {
    if n_corners == 3 { &TRIANGLE } else { &SQUARE }
}

impl Map {
    fn from_node_locations(
        domain: Domain,
        edges: &[(usize, usize)],
        x: &[Option<Vec3>],
    ) -> Option<Self> {
        let n = domain.corners();
        let corners: Vec<Vec3> = x.iter().take(n).flatten().copied().collect();
        if corners.len() != n {
            return None;
        }
        let bent = edges
            .iter()
            .zip(x.get(n..).unwrap_or_default())
            .enumerate()
            .filter_map(|(e, ((a, b), m))| {
                let (a, b) = (corners.get(*a)?, corners.get(*b)?);
                let away = (*m)? - (a + b) / 2.0;
                (away.norm() > STRAIGHT * (b - a).norm()).then_some((e, away))
            });
        Some(Map {
            domain,
            edges: bent.collect(),
            corners,
        })
    }

    /// Area of a triangle or square by the Gauss rule of its domain.
    fn area(&self) -> f64 {
        let at = |point: &RulePoint| {
            let sum = |k: usize| -> Vec3 {
                let corners = self.corners.iter().zip(&point.corners);
                let straight: Vec3 = corners.map(|(x, n)| x * n[k]).sum();
                let bent = self.edges.iter();
                let bent = bent.filter_map(|(e, d)| Some(d * point.edges.get(*e)?[k]));
                straight + bent.sum::<Vec3>()
            };
            point.weight * sum(1).cross(&sum(2)).norm()
        };
        self.domain.rule().iter().map(at).sum()
    }
}

/// A point of a domain's Gauss rule: value and derivatives along the three parameters of every corner function and of four times every
/// edge function.
struct RulePoint {
    weight: f64,
    corners: Vec<[f64; 4]>,
    edges: Vec<[f64; 4]>,
}

impl Domain {
    fn all_edges(self) -> &'static [(usize, usize)] {
        match self {
            Domain::Triangle => &TRIANGLE,
            Domain::Square => &SQUARE,
            Domain::Tetrahedron => &TETRAHEDRON,
            Domain::Wedge => &WEDGE,
            Domain::Cube => &CUBE,
        }
    }

    /// Gauss rule of a triangle or square, computed once.
    fn rule(self) -> &'static [RulePoint] {
        static RULES: [OnceLock<Vec<RulePoint>>; 2] = [const { OnceLock::new() }; 2];
        RULES[usize::from(self != Domain::Triangle)].get_or_init(|| {
            let point = |(weight, p): (f64, [f64; 3])| RulePoint {
                weight,
                corners: self.corner_functions(p),
                edges: self.edge_functions(p),
            };
            self.points().into_iter().map(point).collect()
        })
    }

    fn corner_functions(self, p: [f64; 3]) -> Vec<[f64; 4]> {
        (0..self.corners())
            .map(|c| with_slopes(&|p| self.shape(c, p), p))
            .collect()
    }

    fn edge_functions(self, p: [f64; 3]) -> Vec<[f64; 4]> {
        self.all_edges()
            .iter()
            .map(|(a, b)| with_slopes(&|p| 4.0 * self.edge(*a, *b, p), p))
            .collect()
    }

    fn corners(self) -> usize {
        match self {
            Domain::Triangle => 3,
            Domain::Square | Domain::Tetrahedron => 4,
            Domain::Wedge => 6,
            Domain::Cube => 8,
        }
    }

    /// Linear shape function of a corner.
    fn shape(self, corner: usize, [r, s, t]: [f64; 3]) -> f64 {
        let square = |c: usize| match c {
            0 => (1.0 - r) * (1.0 - s),
            1 => r * (1.0 - s),
            2 => r * s,
            _ => (1.0 - r) * s,
        };
        let triangle = |c: usize| [1.0 - r - s, r, s].get(c).copied().unwrap_or(0.0);
        let level = |top: bool| if top { t } else { 1.0 - t };
        match self {
            Domain::Triangle => triangle(corner),
            Domain::Square => square(corner),
            Domain::Tetrahedron => [1.0 - r - s - t, r, s, t]
                .get(corner)
                .copied()
                .unwrap_or(0.0),
            Domain::Wedge => triangle(corner % 3) * level(corner >= 3),
            Domain::Cube => square(corner % 4) * level(corner >= 4),
        }
    }

    /// Edge function: quadratic along the edge, linear away from it, a quarter in its middle.
    fn edge(self, a: usize, b: usize, [r, s, t]: [f64; 3]) -> f64 {
        let bottom = |c: usize| match self {
            Domain::Wedge => c % 3,
            Domain::Cube => c % 4,
            _ => c,
        };
        // Shape function of a corner of the triangle or square in the base plane, without the factor along the height.
        let flat = |c: usize| match self {
            Domain::Wedge => Domain::Triangle.shape(c, [r, s, 0.0]),
            Domain::Cube => Domain::Square.shape(c, [r, s, 0.0]),
            _ => self.shape(c, [r, s, t]),
        };
        let (i, j) = (bottom(a), bottom(b));
        let tall = matches!(self, Domain::Wedge | Domain::Cube);
        if tall && i == j {
            return flat(i) * t * (1.0 - t);
        }
        let along = match self {
            // Shape functions of two adjacent corners of a square have the factor across the edge in common. It enters once.
            Domain::Square | Domain::Cube => match (i, j) {
                (0, 1) => r * (1.0 - r) * (1.0 - s),
                (1, 2) => s * (1.0 - s) * r,
                (2, 3) => r * (1.0 - r) * s,
                _ => s * (1.0 - s) * (1.0 - r),
            },
            _ => flat(i) * flat(j),
        };
        match (tall, a >= self.corners() / 2) {
            (false, _) => along,
            (true, false) => along * (1.0 - t),
            (true, true) => along * t,
        }
    }

    /// Gauss rule of a triangle or square: three points a direction, the triangle as a collapsed square.
    fn points(self) -> Vec<(f64, [f64; 3])> {
        let mut out = Vec::new();
        for (u, wu) in GAUSS_3 {
            for (v, wv) in GAUSS_3 {
                let w = wu * wv;
                out.push(match self {
                    Domain::Triangle => (w * (1.0 - u), [u, v * (1.0 - u), 0.0]),
                    _ => (w, [u, v, 0.0]),
                });
            }
        }
        out
    }
}

/// Abscissae and weights on 0..1 (Gauss-Legendre, Abramowitz and Stegun table 25.4).
const GAUSS_3: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 0.277_777_777_777_777_8),
    (0.5, 0.444_444_444_444_444_4),
    (0.887_298_334_620_741_7, 0.277_777_777_777_777_8),
];

/// Largest distance of a mid-side grid from the middle of a straight edge, over the length of the edge. Decks contain coordinates to about seven
/// digits.
const STRAIGHT: f64 = 1e-7;

#[cfg(test)]
mod tests;
