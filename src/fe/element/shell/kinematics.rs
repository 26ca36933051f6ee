//! Covariant strains of a shell with nodal directors.
//!
//! Position x(r, s, z) = sum h_k (x_k + z d_k), displacement u = sum h_k (u_k + z theta_k x d_k). With g_r = x,r and D = sum h_k d_k the strains
//! linear in z are e_rr = g_r . u,r + z (g_r . q,r + D,r . u,r) with q = sum h_k theta_k x d_k, and so on. On any shape, all strains vanish for u_k =
//! c + w x x_k, theta_k = w: a x (b x c) products cancel in pairs.

use super::products::Products;
use super::types::{BadShape, Row, ShellLaw, StrainRows};
use crate::model::Vec3;

/// Shape functions and their derivatives at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape<const N: usize> {
    pub(super) h: [f64; N],
    pub(super) hr: [f64; N],
    pub(super) hs: [f64; N],
}

/// Tangents, director and its derivatives at a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tangents {
    pub(super) gr: Vec3,
    pub(super) gs: Vec3,
    d: Vec3,
    dr: Vec3,
    ds: Vec3,
}

impl Tangents {
    pub(super) fn new<const N: usize>(x: &[Vec3; N], d: &[Vec3; N], shape: &Shape<N>) -> Self {
        let sum = |h: &[f64; N], v: &[Vec3; N]| {
            h.iter().zip(v).fold(Vec3::zeros(), |a, (h, v)| a + v * *h)
        };
        Self {
            gr: sum(&shape.hr, x),
            gs: sum(&shape.hs, x),
            d: sum(&shape.h, d),
            dr: sum(&shape.hr, d),
            ds: sum(&shape.hs, d),
        }
    }
}

/// Orthonormal axes in the tangent plane, with x nearest to a given direction, and the derivatives of r and s along these axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct TangentFrame {
    pub(super) e1: Vec3,
    pub(super) e2: Vec3,
    pub(super) n: Vec3,
    pub(super) rx: f64,
    pub(super) sx: f64,
    pub(super) ry: f64,
    pub(super) sy: f64,
    /// Area per dr ds.
    pub(super) area: f64,
}

impl TangentFrame {
    pub(super) fn new(t: &Tangents, x_axis: &Vec3) -> Result<Self, BadShape> {
        let normal = t.gr.cross(&t.gs);
        let area = normal.norm();
        let n = normal.try_normalize(0.0).ok_or(BadShape)?;
        let e1 = (x_axis - n * x_axis.dot(&n))
            .try_normalize(0.0)
            .ok_or(BadShape)?;
        let e2 = n.cross(&e1);
        let (a, b, c, d) = (t.gr.dot(&e1), t.gr.dot(&e2), t.gs.dot(&e1), t.gs.dot(&e2));
        let det = a * d - b * c;
        if !(det > 0.0) {
            return Err(BadShape);
        }
        Ok(Self {
            e1,
            e2,
            n,
            rx: d / det,
            sx: -b / det,
            ry: -c / det,
            sy: a / det,
            area,
        })
    }

    /// Returns the rows xx, yy, xy from covariant rows rr, ss, 2 rs.
    pub(super) fn strain<const M: usize>(&self, [rr, ss, rs]: &[Row<M>; 3]) -> [Row<M>; 3] {
        let (rx, sx, ry, sy) = (self.rx, self.sx, self.ry, self.sy);
        let mut out = [[0.0; M]; 3];
        for i in 0..M {
            out[0][i] = rx * rx * rr[i] + sx * sx * ss[i] + rx * sx * rs[i];
            out[1][i] = ry * ry * rr[i] + sy * sy * ss[i] + ry * sy * rs[i];
            out[2][i] = 2.0 * rx * ry * rr[i] + 2.0 * sx * sy * ss[i] + (rx * sy + ry * sx) * rs[i];
        }
        out
    }

    /// Returns the rows xz, yz from covariant rows r, s.
    pub(super) fn shear<const M: usize>(&self, r: &Row<M>, s: &Row<M>) -> [Row<M>; 2] {
        let mut out = [[0.0; M]; 2];
        for i in 0..M {
            out[0][i] = self.rx * r[i] + self.sx * s[i];
            out[1][i] = self.ry * r[i] + self.sy * s[i];
        }
        out
    }
}

