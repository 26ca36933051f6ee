//! Shape functions of solids at the points of their rules, made once.

use crate::fe::element::triangle_points::RADON;
use crate::model::{solid_edges, solid_functions};
use nastran::cards::SolidShape;
use std::sync::OnceLock;

/// Value of a function, and its derivatives along the parameters.
pub(super) type Function = [f64; 4];

/// Functions at a point.
#[derive(Clone, Debug)]
pub(super) struct TablePoint {
    pub(super) weight: f64,
    pub(super) p: [f64; 3],
    corners: Vec<Function>,
    edges: Vec<Function>,
}

impl TablePoint {
    fn new(shape: SolidShape, weight: f64, p: [f64; 3]) -> Self {
        let (corners, edges) = solid_functions(shape, p);
        Self {
            weight,
            p,
            corners,
            edges,
        }
    }

    /// Returns the functions of the corners, then of the mid-side grids at `mids` (edge numbers). Half of the function of each edge is subtracted
    /// from its corners.
    pub(super) fn functions(&self, shape: SolidShape, mids: &[usize]) -> Vec<Function> {
        let mut all = self.corners.clone();
        let edges = solid_edges(shape);
        for m in mids {
            let (a, b) = edges[*m];
            let f = self.edges[*m];
            for c in [a, b] {
                all[c].iter_mut().zip(f).for_each(|(c, f)| *c -= 0.5 * f);
            }
            all.push(f);
        }
        all
    }
}

/// Integration and sampling points of a shape.
#[derive(Debug)]
pub(super) struct Tables {
    /// Integration without mid-side grids.
    pub(super) linear: Vec<TablePoint>,
    /// Integration with mid-side grids.
    pub(super) quadratic: Vec<TablePoint>,
    /// Points at which strain is computed.
    pub(super) sampling: Vec<TablePoint>,
    /// Weights that extrapolate values at the sampling points to the corners: by corner, then by point.
    pub(super) to_corner: Vec<Vec<f64>>,
    pub(super) centre: TablePoint,
}

impl Tables {
    pub(super) fn get(shape: SolidShape) -> &'static Self {
        static ALL: [OnceLock<Tables>; 4] = [const { OnceLock::new() }; 4];
        ALL[shape as usize].get_or_init(|| Self::new(shape))
    }

    fn new(shape: SolidShape) -> Self {
        let at = |list: Vec<(f64, [f64; 3])>| {
            list.into_iter()
                .map(|(w, p)| TablePoint::new(shape, w, p))
                .collect()
        };
        let (linear, quadratic, sampling, centre) = match shape {
            SolidShape::Tetra => (
                vec![(1.0 / 6.0, [0.25; 3])],
                collapse_cube_rule(),
                tetrahedron(),
                [0.25; 3],
            ),
            SolidShape::Penta => (
                with_height(&triangle(), &TWO),
                with_height(&RADON.map(|(r, s, w)| (w, [r, s])), &THREE),
                with_height(&triangle(), &TWO),
                [1.0 / 3.0, 1.0 / 3.0, 0.5],
            ),
            SolidShape::Hexa => (
                with_height(&square(&TWO), &TWO),
                with_height(&square(&THREE), &THREE),
                with_height(&square(&TWO), &TWO),
                [0.5; 3],
            ),
            // The axis is from the centre of the base to the apex; the centre of gravity is at a quarter of the height.
            SolidShape::Pyram => (
                with_height(&square(&THREE), &THREE),
                with_height(&square(&THREE), &THREE),
                with_height(&square(&TWO), &TWO),
                [0.5, 0.5, 0.25],
            ),
        };
        Self {
            linear: at(linear),
            quadratic: at(quadratic),
            to_corner: to_corner(shape, &sampling),
            sampling: at(sampling),
            centre: TablePoint::new(shape, 1.0, centre),
        }
    }
}

/// Gauss-Legendre on 0..1, abscissae and weights (Abramowitz and Stegun, table 25.4).
const TWO: [(f64, f64); 2] = [
    (0.211_324_865_405_187_1, 0.5),
    (0.788_675_134_594_812_9, 0.5),
];
const THREE: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 0.277_777_777_777_777_8),
    (0.5, 0.444_444_444_444_444_4),
    (0.887_298_334_620_741_7, 0.277_777_777_777_777_8),
];

