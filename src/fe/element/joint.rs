//! CWELD, CFAST, CGAP: six springs between two points that move as patches of grids do.

use super::ElementMatrix;
use crate::linalg::{Matrix6, SMatrix};
use crate::model::Joint;

/// Returns the dofs of the grids, one bit for each dof. Grids of patches are held by their translations only.
pub(super) fn joint_dofs(joint: &Joint) -> u8 {
    let mut motion = joint.ends.iter().flat_map(|e| &e.motion);
    let turns = motion.any(|(_, m)| m.fixed_view::<6, 3>(0, 3).amax() > 0.0);
    if turns { 0b111_111 } else { 0b000_111 }
}

/// Stiffness, basic frame: B' k B with B the relative motion B - A at the location, element axes.
pub(crate) fn joint_stiffness(joint: &Joint) -> ElementMatrix {
    let mut axes = Matrix6::zeros();
    axes.fixed_view_mut::<3, 3>(0, 0).copy_from(&joint.axes);
    axes.fixed_view_mut::<3, 3>(3, 3).copy_from(&joint.axes);
    let grids = joint.all_grids();
    let mut blocks = vec![SMatrix::<f64, 6, 6>::zeros(); grids.len()];
    for (end, sign) in joint.ends.iter().zip([-1.0, 1.0]) {
        let mut arm = Matrix6::identity();
        arm.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&-(joint.location - end.x).cross_matrix());
        let turn = axes * arm * sign;
        for (g, m) in &end.motion {
            if let Ok(at) = grids.binary_search(g) {
                blocks[at] += turn * m;
            }
        }
    }
    let n = 6 * grids.len();
    let mut k = ElementMatrix::zeros(grids);
    for (a, left) in blocks.iter().enumerate() {
        for (b, right) in blocks.iter().enumerate() {
            for i in 0..6 {
                for j in 0..6 {
                    let sum: f64 = (0..6)
                        .map(|c| joint.k[c] * left[(c, i)] * right[(c, j)])
                        .sum();
                    k.values[(6 * a + i) * n + 6 * b + j] = sum;
                }
            }
        }
    }
    k
}
