//! How steep the strain is where a gauge can go: what misplacing it, or the length of its grid, does to its reading.

use super::angle_variance::Form;
use super::sites::{Site, bridge_strain};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::gauge::{Bridge, SMOOTH, centre};
use crate::model::{Mat3, Model, ShellIx};
use crate::sensitivity::LoadCaseOf;
use crate::units::MICROSTRAIN;
use rayon::prelude::*;
use std::collections::HashMap;

/// Share of the spread of the neighbours under which a direction has none: its gradient is then 0.
const NO_SPREAD: f64 = 1e-6;

/// A neighbouring shell that continues a shell smoothly.
struct SmoothNeighbour {
    shell: ShellIx,
    /// From centre to centre, along the x and y axes of the first.
    way: [f64; 2],
    /// Cosine and sine of the first's x axis in the other's frame.
    turn: [f64; 2],
    /// The normals are opposite.
    flipped: bool,
}

/// Returns the quadratic form `H` of each site for a gauge at the angle `t`: `c(t)' H c(t) = variance sum_l (|d eps_l / dx|^2 + |d eps_l / dy|^2)`.
/// The unit is microstrain squared at the expected loads. `variance` is the mean square of the position error along each direction, in length
/// squared. It includes a twelfth of the square of the grid length for the strain variation over the grid.
///
/// The gradients are from the plane through the shell centre that fits the strain at the centres of the adjacent shells best.
pub fn forms(
    model: &Model,
    sites: &[Site],
    bridge: Bridge,
    loads: &[LoadCaseOf],
    scales: &[f64],
    variance: f64,
) -> Vec<Form> {
    let edges = edges(model);
    sites
        .par_iter()
        .map(|&(shell, side)| {
            let near = find_adjacent_shells(model, &edges, shell);
            let mut form = [0.0; 6];
            for (load, scale) in loads.iter().zip(scales) {
                let factor = scale / load.applied / MICROSTRAIN;
                let Some(slopes) = slopes(bridge, load, (shell, side), &near) else {
                    continue;
                };
                for [x, y, g] in slopes.map(|s| s.map(|v| v * factor)) {
                    for (f, v) in form
                        .iter_mut()
                        .zip([x * x, y * y, g * g, x * y, x * g, y * g])
                    {
                        *f += variance * v;
                    }
                }
            }
            form
        })
        .collect()
}

/// Shells at each edge, by its two corner grids.
fn edges(model: &Model) -> HashMap<[u32; 2], Vec<ShellIx>> {
    let mut edges: HashMap<[u32; 2], Vec<ShellIx>> = HashMap::new();
    for (i, s) in model.shells.iter().enumerate() {
        let n = s.shape.n_corners();
        for c in 0..n {
            let (a, b) = (s.grids[c].0, s.grids[(c + 1) % n].0);
            edges
                .entry([a.min(b), a.max(b)])
                .or_default()
                .push(ShellIx(i as u32));
        }
    }
    edges
}

fn find_adjacent_shells(
    model: &Model,
    edges: &HashMap<[u32; 2], Vec<ShellIx>>,
    shell: ShellIx,
) -> Vec<SmoothNeighbour> {
    let Some(me) = model.shells.get(shell.us()) else {
        return Vec::new();
    };
    let frame = |ix: ShellIx| -> Option<(Mat3, crate::model::Vec3)> {
        let s = model.shells.get(ix.us())?;
        Some((shell_axes(model, s, ShellPlace::Centre)?, centre(model, s)?))
    };
    let Some((axes, at)) = frame(shell) else {
        return Vec::new();
    };
    let n = me.shape.n_corners();
    let mut out = Vec::new();
    for c in 0..n {
        let (a, b) = (me.grids[c].0, me.grids[(c + 1) % n].0);
        for &other in edges.get(&[a.min(b), a.max(b)]).into_iter().flatten() {
            if other == shell {
                continue;
            }
            let Some((its, there)) = frame(other) else {
                continue;
            };
            let facing = its.row(2).dot(&axes.row(2));
            let x = its * axes.row(0).transpose();
            let length = x.x.hypot(x.y);
            if facing.abs() < SMOOTH || length == 0.0 {
                continue;
            }
            let way = axes * (there - at);
            out.push(SmoothNeighbour {
                shell: other,
                way: [way.x, way.y],
                turn: [x.x / length, x.y / length],
                flipped: facing < 0.0,
            });
        }
    }
    out
}

/// Gradients of the tensor along x and y, its components in the frame of the site's shell.
fn slopes(
    bridge: Bridge,
    load: &LoadCaseOf,
    site: Site,
    near: &[SmoothNeighbour],
) -> Option<[[f64; 3]; 2]> {
    let here = bridge_strain(bridge, load.case, site)?;
    let (mut a, mut b) = ([0.0; 3], [[0.0; 3]; 2]);
    for n in near {
        let side = match (n.flipped, site.1) {
            (false, s) => s,
            (true, Surface::Top) => Surface::Bottom,
            (true, Surface::Bottom) => Surface::Top,
        };
        let Some([x, y, g]) = bridge_strain(bridge, load.case, (n.shell, side)) else {
            continue;
        };
        let [c, s] = n.turn;
        let shear = 2.0 * c * s * (y - x) + (c * c - s * s) * g;
        let there = [
            c * c * x + s * s * y + s * c * g,
            s * s * x + c * c * y - s * c * g,
            if n.flipped { -shear } else { shear },
        ];
        let [dx, dy] = n.way;
        for (sum, v) in a.iter_mut().zip([dx * dx, dx * dy, dy * dy]) {
            *sum += v;
        }
        for i in 0..3 {
            b[0][i] += dx * (there[i] - here[i]);
            b[1][i] += dy * (there[i] - here[i]);
        }
    }
    let trace = a[0] + a[2];
    if !(trace > 0.0) {
        return None;
    }
    let (xx, xy, yy) = (a[0] + NO_SPREAD * trace, a[1], a[2] + NO_SPREAD * trace);
    let det = xx * yy - xy * xy;
    let solved = |i: usize| {
        (
            (yy * b[0][i] - xy * b[1][i]) / det,
            (xx * b[1][i] - xy * b[0][i]) / det,
        )
    };
    let s = [solved(0), solved(1), solved(2)];
    Some([s.map(|v| v.0), s.map(|v| v.1)])
}
