//! Length of a straight run of bars.

use super::grid_average::SMOOTH;
use crate::model::{BeamIx, GridIx, Model, Vec3};

/// Returns the length of the straight chain of bars that contains this bar. The search ends if the chain is at least as long as `enough`.
pub(super) fn run_length(model: &Model, beam: BeamIx, enough: f64) -> Option<f64> {
    let ends = |ix: BeamIx| {
        let b = model.beams.get(ix.us())?;
        let x = |i: usize| Some(model.grids.get(b.grids[i].us())?.x + b.offsets[i]);
        Some((b.grids, x(1)? - x(0)?))
    };
    let (grids, along) = ends(beam)?;
    let axis = along.normalize();
    let mut length = along.norm();
    let mut seen = vec![beam];
    for (grid, outward) in [(grids[0], -axis), (grids[1], axis)] {
        let mut from: (GridIx, Vec3) = (grid, outward);
        while length < enough {
            let next = (0..model.beams.len() as u32).map(BeamIx).find_map(|ix| {
                let (grids, along) = ends(ix).filter(|_| !seen.contains(&ix))?;
                let (to, way) = match (grids[0] == from.0, grids[1] == from.0) {
                    (true, _) => (grids[1], along),
                    (_, true) => (grids[0], -along),
                    _ => return None,
                };
                let straight = way.dot(&from.1) >= SMOOTH * way.norm();
                straight.then_some((ix, to, way))
            });
            let Some((ix, to, way)) = next else { break };
            seen.push(ix);
            length += way.norm();
            from = (to, way.normalize());
        }
    }
    Some(length)
}
