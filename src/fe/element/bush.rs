//! CBUSH: six springs at a point between two grids, or between a grid and ground.

use super::ElementMatrix;
use crate::model::Model;

/// Returns the stiffness of bush `i`, basic frame. The springs act at the location of the bush. Rigid arms join the location to the grids.
pub(super) fn bush_stiffness(model: &Model, i: usize) -> ElementMatrix {
    let bush = &model.bushes[i];
    let grids: Vec<_> = [Some(bush.grids.0), bush.grids.1]
        .into_iter()
        .flatten()
        .collect();
    let n = 6 * grids.len();
    // Relative displacement at the location, element axes: B - A.
    let mut rows = vec![[0.0; 12]; 6];
    for (end, (g, sign)) in grids.iter().zip([-1.0, 1.0]).enumerate() {
        let arm = bush.location - model.grids[g.us()].x;
        let turned = -(bush.axes * arm.cross_matrix());
        for r in 0..3 {
            for c in 0..3 {
                rows[r][6 * end + c] = sign * bush.axes[(r, c)];
                rows[r][6 * end + 3 + c] = sign * turned[(r, c)];
                rows[3 + r][6 * end + 3 + c] = sign * bush.axes[(r, c)];
            }
        }
    }
    let mut k = ElementMatrix::zeros(grids);
    for (row, stiffness) in rows.iter().zip(bush.k) {
        for a in 0..n {
            for b in 0..n {
                k.values[a * n + b] += stiffness * row[a] * row[b];
            }
        }
    }
    k
}
