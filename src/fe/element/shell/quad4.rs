//! CQUAD4: MITC4 bending and shear, QM6 membrane, drilling stiffness.

use super::kinematics::{
    Section, Shape, TangentFrame, Tangents, add_bending_sides, add_thermal, curvature,
    drilling_row, membrane, shear, shift, shift_rows, shift_stiffness,
};
use super::output_frame::output_frame;
use super::products::Products;
use super::types::{BadShape, Parts, Row, ShellInput, ShellMatrices, Sides, StrainRows};
use crate::linalg::Matrix4;

const CORNERS: [(f64, f64); 4] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
/// 1 / sqrt(3): the 2 x 2 Gauss points.
const GAUSS: f64 = 0.577_350_269_189_625_8;

fn shape(r: f64, s: f64) -> Shape<4> {
    Shape {
        h: CORNERS.map(|(a, b)| 0.25 * (1.0 + a * r) * (1.0 + b * s)),
        hr: CORNERS.map(|(a, b)| 0.25 * a * (1.0 + b * s)),
        hs: CORNERS.map(|(a, b)| 0.25 * b * (1.0 + a * r)),
    }
}

/// Derivatives of the parabola of each side (one in its middle, linear to nothing at the side across).
fn side_slopes(r: f64, s: f64) -> [(f64, f64); 4] {
    [
        (-r * (1.0 - s), -0.5 * (1.0 - r * r)),
        (0.5 * (1.0 - s * s), -s * (1.0 + r)),
        (-r * (1.0 + s), 0.5 * (1.0 - r * r)),
        (-0.5 * (1.0 - s * s), -s * (1.0 - r)),
    ]
}

/// Returns the shape functions at the Gauss points, each of weight 1.
pub(super) fn quad_points() -> [Shape<4>; 4] {
    CORNERS.map(|(a, b)| shape(a * GAUSS, b * GAUSS))
}

/// Strain rows and geometry at a Gauss point, used several times.
struct Point {
    shape: Shape<4>,
    local: TangentFrame,
    membrane: [Row<24>; 3],
    curvature: [Row<24>; 3],
    /// Strains xx, yy, xy of the four incompatible modes.
    modes: [[f64; 4]; 3],
    t: f64,
}

impl Point {
    /// Adds membrane, bending and drilling stiffness, and the load of thermal strain.
    fn add(&self, input: &ShellInput<'_, 4>, stiffness: &mut Products, thermal: &mut Row<24>) {
        if let Some(heat) = input.heat {
            let rise = self
                .shape
                .h
                .iter()
                .zip(&heat.rise)
                .map(|(h, t)| h * t)
                .sum();
            add_thermal(
                thermal,
                self.local.area,
                heat.resultants(rise),
                &self.membrane,
                &self.curvature,
            );
        }
        let section = Section {
            law: input.law,
            t: self.t,
            k6rot: input.k6rot,
        };
        if input.parts == Parts::All {
            section.add(
                stiffness,
                self.local.area,
                &self.membrane,
                &self.curvature,
                &drilling_row(&self.local, &self.shape),
            );
        }
    }
}

