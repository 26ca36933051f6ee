//! Dense matrices of single elements.

use crate::linalg::Matrix6;
use crate::model::{GridIx, Vec3};

/// A symmetric matrix over six dofs of each grid, basic frame, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ElementMatrix {
    pub(crate) grids: Vec<GridIx>,
    pub(crate) values: Vec<f64>,
}

impl ElementMatrix {
    /// Returns a zero matrix.
    pub(crate) fn zeros(grids: Vec<GridIx>) -> Self {
        let n = 6 * grids.len();
        Self {
            grids,
            values: vec![0.0; n * n],
        }
    }

    /// Creates a matrix from rows of fixed length.
    pub(crate) fn from_rows<const M: usize>(grids: &[GridIx], rows: &[[f64; M]; M]) -> Self {
        Self {
            grids: grids.to_vec(),
            values: rows.iter().flatten().copied().collect(),
        }
    }

    /// Returns the number of rows.
    pub(crate) fn n(&self) -> usize {
        6 * self.grids.len()
    }

    /// Returns `K u`. `u` is by grid of this element.
    pub(crate) fn times(&self, u: &[f64]) -> Vec<f64> {
        self.values
            .chunks_exact(self.n().max(1))
            .map(|row| row.iter().zip(u).map(|(a, b)| a * b).sum())
            .collect()
    }
}

/// Returns the 6 x 6 mass of a point at an offset from its grid, about the grid.
pub(crate) fn point_mass(m: f64, offset: &Vec3) -> Matrix6<f64> {
    let c = offset.cross_matrix();
    let mut matrix = Matrix6::zeros();
    matrix.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(m);
    matrix.fixed_view_mut::<3, 3>(0, 3).copy_from(&(c * -m));
    matrix.fixed_view_mut::<3, 3>(3, 0).copy_from(&(c * m));
    matrix.fixed_view_mut::<3, 3>(3, 3).copy_from(&(c * c * -m));
    matrix
}
