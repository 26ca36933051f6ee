//! Dense matrices of single elements.

use crate::model::GridIx;

/// A symmetric matrix over six dofs of each grid, basic frame, row by row.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ElementMatrix {
    pub(crate) grids: Vec<GridIx>,
    pub(crate) values: Vec<f64>,
}

impl ElementMatrix {
    /// A zero matrix.
    pub(crate) fn zeros(grids: Vec<GridIx>) -> Self {
        let n = 6 * grids.len();
        Self {
            grids,
            values: vec![0.0; n * n],
        }
    }

    /// From rows of fixed length.
    pub(crate) fn from_rows<const M: usize>(grids: &[GridIx], rows: &[[f64; M]; M]) -> Self {
        Self {
            grids: grids.to_vec(),
            values: rows.iter().flatten().copied().collect(),
        }
    }

    /// Number of rows.
    pub(crate) fn n(&self) -> usize {
        6 * self.grids.len()
    }

    /// K u, `u` by grid of this element.
    pub(crate) fn times(&self, u: &[f64]) -> Vec<f64> {
        self.values
            .chunks_exact(self.n().max(1))
            .map(|row| row.iter().zip(u).map(|(a, b)| a * b).sum())
            .collect()
    }
}
