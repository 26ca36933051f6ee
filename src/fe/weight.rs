//! Mass, centre of gravity and rigid-body mass matrix of a model, from the element masses of the solver and without its mass matrix.

use super::element::beam::{beam_coupled_mass, beam_lumped_mass};
use super::element::shell::{many_mass, shell_mass};
use super::element::solid::solid_mass;
use super::element::{ElementMatrix, rod_mass, shear_panel_mass};
use super::mass::{is_consistent, resultant, shell_offset};
use super::rigid_motion::rigid_displacement;
use crate::linalg::{Matrix6, Vector6};
use crate::model::{GridIx, Mat3, Model, ScalarMass, Vec3, Weight};
use rayon::prelude::*;

/// Elements of a parallel task. Sums are added task by task, so that they do not depend on the number of threads.
const TASK: usize = 4096;

impl Model {
    /// Returns mass and centre of gravity from [`Self::rigid_body_mass`], WTMASS applied.
    pub fn weight(&self) -> Weight {
        let origin = Vec3::zeros();
        let nothing = Weight {
            mass: 0.0,
            cg: origin,
        };
        Weight::from_mass_matrix(&self.rigid_body_mass(origin), origin).unwrap_or(nothing)
    }

    /// Returns the rigid-body mass matrix (6 x 6: translations, then rotations) about the basic location `about`, WTMASS applied.
    ///
    /// Elements have the mass of the solver's mass matrix, which is not assembled. The table OGPWG of a solver contains this matrix without WTMASS.
    pub fn rigid_body_mass(&self, about: Vec3) -> Matrix6<f64> {
        let arm = |g: &GridIx| self.grids[g.us()].x - about;
        let lumped = |grids: &[GridIx], shares: &[f64]| {
            let mut sum = Moments::default();
            let points = grids.iter().zip(shares);
            points.for_each(|(g, m)| sum.add_point(*m, arm(g)));
            sum
        };
        let products = |grids: &[GridIx], products: &[f64], offset: Vec3, consistent: bool| {
            let x: Vec<Vec3> = grids.iter().map(|g| arm(g) + offset).collect();
            Moments::of_products(&x, products, consistent)
        };
        let mut moments = Moments::default();
        moments.add(&sum_of(self.shells.len(), |i| {
            let shell = &self.shells[i];
            let offset = shell_offset(self, i);
            if is_consistent(shell.shape) {
                let (grids, pairs) = many_mass(self, i);
                return products(&grids, &pairs, offset, true);
            }
            let pairs = shell_mass(self, i);
            let n = shell.shape.n_corners().min(4);
            let mut x = [Vec3::zeros(); 4];
            let corners = x.iter_mut().zip(&shell.grids[..n]);
            corners.for_each(|(x, g)| *x = arm(g) + offset);
            Moments::of_products(&x, pairs.as_flattened(), self.params.coupmass)
        }));
        moments.add(&sum_of(self.solids.len(), |i| {
            let (grids, pairs) = solid_mass(self, i);
            let consistent = self.params.coupmass || grids.len() > self.solids[i].shape.n_corners();
            products(&grids, &pairs, Vec3::zeros(), consistent)
        }));
        moments.add(&sum_of(self.rods.len(), |i| {
            lumped(&self.rods[i].grids, &[0.5 * rod_mass(self, i); 2])
        }));
        moments.add(&sum_of(self.shear_panels.len(), |i| {
            lumped(&self.shear_panels[i].grids, &shear_panel_mass(self, i))
        }));
        let mut sum = moments.matrix();
        for (i, beam) in self.beams.iter().enumerate() {
            if self.params.coupmass {
                sum += self.rigid_mass_of(&beam_coupled_mass(self, i), &about);
            } else {
                for (g, m) in beam.grids.iter().zip(beam_lumped_mass(self, i)) {
                    sum += mass_moved(&m, arm(g));
                }
            }
        }
        for c in &self.masses {
            sum += mass_moved(&c.matrix, arm(&c.grid));
        }
        for c in &self.scalar_masses {
            let row = self.motion_of(c, about);
            sum += row * row.transpose() * c.mass;
        }
        sum * self.params.wtmass
    }

