//! Rigid motions of a model about a point.

use super::grid_frames::to_local;
use crate::linalg::Matrix6;
use crate::model::{Mat3, Vec3};

/// Returns the displacement of a point by rigid motion `mode` about `centre`: unit translations, then unit rotations, basic frame.
pub(crate) fn rigid_displacement(mode: usize, x: &Vec3, centre: &Vec3) -> [f64; 6] {
    let mut u = [0.0; 6];
    u[mode] = 1.0;
    if mode >= 3 {
        let t = Vec3::new(u[3], u[4], u[5]).cross(&(x - centre));
        (u[0], u[1], u[2]) = (t.x, t.y, t.z);
    }
    u
}

/// Returns the six motions as columns, rows in the grid's displacement frame.
pub(super) fn rigid_matrix(x: &Vec3, centre: &Vec3, axes: &Option<Mat3>) -> Matrix6<f64> {
    let mut m = Matrix6::zeros();
    for mode in 0..6 {
        for (i, v) in to_local(axes, rigid_displacement(mode, x, centre))
            .into_iter()
            .enumerate()
        {
            m[(i, mode)] = v;
        }
    }
    m
}
