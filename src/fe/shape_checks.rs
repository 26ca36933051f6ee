//! Elements whose shape makes their strain doubtful: inverted solids, re-entrant and folded quadrilaterals.

use super::element::solid::is_inverted;
use crate::finding::{Finding, Severity, list_few};
use crate::model::{Model, Shell, Vec3};

/// Limit of the corners' distance from the mean plane over the mean diagonal. A quadrilateral above it counts as folded. It is the default limit of
/// the surface warping factor in Nastran's GEOMCHECK (Q4_WARP).
const FOLDED: f64 = 0.05;

/// Returns findings on elements with a doubtful shape, one for each kind.
pub fn check_shapes(model: &Model) -> Vec<Finding> {
    let quads = || model.shells.iter().filter(|s| s.shape.n_corners() == 4);
    let corners = |s: &Shell| -> Option<[Vec3; 4]> {
        let mut x = [Vec3::zeros(); 4];
        for (x, g) in x.iter_mut().zip(&s.grids) {
            *x = model.grids.get(g.us())?.x;
        }
        Some(x)
    };
    let inverted: Vec<u32> = (0..model.solids.len())
        .filter(|i| is_inverted(model, *i))
        .map(|i| model.solids[i].id)
        .collect();
    let re_entrant: Vec<u32> = quads()
        .filter(|s| corners(s).is_some_and(|x| is_re_entrant(&x)))
        .map(|s| s.id)
        .collect();
    let folded: Vec<(u32, f64)> = quads()
        .filter_map(|s| Some((s.id, warp(&corners(s)?))))
        .filter(|(_, w)| *w > FOLDED)
        .collect();
    let worst = folded.iter().map(|f| f.1).fold(0.0, f64::max);
    let folded: Vec<u32> = folded.into_iter().map(|f| f.0).collect();
    let told = [
        (
            inverted,
            "inverted-solid",
            "are numbered as their mirror image (turned inside out); they are solved with the order corrected",
            "renumber their grids so that the normal of the first face points to the other grids",
            None,
        ),
        (
            re_entrant,
            "re-entrant-quad",
            "have an inner angle of 180 degrees or more: their strain is not valid",
            "split each into triangles, or move its corner",
            None,
        ),
        (
            folded,
            "folded-quad",
            "are folded out of their plane: corners are more than a twentieth of the diagonal from the mean plane",
            "split each into two triangles, and put no gauge there",
            Some((worst, FOLDED)),
        ),
    ];
    told.into_iter()
        .filter(|t| !t.0.is_empty())
        .map(|(ids, code, what, remedy, numbers)| {
            let finding = Finding::new(
                Severity::Warning,
                code,
                format!("elements {}", list_few(&ids)),
                format!("{} elements {what}", ids.len()),
                remedy,
            );
            match numbers {
                Some((measured, limit)) => finding.with_numbers(measured, limit),
                None => finding.with_numbers(ids.len() as f64, 0.0),
            }
        })
        .collect()
}

/// Twice the vector area: along the mean normal.
fn mean_normal(x: &[Vec3; 4]) -> Vec3 {
    (x[2] - x[0]).cross(&(x[3] - x[1]))
}

/// Returns whether the corner between its two sides turns back somewhere, seen along the mean normal.
fn is_re_entrant(x: &[Vec3; 4]) -> bool {
    let normal = mean_normal(x);
    (0..4).any(|i| {
        let (next, before) = (x[(i + 1) % 4] - x[i], x[(i + 3) % 4] - x[i]);
        !(next.cross(&before).dot(&normal) > 0.0)
    })
}

/// Distance of the corners from the mean plane over the mean length of the diagonals.
fn warp(x: &[Vec3; 4]) -> f64 {
    let Some(normal) = mean_normal(x).try_normalize(0.0) else {
        return 0.0;
    };
    let diagonal = 0.5 * ((x[2] - x[0]).norm() + (x[3] - x[1]).norm());
    // All corners have the same distance from the mean plane, alternately above and below it.
    let off = 0.25 * (x[0] - x[1] + x[2] - x[3]).dot(&normal).abs();
    off / diagonal
}

#[cfg(test)]
mod tests;
