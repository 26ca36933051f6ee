//! One solid: strain columns at points, stiffness with the incompatible modes taken out, mass.

use super::table::{Function, TablePoint, Tables};
use crate::linalg::{DMatrix, Matrix3, Matrix6, Vector6};
use crate::model::Vec3;
use nastran::cards::SolidShape;

/// A solid's shape.
#[derive(Clone, Debug)]
pub(super) struct SolidInput {
    pub(super) shape: SolidShape,
    /// Corners, then the existing mid-side grids.
    pub(super) x: Vec<Vec3>,
    /// Edge of each mid-side grid.
    pub(super) mids: Vec<usize>,
}

/// The shape is folded or flat somewhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct DegenerateShape;

/// Strain columns at a point: three for each grid, then three for each mode.
pub(super) struct StrainColumns {
    /// Weight times volume per parameter volume.
    pub(super) volume: f64,
    pub(super) functions: Vec<Function>,
    pub(super) columns: Vec<Vector6<f64>>,
}

/// Stiffness over three translations per grid (by rows), and the coefficients of the incompatible modes: `amount = thermal - share u`.
pub(super) struct CondensedSolid {
    pub(super) stiffness: DMatrix<f64>,
    /// Modes by translations.
    pub(super) share: DMatrix<f64>,
    /// Forces on the translations that a thermal strain at the points causes. The modes are eliminated.
    pub(super) force: Vec<f64>,
    /// Amounts of the modes under the thermal strain alone.
    pub(super) amount: Vec<f64>,
}

impl SolidInput {
    fn is_linear(&self) -> bool {
        self.mids.is_empty()
    }

    /// Parameters along which incompatible modes bulge.
    fn modes(&self) -> &'static [usize] {
        match (self.shape, self.is_linear()) {
            (SolidShape::Hexa, true) => &[0, 1, 2],
            (SolidShape::Penta, true) => &[2],
            _ => &[],
        }
    }

    pub(super) fn has_modes(&self) -> bool {
        !self.modes().is_empty()
    }

    pub(super) fn rule(&self) -> &'static [TablePoint] {
        let tables = Tables::get(self.shape);
        if self.is_linear() {
            &tables.linear
        } else {
            &tables.quadratic
        }
    }

    /// Returns the orientation of the numbering: 1, or -1 for an element that is numbered as its mirror image. Solvers accept both.
    pub(super) fn hand(&self) -> f64 {
        let centre = &Tables::get(self.shape).centre;
        self.jacobian(&centre.functions(self.shape, &self.mids))
            .determinant()
            .signum()
    }

    fn jacobian(&self, functions: &[Function]) -> Matrix3<f64> {
        let mut j = Matrix3::zeros();
        for (x, f) in self.x.iter().zip(functions) {
            for r in 0..3 {
                for c in 0..3 {
                    j[(r, c)] += f[1 + r] * x[c];
                }
            }
        }
        j
    }

    /// Returns the strain columns at a point.
    pub(super) fn strain_columns_at(
        &self,
        point: &TablePoint,
    ) -> Result<StrainColumns, DegenerateShape> {
        let functions = point.functions(self.shape, &self.mids);
        let j = self.jacobian(&functions);
        let hand = self.hand();
        let det = j.determinant() * hand;
        let inverse = j
            .try_inverse()
            .filter(|_| det > 0.0)
            .ok_or(DegenerateShape)?;
        let modes = self.modes();
        let mut columns = Vec::with_capacity(3 * (functions.len() + modes.len()));
        for f in &functions {
            push(&mut columns, &(inverse * Vec3::new(f[1], f[2], f[3])));
        }
        if !modes.is_empty() {
            let centre = Tables::get(self.shape)
                .centre
                .functions(self.shape, &self.mids);
            let j0 = self.jacobian(&centre);
            let det0 = j0.determinant() * hand;
            let inverse0 = j0
                .try_inverse()
                .filter(|_| det0 > 0.0)
                .ok_or(DegenerateShape)?;
            for &k in modes {
                let mut slope = Vec3::zeros();
                slope[k] = 4.0 * (1.0 - 2.0 * point.p[k]);
                push(&mut columns, &(inverse0 * slope * (det0 / det)));
            }
        }
        Ok(StrainColumns {
            volume: point.weight * det,
            functions,
            columns,
        })
    }

    /// Returns the stiffness for a law; `strain` is the thermal strain at the point with these functions, if any.
    pub(super) fn form(
        &self,
        law: &Matrix6<f64>,
        thermal: Option<&dyn Fn(&[Function]) -> Vector6<f64>>,
    ) -> Result<CondensedSolid, DegenerateShape> {
        let n = 3 * self.x.len();
        let m = 3 * self.modes().len();
        let mut k = DMatrix::zeros(n + m, n + m);
        let mut f = vec![0.0; n + m];
        for point in self.rule() {
            let at = self.strain_columns_at(point)?;
            let stress: Vec<Vector6<f64>> =
                at.columns.iter().map(|c| law * c * at.volume).collect();
            for (i, s) in stress.iter().enumerate() {
                for (j, c) in at.columns.iter().enumerate().take(i + 1) {
                    k[(i, j)] += s.dot(c);
                }
            }
            if let Some(thermal) = thermal {
                let strain = thermal(&at.functions);
                f.iter_mut()
                    .zip(&stress)
                    .for_each(|(f, s)| *f += s.dot(&strain));
            }
        }
        k.fill_upper_triangle_with_lower_triangle();
        let mut stiffness = k.view((0, 0), (n, n)).into_owned();
        let mut share = DMatrix::zeros(m, n);
        let mut amount = vec![0.0; m];
        if m > 0 {
            let own = k.view((n, n), (m, m)).into_owned();
            let cross = k.view((n, 0), (m, n)).into_owned();
            let factor = own.cholesky().ok_or(DegenerateShape)?;
            share = factor.solve(&cross);
            stiffness -= cross.transpose() * &share;
            let own_force = crate::linalg::DVector::from_column_slice(&f[n..]);
            amount = factor.solve(&own_force).as_slice().to_vec();
            let passed = share.transpose() * own_force;
            f.iter_mut().zip(passed.iter()).for_each(|(f, p)| *f -= p);
        }
        f.truncate(n);
        Ok(CondensedSolid {
            stiffness,
            share,
            force: f,
            amount,
        })
    }

    /// Returns the integral of products of shape functions, row by row over the grids. The folded part of a shape counts as negative.
    pub(super) fn products(&self) -> Vec<f64> {
        let n = self.x.len();
        let mut out = vec![0.0; n * n];
        let hand = self.hand();
        // Products of linear functions have degree two, for which a tetrahedron's single point is not enough.
        for point in &Tables::get(self.shape).quadratic {
            let functions = point.functions(self.shape, &self.mids);
            let det = self.jacobian(&functions).determinant() * hand;
            for (i, a) in functions.iter().enumerate() {
                for (j, b) in functions.iter().enumerate() {
                    out[i * n + j] += a[0] * b[0] * det * point.weight;
                }
            }
        }
        out
    }
}

/// Strain of the three components of a function with this gradient.
fn push(columns: &mut Vec<Vector6<f64>>, g: &Vec3) {
    columns.push(Vector6::new(g.x, 0.0, 0.0, g.y, 0.0, g.z));
    columns.push(Vector6::new(0.0, g.y, 0.0, g.x, g.z, 0.0));
    columns.push(Vector6::new(0.0, 0.0, g.z, 0.0, g.y, g.x));
}
