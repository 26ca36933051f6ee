//! Inertia relief: loads of a free structure balanced by its own inertia.

use super::assembly::Numbering;
use super::constraint::Reduction;
use super::error::{FeError, Refusal};
use super::free_motions::RigidStructure;
use super::grid_frames::to_local;
use super::hanging_points::find_hanging_points;
use super::mass::{Mass, MassProperties, resultant};
use crate::linalg::{DMatrix, DVector};
use crate::model::{Grid, GridIx, Mat3, Model, ScalarMass, Vec3};
use nastran::cards::Dofs;
use rayon::prelude::*;
use serde::Serialize;

/// Number of unknowns in one task of a thread.
const MIN_UNKNOWNS: usize = 4096;

/// The free rigid motions of a model and the inertia that balances loads on them.
#[derive(Clone, Debug)]
pub(crate) struct RigidBody {
    /// Grid locations.
    x: Vec<Vec3>,
    /// Whether a grid is a scalar point: it has no place in the body, and a load on it is no force on the body.
    scalar: Vec<bool>,
    /// Scalar points on springs between grids, and their displacement in the six rigid motions about the centre of gravity.
    hanging: Vec<(usize, [f64; 6])>,
    pub(crate) properties: MassProperties,
    /// Columns: free motions as combinations of three translations and three rotations about the centre of gravity.
    basis: DMatrix<f64>,
    /// Modal mass of the free motions.
    modal: DMatrix<f64>,
    /// Largest distance of a grid from the centre of gravity.
    size: f64,
}

/// Applied and inertia loads of a case about the centre of gravity, basic frame: three forces, three moments.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Balance {
    /// Subcase id.
    pub subcase: u32,
    /// Resultant of the applied loads.
    pub applied: [f64; 6],
    /// Resultant of the inertia loads that balance the loads.
    pub inertia: [f64; 6],
    /// Rigid acceleration: three translations of the centre of gravity, three rotations.
    pub acceleration: [f64; 6],
    /// Largest unbalanced share left.
    pub residual: f64,
}

/// Refuses the mass of a scalar point on a free structure: the deck does not state where its inertia acts.
///
/// # Errors
/// The first such mass.
fn refuse_masses_of_points(model: &Model) -> Result<(), FeError> {
    let refusal = |m: &ScalarMass| {
        let reason =
            "the structure is free, and where the mass of a scalar point acts on it is not stated";
        let remedy = "hold the structure, or give the mass to a grid (CONM2)";
        Refusal::new(format!("CMASS {}", m.id), m.at, reason, remedy)
    };
    match Mass::on_point(model) {
        Some(m) => Err(FeError::Refused(vec![refusal(m)])),
        None => Ok(()),
    }
}

impl RigidBody {
    /// Returns the free motions of a model with the given mass. `touched` are the grids that belong to the structure. `None` if supports and springs
    /// to ground leave no motion free.
    ///
    /// # Errors
    /// Free motions without mass, so that no inertia balances the loads along them.
    pub(crate) fn new(
        model: &Model,
        axes: &[Option<Mat3>],
        mass: &Mass,
        reduction: &Reduction,
        touched: &[bool],
    ) -> Result<Option<Self>, FeError> {
        let x: Vec<Vec3> = model.grids.iter().map(|g| g.x).collect();
        let scalar: Vec<bool> = model.grids.iter().map(Grid::is_scalar).collect();
        let touched: Vec<bool> = touched.iter().zip(&scalar).map(|(t, s)| *t && !s).collect();
        if !touched.contains(&true) {
            return Ok(None); // scalar points alone do not move as a body
        }
        let properties = mass.properties(&x);
        let parts = || x.iter().zip(&touched).filter(|t| *t.1).map(|t| t.0);
        let centre = match &properties {
            Some(p) => p.cg,
            None => parts().sum::<Vec3>() / parts().count().max(1) as f64,
        };
        let size = parts().map(|x| (x - centre).norm()).fold(0.0, f64::max);
        let size = if size > 0.0 { size } else { 1.0 };
        let structure = RigidStructure {
            model,
            axes,
            reduction,
            touched: &touched,
            centre,
            size,
        };
        let basis = structure.free_motions();
        if basis.ncols() == 0 {
            return Ok(None);
        }
        let properties = properties.ok_or(FeError::NoMass)?;
        refuse_masses_of_points(model)?;
        let rigid_mass = DMatrix::from_fn(6, 6, |r, c| properties.matrix[(r, c)]);
        let modal = basis.transpose() * rigid_mass * &basis;
        Ok(Some(Self {
            hanging: find_hanging_points(model, axes, reduction, &properties.cg),
            x,
            scalar,
            properties,
            basis,
            modal,
            size,
        }))
    }

    /// Returns the number of free motions.
    pub(super) fn n_free(&self) -> usize {
        self.basis.ncols()
    }

    /// Returns the displacement field of a free motion, basic frame.
    pub(crate) fn motion(&self, column: usize) -> Vec<[f64; 6]> {
        self.field(&self.basis.column(column).into_owned())
    }

