//! Scalar elements: a spring or a mass between two dofs, or a dof and ground.

use super::ElementMatrix;
use crate::fe::grid_frames::to_basic;
use crate::fe::prepared_model::PreparedModel;
use crate::model::GridIx;

/// Computes the stiffness of spring `i`, basic frame. The dofs of the spring are in the grids' displacement frames.
pub(super) fn spring_stiffness(prepared: &PreparedModel<'_>, i: usize) -> ElementMatrix {
    let spring = &prepared.model.springs[i];
    between_dofs(prepared, &spring.ends, spring.k)
}

/// Returns `factor` times the square of the difference of two dofs as a matrix, basic frame. It is the stiffness of a spring or the mass of a scalar
/// mass.
pub(crate) fn between_dofs(
    prepared: &PreparedModel<'_>,
    ends: &[Option<(GridIx, u8)>; 2],
    factor: f64,
) -> ElementMatrix {
    let mut grids: Vec<_> = ends.iter().flatten().map(|e| e.0).collect();
    grids.dedup();
    let n = 6 * grids.len();
    let mut row = vec![0.0; n];
    for (end, sign) in ends.iter().zip([1.0, -1.0]) {
        let Some((g, dof)) = end else { continue };
        let mut unit = [0.0; 6];
        unit[usize::from(*dof).min(5)] = sign;
        let at = grids.iter().position(|x| x == g).unwrap_or(0);
        for (r, v) in row[6 * at..6 * at + 6]
            .iter_mut()
            .zip(to_basic(&prepared.axes[g.us()], unit))
        {
            *r += v;
        }
    }
    let mut k = ElementMatrix::zeros(grids);
    for a in 0..n {
        for b in 0..n {
            k.values[a * n + b] = factor * row[a] * row[b];
        }
    }
    k
}
