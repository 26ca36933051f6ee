//! The mean strain over a gauge's grid.
//!
//! The strain along the axis is sampled at points over the grid length, each on the shell at that point, and averaged. If the result has corner rows,
//! the strain is bilinear in each shell. If it has centres only, the strain is linear about each centre. Its gradient along the axis then fits the
//! neighbours across the shell's edges (least squares). Neighbours at an angle of more than 20 degrees are round a bend and are left out.

use super::side::{same_side, shell_normal};
use super::surface::{Foot, centre, foot_on};
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, ShellIx, Vec3};

/// Points over the grid: Gauss-Legendre abscissae on [-1, 1] and weights (sum 1).
pub const POINTS: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.118_463_442_528_094_5),
    (-0.538_469_310_105_683, 0.239_314_335_249_683_2),
    (0.0, 0.284_444_444_444_444_4),
    (0.538_469_310_105_683, 0.239_314_335_249_683_2),
    (0.906_179_845_938_664, 0.118_463_442_528_094_5),
];

/// Cosine of 20 degrees, the default of PARAM,SNORM: plates that meet at a larger angle form a bend or a joint.
pub const SMOOTH: f64 = 0.939_692_620_785_908_4;

/// Returns the shells that share an edge with `shell` and continue it smoothly.
pub fn neighbours(model: &Model, shell: ShellIx) -> Vec<ShellIx> {
    let Some(me) = model.shells.get(shell.us()) else {
        return Vec::new();
    };
    let Some(n) = shell_normal(model, shell) else {
        return Vec::new();
    };
    let mine = &me.grids[..me.shape.n_corners()];
    (0..model.shells.len() as u32)
        .map(ShellIx)
        .filter(|&ix| ix != shell)
        .filter(|ix| {
            model.shells.get(ix.us()).is_some_and(|s| {
                s.grids[..s.shape.n_corners()]
                    .iter()
                    .filter(|g| mine.contains(g))
                    .count()
                    >= 2
            })
        })
        .filter(|&ix| shell_normal(model, ix).is_some_and(|m| m.dot(&n).abs() >= SMOOTH))
        .collect()
}

/// Returns the weights of the centres of `shell` and its neighbours for the strain at `x` on the shell: value and gradient along `axis`.
pub fn about_centre(model: &Model, shell: ShellIx, x: Vec3, axis: Vec3) -> Vec<(ShellIx, f64)> {
    let Some(c) = model.shells.get(shell.us()).and_then(|s| centre(model, s)) else {
        return vec![(shell, 1.0)];
    };
    let along = (x - c).dot(&axis);
    let near: Vec<(ShellIx, f64)> = neighbours(model, shell)
        .into_iter()
        .filter_map(|ix| {
            Some((
                ix,
                (centre(model, model.shells.get(ix.us())?)? - c).dot(&axis),
            ))
        })
        .collect();
    let spread: f64 = near.iter().map(|(_, t)| t * t).sum();
    if spread <= 0.0 {
        return vec![(shell, 1.0)];
    }
    let mut own = 1.0;
    let mut out = Vec::new();
    for (ix, t) in near {
        let w = along * t / spread;
        own -= w;
        out.push((ix, w));
    }
    out.push((shell, own));
    out
}

/// Point on the shells. The side of this shell faces in the same direction as the side of the first shell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Landing {
    /// Point on the reference surface. `side` faces in the same direction as the requested side.
    pub foot: Foot,
    /// Distance from the edge of the surface to the requested point, along the surface. It is 0 if the point is over the surface.
    pub past_edge: f64,
}

/// Returns the place on the shells at `x`, seen from `side` of `home`. It is on `home`, or on a shell that smooth neighbours connect with `home`.
/// Each step keeps the side in space. The directions of the shell normals do not matter.
pub(super) fn place_at(
    model: &Model,
    (home, side): (ShellIx, Surface),
    x: Vec3,
) -> Option<Landing> {
    let on = |ix: ShellIx, side: Surface| {
        let foot = foot_on(model, ix, x)?;
        Some(Foot { side, ..foot })
    };
    let mut best = on(home, side)?;
    let mut seen = vec![home];
    while best.distance >= 1e-9 * best.point.norm().max(1.0) {
        let next = neighbours(model, best.shell)
            .into_iter()
            .filter(|ix| !seen.contains(ix))
            .collect::<Vec<_>>();
        seen.extend(&next);
        let feet = next.into_iter().filter_map(|ix| {
            let facing = same_side(model, (best.shell, best.side), ix)?;
            on(ix, facing)
        });
        let Some(found) = feet.min_by(|a, b| a.distance.total_cmp(&b.distance)) else {
            break;
        };
        if found.distance >= best.distance {
            break;
        }
        best = found;
    }
    let z = shell_normal(model, best.shell)?;
    let off = x - best.point;
    let flat = (off - z * off.dot(&z)).norm();
    // On a smooth surface, the offset of the point is along the normal. At an edge, the offset is along the surface.
    let at_edge = flat * flat > (1.0 - SMOOTH * SMOOTH) * off.norm_squared();
    Some(Landing {
        foot: best,
        past_edge: if at_edge { flat } else { 0.0 },
    })
}
