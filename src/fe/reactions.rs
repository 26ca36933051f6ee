//! Reactions: what supports put onto the structure.

use super::error::FeError;
use super::grid_frames::{to_basic, to_local};
use super::mass::resultant;
use super::prepared::Prepared;
use super::system::System;
use crate::model::{Model, Vec3};
use rayon::prelude::*;
use serde::Serialize;

/// Elements a task: sums over tasks are taken in their order, so that threads change nothing.
const CHUNK: usize = 1024;
/// Reactions below this share of the largest one are rounding and left out of the list.
const ROUNDING: f64 = 1e-12;

/// Force and moment that the supports put onto one grid, basic frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reaction {
    /// Grid id.
    pub grid: u32,
    /// Three forces, three moments; zero along dofs that no support holds.
    pub force: [f64; 6],
}

/// Reactions of a load case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reactions {
    /// Subcase id.
    pub subcase: u32,
    /// Resultant of what acts on grids (inertia included where it balances), about the basic origin: three forces, three moments.
    pub applied: [f64; 6],
    /// Resultant of the reactions about the same point: the applied one with its sign turned.
    pub total: [f64; 6],
    /// Largest share of the applied forces, or moments, that the reactions leave unbalanced.
    pub residual: f64,
    /// By grid, ascending.
    pub grids: Vec<Reaction>,
}

/// Reactions of solved cases: K u - f at held dofs, what dependent dofs hand on included; empty where nothing is held.
///
/// `displacements` and `forces` (what acts, without reactions) by grid in the basic frame, one each a case.
///
/// # Errors
/// Elements that can't be formed.
pub(super) fn reactions(
    prepared: &Prepared<'_>,
    system: &System,
    cases: &[u32],
    displacements: &[Vec<[f64; 6]>],
    forces: &[Vec<[f64; 6]>],
) -> Result<Vec<Reactions>, FeError> {
    let model = prepared.model;
    let reduction = &system.reduction;
    let holds: Vec<bool> = (0..model.grids.len())
        .map(|g| (0..6).any(|i| reduction.reaches_support(6 * g + i)))
        .collect();
    if !holds.contains(&true) {
        return Ok(Vec::new());
    }
    let internal = internal_forces(prepared, displacements, &holds)?;
    let x: Vec<Vec3> = model.grids.iter().map(|g| g.x).collect();
    let of_case = |(case, (f, internal)): (&u32, (&Vec<[f64; 6]>, Vec<[f64; 6]>))| {
        let mut left = internal;
        for (((left, f), axes), holds) in left.iter_mut().zip(f).zip(&prepared.axes).zip(&holds) {
            *left = match holds {
                true => to_local(axes, std::array::from_fn(|i| left[i] - f[i])),
                false => [0.0; 6],
            };
        }
        let mut held = reduction.onto_held(&left);
        for (v, axes) in held.iter_mut().zip(&prepared.axes) {
            *v = to_basic(axes, *v);
        }
        let origin = Vec3::zeros();
        let largest = super::applied::largest(&held);
        let (acts, holds) = (without_points(model, f), without_points(model, &held));
        let (applied, total) = (
            resultant(&x, &acts, &origin),
            resultant(&x, &holds, &origin),
        );
        Reactions {
            subcase: *case,
            applied,
            total,
            residual: unbalanced(&x, &acts, &holds, &applied, &total),
            grids: model
                .grids
                .iter()
                .zip(held)
                .filter(|(_, v)| v.iter().any(|v| v.abs() > ROUNDING * largest))
                .map(|(g, force)| Reaction { grid: g.id, force })
                .collect(),
        }
    };
    Ok(cases
        .iter()
        .zip(forces.iter().zip(internal))
        .map(of_case)
        .collect())
}

/// A field without what stands at scalar points: a bimoment there is no force.
fn without_points(model: &Model, field: &[[f64; 6]]) -> Vec<[f64; 6]> {
    let pairs = model.grids.iter().zip(field);
    pairs
        .map(|(g, v)| if g.is_scalar() { [0.0; 6] } else { *v })
        .collect()
}

/// K u of the elements at the grids marked, basic frame, one field a case.
fn internal_forces(
    prepared: &Prepared<'_>,
    displacements: &[Vec<[f64; 6]>],
    marked: &[bool],
) -> Result<Vec<Vec<[f64; 6]>>, FeError> {
    let elements: Vec<_> = prepared
        .elements()
        .into_iter()
        .filter(|e| prepared.grids(*e).iter().any(|g| marked[g.us()]))
        .collect();
    // By element: its grids and, case by case, six forces a grid.
    let parts: Vec<Vec<_>> = elements
        .par_chunks(CHUNK)
        .map(|chunk| {
            chunk
                .iter()
                .map(|element| {
                    let k = prepared
                        .stiffness(*element)
                        .map_err(|r| FeError::Refused(vec![r]))?;
                    let forces: Vec<Vec<f64>> = displacements
                        .iter()
                        .map(|u| {
                            let own: Vec<f64> = k.grids.iter().flat_map(|g| u[g.us()]).collect();
                            k.times(&own)
                        })
                        .collect();
                    Ok((k.grids, forces))
                })
                .collect::<Result<_, FeError>>()
        })
        .collect::<Result<_, FeError>>()?;
    let mut out = vec![vec![[0.0; 6]; marked.len()]; displacements.len()];
    for (grids, forces) in parts.iter().flatten() {
        for (field, forces) in out.iter_mut().zip(forces) {
            for (g, v) in grids.iter().zip(forces.chunks_exact(6)) {
                field[g.us()].iter_mut().zip(v).for_each(|(f, v)| *f += v);
            }
        }
    }
    Ok(out)
}

/// What the sum of loads and reactions leaves, as a share of the sizes that were summed: forces and moments each by their own.
fn unbalanced(
    x: &[Vec3],
    applied: &[[f64; 6]],
    held: &[[f64; 6]],
    total_applied: &[f64; 6],
    total_held: &[f64; 6],
) -> f64 {
    let (mut force, mut moment) = (0.0, 0.0);
    for (x, v) in x.iter().zip(applied).chain(x.iter().zip(held)) {
        let f = Vec3::new(v[0], v[1], v[2]);
        force += f.norm();
        moment += x.cross(&f).norm() + Vec3::new(v[3], v[4], v[5]).norm();
    }
    let left = |range: std::ops::Range<usize>| {
        range
            .map(|i| (total_applied[i] + total_held[i]).abs())
            .fold(0.0, f64::max)
    };
    let share = |left: f64, size: f64| if size > 0.0 { left / size } else { 0.0 };
    share(left(0..3), force).max(share(left(3..6), moment))
}
