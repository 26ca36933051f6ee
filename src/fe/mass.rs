//! The mass of a model.

use super::element::beam::{beam_coupled_mass, beam_lumped_mass};
use super::element::shell::{many_mass, output_frame, shell_mass};
use super::element::solid::solid_mass;
use super::element::{ElementMatrix, between_dofs, point_mass, rod_mass, shear_panel_mass};
use super::prepared_model::PreparedModel;
use super::rigid_motion::rigid_displacement;
use crate::linalg::Matrix6;
use crate::model::{Grid, GridIx, Load, Mat3, Model, ScalarMass, Vec3, Weight};
use nastran::cards::ShellShape;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Mass matrix over all grids, basic frame, WTMASS applied.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mass {
    /// Translational mass by grid.
    point: Vec<f64>,
    /// Further 6 x 6 blocks of single grids.
    blocks: BTreeMap<GridIx, Matrix6<f64>>,
    /// Coupled masses of elements.
    coupled: Vec<ElementMatrix>,
    /// Masses that couple grids equally in all three translations: the grids, and their shares by rows.
    scalar: Vec<(Vec<GridIx>, Vec<f64>)>,
    /// Whether each grid is a scalar point. Scalar points have no location: rigid motions and fields of acceleration leave them out.
    points: Vec<bool>,
}

/// Mass, centre of gravity and the 6 x 6 matrix of rigid motions about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassProperties {
    /// Mass of the model, equal to the mass in [`crate::model::Weight`].
    pub mass: f64,
    /// Centre of gravity, basic frame.
    pub cg: Vec3,
    /// Rigid mass matrix about the centre of gravity: translations, then rotations.
    pub matrix: Matrix6<f64>,
}

impl Mass {
    /// Computes the mass of all elements and concentrated masses. It is lumped. With PARAM,COUPMASS it is consistent for shells, bars, beams and
    /// solids. Rods and shear panels stay lumped. Solids with mid-side grids are always consistent, because lumping by rows gives their corners
    /// negative mass.
    pub(crate) fn new(prepared: &PreparedModel<'_>) -> Self {
        let model = prepared.model;
        let mut mass = Self {
            point: vec![0.0; model.grids.len()],
            points: model.grids.iter().map(Grid::is_scalar).collect(),
            ..Self::default()
        };
        let shells: Vec<[[f64; 4]; 4]> = (0..model.shells.len())
            .into_par_iter()
            .map(|i| shell_mass(model, i))
            .collect();
        for (i, (shell, pairs)) in model.shells.iter().zip(shells).enumerate() {
            let offset = shell_offset(model, i);
            if is_consistent(shell.shape) {
                let (grids, products) = many_mass(model, i);
                if offset == Vec3::zeros() {
                    mass.scalar.push((grids, products));
                } else {
                    mass.coupled
                        .push(coupled_points(&grids, &products, &offset));
                }
                continue;
            }
            let n = shell.shape.n_corners().min(4);
            if model.params.coupmass {
                let products: Vec<f64> = pairs[..n]
                    .iter()
                    .flat_map(|row| row[..n].to_vec())
                    .collect();
                mass.coupled
                    .push(coupled_points(&shell.grids[..n], &products, &offset));
            } else {
                for (g, row) in shell.grids[..n].iter().zip(&pairs) {
                    mass.add_point(*g, row.iter().sum(), &offset);
                }
            }
        }
        for (i, beam) in model.beams.iter().enumerate() {
            if model.params.coupmass {
                mass.coupled.push(beam_coupled_mass(model, i));
            } else {
                for (g, m) in beam.grids.iter().zip(beam_lumped_mass(model, i)) {
                    *mass.blocks.entry(*g).or_insert_with(Matrix6::zeros) += m;
                }
            }
        }
        for (i, rod) in model.rods.iter().enumerate() {
            let half = 0.5 * rod_mass(model, i);
            rod.grids.iter().for_each(|g| mass.point[g.us()] += half);
        }
        for (i, panel) in model.shear_panels.iter().enumerate() {
            let shares = shear_panel_mass(model, i);
            for (g, m) in panel.grids.iter().zip(shares) {
                mass.point[g.us()] += m;
            }
        }
        let solids: Vec<_> = (0..model.solids.len())
            .into_par_iter()
            .map(|i| solid_mass(model, i))
            .collect();
        for (solid, (grids, products)) in model.solids.iter().zip(solids) {
            let n = grids.len();
            if model.params.coupmass || n > solid.shape.n_corners() {
                mass.scalar.push((grids, products));
            } else {
                for (g, row) in grids.iter().zip(products.chunks_exact(n.max(1))) {
                    mass.point[g.us()] += row.iter().sum::<f64>();
                }
            }
        }
        for m in &model.masses {
            *mass.blocks.entry(m.grid).or_insert_with(Matrix6::zeros) += m.matrix;
        }
        let scalar_masses = model.scalar_masses.iter();
        mass.coupled
            .extend(scalar_masses.map(|m| between_dofs(prepared, &m.ends, m.mass)));
        let w = model.params.wtmass;
        mass.point.iter_mut().for_each(|m| *m *= w);
        mass.blocks.values_mut().for_each(|m| *m *= w);
        mass.coupled
            .iter_mut()
            .flat_map(|m| &mut m.values)
            .chain(mass.scalar.iter_mut().flat_map(|m| &mut m.1))
            .for_each(|v| *v *= w);
        mass
    }

