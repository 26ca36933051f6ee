//! Lines of the model: where shells end, meet or fold, and all bars.

use crate::model::{GridIx, Model, Vec3};
use std::collections::BTreeMap;

/// Maximum number of edges drawn. If there are more, they are thinned evenly.
const MOST_EDGES: usize = 12_000;
/// Elements up to which every edge of the mesh is drawn.
const SMALL: usize = 3_000;

/// Returns the edges of shells at which the outline shows: free edges, edges of three and more shells, folds. Of a small model, all edges.
pub(super) fn outline(model: &Model, faces: impl Iterator<Item = [GridIx; 4]>) -> Vec<[Vec3; 2]> {
    let mut edges: BTreeMap<[u32; 2], (usize, Vec3, bool)> = BTreeMap::new();
    let at = |g: GridIx| model.grids.get(g.us()).map(|g| g.x);
    let mut n_faces = 0;
    for f in faces {
        n_faces += 1;
        let n = if f[2] == f[3] { 3 } else { 4 };
        let (Some(a), Some(b), Some(c)) = (at(f[0]), at(f[1]), at(f[n - 1])) else {
            continue;
        };
        let normal = (b - a)
            .cross(&(c - a))
            .try_normalize(0.0)
            .unwrap_or_else(Vec3::zeros);
        for i in 0..n {
            let (p, q) = (f[i].0, f[(i + 1) % n].0);
            let e = edges
                .entry([p.min(q), p.max(q)])
                .or_insert((0, normal, false));
            e.0 += 1;
            // A fold of more than 30 degrees is drawn.
            e.2 |= e.1.dot(&normal).abs() < 0.866;
        }
    }
    thin_edges(
        edges
            .iter()
            .filter(|(_, (n, _, fold))| n_faces <= SMALL || *n != 2 || *fold)
            .filter_map(|([p, q], _)| Some([at(GridIx(*p))?, at(GridIx(*q))?]))
            .collect(),
    )
}

/// Returns the axes of bars, beams and rods.
pub(super) fn bars(model: &Model) -> Vec<[Vec3; 2]> {
    let at = |g: GridIx| model.grids.get(g.us()).map(|g| g.x);
    let beams = model.beams.iter().map(|b| b.grids);
    let ends = beams.chain(model.rods.iter().map(|r| r.grids));
    thin_edges(ends.filter_map(|[p, q]| Some([at(p)?, at(q)?])).collect())
}

fn thin_edges(list: Vec<[Vec3; 2]>) -> Vec<[Vec3; 2]> {
    let stride = list.len().div_ceil(MOST_EDGES).max(1);
    list.into_iter().step_by(stride).collect()
}