    /// Returns R' M R of an element about a location.
    fn rigid_mass_of(&self, mass: &ElementMatrix, about: &Vec3) -> Matrix6<f64> {
        let x: Vec<Vec3> = mass.grids.iter().map(|g| self.grids[g.us()].x).collect();
        let mut matrix = Matrix6::zeros();
        for mode in 0..6 {
            let u: Vec<f64> = x
                .iter()
                .flat_map(|x| rigid_displacement(mode, x, about))
                .collect();
            let f = mass.times(&u);
            let (f, _) = f.as_chunks::<6>();
            matrix.set_column(mode, &resultant(&x, f, about).into());
        }
        matrix
    }

    /// Returns the motion of a scalar mass in each of the six rigid motions about `about`: first end minus second end. Scalar points and
    /// ground do not move.
    fn motion_of(&self, mass: &ScalarMass, about: Vec3) -> Vector6<f64> {
        let mut row = Vector6::zeros();
        for (end, sign) in mass.ends.iter().zip([1.0, -1.0]) {
            let Some((g, dof)) = end else { continue };
            let Some(grid) = self.grids.get(g.us()).filter(|g| !g.is_scalar()) else {
                continue;
            };
            let dof = usize::from(*dof).min(5);
            let axis = self.cd_axes(*g).row(dof % 3).transpose() * sign;
            let mut add = |first: usize, v: Vec3| (0..3).for_each(|i| row[first + i] += v[i]);
            if dof < 3 {
                add(0, axis);
                add(3, (grid.x - about).cross(&axis));
            } else {
                add(3, axis);
            }
        }
        row
    }
}

/// Returns the mass matrix of a body about a point, from its matrix about a grid at `r` from that point.
pub(crate) fn mass_moved(matrix: &Matrix6<f64>, r: Vec3) -> Matrix6<f64> {
    let mut t = Matrix6::identity();
    t.fixed_view_mut::<3, 3>(0, 3).copy_from(&-r.cross_matrix());
    t.transpose() * matrix * t
}

/// Returns the sum of the moments of `n` elements.
fn sum_of(n: usize, of: impl Fn(usize) -> Moments + Sync) -> Moments {
    let tasks: Vec<Moments> = (0..n.div_ceil(TASK))
        .into_par_iter()
        .map(|task| {
            let mut sum = Moments::default();
            (task * TASK..n.min((task + 1) * TASK)).for_each(|i| sum.add(&of(i)));
            sum
        })
        .collect();
    let mut sum = Moments::default();
    tasks.iter().for_each(|t| sum.add(t));
    sum
}

/// Mass with its first and second moments about a point: integrals of 1, x and x x'.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    mass: f64,
    first: Vec3,
    second: Mat3,
}

impl Moments {
    fn add(&mut self, other: &Self) {
        self.mass += other.mass;
        self.first += other.first;
        self.second += other.second;
    }

    fn add_point(&mut self, m: f64, x: Vec3) {
        self.mass += m;
        self.first += x * m;
        self.second += x * x.transpose() * m;
    }

    /// Moments of the masses of pairs of points, row by row. A mass that is not consistent has the sum of each row at its point.
    fn of_products(x: &[Vec3], products: &[f64], consistent: bool) -> Self {
        let mut sum = Self::default();
        for (a, row) in x.iter().zip(products.chunks_exact(x.len().max(1))) {
            let m: f64 = row.iter().sum();
            sum.add_point(m, *a);
            if consistent {
                // Replace m x x' of the point by the product of x and the row's sum of m x'.
                let other: Vec3 = x.iter().zip(row).map(|(b, m)| b * *m).sum();
                sum.second += a * (other - a * m).transpose();
            }
        }
        sum
    }

    /// Rigid-body mass matrix.
    fn matrix(&self) -> Matrix6<f64> {
        let cross = self.first.cross_matrix();
        let mut m = Matrix6::zeros();
        m.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(self.mass);
        m.fixed_view_mut::<3, 3>(0, 3).copy_from(&-cross);
        m.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross);
        let inertia = Mat3::from_diagonal_element(self.second.trace()) - self.second;
        m.fixed_view_mut::<3, 3>(3, 3).copy_from(&inertia);
        m
    }
}