    /// Adds a point mass at an offset from a grid.
    pub(super) fn add_point(&mut self, grid: GridIx, m: f64, offset: &Vec3) {
        if *offset == Vec3::zeros() {
            self.point[grid.us()] += m;
        } else {
            *self.blocks.entry(grid).or_insert_with(Matrix6::zeros) += point_mass(m, offset);
        }
    }

    /// Returns `M u`.
    pub(crate) fn times(&self, u: &[[f64; 6]]) -> Vec<[f64; 6]> {
        let mut f: Vec<[f64; 6]> = self
            .point
            .iter()
            .zip(u)
            .map(|(m, u)| [m * u[0], m * u[1], m * u[2], 0.0, 0.0, 0.0])
            .collect();
        for (g, m) in &self.blocks {
            for i in 0..6 {
                f[g.us()][i] += (0..6).map(|j| m[(i, j)] * u[g.us()][j]).sum::<f64>();
            }
        }
        for m in &self.coupled {
            let local: Vec<f64> = m.grids.iter().flat_map(|g| u[g.us()]).collect();
            for (g, v) in m.grids.iter().zip(m.times(&local).chunks_exact(6)) {
                f[g.us()].iter_mut().zip(v).for_each(|(f, v)| *f += v);
            }
        }
        for (grids, products) in &self.scalar {
            for (g, row) in grids.iter().zip(products.chunks_exact(grids.len().max(1))) {
                for (h, m) in grids.iter().zip(row) {
                    for i in 0..3 {
                        f[g.us()][i] += m * u[h.us()][i];
                    }
                }
            }
        }
        f
    }

    /// Returns M u, with zeros at scalar points.
    pub(super) fn on_grids(&self, u: &[[f64; 6]]) -> Vec<[f64; 6]> {
        let mut f = self.times(u);
        let points = f.iter_mut().zip(&self.points).filter(|p| *p.1);
        points.for_each(|(f, _)| *f = [0.0; 6]);
        f
    }

    /// Returns the displacements of rigid motion `mode` about a point: [`rigid_displacement`] at grids, zero at scalar points.
    pub(crate) fn rigid_field(&self, mode: usize, x: &[Vec3], centre: &Vec3) -> Vec<[f64; 6]> {
        let pairs = x.iter().zip(&self.points);
        pairs
            .map(|(x, point)| {
                if *point {
                    [0.0; 6]
                } else {
                    rigid_displacement(mode, x, centre)
                }
            })
            .collect()
    }

    /// Returns the first scalar mass that acts at a scalar point.
    pub(super) fn on_point(model: &Model) -> Option<&ScalarMass> {
        let scalar = |g: &GridIx| model.grids[g.us()].is_scalar();
        let mut masses = model.scalar_masses.iter().filter(|m| m.mass != 0.0);
        masses.find(|m| m.ends.iter().flatten().any(|(g, _)| scalar(g)))
    }

    /// Adds the centrifugal forces of masses away from their grids in a rotation `omega`. [`Mass::on_grids`] gives the forces of masses at the grids.
    pub(super) fn add_off_grids(&self, factor: f64, omega: &Vec3, f: &mut [[f64; 6]]) {
        let gradient = centrifugal_gradient(omega) * factor;
        for (g, m) in &self.blocks {
            // First moment m o and second moment J = tr(I)/2 - I of the mass about its grid.
            let first = Vec3::new(m[(1, 5)], m[(2, 3)], m[(0, 4)]);
            let inertia = m.fixed_view::<3, 3>(3, 3).into_owned();
            let second = Mat3::from_diagonal_element(0.5 * inertia.trace()) - inertia;
            let force = gradient * first;
            let moments = second * gradient.transpose();
            for i in 0..3 {
                f[g.us()][i] += force[i];
                let (j, k) = ((i + 1) % 3, (i + 2) % 3);
                f[g.us()][3 + i] += moments[(j, k)] - moments[(k, j)];
            }
        }
    }

