//! Mass with centre of gravity, and the areas and lengths over which non-structural mass is spread.

use super::types::*;
use crate::linalg::Matrix6;

/// Mass and centre of gravity of a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weight {
    /// Mass, PARAM,WTMASS applied.
    pub mass: f64,
    /// Centre of gravity, basic frame. It is the origin for a model without mass.
    pub cg: Vec3,
}

impl Weight {
    /// Returns mass and centre of gravity of a rigid-body mass matrix about `about`; `None` without mass.
    ///
    /// If the mass differs by direction (CONM1, scalar masses), the result is the largest of the three principal masses. Nastran's grid point weight
    /// generator lists these masses in its mass axis system.
    pub(crate) fn from_mass_matrix(m: &Matrix6<f64>, about: Vec3) -> Option<Self> {
        let by_axis = [m[(0, 0)], m[(1, 1)], m[(2, 2)]];
        let translation = m.fixed_view::<3, 3>(0, 0).into_owned();
        let even = translation == Mat3::from_diagonal_element(by_axis[0]);
        let mass = match even {
            true => by_axis[0],
            false => translation.symmetric_eigenvalues().max(),
        };
        if !(mass > 0.0) {
            return None;
        }
        let share = |first: f64, i: usize, j: usize| match by_axis[i] + by_axis[j] {
            sum if sum > 0.0 => first / sum,
            _ => 0.0,
        };
        let offset = Vec3::new(
            share(m[(1, 5)] - m[(2, 4)], 1, 2),
            share(m[(2, 3)] - m[(0, 5)], 0, 2),
            share(m[(0, 4)] - m[(1, 3)], 0, 1),
        );
        Some(Self {
            mass,
            cg: about + offset,
        })
    }
}

impl Model {
    fn grid_location(&self, g: GridIx) -> Vec3 {
        self.grids.get(g.us()).map_or_else(Vec3::zeros, |g| g.x)
    }

    /// Returns the area of shell `i`.
    pub(super) fn shell_area(&self, i: usize) -> f64 {
        let Some(s) = self.shells.get(i) else {
            return 0.0;
        };
        super::shape_functions::shell_area(s.shape, &self.places_of(s)).unwrap_or(0.0)
    }

    /// Returns the area of shear panel `i`: the mean of both divisions into triangles.
    pub(super) fn panel_area(&self, i: usize) -> f64 {
        let Some(panel) = self.shear_panels.get(i) else {
            return 0.0;
        };
        let x = panel.grids.map(|g| self.grid_location(g));
        let twice = |t: [usize; 3]| {
            let [a, b, c] = t.map(|k| x[k]);
            (b - a).cross(&(c - a)).norm()
        };
        let triangles = [[0, 1, 2], [0, 2, 3], [0, 1, 3], [1, 2, 3]];
        triangles.map(twice).iter().sum::<f64>() / 4.0
    }

    /// Returns the length of bar or beam `i`, offsets included.
    pub(super) fn beam_length(&self, i: usize) -> f64 {
        let length = |b: &Beam| {
            let [a, e] = [0, 1].map(|k| self.grid_location(b.grids[k]) + b.offsets[k]);
            (e - a).norm()
        };
        self.beams.get(i).map_or(0.0, length)
    }

    /// Returns the length of rod `i`.
    pub(super) fn rod_length(&self, i: usize) -> f64 {
        let length =
            |r: &Rod| (self.grid_location(r.grids[1]) - self.grid_location(r.grids[0])).norm();
        self.rods.get(i).map_or(0.0, length)
    }

    /// Returns the grid locations of a shell, `None` for a missing mid-side grid. In the model, the latter repeats the first corner of its edge.
    fn places_of(&self, s: &Shell) -> Vec<Option<Vec3>> {
        let n = s.shape.n_corners();
        (0..s.shape.n_grids())
            .map(|i| {
                s.grids
                    .get(i)
                    .filter(|g| i < n || s.grids.get(i - n) != Some(g))
            })
            .map(|g| g.map(|g| self.grid_location(*g)))
            .collect()
    }
}