fn add_vector<const M: usize>(row: &mut Row<M>, at: usize, v: &Vec3) {
    row[at] += v.x;
    row[at + 1] += v.y;
    row[at + 2] += v.z;
}

/// Returns the mid-surface strains rr, ss, 2 rs.
pub(super) fn membrane<const N: usize, const M: usize>(
    t: &Tangents,
    shape: &Shape<N>,
) -> [Row<M>; 3] {
    let mut rows = [[0.0; M]; 3];
    for k in 0..N {
        let (hr, hs) = (shape.hr[k], shape.hs[k]);
        add_vector(&mut rows[0], 6 * k, &(t.gr * hr));
        add_vector(&mut rows[1], 6 * k, &(t.gs * hs));
        add_vector(&mut rows[2], 6 * k, &(t.gr * hs + t.gs * hr));
    }
    rows
}

/// Adds the contribution of bending sides to the mid-surface strains rr, ss, 2 rs.
///
/// Between corners i and j the side bulges as a parabola along the side. The bulge is (x_j - x_i) x n / 8 times the difference of their rotations
/// about n. `slopes` are the derivatives along r and s of parabolas with the value one in the middle of their sides.
///
/// # Reference
/// Allman, A compatible triangular element including vertex rotations, Computers and Structures 19 (1984) 1.
pub(super) fn add_bending_sides<const N: usize, const M: usize>(
    rows: &mut [Row<M>; 3],
    t: &Tangents,
    x: &[Vec3; N],
    n: &Vec3,
    slopes: &[(f64, f64); N],
) {
    for (i, (mr, ms)) in slopes.iter().enumerate() {
        let j = (i + 1) % N;
        let bulge = (x[j] - x[i]).cross(n) / 8.0;
        let (along_r, along_s) = (t.gr.dot(&bulge), t.gs.dot(&bulge));
        let strains = [along_r * mr, along_s * ms, along_r * ms + along_s * mr];
        for (row, e) in rows.iter_mut().zip(strains) {
            add_vector(row, 6 * j + 3, &(n * e));
            add_vector(row, 6 * i + 3, &(n * -e));
        }
    }
}

/// Returns the coefficients of z in the strains rr, ss, 2 rs.
pub(super) fn curvature<const N: usize, const M: usize>(
    t: &Tangents,
    shape: &Shape<N>,
    d: &[Vec3; N],
) -> [Row<M>; 3] {
    let mut rows = [[0.0; M]; 3];
    for k in 0..N {
        let (hr, hs) = (shape.hr[k], shape.hs[k]);
        let (dr, ds) = (d[k].cross(&t.gr), d[k].cross(&t.gs));
        add_vector(&mut rows[0], 6 * k, &(t.dr * hr));
        add_vector(&mut rows[1], 6 * k, &(t.ds * hs));
        add_vector(&mut rows[2], 6 * k, &(t.dr * hs + t.ds * hr));
        add_vector(&mut rows[0], 6 * k + 3, &(dr * hr));
        add_vector(&mut rows[1], 6 * k + 3, &(ds * hs));
        add_vector(&mut rows[2], 6 * k + 3, &(dr * hs + ds * hr));
    }
    rows
}

/// Returns the transverse shear strains r, s.
pub(super) fn shear<const N: usize, const M: usize>(
    t: &Tangents,
    shape: &Shape<N>,
    d: &[Vec3; N],
) -> [Row<M>; 2] {
    let mut rows = [[0.0; M]; 2];
    for k in 0..N {
        add_vector(&mut rows[0], 6 * k, &(t.d * shape.hr[k]));
        add_vector(&mut rows[1], 6 * k, &(t.d * shape.hs[k]));
        add_vector(&mut rows[0], 6 * k + 3, &(d[k].cross(&t.gr) * shape.h[k]));
        add_vector(&mut rows[1], 6 * k + 3, &(d[k].cross(&t.gs) * shape.h[k]));
    }
    rows
}