fn square(line: &[(f64, f64)]) -> Vec<(f64, [f64; 2])> {
    line.iter()
        .flat_map(|(s, ws)| line.iter().map(move |(r, wr)| (wr * ws, [*r, *s])))
        .collect()
}

/// Degree 2, inside.
fn triangle() -> Vec<(f64, [f64; 2])> {
    let (a, b) = (1.0 / 6.0, 2.0 / 3.0);
    [[a, a], [b, a], [a, b]].map(|p| (1.0 / 6.0, p)).to_vec()
}

fn with_height(base: &[(f64, [f64; 2])], line: &[(f64, f64)]) -> Vec<(f64, [f64; 3])> {
    line.iter()
        .flat_map(|(t, wt)| base.iter().map(move |(w, [r, s])| (w * wt, [*r, *s, *t])))
        .collect()
}

/// Degree 2 on the tetrahedron, four points; [`FAR`] and [`NEAR`] are their barycentric coordinates.
fn tetrahedron() -> Vec<(f64, [f64; 3])> {
    [
        [NEAR, NEAR, NEAR],
        [FAR, NEAR, NEAR],
        [NEAR, FAR, NEAR],
        [NEAR, NEAR, FAR],
    ]
    .map(|p| (1.0 / 24.0, p))
    .to_vec()
}

const FAR: f64 = 0.585_410_196_624_968_5;
const NEAR: f64 = 0.138_196_601_125_010_5;

/// A cube's rule collapsed: for mass and stiffness of tetrahedra with mid-side grids, curved ones too.
fn collapse_cube_rule() -> Vec<(f64, [f64; 3])> {
    let mut out = Vec::new();
    for (u, wu) in THREE {
        for (v, wv) in THREE {
            for (t, wt) in THREE {
                let rest = (1.0 - u) * (1.0 - v);
                out.push((
                    wu * wv * wt * (1.0 - u) * rest,
                    [u, v * (1.0 - u), t * rest],
                ));
            }
        }
    }
    out
}

/// Linear (bricks: trilinear) through the sampling points, taken at the corners.
fn to_corner(shape: SolidShape, sampling: &[(f64, [f64; 3])]) -> Vec<Vec<f64>> {
    // Weight of the point `at` in the linear extrapolation from two points to an end.
    let along = |end: f64, at: f64| {
        let [(a, _), (b, _)] = TWO;
        let other = if (at - a).abs() < 0.1 { b } else { a };
        (end - other) / (at - other)
    };
    let on_triangle = |corner: usize, p: &[f64; 3]| {
        let l = [1.0 - p[0] - p[1], p[0], p[1]];
        // The points have the barycentric coordinates 2/3 and 1/6.
        let own = if l[corner] > 0.5 { 1.0 } else { 0.0 };
        (own - 1.0 / 6.0) / 0.5
    };
    let corners: Vec<[f64; 3]> = match shape {
        SolidShape::Pyram => vec![
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [0., 1., 0.],
            [0.5, 0.5, 1.],
        ],
        _ => vec![
            [0., 0., 0.],
            [1., 0., 0.],
            [1., 1., 0.],
            [0., 1., 0.],
            [0., 0., 1.],
            [1., 0., 1.],
            [1., 1., 1.],
            [0., 1., 1.],
        ],
    };
    (0..shape.n_corners())
        .map(|c| {
            sampling
                .iter()
                .enumerate()
                .map(|(k, (_, p))| match shape {
                    SolidShape::Tetra => {
                        let own = if k == c { 1.0 } else { 0.0 };
                        (own - NEAR) / (FAR - NEAR)
                    }
                    SolidShape::Penta => {
                        on_triangle(c % 3, p) * along(if c < 3 { 0.0 } else { 1.0 }, p[2])
                    }
                    SolidShape::Hexa | SolidShape::Pyram => {
                        (0..3).map(|i| along(corners[c][i], p[i])).product()
                    }
                })
                .collect()
        })
        .collect()
}
