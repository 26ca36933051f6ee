//! Sides of shells in space, whichever way their normals point.

use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::model::{Model, ShellIx, Vec3};

/// Returns the other side of the same shell.
pub fn opposite_side(side: Surface) -> Surface {
    match side {
        Surface::Top => Surface::Bottom,
        Surface::Bottom => Surface::Top,
    }
}

/// Returns the unit normal at the centre of a shell, basic frame; `None` without area.
pub(super) fn shell_normal(model: &Model, ix: ShellIx) -> Option<Vec3> {
    let shell = model.shells.get(ix.us())?;
    Some(
        shell_axes(model, shell, ShellPlace::Centre)?
            .row(2)
            .transpose(),
    )
}

/// Returns the side of shell `other` that faces in the same direction as `side` of shell `from`. It is the opposite side if the normals are opposite.
pub(super) fn same_side(
    model: &Model,
    (from, side): (ShellIx, Surface),
    other: ShellIx,
) -> Option<Surface> {
    let opposed = shell_normal(model, from)?.dot(&shell_normal(model, other)?) < 0.0;
    Some(if opposed { opposite_side(side) } else { side })
}

/// Cosine of the angle between two normals below which shells face neither the same nor opposite ways: 60 degrees.
const FACING: f64 = 0.5;

/// Returns the side of shell `other` that faces in the direction opposite to `side` of shell `from`. `None` if the angle between their normals is 60
/// to 120 degrees, or if a shell has no area.
pub fn away_from(
    model: &Model,
    (from, side): (ShellIx, Surface),
    other: ShellIx,
) -> Option<Surface> {
    let facing = shell_normal(model, from)?.dot(&shell_normal(model, other)?);
    (facing.abs() >= FACING)
        .then(|| same_side(model, (from, side), other).map(opposite_side))
        .flatten()
}
