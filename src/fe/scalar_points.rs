//! Scalar points: they have no place, so what acts there counts at the grids that they follow, or as no force at all.

use super::constraint::{Reduction, State};
use super::error::{FeError, Refusal};
use super::grid_frames::{to_basic, to_local};
use super::prepared_model::PreparedModel;
use crate::model::{Grid, Model};

/// Returns whether each grid is a warping point of a beam. No rigid motion moves a warping point, and a load on it is a bimoment.
fn warping_points(model: &Model) -> Vec<bool> {
    let mut warps = vec![false; model.grids.len()];
    for g in model.beams.iter().filter_map(|b| b.warping).flatten() {
        warps[g.us()] = true;
    }
    warps
}

/// Moves loads on scalar points that depend on grids (MPC) to these grids by virtual work, basic frame.
///
/// With u = sum of c_j u_j, the load moves as f_j += c_j f.
pub(super) fn carry_to_grids(
    prepared: &PreparedModel<'_>,
    reduction: &Reduction,
    field: &mut [[f64; 6]],
) {
    for (g, grid) in prepared.model.grids.iter().enumerate() {
        let State::Dependent(r) = reduction.state[6 * g] else {
            continue;
        };
        let v = field[g][0];
        if !grid.is_scalar() || v == 0.0 {
            continue;
        }
        field[g][0] = 0.0;
        let row = &reduction.rows[r as usize];
        for (dof, c) in row.free.iter().chain(&row.held) {
            let to = (*dof / 6) as usize;
            let mut local = [0.0; 6];
            local[(*dof % 6) as usize] = c * v;
            let carried = to_basic(&prepared.axes[to], local);
            field[to].iter_mut().zip(carried).for_each(|(f, v)| *f += v);
        }
    }
}

/// Sets the displacement of each scalar point that depends on grids, from the displacement of these grids (basic frame).
pub(super) fn follow_grids(
    prepared: &PreparedModel<'_>,
    reduction: &Reduction,
    u: &mut [[f64; 6]],
) {
    for (g, grid) in prepared.model.grids.iter().enumerate() {
        let State::Dependent(r) = reduction.state[6 * g] else {
            continue;
        };
        if !grid.is_scalar() {
            continue;
        }
        let row = &reduction.rows[r as usize];
        let of = |(dof, c): &(u32, f64)| {
            let from = (*dof / 6) as usize;
            c * to_local(&prepared.axes[from], u[from])[(*dof % 6) as usize]
        };
        u[g][0] = row.constant + row.free.iter().map(of).sum::<f64>();
    }
}

/// Checks that no load acts on an independent scalar point of a free structure. Inertia can't balance such a load, because the path of its force into
/// the body is unknown. `field` is the result of [`carry_to_grids`].
///
/// # Errors
/// The load on such a point, with the point.
pub(super) fn check_free_points(
    model: &Model,
    reduction: &Reduction,
    subcase: u32,
    field: &[[f64; 6]],
) -> Result<(), FeError> {
    let loaded = |(g, grid): &(usize, &Grid)| {
        grid.is_scalar() && field[*g][0] != 0.0 && reduction.state[6 * g] == State::Free
    };
    let mut loaded = model.grids.iter().enumerate().filter(loaded).peekable();
    if loaded.peek().is_none() {
        return Ok(());
    }
    let warps = warping_points(model);
    let refused: Vec<Refusal> = loaded
        .filter(|(g, _)| !warps[*g])
        .map(|(_, grid)| Refusal {
            card: format!("SPOINT {}", grid.id),
            at: grid.at,
            reason: format!(
                "subcase {subcase} loads this scalar point of a free structure: where its force acts on the body is not stated"
            ),
            remedy: "load the grid that the point stands for, let the point follow grids (first term of an MPC), or hold the structure".to_owned(),
        })
        .collect();
    match refused.is_empty() {
        true => Ok(()),
        false => Err(FeError::Refused(refused)),
    }
}
