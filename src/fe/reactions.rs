//! Reactions: what supports put onto the structure.

use super::constraint::Reduction;
use super::error::FeError;
use super::grid_frames::{to_basic, to_local};
use super::ground::{ground_forces, grounded_points, grounds};
use super::hanging_points::find_hanging_points;
use super::mass::resultant;
use super::prepared_model::PreparedModel;
use super::reaction_balance::{LoadImbalance, check_balance};
use super::system::System;
use crate::finding::Finding;
use crate::model::{ElementRef, Model, Vec3};
use rayon::prelude::*;
use serde::Serialize;

/// Elements a task: sums over tasks are taken in their order, so that threads change nothing.
const CHUNK: usize = 1024;
/// Reactions below this share of the largest one are rounding and left out of the list.
const ROUNDING: f64 = 1e-12;

/// Force and moment that supports and springs to ground apply to one grid, basic frame.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reaction {
    /// Grid id.
    pub grid: u32,
    /// Three forces and three moments. Dofs that neither a support nor a spring to ground holds have zeros.
    pub force: [f64; 6],
}

/// Reactions of a load case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Reactions {
    /// Subcase id.
    pub subcase: u32,
    /// Resultant of the forces on grids about the basic origin: three forces, three moments. It includes the inertia forces that balance the loads.
    pub applied: [f64; 6],
    /// Resultant of the reactions about the basic origin: minus `applied`, except for `residual`.
    pub total: [f64; 6],
    /// Largest share of the applied forces, or moments, that the reactions leave unbalanced.
    pub residual: f64,
    /// Reactions by grid, ascending, without scalar points. The force on a held scalar point counts at the grids of its springs. A bimoment is not a
    /// force.
    pub grids: Vec<Reaction>,
}

/// A solved case: subcase id, displacements, and forces without reactions. Scalar points that follow grids have no forces. Fields are by grid in the
/// basic frame.
pub(super) type SolvedCase<'a> = (u32, &'a [[f64; 6]], &'a [[f64; 6]]);