    fn field(&self, amounts: &DVector<f64>) -> Vec<[f64; 6]> {
        let (t, w) = (
            Vec3::new(amounts[0], amounts[1], amounts[2]),
            Vec3::new(amounts[3], amounts[4], amounts[5]),
        );
        let points = self.x.iter().zip(&self.scalar);
        points
            .map(|(x, scalar)| {
                let u = t + w.cross(&(x - self.properties.cg));
                if *scalar {
                    [0.0; 6]
                } else {
                    [u.x, u.y, u.z, w.x, w.y, w.z]
                }
            })
            .collect()
    }

    /// Lets the points that hang on springs go along with the body.
    fn let_follow(&self, amounts: &DVector<f64>, field: &mut [[f64; 6]]) {
        for (point, by_motion) in &self.hanging {
            field[*point][0] = by_motion
                .iter()
                .zip(amounts.iter())
                .map(|(u, a)| u * a)
                .sum();
        }
    }

    /// Force and moment on the body about its centre of gravity.
    fn resultant(&self, f: &[[f64; 6]]) -> [f64; 6] {
        let on_body = f.iter().zip(&self.scalar);
        let on_body: Vec<[f64; 6]> = on_body
            .map(|(f, scalar)| if *scalar { [0.0; 6] } else { *f })
            .collect();
        resultant(&self.x, &on_body, &self.properties.cg)
    }

    /// Returns the balanced force `f - M R a` with `a = (R'MR)^-1 R'f` over the free motions, and a description of the balance.
    pub(crate) fn balance(&self, subcase: u32, mass: &Mass, f: &mut [[f64; 6]]) -> Balance {
        let applied = self.resultant(f);
        let generalized = self.basis.transpose() * DVector::from_column_slice(&applied);
        let amounts = &self.basis * self.modal_solve(&generalized);
        let inertia_field = mass.times(&self.field(&amounts));
        for (f, m) in f.iter_mut().zip(&inertia_field) {
            f.iter_mut().zip(m).for_each(|(f, m)| *f -= m);
        }
        let inertia = self.resultant(&inertia_field).map(|v| -v);
        let left = self.basis.transpose() * DVector::from_column_slice(&self.resultant(f));
        let scale = generalized.amax().max(f64::MIN_POSITIVE);
        Balance {
            subcase,
            applied,
            inertia,
            acceleration: std::array::from_fn(|i| amounts[i]),
            residual: left.amax() / scale,
        }
    }

    /// Modal mass solved for; a motion without mass (a straight bar about its own axis) is left out.
    fn modal_solve(&self, generalized: &DVector<f64>) -> DVector<f64> {
        let n = self.modal.nrows();
        let scale: Vec<f64> = (0..n)
            .map(|c| {
                let b = self.basis.column(c);
                let square = b.rows(0, 3).norm_squared()
                    + b.rows(3, 3).norm_squared() * self.size * self.size;
                1.0 / (self.properties.mass * square).sqrt()
            })
            .collect();
        let eigen = DMatrix::from_fn(n, n, |i, j| self.modal[(i, j)] * scale[i] * scale[j])
            .symmetric_eigen();
        let mut x = DVector::zeros(n);
        for (value, vector) in eigen
            .eigenvalues
            .iter()
            .zip(eigen.eigenvectors.column_iter())
        {
            if *value > 1e-12 {
                let along: f64 = (0..n)
                    .map(|i| vector[i] * scale[i] * generalized[i])
                    .sum::<f64>()
                    / value;
                (0..n).for_each(|i| x[i] += along * vector[i] * scale[i]);
            }
        }
        x
    }

    /// Removes the free motions from a displacement field, so that R'M u = 0.
    pub(crate) fn take_out(&self, mass: &Mass, u: &mut [[f64; 6]]) {
        let momentum = self.resultant(&mass.times(u));
        let generalized = self.basis.transpose() * DVector::from_column_slice(&momentum);
        let amounts = &self.basis * self.modal_solve(&generalized);
        let mut field = self.field(&amounts);
        self.let_follow(&amounts, &mut field);
        for (u, r) in u.iter_mut().zip(field) {
            u.iter_mut().zip(r).for_each(|(u, r)| *u -= r);
        }
    }

