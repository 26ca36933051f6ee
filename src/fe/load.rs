//! Nodal forces of loads.

use super::element::beam::beam_end_forces;
use super::element::shell::{linear_part, many_grids, over_face};
use super::error::Refusal;
use super::mass::{Mass, add_acceleration};
use crate::model::{Direction, GridIx, Load, LoadSet, Model, Vec3, solid_edges};
use std::collections::HashMap;

/// Returns forces and moments of one load set at all grids, basic frame.
///
/// # Errors
/// A load along a beam that can't be formed.
pub(super) fn load_vector(
    model: &Model,
    mass: &Mass,
    set: &LoadSet,
) -> Result<Vec<[f64; 6]>, Refusal> {
    let mut f = vec![[0.0; 6]; model.grids.len()];
    let on_faces = |l: &(f64, Load)| matches!(l.1, Load::FacePressure { .. });
    let mids = if set.loads.iter().any(on_faces) {
        mid_sides(model)
    } else {
        HashMap::new()
    };
    for (factor, load) in &set.loads {
        add(model, mass, &mids, *factor, load, &mut f)?;
    }
    Ok(f)
}

fn push(f: &mut [[f64; 6]], grid: GridIx, at: usize, v: &Vec3) {
    for i in 0..3 {
        f[grid.us()][at + i] += v[i];
    }
}

fn push_all(f: &mut [[f64; 6]], factor: f64, more: &[[f64; 6]]) {
    for (f, m) in f.iter_mut().zip(more) {
        f.iter_mut().zip(m).for_each(|(f, m)| *f += factor * m);
    }
}

fn add(
    model: &Model,
    mass: &Mass,
    mids: &HashMap<(GridIx, GridIx), GridIx>,
    factor: f64,
    load: &Load,
    f: &mut [[f64; 6]],
) -> Result<(), Refusal> {
    match load {
        Load::Force(g, v) => push(f, *g, 0, &(v * factor)),
        Load::Moment(g, v) => push(f, *g, 3, &(v * factor)),
        Load::ShellPressure {
            shells,
            pressure,
            direction,
        } => {
            for s in shells {
                let shell = &model.shells[s.us()];
                let n = shell.shape.n_corners();
                if shell.shape.n_grids() > n {
                    let (grids, sides) = many_grids(shell);
                    let face = (n, grids.as_slice(), sides.as_slice());
                    pressure_on_curved(model, face, pressure, direction, factor, f);
                    continue;
                }
                pressure_on(
                    model,
                    &shell.grids[..shell.shape.n_corners()],
                    pressure,
                    direction,
                    factor,
                    f,
                );
            }
        }
        Load::FacePressure {
            grids,
            pressure,
            direction,
        } => {
            let mut grids: Vec<GridIx> = grids.iter().flatten().copied().collect();
            let n = grids.len();
            let mut sides = Vec::new();
            for side in 0..n {
                let (a, b) = (grids[side], grids[(side + 1) % n]);
                if let Some(mid) = mids.get(&(a.min(b), a.max(b))) {
                    sides.push(side);
                    grids.push(*mid);
                }
            }
            if sides.is_empty() {
                pressure_on(model, &grids, pressure, direction, factor, f);
            } else {
                let face = (n, grids.as_slice(), sides.as_slice());
                pressure_on_curved(model, face, pressure, direction, factor, f);
            }
        }
        Load::Gravity(_) | Load::Acceleration { .. } | Load::Spin { .. } => {
            let mut field = vec![[0.0; 6]; model.grids.len()];
            add_acceleration(model, factor, load, &mut field);
            push_all(f, 1.0, &mass.on_grids(&field));
            if let Load::Spin { omega, .. } = load {
                mass.add_off_grids(factor, omega, f);
            }
        }
        Load::Line { beam, .. } => {
            let interior = super::line_load::as_line_load(load);
            for (g, v) in beam_end_forces(model, beam.us(), &interior)? {
                f[g.us()]
                    .iter_mut()
                    .zip(v)
                    .for_each(|(f, v)| *f += factor * v);
            }
        }
        Load::Enforced { .. } | Load::Unsupported(..) => {}
    }
    Ok(())
}

/// Consistent forces of a pressure over a triangle or a quadrilateral: integral of shape function, pressure and area vector.
fn pressure_on(
    model: &Model,
    corners: &[GridIx],
    pressure: &[f64; 4],
    direction: &Option<Direction>,
    factor: f64,
    f: &mut [[f64; 6]],
) {
    let x: Vec<Vec3> = corners.iter().map(|g| model.grids[g.us()].x).collect();
    let mut at_point = |h: &[f64], area: Vec3| {
        let p: f64 = h.iter().zip(pressure).map(|(h, p)| h * p).sum::<f64>() * factor;
        let here = || x.iter().zip(h).map(|(x, h)| x * *h).sum::<Vec3>();
        let along = direction.map_or(area, |d| d.vector_at(model, here()) * area.norm());
        for (g, h) in corners.iter().zip(h) {
            push(f, *g, 0, &(along * (p * h)));
        }
    };
    match x.as_slice() {
        [a, b, c] => {
            let area = (b - a).cross(&(c - a)) / 6.0;
            for h in [[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]] {
                at_point(&h, area);
            }
        }
        [a, b, c, d] => {
            let g = 1.0 / 3.0_f64.sqrt();
            for (r, s) in [(-g, -g), (g, -g), (g, g), (-g, g)] {
                let h = [
                    (1.0 - r) * (1.0 - s),
                    (1.0 + r) * (1.0 - s),
                    (1.0 + r) * (1.0 + s),
                    (1.0 - r) * (1.0 + s),
                ];
                let xr = (b - a) * (1.0 - s) + (c - d) * (1.0 + s);
                let xs = (d - a) * (1.0 - r) + (c - b) * (1.0 + r);
                at_point(&h.map(|h| h / 4.0), xr.cross(&xs) / 16.0);
            }
        }
        _ => {}
    }
}

/// Adds the forces of a pressure on a face with mid-side grids, each with the number of its side. The corners' functions interpolate corner
/// pressures; the functions of all grids distribute forces.
fn pressure_on_curved(
    model: &Model,
    (n, grids, sides): (usize, &[GridIx], &[usize]),
    pressure: &[f64; 4],
    direction: &Option<Direction>,
    factor: f64,
    f: &mut [[f64; 6]],
) {
    let x: Vec<Vec3> = grids.iter().map(|g| model.grids[g.us()].x).collect();
    over_face(n, &x, sides, |functions, area| {
        let p: f64 = (0..n)
            .map(|c| linear_part(n, functions, sides, c) * pressure[c])
            .sum::<f64>()
            * factor;
        let here = || x.iter().zip(functions).map(|(x, h)| x * h[0]).sum::<Vec3>();
        let along = direction.map_or(area, |d| d.vector_at(model, here()) * area.norm());
        for (g, h) in grids.iter().zip(functions) {
            push(f, *g, 0, &(along * (p * h[0])));
        }
    });
}

/// Mid-side grids of solids by the corners of their edges, smaller index first.
fn mid_sides(model: &Model) -> HashMap<(GridIx, GridIx), GridIx> {
    let mut all = HashMap::new();
    for s in &model.solids {
        let n = s.shape.n_corners();
        for ((a, b), mid) in solid_edges(s.shape).iter().zip(&s.grids[n..]) {
            if let (Some(a), Some(b), Some(mid)) = (s.grids[*a], s.grids[*b], mid) {
                all.insert((a.min(b), a.max(b)), *mid);
            }
        }
    }
    all
}
