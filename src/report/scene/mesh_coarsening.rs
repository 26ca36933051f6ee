//! Coarser mesh for pictures: grids close together are merged into one. Computed results never depend on it.

use super::part::{Part, PartMesh};
use crate::model::{Model, Vec3};
use std::collections::{BTreeMap, HashMap, HashSet};

/// Halvings of the search for the width of a cell.
const STEPS: usize = 9;
/// Two unit vectors of a border's grid add up to this where the border turns by 29 degrees: a corner.
const TURN: f64 = 0.5;

/// Returns the mesh of a part with at most `most` triangles, and at least one. If the part has more, its grids are merged in cubes, as small as
/// possible.
pub(super) fn coarsen(model: &Model, part: &Part, most: usize) -> PartMesh {
    let whole = PartMesh {
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
    // Widths of the cubes are in geometric progression, from a thousandth to a quarter of the part.
    let width = |s: f64| size * 0.001 * 250_f64.powf(s);
    let (mut fine, mut wide) = (0.0, 1.0);
    let rank = ranks(part, &at);
    let mut best = merge_grids_in_cubes(part, &at, &rank, lo, width(wide));
    for _ in 0..STEPS {
        let middle = 0.5 * (fine + wide);
        let tried = merge_grids_in_cubes(part, &at, &rank, lo, width(middle));
        if tried.triangles.len() <= most {
            wide = middle;
            best = tried;
        } else {
            fine = middle;
        }
    }
    best
}

/// Returns the rank of each grid: 0 inside, 1 on the border of the part, 2 at a corner of the border. A border is a side that is not shared by two
/// faces.
fn ranks(part: &Part, at: &[Vec3]) -> Vec<u8> {
    let mut sides: HashMap<[u32; 2], usize> = HashMap::new();
    for (_, f) in &part.faces {
        for k in 0..4 {
            let (a, b) = (f[k], f[(k + 1) % 4]);
            if a != b {
                *sides.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
            }
        }
    }
    // Unit vectors along the border, away from each grid: along a straight line they cancel.
    let mut along = vec![(Vec3::zeros(), false); at.len()];
    let mut border: Vec<[u32; 2]> = sides
        .into_iter()
        .filter(|s| s.1 != 2)
        .map(|s| s.0)
        .collect();
    border.sort_unstable();
    for [a, b] in border.into_iter().map(|s| s.map(|g| g as usize)) {
        let way = (at[b] - at[a]).try_normalize(0.0).unwrap_or_default();
        along[a] = (along[a].0 + way, true);
        along[b] = (along[b].0 - way, true);
    }
    let rank = |(sum, on_border): &(Vec3, bool)| match on_border {
        false => 0,
        true if sum.norm() < TURN => 1,
        true => 2,
    };
    along.iter().map(rank).collect()
}

/// Merges the grids in each cube of width `h` into one.
///
/// Replaces the grids of a cube by the one of the highest rank that is nearest to the mean of its rank. Borders therefore keep their places,
/// and no gaps open between parts that meet.
fn merge_grids_in_cubes(part: &Part, at: &[Vec3], rank: &[u8], lo: Vec3, h: f64) -> PartMesh {
    let cube = |x: &Vec3| ((x - lo) / h).map(|v| v.floor() as i64);
    let mut cubes: BTreeMap<[i64; 3], (Vec3, usize, u8)> = BTreeMap::new();
    for (x, rank) in at.iter().zip(rank) {
        let c = cubes.entry(cube(x).into()).or_insert((Vec3::zeros(), 0, 0));
        if *rank > c.2 {
            *c = (Vec3::zeros(), 0, *rank);
        }
        if *rank == c.2 {
            c.0 += x;
            c.1 += 1;
        }
    }
    let index: BTreeMap<[i64; 3], u32> = cubes.keys().copied().zip(0..).collect();
    let middles: Vec<Vec3> = cubes.values().map(|c| c.0 / c.1 as f64).collect();
    let mut nearest = vec![(f64::INFINITY, 0_u32); middles.len()];
    let highest: Vec<u8> = cubes.values().map(|c| c.2).collect();
    let vertex_of: Vec<u32> = at
        .iter()
        .zip(rank)
        .zip(0..)
        .map(|((x, rank), grid)| {
            let key: [i64; 3] = cube(x).into();
            let v = index.get(&key).copied().unwrap_or(0);
            let distance = (x - middles[v as usize]).norm_squared();
            let n = &mut nearest[v as usize];
            if *rank == highest[v as usize] && distance < n.0 {
                *n = (distance, grid);
            }
            v
        })
        .collect();
    PartMesh {
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
