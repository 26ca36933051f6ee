//! Where strain is not to be trusted: how far places are from free edges, joints of plates, loads and attachments.

use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::gauge::SMOOTH;
use crate::model::{Model, ShellIx, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// A straight piece, or a point twice.
pub type Segment = [Vec3; 2];

/// Returns the edges that belong to one shell only: borders, and rims of holes.
pub fn free_edges(model: &Model) -> Vec<Segment> {
    by_edge(model, |shells| shells.len() == 1)
}

/// Returns the free edges that are not rims of holes.
pub fn borders(model: &Model) -> Vec<Segment> {
    split(model).0
}

/// Returns the rims of holes, which are closed chains of free edges that turn towards the material.
///
/// Let `theta` be the angle of the material at a grid. By the theorem of Gauss and Bonnet, `sum (pi - theta)` is `2 pi` along the border of a plate
/// and `-2 pi` around a hole. At the open end of a tube it is 0. A chain with a sum below `-pi` is a rim. `theta` adds up the shells from one free
/// edge to the next across edges of two shells.
pub fn hole_rims(model: &Model) -> Vec<Segment> {
    split(model).1
}

fn split(model: &Model) -> (Vec<Segment>, Vec<Segment>) {
    let edges = edges_of(model);
    let mut free: Vec<([u32; 2], ShellIx)> = edges
        .iter()
        .filter_map(|(e, shells)| match shells.as_slice() {
            [one] => Some((*e, *one)),
            _ => None,
        })
        .collect();
    free.sort_unstable_by_key(|f| f.0);
    // Group the grids that free edges connect.
    let mut run: HashMap<u32, u32> = HashMap::new();
    for ([a, b], _) in &free {
        let (a, b) = (root(&mut run, *a), root(&mut run, *b));
        if a != b {
            run.insert(a.max(b), a.min(b));
        }
    }
    let mut turn: HashMap<u32, f64> = HashMap::new();
    for (edge, shell) in &free {
        for grid in edge {
            // Each grid of a chain is visited from both of its free edges.
            let theta = material(model, &edges, *edge, *shell, *grid);
            *turn.entry(root(&mut run, *grid)).or_insert(0.0) +=
                0.5 * (std::f64::consts::PI - theta);
        }
    }
    let at = |g: u32| model.grids.get(g as usize).map(|g| g.x);
    let (mut borders, mut rims) = (Vec::new(), Vec::new());
    for ([a, b], _) in free {
        let inward = turn
            .get(&root(&mut run, a))
            .is_some_and(|t| *t < -std::f64::consts::PI);
        if let Some(segment) = at(a).zip(at(b)) {
            let segment = [segment.0, segment.1];
            if inward {
                rims.push(segment);
            } else {
                borders.push(segment);
            }
        }
    }
    (borders, rims)
}

fn root(run: &mut HashMap<u32, u32>, grid: u32) -> u32 {
    let mut at = grid;
    while let Some(&up) = run.get(&at).filter(|up| **up != at) {
        at = up;
    }
    run.insert(grid, at);
    at
}

/// Angle of the shells around `grid` from a free edge to where they end.
fn material(
    model: &Model,
    edges: &HashMap<[u32; 2], Vec<ShellIx>>,
    mut edge: [u32; 2],
    mut shell: ShellIx,
    grid: u32,
) -> f64 {
    let mut sum = 0.0;
    for _ in 0..MOST_AROUND {
        let Some(s) = model.shells.get(shell.us()) else {
            break;
        };
        let n = s.shape.n_corners();
        let Some(c) = (0..n).find(|&c| s.grids[c].0 == grid) else {
            break;
        };
        let around = [s.grids[(c + 1) % n].0, s.grids[(c + n - 1) % n].0];
        let at = |g: u32| model.grids.get(g as usize).map(|g| g.x).unwrap_or_default();
        let [u, v] = around.map(|g| at(g) - at(grid));
        sum += u.cross(&v).norm().atan2(u.dot(&v));
        let far = around.map(|g| [g.min(grid), g.max(grid)]);
        let next = if far[0] == edge { far[1] } else { far[0] };
        match edges.get(&next).map(Vec::as_slice) {
            Some([a, b]) => (edge, shell) = (next, if *a == shell { *b } else { *a }),
            _ => break,
        }
    }
    sum
}

/// Shells around a grid at most.
const MOST_AROUND: usize = 64;

/// Returns the edges where plates meet at an angle, or where more than two plates meet. Welds are there.
pub fn joints(model: &Model) -> Vec<Segment> {
    let normal = |ix: &ShellIx| -> Option<Vec3> {
        let s = model.shells.get(ix.us())?;
        Some(shell_axes(model, s, ShellPlace::Centre)?.row(2).transpose())
    };
    by_edge(model, |shells| match shells {
        [a, b] => normal(a)
            .zip(normal(b))
            .is_some_and(|(x, y)| x.dot(&y).abs() < SMOOTH),
        more => more.len() > 2,
    })
}

/// Shells by edge, grids ascending.
fn edges_of(model: &Model) -> HashMap<[u32; 2], Vec<ShellIx>> {
    let mut edges: HashMap<[u32; 2], Vec<ShellIx>> = HashMap::new();
    for (i, s) in model.shells.iter().enumerate() {
        let n = s.shape.n_corners();
        for c in 0..n {
            let (a, b) = (s.grids[c].0, s.grids[(c + 1) % n].0);
            if a != b {
                let shells = edges.entry([a.min(b), a.max(b)]).or_default();
                shells.push(ShellIx(i as u32));
            }
        }
    }
    edges
}

fn by_edge(model: &Model, taken: impl Fn(&[ShellIx]) -> bool) -> Vec<Segment> {
    let mut kept: Vec<[u32; 2]> = edges_of(model)
        .into_iter()
        .filter(|(_, shells)| taken(shells))
        .map(|(e, _)| e)
        .collect();
    kept.sort_unstable();
    let at = |g: u32| model.grids.get(g as usize).map(|g| g.x);
    kept.into_iter()
        .filter_map(|[a, b]| Some([at(a)?, at(b)?]))
        .collect()
}

/// Returns the grids that rigid elements, RBE3, bushes, welds, fasteners and gaps hold.
pub fn attachments(model: &Model) -> Vec<Segment> {
    let mut grids: Vec<u32> = Vec::new();
    for r in &model.rigids {
        grids.extend(r.kind.grids().iter().map(|g| g.0));
    }
    for end in model.joints.iter().flat_map(|j| &j.ends) {
        grids.extend(end.motion.iter().map(|m| m.0.0));
    }
    for b in &model.bushes {
        grids.push(b.grids.0.0);
        grids.extend(b.grids.1.map(|g| g.0));
    }
    grids.sort_unstable();
    grids.dedup();
    let at = |g: u32| model.grids.get(g as usize).map(|g| g.x);
    grids
        .into_iter()
        .filter_map(|g| Some([at(g)?, at(g)?]))
        .collect()
}

/// Returns for each point whether its distance from every segment is at least `distance`.
pub fn clear_of(points: &[Vec3], segments: &[Segment], distance: f64) -> Vec<bool> {
    if segments.is_empty() || !(distance > 0.0) {
        return vec![true; points.len()];
    }
    let longest = segments
        .iter()
        .map(|[a, b]| (b - a).norm())
        .fold(0.0, f64::max);
    let cell = distance.max(longest);
    let key = |x: Vec3| -> [i64; 3] { [x.x, x.y, x.z].map(|v| (v / cell).floor() as i64) };
    let mut grid: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (i, [a, b]) in segments.iter().enumerate() {
        grid.entry(key((a + b) * 0.5)).or_default().push(i as u32);
    }
    points
        .par_iter()
        .map(|&x| {
            // The middle of a segment within reach is at most distance + longest / 2 away, so at most two cells.
            let c = key(x);
            (-2..=2).all(|i| {
                (-2..=2).all(|j| {
                    (-2..=2).all(|l| {
                        grid.get(&[c[0] + i, c[1] + j, c[2] + l])
                            .into_iter()
                            .flatten()
                            .all(|&s| to_segment(x, segments[s as usize]) >= distance)
                    })
                })
            })
        })
        .collect()
}

fn to_segment(x: Vec3, [a, b]: Segment) -> f64 {
    let d = b - a;
    let l = d.dot(&d);
    let t = if l > 0.0 {
        ((x - a).dot(&d) / l).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (a + d * t - x).norm()
}
