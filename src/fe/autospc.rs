//! Dofs without stiffness at single grids (PARAM,AUTOSPC).

use super::assembly::Assembled;
use crate::linalg::{DMatrix, sparse::BlockMatrix};

/// A direction at a grid is without stiffness when it has less than this share of the grid's stiffest one.
const EPZERO: f64 = 1e-8;
/// With AUTOSPC off: none but rounding.
const NOTHING: f64 = 1e-13;

/// Unknowns (with the stiffness to give them) that, held, leave no direction at a single grid without stiffness.
///
/// With AUTOSPC off, only directions without any stiffness are held: nothing can act on them, and a solver takes its null columns out.
pub(crate) fn weak_unknowns(assembled: &Assembled, autospc: bool) -> Vec<(usize, f64)> {
    let limit = if autospc { EPZERO } else { NOTHING };
    let diagonal = assembled.stiffness.diagonal_values(&assembled.symbolic);
    let typical = diagonal.iter().fold(0.0_f64, |a, v| a.max(*v));
    let start = assembled.symbolic.unknown_start();
    let mut weak = Vec::new();
    for (g, free) in assembled.numbering.free.iter().enumerate() {
        let block = BlockMatrix::diagonal_block(&assembled.stiffness, &assembled.symbolic, g);
        let n = free.count_ones() as usize;
        let translations = (free & 0b111).count_ones() as usize;
        for part in [0..translations, translations..n] {
            let m = part.len();
            if m == 0 {
                continue;
            }
            let k = DMatrix::from_fn(m, m, |i, j| block[(part.start + i) * n + part.start + j]);
            let largest = k.diagonal().max();
            // Cheap and sufficient for most grids: strictly dominant diagonals of like size.
            if well_held(&k, largest) {
                continue;
            }
            // The factor names the grid of a stiffness that is not a number.
            if k.iter().any(|v| !v.is_finite()) {
                continue;
            }
            let eigen = k.symmetric_eigen();
            let stiffest = eigen.eigenvalues.max();
            let mut taken = vec![false; m];
            for (value, vector) in eigen
                .eigenvalues
                .iter()
                .zip(eigen.eigenvectors.column_iter())
            {
                if *value <= limit * stiffest || stiffest <= 0.0 {
                    let pick = (0..m)
                        .filter(|&i| !taken[i])
                        .max_by(|&a, &b| vector[a].abs().total_cmp(&vector[b].abs()));
                    if let Some(i) = pick {
                        taken[i] = true;
                        weak.push((
                            start[g] + part.start + i,
                            if stiffest > 0.0 { stiffest } else { typical },
                        ));
                    }
                }
            }
        }
    }
    weak
}

/// Gershgorin: every eigenvalue is above 1e-4 of the largest diagonal entry.
fn well_held(k: &DMatrix<f64>, largest: f64) -> bool {
    (0..k.nrows()).all(|i| {
        let beside: f64 = (0..k.ncols())
            .filter(|&j| j != i)
            .map(|j| k[(i, j)].abs())
            .sum();
        k[(i, i)] - beside > 1e-4 * largest
    })
}
