//! CQUAD8 and CTRIA6: four- or three-sided shells with mid-side grids. Each consists of one quadrilateral per corner around a middle point, whose
//! unknowns are eliminated.
//!
//! Every quadrilateral is the four-node shell of this module between a corner, the middles of its two sides and the centre. All its points are on the
//! serendipity surface through the grids, with the normals of that surface as directors. So the element passes the tests that its parts pass
//! (constant strain and curvature, six rigid motions and no other). It bends in its plane like two elements per side, and follows a curve. A mid-side
//! grid that the card leaves out is halfway between its corners and moves with their mean.

use super::expansion::{expansion, turn_strain};
use super::output_frame::output_frame;
use super::quad4::quad4;
use super::types::{BadShape, Heat, Parts, ShellInput, ShellLaw, ShellMatrices, Sides};
use crate::linalg::{DMatrix, DVector};
use crate::model::{GridIx, Mat3, Model, Shell, ShellProperty, Vec3, face_edges, face_functions};

/// Strain at a place: rows over the element's unknowns, and the contribution of temperature through the motion of the centre.
#[derive(Clone, Debug, Default)]
pub(crate) struct ManyRows {
    pub(crate) membrane: [Vec<f64>; 3],
    pub(crate) curvature: [Vec<f64>; 3],
    constant: [[f64; 3]; 2],
}

/// Stiffness (row by row), strain and thermal load over six unknowns for each grid.
#[derive(Clone, Debug)]
pub(crate) struct ManyShell {
    pub(crate) stiffness: Vec<f64>,
    pub(crate) centre: ManyRows,
    pub(crate) corners: Vec<ManyRows>,
    pub(crate) thermal: Vec<f64>,
}

impl ManyRows {
    /// Returns the mechanical strain at both surfaces, minus the thermal strain.
    pub(crate) fn surfaces(&self, z: [f64; 2], u: &[f64], free: &[[f64; 3]; 2]) -> [[f64; 3]; 2] {
        let dot = |rows: &[Vec<f64>; 3], constant: [f64; 3]| -> [f64; 3] {
            std::array::from_fn(|c| {
                constant[c] + rows[c].iter().zip(u).map(|(a, b)| a * b).sum::<f64>()
            })
        };
        let membrane = dot(&self.membrane, self.constant[0]);
        let curvature = dot(&self.curvature, self.constant[1]);
        std::array::from_fn(|s| {
            std::array::from_fn(|c| membrane[c] + z[s] * curvature[c] - free[s][c])
        })
    }

    fn add(&mut self, other: &ManyRows, by: f64) {
        let both = [
            (&mut self.membrane, &other.membrane),
            (&mut self.curvature, &other.curvature),
        ];
        for (to, from) in both {
            for (t, f) in to.iter_mut().zip(from) {
                if t.is_empty() {
                    *t = vec![0.0; f.len()];
                }
                t.iter_mut().zip(f).for_each(|(t, f)| *t += by * f);
            }
        }
    }
}

/// Returns the grids of a shell: the corners, then the existing mid-side grids, each with the number of its side.
pub(crate) fn many_grids(shell: &Shell) -> (Vec<GridIx>, Vec<usize>) {
    (shell.all_grids(), shell.middles().collect())
}

/// A corner, a middle of a side or the centre.
struct Point {
    x: Vec3,
    director: Vec3,
    thickness: f64,
    rise: f64,
    /// The unknowns' points that it moves with, the centre behind the grids.
    moves: Vec<(usize, f64)>,
}

/// Corners, middles, centre.
fn points(model: &Model, shell: &Shell, rise: Option<[f64; 4]>) -> Result<Vec<Point>, BadShape> {
    let n = shell.shape.n_corners();
    let (grids, sides) = many_grids(shell);
    let x: Vec<Vec3> = grids.iter().map(|g| model.grids[g.us()].x).collect();
    let places: Vec<[f64; 2]> = if n == 3 {
        let t = 1.0 / 3.0;
        vec![
            [0., 0.],
            [1., 0.],
            [0., 1.],
            [0.5, 0.],
            [0.5, 0.5],
            [0., 0.5],
            [t, t],
        ]
    } else {
        vec![
            [0., 0.],
            [1., 0.],
            [1., 1.],
            [0., 1.],
            [0.5, 0.],
            [1., 0.5],
            [0.5, 1.],
            [0., 0.5],
            [0.5, 0.5],
        ]
    };
    places
        .into_iter()
        .enumerate()
        .map(|(k, p)| {
            let functions = surface_functions(n, p, &sides);
            let sum = |c: usize| -> Vec3 { x.iter().zip(&functions).map(|(x, f)| x * f[c]).sum() };
            let (corner, _) = face_functions(n, p);
            let linear = |v: &[f64; 4]| corner.iter().zip(v).map(|(f, v)| f[0] * v).sum::<f64>();
            let moves = if k < n {
                vec![(k, 1.0)]
            } else if k == 2 * n {
                vec![(grids.len(), 1.0)]
            } else {
                let side = k - n;
                match sides.iter().position(|s| *s == side) {
                    Some(at) => vec![(n + at, 1.0)],
                    None => vec![(side, 0.5), ((side + 1) % n, 0.5)],
                }
            };
            Ok(Point {
                x: sum(0),
                director: sum(1).cross(&sum(2)).try_normalize(0.0).ok_or(BadShape)?,
                thickness: linear(&shell.thickness),
                rise: rise.map_or(0.0, |r| linear(&r)),
                moves,
            })
        })
        .collect()
}

