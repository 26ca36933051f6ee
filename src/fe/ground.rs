//! Springs and bushes that join grids to ground: what they put onto the structure is a reaction.

use super::constraint::{Reduction, State};
use super::error::FeError;
use super::grid_frames::{to_basic, to_local};
use super::prepared::Prepared;
use super::scalar_points::carry_to_grids;
use crate::model::{ElementRef, GridIx, Model};

/// What joins a grid to ground.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ground {
    /// A CELAS: its number, which end is at the grid, and the scalar point at the other one, if any.
    Spring(usize, usize, Option<GridIx>),
    /// A CBUSH without GB.
    Bush(usize),
}

/// All of them. A scalar point that a constraint or a spring of its own holds to ground is ground to the springs between it and grids.
pub(super) fn grounds(model: &Model, reduction: &Reduction) -> Vec<Ground> {
    let scalar = |g: GridIx| model.grids[g.us()].is_scalar();
    let mut anchored = vec![false; model.grids.len()];
    for s in model.springs.iter().filter(|s| s.k != 0.0) {
        if let [Some((g, _)), None] | [None, Some((g, _))] = s.ends {
            anchored[g.us()] = true;
        }
    }
    let state = |g: GridIx| reduction.state[6 * g.us()];
    let is_ground = |g: GridIx| {
        scalar(g) && (state(g) == State::Held || (state(g) == State::Free && anchored[g.us()]))
    };
    let mut all = Vec::new();
    for (i, s) in model.springs.iter().enumerate() {
        if s.k == 0.0 {
            continue;
        }
        // A free scalar point counts where its other springs meet grids; one that follows grids hands on to these.
        let counts = |g: GridIx| !scalar(g) || matches!(state(g), State::Dependent(_));
        match s.ends {
            [Some((g, _)), None] if counts(g) => all.push(Ground::Spring(i, 0, None)),
            [None, Some((g, _))] if counts(g) => all.push(Ground::Spring(i, 1, None)),
            [Some((a, _)), Some((b, _))] if counts(a) && is_ground(b) => {
                all.push(Ground::Spring(i, 0, Some(b)));
            }
            [Some((a, _)), Some((b, _))] if counts(b) && is_ground(a) => {
                all.push(Ground::Spring(i, 1, Some(a)));
            }
            _ => {}
        }
    }
    let bushes = model.bushes.iter().enumerate();
    let bushes = bushes.filter(|(_, b)| b.grids.1.is_none() && b.k.iter().any(|k| *k != 0.0));
    all.extend(bushes.map(|(i, _)| Ground::Bush(i)));
    all
}

/// The forces that these put onto the grids, basic frame, of displacements in the same.
///
/// # Errors
/// Elements that can't be formed.
pub(super) fn ground_forces(
    prepared: &Prepared<'_>,
    reduction: &Reduction,
    grounds: &[Ground],
    u: &[[f64; 6]],
) -> Result<Vec<[f64; 6]>, FeError> {
    let model = prepared.model;
    let mut field = vec![[0.0; 6]; u.len()];
    for ground in grounds {
        match *ground {
            Ground::Spring(i, end, point) => {
                let spring = &model.springs[i];
                let Some((g, dof)) = spring.ends[end] else {
                    continue;
                };
                let (g, dof) = (g.us(), usize::from(dof).min(5));
                let other = point.map_or(0.0, |p| u[p.us()][0]);
                let mut local = [0.0; 6];
                local[dof] = spring.k * (other - to_local(&prepared.axes[g], u[g])[dof]);
                let force = to_basic(&prepared.axes[g], local);
                field[g].iter_mut().zip(force).for_each(|(f, v)| *f += v);
            }
            Ground::Bush(i) => {
                let k = prepared
                    .stiffness(ElementRef::Bush(i))
                    .map_err(|r| FeError::Refused(vec![r]))?;
                let g = model.bushes[i].grids.0.us();
                let force = k.times(&u[g]);
                field[g].iter_mut().zip(force).for_each(|(f, v)| *f -= v);
            }
        }
    }
    carry_to_grids(prepared, reduction, &mut field);
    Ok(field)
}
