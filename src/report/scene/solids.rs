//! Faces of solids that no other solid shares.

use crate::model::{GridIx, Model, solid_faces};
use std::collections::HashMap;

/// Returns solid index and corners of each outer face. A triangle repeats its third corner.
pub(super) fn outer_faces(model: &Model) -> Vec<(usize, [GridIx; 4])> {
    let mut seen: HashMap<[u32; 4], (usize, [GridIx; 4], usize)> = HashMap::new();
    for (i, solid) in model.solids.iter().enumerate() {
        for face in solid_faces(solid.shape) {
            let corner = |k: usize| {
                let at = face.get(k).or(face.get(2))?;
                solid.grids.get(*at).copied().flatten()
            };
            let (Some(a), Some(b), Some(c), Some(d)) = (corner(0), corner(1), corner(2), corner(3))
            else {
                continue;
            };
            let mut key = [a.0, b.0, c.0, d.0];
            key.sort_unstable();
            seen.entry(key).or_insert((i, [a, b, c, d], 0)).2 += 1;
        }
    }
    let mut out: Vec<(usize, [GridIx; 4])> = seen
        .into_values()
        .filter(|f| f.2 == 1)
        .map(|f| (f.0, f.1))
        .collect();
    out.sort_unstable();
    out
}