    /// Returns `R' M R` about a point.
    pub(crate) fn rigid_mass_matrix(&self, x: &[Vec3], centre: &Vec3) -> Matrix6<f64> {
        let mut matrix = Matrix6::zeros();
        for mode in 0..6 {
            let u = self.rigid_field(mode, x, centre);
            matrix.set_column(mode, &resultant(x, &self.on_grids(&u), centre).into());
        }
        matrix
    }

    /// Returns mass and centre of gravity. `None` without mass.
    pub(crate) fn properties(&self, x: &[Vec3]) -> Option<MassProperties> {
        let near = x.first().copied().unwrap_or_else(Vec3::zeros);
        let Weight { mass, cg } =
            Weight::from_mass_matrix(&self.rigid_mass_matrix(x, &near), near)?;
        Some(MassProperties {
            mass,
            cg,
            matrix: self.rigid_mass_matrix(x, &cg),
        })
    }

    /// Returns whether every mass is zero.
    pub(crate) fn is_zero(&self) -> bool {
        let blocks = self.blocks.values().flat_map(|m| m.iter());
        let coupled = self.coupled.iter().flat_map(|m| &m.values);
        let scalar = self.scalar.iter().flat_map(|m| &m.1);
        let mut all = self.point.iter().chain(blocks).chain(coupled).chain(scalar);
        all.all(|v| *v == 0.0)
    }
}

/// Returns whether shells of this shape have a consistent mass whatever PARAM,COUPMASS states.
pub(super) fn is_consistent(shape: ShellShape) -> bool {
    matches!(shape, ShellShape::Quad8 | ShellShape::Tria6)
}

/// Returns the vector from the grids of shell `i` to its mass.
pub(super) fn shell_offset(model: &Model, i: usize) -> Vec3 {
    let shell = &model.shells[i];
    if shell.zoffs == 0.0 {
        return Vec3::zeros();
    }
    let corners = shell.grids.iter().take(shell.shape.n_corners());
    let x: Vec<Vec3> = corners.map(|g| model.grids[g.us()].x).collect();
    output_frame(&x).map_or_else(Vec3::zeros, |f| f.row(2).transpose() * shell.zoffs)
}

/// Gradient of the centrifugal acceleration -w x (w x r) of a rotation.
fn centrifugal_gradient(omega: &Vec3) -> Mat3 {
    let spin = omega.cross_matrix();
    -(spin * spin)
}

/// Adds the acceleration of a load on mass (basic frame, by grid) to a field. Scalar points have none. Other loads add nothing.
pub(super) fn add_acceleration(model: &Model, factor: f64, load: &Load, field: &mut [[f64; 6]]) {
    let mut add = |g: usize, a: Vec3| {
        if let (Some(grid), Some(u)) = (model.grids.get(g), field.get_mut(g))
            && !grid.is_scalar()
        {
            (0..3).for_each(|i| u[i] += factor * a[i]);
        }
    };
    match load {
        Load::Gravity(a) => (0..model.grids.len()).for_each(|g| add(g, *a)),
        Load::Acceleration { a, grids } => {
            grids.iter().for_each(|(g, share)| add(g.us(), a * *share));
        }
        Load::Spin { centre, omega } => {
            let gradient = centrifugal_gradient(omega);
            for (g, grid) in model.grids.iter().enumerate() {
                add(g, gradient * (grid.x - centre));
            }
        }
        _ => {}
    }
}

/// Returns the force and moment about a point of nodal forces.
pub(crate) fn resultant(x: &[Vec3], f: &[[f64; 6]], centre: &Vec3) -> [f64; 6] {
    let mut sum = [0.0; 6];
    for (x, f) in x.iter().zip(f) {
        let moment = (x - centre).cross(&Vec3::new(f[0], f[1], f[2]));
        for i in 0..3 {
            sum[i] += f[i];
            sum[3 + i] += f[3 + i] + moment[i];
        }
    }
    sum
}

/// Mass of pairs of grids, row by row, all at one offset from them.
fn coupled_points(grids: &[GridIx], products: &[f64], offset: &Vec3) -> ElementMatrix {
    let mut m = ElementMatrix::zeros(grids.to_vec());
    let n = m.n();
    for (k, row) in products.chunks_exact(grids.len().max(1)).enumerate() {
        for (l, mass) in row.iter().enumerate() {
            let block = point_mass(*mass, offset);
            for i in 0..6 {
                for j in 0..6 {
                    m.values[(6 * k + i) * n + 6 * l + j] = block[(i, j)];
                }
            }
        }
    }
    m
}
