//! Where strain is not to be trusted: how far places are from free edges, joints of plates, loads and attachments.

use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::model::{Model, RigidKind, ShellIx, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Cosine of the bend from which plates meet in a joint: that of PARAM,SNORM's default, 20 degrees.
const BEND: f64 = 0.939_692_620_785_908_4;

/// A straight piece, or a point twice.
pub type Segment = [Vec3; 2];

/// Edges that belong to one shell alone: borders, and the rims of holes.
pub fn free_edges(model: &Model) -> Vec<Segment> {
    by_edge(model, |shells| shells.len() == 1)
}

/// Edges where plates meet at an angle, or more than two of them: where a weld is.
pub fn joints(model: &Model) -> Vec<Segment> {
    let normal = |ix: &ShellIx| -> Option<Vec3> {
        let s = model.shells.get(ix.us())?;
        Some(shell_axes(model, s, ShellPlace::Centre)?.row(2).transpose())
    };
    by_edge(model, |shells| match shells {
        [a, b] => normal(a)
            .zip(normal(b))
            .is_some_and(|(x, y)| x.dot(&y).abs() < BEND),
        more => more.len() > 2,
    })
}

fn by_edge(model: &Model, taken: impl Fn(&[ShellIx]) -> bool) -> Vec<Segment> {
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
    let mut kept: Vec<[u32; 2]> = edges
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

/// Grids that rigid elements, RBE3 and bushes hold.
pub fn attachments(model: &Model) -> Vec<Segment> {
    let mut grids: Vec<u32> = Vec::new();
    for r in &model.rigids {
        match &r.kind {
            RigidKind::Body {
                independent,
                dependent,
                ..
            } => grids.extend(independent.iter().chain(dependent).map(|g| g.0.0)),
            RigidKind::Mean {
                reference, arms, ..
            } => {
                grids.push(reference.0);
                grids.extend(arms.iter().map(|a| a.2.0));
            }
        }
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

/// By point, whether it is at least `distance` from every segment.
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