/// Returns the functions of the corners, then of the present mid-side grids.
fn surface_functions(n: usize, p: [f64; 2], sides: &[usize]) -> Vec<[f64; 4]> {
    let (mut all, edges) = face_functions(n, p);
    for side in sides {
        let (a, b) = face_edges(n)[*side];
        let f = edges[*side];
        for c in [a, b] {
            all[c].iter_mut().zip(f).for_each(|(c, f)| *c -= 0.5 * f);
        }
        all.push(f);
    }
    all
}

/// Data that all parts of a shell with mid-side grids share.
struct ParentShell<'a> {
    model: &'a Model,
    property: &'a ShellProperty,
    frame: Mat3,
    /// Direction of the material's x axis.
    material_x: Vec3,
    zoffs: f64,
    k6rot: f64,
    heat: Option<&'a Heat>,
}

impl ParentShell<'_> {
    /// A quadrilateral of four points and the angle of the element's x axis in its frame.
    fn part(&self, p: [&Point; 4]) -> Result<(ShellMatrices<4, 24>, f64), BadShape> {
        let x = p.map(|p| p.x);
        let frame = output_frame(&x).ok_or(BadShape)?;
        let angle_of = |v: &Vec3| {
            let local = frame * v;
            local.y.atan2(local.x)
        };
        let angle = angle_of(&self.material_x);
        let law = ShellLaw::new(self.model, self.property, angle).ok_or(BadShape)?;
        let thickness = p.map(|p| p.thickness);
        let mean = thickness.iter().sum::<f64>() / 4.0;
        let heat = self.heat.map(|h| Heat {
            expansion: expansion(self.model, self.property, mean, angle).unwrap_or_default(),
            rise: p.map(|p| p.rise),
            gradient: h.gradient,
        });
        let matrices = quad4(&ShellInput {
            x,
            directors: p.map(|p| p.director),
            thickness,
            law: &law,
            zoffs: self.zoffs,
            k6rot: self.k6rot,
            parts: Parts::All,
            sides: Sides::Straight,
            heat: heat.as_ref(),
        })?;
        Ok((matrices, angle_of(&self.frame.row(0).transpose())))
    }
}

