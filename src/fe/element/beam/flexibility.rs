//! Stiffness of a beam in its own frame.

use crate::linalg::{Matrix3, Matrix6, SMatrix, SVector};
use crate::model::Section;

/// Three-point Gauss rule on 0..1.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];
/// Share of the other stiffnesses that replaces a section's missing stiffness in a direction during integration. The rows of that direction are
/// cleared afterwards.
const ALMOST_NOTHING: f64 = 1e-9;

/// A beam in the element frame.
#[derive(Clone, Debug)]
pub(super) struct LocalBeam<'a> {
    pub(super) sections: &'a [(f64, Section)],
    pub(super) e: f64,
    pub(super) g: f64,
    pub(super) length: f64,
    /// Shear factors K1, K2. A factor of 0 means rigid in shear.
    pub(super) k: [f64; 2],
}

/// Returns the properties between stations, linear in x.
pub(crate) fn section_at(sections: &[(f64, Section)], xi: f64) -> Section {
    let last = sections.last().map(|s| s.1).unwrap_or_default();
    let Some(i) = sections.windows(2).position(|w| xi <= w[1].0) else {
        return last;
    };
    let ((x0, a), (x1, b)) = (sections[i], sections[i + 1]);
    let s = if x1 > x0 {
        ((xi - x0) / (x1 - x0)).clamp(0.0, 1.0)
    } else {
        1.0
    };
    let mix = |p: f64, q: f64| p + (q - p) * s;
    let mix2 = |p: [f64; 2], q: [f64; 2]| [mix(p[0], q[0]), mix(p[1], q[1])];
    Section {
        area: mix(a.area, b.area),
        i1: mix(a.i1, b.i1),
        i2: mix(a.i2, b.i2),
        i12: mix(a.i12, b.i12),
        j: mix(a.j, b.j),
        nsm: mix(a.nsm, b.nsm),
        recovery: std::array::from_fn(|k| mix2(a.recovery[k], b.recovery[k])),
        neutral: mix2(a.neutral, b.neutral),
        nsm_centre: mix2(a.nsm_centre, b.nsm_centre),
        nsi: mix(a.nsi, b.nsi),
    }
}

/// Returns the largest of the area, and of second moments and torsion constant over the squared length `l2`.
fn largest_of(s: &Section, l2: f64) -> f64 {
    s.area
        .max(s.i1 / l2)
        .max(s.i2 / l2)
        .max(s.j / l2)
        .max(f64::MIN_POSITIVE)
}

/// Returns the compliance of a section for N, My, Mz about the reference line: strain of the line, curvatures d(theta_y)/dx, d(theta_z)/dx.
///
/// Strain at (y, z) is e0 + z ky - y kz.
pub(super) fn compliance(s: &Section, e: f64, length: f64) -> Matrix3<f64> {
    let tiny = ALMOST_NOTHING;
    let l2 = length * length;
    let largest = largest_of(s, l2);
    let a = s.area.max(tiny * largest);
    let (i1, i2) = (s.i1.max(tiny * largest * l2), s.i2.max(tiny * largest * l2));
    let [yn, zn] = s.neutral;
    let (yy, zz, yz) = (i1 + a * yn * yn, i2 + a * zn * zn, s.i12 + a * yn * zn);
    let k = Matrix3::new(a, a * zn, -a * yn, a * zn, zz, -yz, -a * yn, -yz, yy) * e;
    k.try_inverse().unwrap_or_else(Matrix3::zeros)
}

impl LocalBeam<'_> {
    pub(super) fn compliance(&self, s: &Section) -> Matrix3<f64> {
        compliance(s, self.e, self.length)
    }

    /// Flexibility of end B with end A held: N, Vy, Vz, T, My, Mz.
    fn flexibility(&self) -> Matrix6<f64> {
        let l = self.length;
        let mut f = Matrix6::zeros();
        for w in self.sections.windows(2) {
            let span = w[1].0 - w[0].0;
            if span <= 0.0 {
                continue;
            }
            for (x, weight) in GAUSS {
                let xi = w[0].0 + span * x;
                let s = section_at(self.sections, xi);
                let arm = l * (1.0 - xi);
                // Rows N, My, Mz at the section under the forces at B.
                let b = SMatrix::<f64, 3, 6>::from_row_slice(&[
                    1.0, 0.0, 0.0, 0.0, 0.0, 0.0, //
                    0.0, 0.0, -arm, 0.0, 1.0, 0.0, //
                    0.0, arm, 0.0, 0.0, 0.0, 1.0,
                ]);
                let dx = weight * span * l;
                f += b.transpose() * self.compliance(&s) * b * dx;
                for (i, k) in self.k.iter().enumerate() {
                    if *k > 0.0 && s.area > 0.0 {
                        f[(1 + i, 1 + i)] += dx / (k * self.g * s.area);
                    }
                }
                let l2 = l * l;
                let largest = largest_of(&s, l2);
                f[(3, 3)] += dx / (self.g * s.j.max(ALMOST_NOTHING * largest * l2));
            }
        }
        f
    }

    /// Returns the stiffness of end B with end A held, and the matrix that transfers forces at B to A with reversed sign.
    pub(super) fn basic(&self) -> Option<(Matrix6<f64>, Matrix6<f64>)> {
        let kb = self.flexibility().try_inverse()?;
        let kb = (kb + kb.transpose()) * 0.5;
        // The forces at A are -g times the forces at B.
        let mut g = Matrix6::identity();
        g[(4, 2)] = -self.length;
        g[(5, 1)] = self.length;
        Some((kb, g))
    }

    /// Returns the stiffness over displacements and rotations at A, then B, element frame.
    pub(super) fn stiffness(&self) -> Option<SMatrix<f64, 12, 12>> {
        let (kb, g) = self.basic()?;
        let mut k = SMatrix::<f64, 12, 12>::zeros();
        k.fixed_view_mut::<6, 6>(0, 0)
            .copy_from(&(g * kb * g.transpose()));
        k.fixed_view_mut::<6, 6>(0, 6).copy_from(&(-g * kb));
        k.fixed_view_mut::<6, 6>(6, 0)
            .copy_from(&(-kb * g.transpose()));
        k.fixed_view_mut::<6, 6>(6, 6).copy_from(&kb);
        let lacks = |f: fn(&Section) -> f64| self.sections.iter().all(|s| f(&s.1) <= 0.0);
        let mut clear = |dofs: &[usize]| {
            for &d in dofs {
                k.row_mut(d).fill(0.0);
                k.column_mut(d).fill(0.0);
            }
        };
        if lacks(|s| s.area) {
            clear(&[0, 6]);
        }
        if lacks(|s| s.i1) {
            clear(&[1, 5, 7, 11]);
        }
        if lacks(|s| s.i2) {
            clear(&[2, 4, 8, 10]);
        }
        if lacks(|s| s.j) {
            clear(&[3, 9]);
        }
        Some(k)
    }
}

/// Removes released dofs from a stiffness and from the forces on it, by static condensation. Each bit of the mask is a dof, A then B.
pub(super) fn release(k: &mut SMatrix<f64, 12, 12>, f: &mut SVector<f64, 12>, pins: u16) {
    for r in (0..12).filter(|r| pins >> r & 1 == 1) {
        let pivot = k[(r, r)];
        let scale = k.diagonal().amax();
        if pivot > 1e-14 * scale {
            let column = k.column(r).into_owned();
            *f -= column * (f[r] / pivot);
            *k -= column * column.transpose() / pivot;
        }
        k.row_mut(r).fill(0.0);
        k.column_mut(r).fill(0.0);
        f[r] = 0.0;
    }
}
