//! Scalar points that only springs hold between grids. They move with a rigid motion of the grids.

use super::constraint::{Reduction, State};
use super::grid_frames::to_local;
use super::rigid_motion::rigid_displacement;
use crate::linalg::{DMatrix, Vector6};
use crate::model::{GridIx, Mat3, Model, Vec3};
use std::collections::HashMap;

/// Largest number of such points that are moved; springs in series are few.
const MOST: usize = 500;

/// Returns the displacement of each of these points in the six rigid motions about `centre`: `K_ss u_s = -K_sb u_b`. Empty if the springs leave a
/// point free.
pub(super) fn find_hanging_points(
    model: &Model,
    axes: &[Option<Mat3>],
    reduction: &Reduction,
    centre: &Vec3,
) -> Vec<(usize, [f64; 6])> {
    let warps: Vec<GridIx> = model
        .beams
        .iter()
        .filter_map(|b| b.warping)
        .flatten()
        .collect();
    let hangs = |g: GridIx| {
        model.grids[g.us()].is_scalar()
            && reduction.state[6 * g.us()] == State::Free
            && !warps.contains(&g)
    };
    let mut number: HashMap<GridIx, usize> = HashMap::new();
    let mut points = Vec::new();
    let springs = || model.springs.iter().filter(|s| s.k != 0.0);
    for (g, _) in springs().flat_map(|s| s.ends.iter().flatten()) {
        if hangs(*g) && !number.contains_key(g) {
            number.insert(*g, points.len());
            points.push(g.us());
        }
    }
    if points.is_empty() || points.len() > MOST {
        return Vec::new();
    }
    let n = points.len();
    let (mut stiffness, mut pulls) = (DMatrix::zeros(n, n), DMatrix::zeros(n, 6));
    for s in springs() {
        for (end, other) in [(s.ends[0], s.ends[1]), (s.ends[1], s.ends[0])] {
            let Some(i) = end.and_then(|(g, _)| number.get(&g)) else {
                continue;
            };
            stiffness[(*i, *i)] += s.k;
            let Some((g, dof)) = other else { continue };
            if let Some(j) = number.get(&g) {
                stiffness[(*i, *j)] -= s.k;
            } else if !model.grids[g.us()].is_scalar() {
                for mode in 0..6 {
                    let x = &model.grids[g.us()].x;
                    let moved = to_local(&axes[g.us()], rigid_displacement(mode, x, centre));
                    pulls[(*i, mode)] += s.k * moved[usize::from(dof).min(5)];
                }
            }
        }
    }
    let Some(factor) = stiffness.cholesky() else {
        return Vec::new();
    };
    let moved = factor.solve(&pulls);
    let rows = moved
        .row_iter()
        .map(|r| Vector6::from_iterator(r.iter().copied()).into());
    points.into_iter().zip(rows).collect()
}
