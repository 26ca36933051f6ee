//! Fewer triangles for the eye: grids that lie close together become one. What is computed never passes here.

use super::part::{Drawn, Part};
use crate::model::{Model, Vec3};
use std::collections::{BTreeMap, HashSet};

/// Halvings of the search for the width of a cell.
const STEPS: usize = 9;

/// The part with `most` triangles or fewer (never none): whole where it can be, else with its grids gathered in cubes as small as will do.
pub(super) fn coarsened(model: &Model, part: &Part, most: usize) -> Drawn {
    let whole = Drawn {
        vertex_of: (0..part.grids.len() as u32).collect(),
        vertices: (0..part.grids.len() as u32).collect(),
        triangles: triangles(part, &(0..part.grids.len() as u32).collect::<Vec<_>>()),
        whole: true,
    };
    if whole.triangles.len() <= most {
        return whole;
    }
    let at: Vec<Vec3> = part
        .grids
        .iter()
        .map(|g| model.grids.get(g.us()).map_or_else(Vec3::zeros, |g| g.x))
        .collect();
    let (mut lo, mut hi) = (at[0], at[0]);
    for x in &at {
        lo = lo.inf(x);
        hi = hi.sup(x);
    }
    let size = (hi - lo).norm();
    // Widths by powers: from a thousandth of the part to a quarter of it.
    let width = |s: f64| size * 0.001 * 250_f64.powf(s);
    let (mut fine, mut wide) = (0.0, 1.0);
    let mut best = gathered(part, &at, lo, width(wide));
    for _ in 0..STEPS {
        let middle = 0.5 * (fine + wide);
        let tried = gathered(part, &at, lo, width(middle));
        if tried.triangles.len() <= most {
            wide = middle;
            best = tried;
        } else {
            fine = middle;
        }
    }
    best
}

/// Grids in cubes of width `h`; the one nearest to the middle of its cube's grids stands for them.
fn gathered(part: &Part, at: &[Vec3], lo: Vec3, h: f64) -> Drawn {
    let cube = |x: &Vec3| ((x - lo) / h).map(|v| v.floor() as i64);
    let mut cubes: BTreeMap<[i64; 3], (Vec3, usize)> = BTreeMap::new();
    for x in at {
        let c = cubes.entry(cube(x).into()).or_insert((Vec3::zeros(), 0));
        c.0 += x;
        c.1 += 1;
    }
    let index: BTreeMap<[i64; 3], u32> = cubes.keys().copied().zip(0..).collect();
    let middles: Vec<Vec3> = cubes.values().map(|c| c.0 / c.1 as f64).collect();
    let mut nearest = vec![(f64::INFINITY, 0_u32); middles.len()];
    let vertex_of: Vec<u32> = at
        .iter()
        .zip(0..)
        .map(|(x, grid)| {
            let key: [i64; 3] = cube(x).into();
            let v = index.get(&key).copied().unwrap_or(0);
            let distance = (x - middles[v as usize]).norm_squared();
            let n = &mut nearest[v as usize];
            if distance < n.0 {
                *n = (distance, grid);
            }
            v
        })
        .collect();
    Drawn {
        vertices: nearest.iter().map(|n| n.1).collect(),
        triangles: triangles(part, &vertex_of),
        whole: false,
        vertex_of,
    }
}

/// Faces as triangles of vertices: those without area in numbers left out, each once.
fn triangles(part: &Part, vertex_of: &[u32]) -> Vec<[u32; 3]> {
    let mut seen: HashSet<[u32; 3]> = HashSet::new();
    let mut out = Vec::new();
    for (_, f) in &part.faces {
        let [a, b, c, d] = f.map(|g| vertex_of[g as usize]);
        for t in [[a, b, c], [a, c, d]] {
            let mut key = t;
            key.sort_unstable();
            if key[0] != key[1] && key[1] != key[2] && seen.insert(key) {
                out.push(t);
            }
        }
    }
    out
}
