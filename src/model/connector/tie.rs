//! How the end of a connector moves with the grids of a patch.

use super::patch::{Foot, Patch};
use crate::linalg::{Matrix6, SMatrix};
use crate::model::types::*;
use std::collections::BTreeMap;

type Rows3 = SMatrix<f64, 3, 6>;

/// Returns the motion of the foot of a patch from translations alone. The translation is u = sum N_i u_i. The rotation is half the curl in the
/// tangent plane: `theta_1 = sum dN_i/dy w_i`, `theta_2 = - sum dN_i/dx w_i`, `theta_3 = (sum dN_i/dx v_i - sum dN_i/dy u_i) / 2`. Here x and y are
/// in the tangent plane and w is along the normal.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, CWELD (constraints of the formats GRIDID and ELEMID).
pub(super) fn by_slopes(patch: &Patch, foot: &Foot) -> Option<JointEnd> {
    let along = |k: usize| {
        let pairs = patch.x.iter().zip(&foot.functions);
        pairs.map(|(x, f)| x * f[k]).sum::<Vec3>()
    };
    let (a, b) = (along(1), along(2));
    let t1 = a.try_normalize(0.0)?;
    let n = foot.normal;
    let t2 = n.cross(&t1);
    // Converts slopes along r and s to slopes along x and y.
    let (xr, yr, xs, ys) = (a.dot(&t1), a.dot(&t2), b.dot(&t1), b.dot(&t2));
    let det = xr * ys - yr * xs;
    if !(det.abs() > 0.0) {
        return None;
    }
    let motion = patch.grids.iter().zip(&foot.functions).map(|(g, f)| {
        let dx = (f[1] * ys - f[2] * yr) / det;
        let dy = (f[2] * xr - f[1] * xs) / det;
        let turn = t1 * n.transpose() * dy - t2 * n.transpose() * dx
            + n * (t2.transpose() * dx - t1.transpose() * dy) / 2.0;
        let mut m = Matrix6::zeros();
        m.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(f[0]);
        m.fixed_view_mut::<3, 3>(3, 0).copy_from(&turn);
        (*g, m)
    });
    Some(JointEnd {
        x: foot.x,
        motion: motion.collect(),
    })
}

/// Returns the motion at `x` with the best fit to the translations of auxiliary points. Each point moves by the shape functions of its patch. The end
/// is an RBE3 with equal weights over the points.
///
/// # Reference
/// MSC Nastran Quick Reference Guide, CFAST and CWELD (auxiliary points of the formats PROP, ELEM, PARTPAT, ELPAT).
pub(super) fn by_points(x: Vec3, points: &[(Patch, Foot)]) -> Option<JointEnd> {
    let rows = |p: &Vec3| {
        let mut s = Rows3::zeros();
        s.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(1.0);
        s.fixed_view_mut::<3, 3>(0, 3)
            .copy_from(&-(p - x).cross_matrix());
        s
    };
    let mut normal = Matrix6::zeros();
    for (_, foot) in points {
        let s = rows(&foot.x);
        normal += s.transpose() * s;
    }
    let inverse = normal.try_inverse()?;
    let mut motion: BTreeMap<GridIx, Matrix6<f64>> = BTreeMap::new();
    for (patch, foot) in points {
        let pull = inverse * rows(&foot.x).transpose();
        for (g, f) in patch.grids.iter().zip(&foot.functions) {
            let slot = motion.entry(*g).or_insert_with(Matrix6::zeros);
            let mut part = slot.fixed_view_mut::<6, 3>(0, 0);
            part += pull * f[0];
        }
    }
    Some(JointEnd {
        x,
        motion: motion.into_iter().collect(),
    })
}

/// Returns the equations that make grid `g` follow an end with a rigid arm, all in displacement frames, the dependent term first.
pub(super) fn equations(model: &Model, g: GridIx, end: &JointEnd) -> Vec<Vec<(GridIx, u8, f64)>> {
    let x = model.grids.get(g.us()).map_or(end.x, |g| g.x);
    let mut arm = Matrix6::identity();
    arm.fixed_view_mut::<3, 3>(0, 3)
        .copy_from(&-(x - end.x).cross_matrix());
    let own = six(&model.cd_axes(g)) * arm;
    let parts: Vec<(GridIx, Matrix6<f64>)> = end
        .motion
        .iter()
        .map(|(of, m)| (*of, own * m * six(&model.cd_axes(*of)).transpose()))
        .collect();
    (0..6_u8)
        .map(|i| {
            let mut terms = vec![(g, i, 1.0)];
            for (of, m) in &parts {
                let row = m.row(usize::from(i));
                let largest = row.amax();
                let some = (0..6_u8)
                    .zip(row.iter())
                    .filter(|(_, v)| v.abs() > 1e-14 * largest);
                terms.extend(some.map(|(j, v)| (*of, j, -v)));
            }
            terms
        })
        .collect()
}

/// The axes twice on the diagonal.
fn six(axes: &Mat3) -> Matrix6<f64> {
    let mut m = Matrix6::zeros();
    m.fixed_view_mut::<3, 3>(0, 0).copy_from(axes);
    m.fixed_view_mut::<3, 3>(3, 3).copy_from(axes);
    m
}