    /// Returns the unknown numbers of a statically determinate set of dofs that holds every free motion. Each step takes the translation that moves
    /// most under the motions not yet held, or a rotation if no translation moves. This QR with row pivoting spreads the set over distant grids.
    pub(super) fn choose_supports(
        &self,
        axes: &[Option<Mat3>],
        numbering: &Numbering,
    ) -> Vec<usize> {
        let fields: Vec<Vec<f64>> = (0..self.n_free())
            .into_par_iter()
            .map(|c| self.pack_motion(axes, numbering, c))
            .collect();
        let n = fields.first().map_or(0, Vec::len);
        let translation: Vec<bool> = {
            let mut flags = vec![[0.0; 6]; numbering.group.len()];
            flags.iter_mut().for_each(|f| f[..3].fill(1.0));
            let mut packed = vec![0.0; n];
            numbering.pack(&flags, &mut packed);
            packed.iter().map(|v| *v == 1.0).collect()
        };
        let mut chosen = Vec::new();
        let mut held: Vec<[f64; 6]> = Vec::new();
        let dot = |a: &[f64; 6], b: &[f64; 6]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        while chosen.len() < self.n_free() {
            let rest = |i: usize| {
                let mut r = [0.0; 6];
                fields.iter().zip(&mut r).for_each(|(f, r)| *r = f[i]);
                for h in &held {
                    let along = dot(h, &r);
                    r.iter_mut().zip(h).for_each(|(r, h)| *r -= along * h);
                }
                r
            };
            // Among equal distances, the first unknown is taken.
            let farther = |a: (f64, usize), b: (f64, usize)| if b.0 > a.0 { b } else { a };
            let none = || (1e-12, usize::MAX);
            let farthest = |pick: bool| {
                (0..n)
                    .into_par_iter()
                    .with_min_len(MIN_UNKNOWNS)
                    .filter(|&i| translation[i] == pick)
                    .map(|i| {
                        let r = rest(i);
                        (dot(&r, &r), i)
                    })
                    .reduce(none, farther)
            };
            // A straight bar can rotate about its own axis without any translation; then a rotation is held.
            let mut best = farthest(true);
            if best.1 == usize::MAX {
                best = farthest(false);
            }
            if best.1 == usize::MAX {
                break;
            }
            chosen.push(best.1);
            let norm = best.0.sqrt();
            held.push(rest(best.1).map(|v| v / norm));
        }
        chosen
    }

    /// Returns the unknowns of the SUPORT dofs if they hold every free motion exactly once.
    ///
    /// # Errors
    /// Another number of dofs than free motions, dofs that are no unknowns, or that leave a motion free.
    pub(super) fn given_supports(
        &self,
        axes: &[Option<Mat3>],
        numbering: &Numbering,
        start: &[usize],
        dofs: &[(GridIx, Dofs)],
    ) -> Result<Vec<usize>, FeError> {
        let count = dofs.iter().map(|d| d.1.len()).sum();
        let fault = || FeError::Suport {
            free_motions: self.n_free(),
            dofs: count,
        };
        let mut unknowns = Vec::new();
        for (g, set) in dofs {
            let group = numbering.group[g.us()].ok_or_else(fault)? as usize;
            for i in set.iter0() {
                if numbering.free[group] >> i & 1 == 0 {
                    return Err(fault());
                }
                let below = numbering.free[group] & ((1_u8 << i) - 1);
                unknowns.push(start[group] + below.count_ones() as usize);
            }
        }
        if count != self.n_free() {
            return Err(fault());
        }
        let fields: Vec<Vec<f64>> = (0..self.n_free())
            .map(|c| self.pack_motion(axes, numbering, c))
            .collect();
        let mut rows = DMatrix::from_fn(count, count, |r, c| fields[c][unknowns[r]]);
        for mut row in rows.row_iter_mut() {
            let norm = row.norm();
            row /= if norm > 0.0 { norm } else { 1.0 };
        }
        let singular = rows.singular_values();
        if count == 0 || singular.min() > 1e-9 * singular.max() {
            Ok(unknowns)
        } else {
            Err(fault())
        }
    }

    /// Returns a free motion at the unknowns, scaled to the order of one: rotations are multiplied by the size of the model.
    pub(crate) fn pack_motion(
        &self,
        axes: &[Option<Mat3>],
        numbering: &Numbering,
        column: usize,
    ) -> Vec<f64> {
        let mut field = self.motion_in_grid_frames(axes, column);
        let largest = field
            .iter()
            .flat_map(|u| {
                (0..6).map(|i| {
                    if i < 3 {
                        u[i].abs()
                    } else {
                        u[i].abs() * self.size
                    }
                })
            })
            .fold(f64::MIN_POSITIVE, f64::max);
        for u in &mut field {
            *u = std::array::from_fn(|i| u[i] * if i < 3 { 1.0 } else { self.size } / largest);
        }
        let mut out = vec![0.0; numbering.free.iter().map(|b| b.count_ones() as usize).sum()];
        numbering.pack(&field, &mut out);
        out
    }

    /// Returns a free motion at the unknowns without scaling.
    pub(super) fn packed_motion(
        &self,
        axes: &[Option<Mat3>],
        numbering: &Numbering,
        column: usize,
    ) -> Vec<f64> {
        let mut out = vec![0.0; numbering.free.iter().map(|b| b.count_ones() as usize).sum()];
        let mut field = self.motion_in_grid_frames(axes, column);
        self.let_follow(&self.basis.column(column).into_owned(), &mut field);
        numbering.pack(&field, &mut out);
        let largest = out.iter().fold(f64::MIN_POSITIVE, |a, v| a.max(v.abs()));
        out.iter_mut().for_each(|v| *v /= largest);
        out
    }

    /// A free motion in the displacement frames of the grids.
    fn motion_in_grid_frames(&self, axes: &[Option<Mat3>], column: usize) -> Vec<[f64; 6]> {
        let mut field = self.motion(column);
        for (u, axes) in field.iter_mut().zip(axes) {
            *u = to_local(axes, *u);
        }
        field
    }
}
