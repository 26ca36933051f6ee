//! The size of a mesh: what lengths in a job are measured by.

use crate::estimate::median;
use crate::model::Model;

/// Returns the usual side length of a shell: the median distance between its first two grids. `None` without shells.
pub(super) fn shell_side(model: &Model) -> Option<f64> {
    let place = |g: crate::model::GridIx| model.grids.get(g.us()).map(|g| g.x);
    let sides = model
        .shells
        .iter()
        .filter_map(|s| Some((place(s.grids[1])? - place(s.grids[0])?).norm()))
        .filter(|side| *side > 0.0);
    median(sides.collect())
}

/// Returns the diagonal of the box around the shells; 0 without shells.
pub(super) fn extent(model: &Model) -> f64 {
    let grids = model
        .shells
        .iter()
        .flat_map(|s| &s.grids[..s.shape.n_grids()]);
    let mut places = grids.filter_map(|g| model.grids.get(g.us())).map(|g| g.x);
    let Some(first) = places.next() else {
        return 0.0;
    };
    let (low, high) = places.fold((first, first), |(low, high), x| (low.inf(&x), high.sup(&x)));
    (high - low).norm()
}