/// Returns the stiffness and strain of a four-node shell.
///
/// # Reference
/// Dvorkin and Bathe, Eng. Comput. 1 (1984) 77; Taylor, Beresford and Wilson, IJNME 10 (1976) 1211.
///
/// # Errors
/// An error if the corners do not form a convex quadrilateral.
pub(crate) fn quad4(input: &ShellInput<'_, 4>) -> Result<ShellMatrices<4, 24>, BadShape> {
    let frame = output_frame(&input.x).ok_or(BadShape)?;
    let (x_axis, normal) = (frame.row(0).transpose(), frame.row(2).transpose());
    let offset = normal * input.zoffs;
    let x = input.x.map(|x| x + offset);
    let d = &input.directors;
    let in_plane = |t: &Tangents, shape: &Shape<4>, r: f64, s: f64| -> [Row<24>; 3] {
        let mut rows = membrane(t, shape);
        if input.sides == Sides::Bending {
            add_bending_sides(&mut rows, t, &x, &normal, &side_slopes(r, s));
        }
        rows
    };
    let at = |r: f64, s: f64| {
        let shape = shape(r, s);
        (shape, Tangents::new(&x, d, &shape))
    };
    let (centre_shape, centre_tangents) = at(0.0, 0.0);
    let centre_local = TangentFrame::new(&centre_tangents, &x_axis)?;
    let centre_rows = StrainRows {
        membrane: centre_local.strain(&in_plane(&centre_tangents, &centre_shape, 0.0, 0.0)),
        curvature: centre_local.strain(&curvature(&centre_tangents, &centre_shape, d)),
    };
    let tie = |r: f64, s: f64| -> [Row<24>; 2] {
        let (shape, t) = at(r, s);
        shear(&t, &shape, d)
    };
    let (low, high, left, right) = (
        tie(0.0, -1.0)[0],
        tie(0.0, 1.0)[0],
        tie(-1.0, 0.0)[1],
        tie(1.0, 0.0)[1],
    );

    let mut products = Products::new();
    let mut points = Vec::with_capacity(4);
    for (a, b) in CORNERS {
        let (r, s) = (a * GAUSS, b * GAUSS);
        let (shape, t) = at(r, s);
        let local = TangentFrame::new(&t, &x_axis)?;
        let share = centre_local.area / local.area;
        let (mr, ms) = (-2.0 * r * share, -2.0 * s * share);
        let (m1x, m1y) = (mr * centre_local.rx, mr * centre_local.ry);
        let (m2x, m2y) = (ms * centre_local.sx, ms * centre_local.sy);
        let thickness = shape
            .h
            .iter()
            .zip(&input.thickness)
            .map(|(h, t)| h * t)
            .sum();
        let mut rows_r = [0.0; 24];
        let mut rows_s = [0.0; 24];
        for i in 0..24 {
            rows_r[i] = 0.5 * ((1.0 - s) * low[i] + (1.0 + s) * high[i]);
            rows_s[i] = 0.5 * ((1.0 - r) * left[i] + (1.0 + r) * right[i]);
        }
        let section = Section {
            law: input.law,
            t: thickness,
            k6rot: input.k6rot,
        };
        if input.parts == Parts::All {
            section.add_shear(&mut products, local.area, &local.shear(&rows_r, &rows_s));
        }
        points.push(Point {
            membrane: local.strain(&in_plane(&t, &shape, r, s)),
            curvature: local.strain(&curvature(&t, &shape, d)),
            modes: [
                [m1x, 0.0, m2x, 0.0],
                [0.0, m1y, 0.0, m2y],
                [m1y, m1x, m2y, m2x],
            ],
            t: thickness,
            shape,
            local,
        });
    }
    if input.sides == Sides::Straight {
        condense_modes(input, &mut points);
    }
    let mut thermal = [0.0; 24];
    for p in &points {
        p.add(input, &mut products, &mut thermal);
    }
    let mut stiffness = products.sum();
    let mut corners = corner_rows(&points);
    let mut centre = centre_rows;
    if input.zoffs != 0.0 {
        shift_stiffness(&mut stiffness, &offset);
        shift(&mut thermal, &offset);
        let all = corners.iter_mut().chain([&mut centre]);
        all.for_each(|rows| shift_rows(rows, &offset));
    }
    Ok(ShellMatrices {
        stiffness,
        centre,
        corners,
        thermal,
    })
}

/// Strain at the corners, bilinear through the Gauss points.
fn corner_rows(points: &[Point]) -> [StrainRows<24>; 4] {
    CORNERS.map(|(a, b)| {
        let mut rows = StrainRows {
            membrane: [[0.0; 24]; 3],
            curvature: [[0.0; 24]; 3],
        };
        for (p, (pa, pb)) in points.iter().zip(CORNERS) {
            // Weight of the Gauss point in the bilinear extrapolation to the corner.
            let w = 0.25 * (1.0 + a * pa / GAUSS) * (1.0 + b * pb / GAUSS);
            for c in 0..3 {
                for i in 0..24 {
                    rows.membrane[c][i] += w * p.membrane[c][i];
                    rows.curvature[c][i] += w * p.curvature[c][i];
                }
            }
        }
        rows
    })
}

/// Takes the incompatible modes out: alpha = -(G'AG)^-1 G'A B u makes the energy least, so B - G (..) replaces B.
fn condense_modes(input: &ShellInput<'_, 4>, points: &mut [Point]) {
    let mut own = Matrix4::<f64>::zeros();
    let mut cross = [[0.0; 24]; 4];
    for p in points.iter() {
        let section = Section {
            law: input.law,
            t: p.t,
            k6rot: 0.0,
        };
        let Some(a) = section.membrane_matrix() else {
            return;
        };
        let coupling = input
            .law
            .coupling
            .map(|b| b.map(|row| row.map(|v| v * p.t * p.t)));
        for m in 0..4 {
            for c in 0..3 {
                let weighted: f64 =
                    (0..3).map(|e| p.modes[e][m] * a[e][c]).sum::<f64>() * p.local.area;
                for n in 0..4 {
                    own[(m, n)] += weighted * p.modes[c][n];
                }
                for i in 0..24 {
                    cross[m][i] += weighted * p.membrane[c][i];
                }
                if let Some(b) = coupling {
                    let weighted: f64 =
                        (0..3).map(|e| p.modes[e][m] * b[e][c]).sum::<f64>() * p.local.area;
                    for i in 0..24 {
                        cross[m][i] += weighted * p.curvature[c][i];
                    }
                }
            }
        }
    }
    let Some(inverse) = own.try_inverse() else {
        return;
    };
    let mut solved = [[0.0; 24]; 4];
    for m in 0..4 {
        for n in 0..4 {
            for i in 0..24 {
                solved[m][i] += inverse[(m, n)] * cross[n][i];
            }
        }
    }
    for p in points {
        for c in 0..3 {
            for m in 0..4 {
                for i in 0..24 {
                    p.membrane[c][i] -= p.modes[c][m] * solved[m][i];
                }
            }
        }
    }
}