/// Returns the row of the rotation about the surface normal minus half the curl of the displacements about this normal.
pub(super) fn drilling_row<const N: usize, const M: usize>(
    local: &TangentFrame,
    shape: &Shape<N>,
) -> Row<M> {
    let mut row = [0.0; M];
    for k in 0..N {
        let hx = local.rx * shape.hr[k] + local.sx * shape.hs[k];
        let hy = local.ry * shape.hr[k] + local.sy * shape.hs[k];
        add_vector(
            &mut row,
            6 * k,
            &(local.e1 * (0.5 * hy) - local.e2 * (0.5 * hx)),
        );
        add_vector(&mut row, 6 * k + 3, &(local.n * shape.h[k]));
    }
    row
}

/// Section of a shell: its law, its thickness, and K6ROT, the factor of the drilling stiffness.
pub(super) struct Section<'a> {
    pub(super) law: &'a ShellLaw,
    pub(super) t: f64,
    pub(super) k6rot: f64,
}

impl Section<'_> {
    pub(super) fn membrane_matrix(&self) -> Option<[[f64; 3]; 3]> {
        self.law
            .membrane
            .map(|g| g.map(|row| row.map(|v| v * self.t)))
    }

    /// Drilling stiffness per area: 1e-6 K6ROT G t.
    fn drilling_stiffness(&self) -> f64 {
        let g = self
            .law
            .membrane
            .or(self.law.bending)
            .map_or(0.0, |g| g[2][2]);
        1e-6 * self.k6rot * g * self.t
    }

    pub(super) fn add<const M: usize>(
        &self,
        k: &mut Products,
        weight: f64,
        membrane: &[Row<M>; 3],
        curvature: &[Row<M>; 3],
        drilling: &Row<M>,
    ) {
        let t = self.t;
        let scaled = |g: &Option<[[f64; 3]; 3]>, by: f64| {
            g.map(|g| g.map(|row| row.map(|v| v * by * weight)))
        };
        if let Some(a) = scaled(&self.law.membrane, t) {
            k.add(membrane, &a, membrane);
        }
        if let Some(d) = scaled(&self.law.bending, t * t * t / 12.0) {
            k.add(curvature, &d, curvature);
        }
        if let Some(b) = scaled(&self.law.coupling, t * t) {
            k.add(membrane, &b, curvature);
            k.add(curvature, &b, membrane);
        }
        k.add(
            &[*drilling],
            &[[self.drilling_stiffness() * weight]],
            &[*drilling],
        );
    }

    pub(super) fn add_shear<const M: usize>(
        &self,
        k: &mut Products,
        weight: f64,
        shear: &[Row<M>; 2],
    ) {
        if let Some(s) = self.law.shear {
            let s = s.map(|row| row.map(|v| v * self.t * weight));
            k.add(shear, &s, shear);
        }
    }
}

/// f += weight * (membrane' N + curvature' M) with the stress resultants N, M of a held shell.
pub(super) fn add_thermal<const M: usize>(
    f: &mut [f64; M],
    weight: f64,
    (force, moment): ([f64; 3], [f64; 3]),
    membrane: &[Row<M>; 3],
    curvature: &[Row<M>; 3],
) {
    for c in 0..3 {
        for i in 0..M {
            f[i] += weight * (membrane[c][i] * force[c] + curvature[c][i] * moment[c]);
        }
    }
}

/// Transforms a row from the reference plane to grids at `offset` below it: u_mid = u + theta x offset.
pub(super) fn shift<const M: usize>(row: &mut Row<M>, offset: &Vec3) {
    for k in 0..M / 6 {
        let u = Vec3::new(row[6 * k], row[6 * k + 1], row[6 * k + 2]);
        add_vector(row, 6 * k + 3, &offset.cross(&u));
    }
}

/// Transforms the strain rows at a point from the reference plane to grids at `offset` below it.
pub(super) fn shift_rows<const M: usize>(rows: &mut StrainRows<M>, offset: &Vec3) {
    let all = rows.membrane.iter_mut().chain(&mut rows.curvature);
    all.for_each(|row| shift(row, offset));
}

/// Transforms a stiffness from the reference plane to grids at `offset` below it: L' K L.
pub(super) fn shift_stiffness<const M: usize>(k: &mut [[f64; M]; M], offset: &Vec3) {
    k.iter_mut().for_each(|row| shift(row, offset));
    let mut t = [[0.0; M]; M];
    for i in 0..M {
        for j in 0..M {
            t[i][j] = k[j][i];
        }
    }
    t.iter_mut().for_each(|row| shift(row, offset));
    *k = t;
}
