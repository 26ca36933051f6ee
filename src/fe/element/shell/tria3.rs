//! CTRIA3: MITC3+ bending and shear, constant-strain membrane, drilling stiffness.

use super::kinematics::{
    Section, Shape, TangentFrame, Tangents, add_bending_sides, add_thermal, curvature,
    drilling_row, membrane, shear, shift, shift_rows, shift_stiffness,
};
use super::output_frame::output_frame;
use super::products::Products;
use super::types::{BadShape, Parts, Row, ShellInput, ShellMatrices, Sides, StrainRows};
use crate::fe::element::triangle_points::RADON;
use crate::linalg::SMatrix;

/// Distance of the inner tying points from the centre in MITC3+.
const TYING: f64 = 1.0e-4;
/// Unknowns with the two of the bubble.
const WITH_BUBBLE: usize = 20;

fn shape(r: f64, s: f64) -> Shape<3> {
    Shape {
        h: [1.0 - r - s, r, s],
        hr: [-1.0, 1.0, 0.0],
        hs: [-1.0, 0.0, 1.0],
    }
}

/// Returns shape functions and weights of the integration points. The weights sum to half the parallelogram of the two sides.
pub(super) fn tria_points() -> [(Shape<3>, f64); 7] {
    RADON.map(|(r, s, w)| (shape(r, s), w))
}

/// Returns the stiffness and strain of a three-node shell. The rotation has a cubic bubble whose two amplitudes are eliminated.
///
/// # Reference
/// Lee, Lee and Bathe, The MITC3+ shell element and its performance, Computers and Structures 138 (2014) 12.
///
/// # Errors
/// An error if the corners lie on a line.
pub(crate) fn tria3(input: &ShellInput<'_, 3>) -> Result<ShellMatrices<3, 18>, BadShape> {
    let frame = output_frame(&input.x).ok_or(BadShape)?;
    let (x_axis, normal) = (frame.row(0).transpose(), frame.row(2).transpose());
    let offset = normal * input.zoffs;
    let x = input.x.map(|x| x + offset);
    let d = &input.directors;
    let centre_shape = shape(1.0 / 3.0, 1.0 / 3.0);
    let centre_tangents = Tangents::new(&x, d, &centre_shape);
    let local = TangentFrame::new(&centre_tangents, &x_axis)?;
    let (gr, gs) = (centre_tangents.gr, centre_tangents.gs);
    // q = bubble (b1 e1 + b2 e2)
    let along = |g: &crate::model::Vec3| [g.dot(&local.e1), g.dot(&local.e2)];
    let (br, bs) = (along(&gr), along(&gs));

    let third = 1.0 / 3.0;
    let in_plane = |t: &Tangents, shape: &Shape<3>| -> [Row<18>; 3] {
        let mut rows = membrane(t, shape);
        if input.sides == Sides::Bending {
            add_bending_sides(&mut rows, t, &x, &normal, &side_slopes(&shape.h));
        }
        rows
    };
    let covariant = |r: f64, s: f64| -> [Row<WITH_BUBBLE>; 2] {
        let shape = shape(r, s);
        let mut rows = shear::<3, WITH_BUBBLE>(&Tangents::new(&x, d, &shape), &shape, d);
        let bubble = 27.0 * r * s * (1.0 - r - s);
        for c in 0..2 {
            rows[0][18 + c] = bubble * br[c];
            rows[1][18 + c] = bubble * bs[c];
        }
        rows
    };
    let assumed = AssumedShear {
        a: covariant(1.0 / 6.0, 2.0 / 3.0),
        b: covariant(2.0 / 3.0, 1.0 / 6.0),
        c: covariant(1.0 / 6.0, 1.0 / 6.0),
        e: covariant(third - 2.0 * TYING, third + TYING),
        f: covariant(third + TYING, third + TYING),
        g: covariant(third + TYING, third - 2.0 * TYING),
    };

    let mut products = Products::new();
    let mut thermal = [0.0; 18];
    for (r, s, w) in RADON {
        let shape = shape(r, s);
        let t = Tangents::new(&x, d, &shape);
        let thickness = shape
            .h
            .iter()
            .zip(&input.thickness)
            .map(|(h, t)| h * t)
            .sum();
        let section = Section {
            law: input.law,
            t: thickness,
            k6rot: input.k6rot,
        };
        let weight = w * local.area;
        let mut bend = curvature::<3, WITH_BUBBLE>(&t, &shape, d);
        let (fr, fs) = (
            27.0 * s * (1.0 - 2.0 * r - s),
            27.0 * r * (1.0 - r - 2.0 * s),
        );
        for k in 0..2 {
            bend[0][18 + k] = fr * br[k];
            bend[1][18 + k] = fs * bs[k];
            bend[2][18 + k] = fs * br[k] + fr * bs[k];
        }
        let [rows_r, rows_s] = assumed.shear_rows_at(r, s);
        if let Some(heat) = input.heat {
            // The bubble has no thermal force, because the integral of its curvature vanishes.
            let rise = shape.h.iter().zip(&heat.rise).map(|(h, t)| h * t).sum();
            add_thermal(
                &mut thermal,
                weight,
                heat.resultants(rise),
                &local.strain(&in_plane(&t, &shape)),
                &local.strain(&curvature::<3, 18>(&t, &shape, d)),
            );
        }
        if input.parts == Parts::All {
            section.add_shear(&mut products, weight, &local.shear(&rows_r, &rows_s));
        }
        if input.parts == Parts::All {
            section.add(
                &mut products,
                weight,
                &with_bubble(&local.strain(&in_plane(&t, &shape))),
                &local.strain(&bend),
                &drilling_row::<3, WITH_BUBBLE>(&local, &shape),
            );
        }
    }
    let mut stiffness = condense_bubble(&products.sum());
    let mut centre = StrainRows {
        membrane: local.strain(&in_plane(&centre_tangents, &centre_shape)),
        curvature: local.strain(&curvature::<3, 18>(&centre_tangents, &centre_shape, d)),
    };
    if input.zoffs != 0.0 {
        shift_stiffness(&mut stiffness, &offset);
        shift(&mut thermal, &offset);
        shift_rows(&mut centre, &offset);
    }
    Ok(ShellMatrices {
        stiffness,
        centre,
        corners: [centre; 3],
        thermal,
    })
}