/// Returns the matrices of a shell with mid-side grids; `material_angle_rad` from the output x axis of its corners.
///
/// # Errors
/// Parts that do not form a quadrilateral.
pub(super) fn many_shell(
    model: &Model,
    shell: &Shell,
    property: &ShellProperty,
    material_angle_rad: f64,
    k6rot: f64,
    heat: Option<&Heat>,
) -> Result<ManyShell, BadShape> {
    let n = shell.shape.n_corners();
    let points = points(model, shell, heat.map(|h| h.rise))?;
    let corners: Vec<Vec3> = points[..n].iter().map(|p| p.x).collect();
    let frame = output_frame(&corners).ok_or(BadShape)?;
    let (sin, cos) = material_angle_rad.sin_cos();
    let whole = ParentShell {
        model,
        property,
        frame,
        material_x: (frame.row(0) * cos + frame.row(1) * sin).transpose(),
        zoffs: shell.zoffs,
        k6rot,
        heat,
    };
    let outer = 6 * shell.all_grids().len();
    let size = outer + 6;
    let mut k = DMatrix::zeros(size, size);
    let mut f = DVector::zeros(size);
    let mut at_corner: Vec<ManyRows> = Vec::with_capacity(n);
    let mut at_centre = ManyRows::default();
    for c in 0..n {
        let four = [c, n + c, 2 * n, n + (c + n - 1) % n];
        let (m, x_angle) = whole.part(four.map(|i| &points[i]))?;
        // For each of the 24 unknowns of a part: unknowns of the whole element, with factors.
        let to: Vec<Vec<(usize, f64)>> = (0..24)
            .map(|i| {
                points[four[i / 6]]
                    .moves
                    .iter()
                    .map(|(p, w)| (6 * p + i % 6, *w))
                    .collect()
            })
            .collect();
        for (i, row) in m.stiffness.iter().enumerate() {
            for (a, wa) in &to[i] {
                f[*a] += wa * m.thermal[i];
                for (j, v) in row.iter().enumerate() {
                    for (b, wb) in &to[j] {
                        k[(*a, *b)] += wa * wb * v;
                    }
                }
            }
        }
        let spread = |rows: &[[f64; 24]; 3]| -> [Vec<f64>; 3] {
            let mut out: [Vec<f64>; 3] = std::array::from_fn(|_| vec![0.0; size]);
            for (i, to) in to.iter().enumerate() {
                let e = turn_strain([rows[0][i], rows[1][i], rows[2][i]], -x_angle);
                for (a, w) in to {
                    (0..3).for_each(|c| out[c][*a] += w * e[c]);
                }
            }
            out
        };
        let rows = |s: &super::StrainRows<24>| ManyRows {
            membrane: spread(&s.membrane),
            curvature: spread(&s.curvature),
            constant: [[0.0; 3]; 2],
        };
        at_corner.push(rows(&m.corners[0]));
        at_centre.add(&rows(&m.corners[2]), 1.0 / n as f64);
    }
    let inner = k.view((outer, outer), (6, 6)).into_owned();
    let factor = inner.cholesky().ok_or(BadShape)?;
    let follow = factor.solve(&k.view((outer, 0), (6, outer)).into_owned());
    let own = factor.solve(&f.rows(outer, 6).into_owned());
    let reduced = k.view((0, 0), (outer, outer)) - k.view((0, outer), (outer, 6)) * &follow;
    let thermal = f.rows(0, outer) - follow.transpose() * f.rows(outer, 6);
    let condense = |rows: &mut ManyRows| {
        let both = [&mut rows.membrane, &mut rows.curvature];
        let all = both
            .into_iter()
            .zip(&mut rows.constant)
            .flat_map(|(rows, constant)| rows.iter_mut().zip(constant));
        for (row, constant) in all {
            let centre = DVector::from_column_slice(&row[outer..]);
            *constant = centre.dot(&own);
            let moved = follow.transpose() * centre;
            row.truncate(outer);
            row.iter_mut().zip(moved.iter()).for_each(|(r, m)| *r -= m);
        }
    };
    at_corner.iter_mut().for_each(condense);
    condense(&mut at_centre);
    Ok(ManyShell {
        stiffness: reduced.transpose().as_slice().to_vec(),
        centre: at_centre,
        corners: at_corner,
        thermal: thermal.as_slice().to_vec(),
    })
}

/// Three-point Gauss rule on 0..1.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Calls `f` with functions (corners, then mid-side grids), area vector and thickness at the points of a rule on the surface.
pub(super) fn over_surface(
    model: &Model,
    shell: &Shell,
    mut at: impl FnMut(&[[f64; 4]], Vec3, f64),
) {
    let n = shell.shape.n_corners();
    let (grids, sides) = many_grids(shell);
    let x: Vec<Vec3> = grids.iter().map(|g| model.grids[g.us()].x).collect();
    over_face(n, &x, &sides, |functions, area| {
        let t = (0..n)
            .map(|c| linear_part(n, functions, &sides, c) * shell.thickness[c])
            .sum();
        at(functions, area, t);
    });
}

/// Returns the linear function of corner `c`: its own function plus half of the functions of the grids on its two sides.
pub(crate) fn linear_part(n: usize, functions: &[[f64; 4]], sides: &[usize], c: usize) -> f64 {
    let halves = sides
        .iter()
        .zip(&functions[n..])
        .filter(|(s, _)| **s == c || (**s + 1) % n == c)
        .map(|(_, f)| 0.5 * f[0]);
    functions[c][0] + halves.sum::<f64>()
}

/// Calls `f` with functions and area vector at the points of a rule on a face of `n` corners with mid-side grids on `sides`.
pub(crate) fn over_face(
    n: usize,
    x: &[Vec3],
    sides: &[usize],
    mut at: impl FnMut(&[[f64; 4]], Vec3),
) {
    for (u, wu) in GAUSS {
        for (v, wv) in GAUSS {
            let (p, w) = if n == 3 {
                ([u, v * (1.0 - u)], wu * wv * (1.0 - u))
            } else {
                ([u, v], wu * wv)
            };
            let functions = surface_functions(n, p, sides);
            let sum = |c: usize| -> Vec3 { x.iter().zip(&functions).map(|(x, f)| x * f[c]).sum() };
            at(&functions, sum(1).cross(&sum(2)) * w);
        }
    }
}