/// Computes the reactions of solved cases: K u - f at held dofs, and the forces of springs to ground. K u - f includes the forces that dependent dofs
/// transfer. Reactions that leave loads unbalanced have a finding. Empty if nothing is held. `mpc` states whether equations of an MPC set are active.
///
/// # Errors
/// Elements that can't be formed.
pub(super) fn reactions(
    prepared: &PreparedModel<'_>,
    system: &System,
    cases: &[SolvedCase<'_>],
    mpc: bool,
) -> Result<Vec<(Reactions, Option<Finding>)>, FeError> {
    let model = prepared.model;
    let reduction = &system.reduction;
    let holds: Vec<bool> = (0..model.grids.len())
        .map(|g| (0..6).any(|i| reduction.reaches_support(6 * g + i)))
        .collect();
    let grounds = grounds(model, reduction);
    if grounds.is_empty() && !holds.contains(&true) {
        return Ok(Vec::new());
    }
    let elements: Vec<ElementRef> = model
        .elements()
        .filter(|e| model.element_grids(*e).iter().any(|g| holds[g.us()]))
        .collect();
    let internal = internal_forces(prepared, &elements, cases)?;
    let arriving = HangingPoints::from_cases(prepared, reduction, cases);
    let x: Vec<Vec3> = model.grids.iter().map(|g| g.x).collect();
    let of_case = |(case, internal): (&SolvedCase<'_>, Vec<[f64; 6]>)| {
        let (subcase, u, f) = *case;
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
        let of_ground = ground_forces(prepared, reduction, &grounds, u)?;
        for (v, ground) in held.iter_mut().zip(of_ground) {
            v.iter_mut().zip(ground).for_each(|(v, g)| *v += g);
        }
        let origin = Vec3::zeros();
        let (acts, held) = (without_points(model, f), without_points(model, &held));
        let largest = super::applied_loads::largest_component(&held);
        let (mut applied, total) = (resultant(&x, &acts, &origin), resultant(&x, &held, &origin));
        arriving.add(f, &mut applied);
        let left = LoadImbalance::from_forces(&x, &acts, &held, &applied, &total);
        let finding = check_balance(prepared, &elements, (subcase, mpc), &left, u)?;
        let reactions = Reactions {
            subcase,
            applied,
            total,
            residual: left.share(),
            grids: model
                .grids
                .iter()
                .zip(held)
                .filter(|(_, v)| v.iter().any(|v| v.abs() > ROUNDING * largest))
                .map(|(g, force)| Reaction { grid: g.id, force })
                .collect(),
        };
        Ok((reactions, finding))
    };
    cases.iter().zip(internal).map(of_case).collect()
}

/// Scalar points that springs connect to grids. Loads at these points count in the resultant, at the grids that the springs carry them to.
struct HangingPoints(Vec<(usize, [f64; 6])>);

impl HangingPoints {
    /// Returns the points of this model, or none if no case loads a scalar point. Forces of grounded points count as reactions.
    fn from_cases(
        prepared: &PreparedModel<'_>,
        reduction: &Reduction,
        cases: &[SolvedCase<'_>],
    ) -> Self {
        let model = prepared.model;
        let grids = || model.grids.iter().enumerate();
        let loaded =
            |(_, _, f): &SolvedCase<'_>| grids().any(|(g, p)| p.is_scalar() && f[g][0] != 0.0);
        if !cases.iter().any(loaded) {
            return Self(Vec::new());
        }
        let grounded = grounded_points(model, reduction);
        let mut points = find_hanging_points(model, &prepared.axes, reduction, &Vec3::zeros());
        points.retain(|(point, _)| !grounded[*point]);
        Self(points)
    }

    /// Adds the resultant of these loads about the basic origin, by virtual work of the rigid motions.
    fn add(&self, f: &[[f64; 6]], applied: &mut [f64; 6]) {
        for (point, by_motion) in &self.0 {
            let sums = applied.iter_mut().zip(by_motion);
            sums.for_each(|(sum, moved)| *sum += f[*point][0] * moved);
        }
    }
}

/// A field without the values of scalar points: a bimoment there is no force.
fn without_points(model: &Model, field: &[[f64; 6]]) -> Vec<[f64; 6]> {
    let pairs = model.grids.iter().zip(field);
    pairs
        .map(|(g, v)| if g.is_scalar() { [0.0; 6] } else { *v })
        .collect()
}

/// K u of these elements, basic frame, one field a case.
fn internal_forces(
    prepared: &PreparedModel<'_>,
    elements: &[ElementRef],
    cases: &[SolvedCase<'_>],
) -> Result<Vec<Vec<[f64; 6]>>, FeError> {
    // For each element: its grids, and for each case six forces per grid.
    let parts: Vec<Vec<_>> = elements
        .par_chunks(CHUNK)
        .map(|chunk| {
            chunk
                .iter()
                .map(|element| {
                    let k = prepared
                        .stiffness(*element)
                        .map_err(|r| FeError::Refused(vec![r]))?;
                    let forces: Vec<Vec<f64>> = cases
                        .iter()
                        .map(|(_, u, _)| {
                            let own: Vec<f64> = k.grids.iter().flat_map(|g| u[g.us()]).collect();
                            k.times(&own)
                        })
                        .collect();
                    Ok((k.grids, forces))
                })
                .collect::<Result<_, FeError>>()
        })
        .collect::<Result<_, FeError>>()?;
    let mut out = vec![vec![[0.0; 6]; prepared.model.grids.len()]; cases.len()];
    for (grids, forces) in parts.iter().flatten() {
        for (field, forces) in out.iter_mut().zip(forces) {
            for (g, v) in grids.iter().zip(forces.chunks_exact(6)) {
                field[g.us()].iter_mut().zip(v).for_each(|(f, v)| *f += v);
            }
        }
    }
    Ok(out)
}