/// Covariant transverse shear strains at the tying points of MITC3+, and their interpolation.
struct AssumedShear {
    a: [Row<WITH_BUBBLE>; 2],
    b: [Row<WITH_BUBBLE>; 2],
    c: [Row<WITH_BUBBLE>; 2],
    e: [Row<WITH_BUBBLE>; 2],
    f: [Row<WITH_BUBBLE>; 2],
    g: [Row<WITH_BUBBLE>; 2],
}

impl AssumedShear {
    /// Along r and s at a point.
    fn shear_rows_at(&self, r: f64, s: f64) -> [Row<WITH_BUBBLE>; 2] {
        let Self { a, b, c, e, f, g } = self;
        let mut rows_r = [0.0; WITH_BUBBLE];
        let mut rows_s = [0.0; WITH_BUBBLE];
        for i in 0..WITH_BUBBLE {
            let twist = f[0][i] - g[0][i] - f[1][i] + e[1][i];
            let mean = (c[0][i] + c[1][i]) / 3.0;
            rows_r[i] = (2.0 * b[0][i] - b[1][i]) / 3.0 + mean + twist * (3.0 * s - 1.0) / 3.0;
            rows_s[i] = (2.0 * a[1][i] - a[0][i]) / 3.0 + mean + twist * (1.0 - 3.0 * r) / 3.0;
        }
        [rows_r, rows_s]
    }
}

/// Derivatives of the parabola of each side, four times the product of its corners' functions.
fn side_slopes(h: &[f64; 3]) -> [(f64, f64); 3] {
    const SLOPES: [(f64, f64); 3] = [(-1.0, -1.0), (1.0, 0.0), (0.0, 1.0)];
    std::array::from_fn(|i| {
        let j = (i + 1) % 3;
        let ((ir, is), (jr, js)) = (SLOPES[i], SLOPES[j]);
        (4.0 * (ir * h[j] + jr * h[i]), 4.0 * (is * h[j] + js * h[i]))
    })
}

/// Rows with the bubble's unknowns, which take no part.
fn with_bubble(rows: &[Row<18>; 3]) -> [Row<WITH_BUBBLE>; 3] {
    let mut out = [[0.0; WITH_BUBBLE]; 3];
    for (to, from) in out.iter_mut().zip(rows) {
        to[..18].copy_from_slice(from);
    }
    out
}

fn condense_bubble(big: &[[f64; WITH_BUBBLE]; WITH_BUBBLE]) -> [[f64; 18]; 18] {
    let mut k = [[0.0; 18]; 18];
    let own = SMatrix::<f64, 2, 2>::new(big[18][18], big[18][19], big[19][18], big[19][19]);
    let inverse = own.try_inverse().unwrap_or_else(SMatrix::zeros);
    for i in 0..18 {
        for j in 0..18 {
            let mut v = big[i][j];
            for m in 0..2 {
                for n in 0..2 {
                    v -= big[i][18 + m] * inverse[(m, n)] * big[18 + n][j];
                }
            }
            k[i][j] = v;
        }
    }
    k
}
