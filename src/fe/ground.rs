//! Springs and bushes that join grids to ground: their forces on the structure are reactions.

use super::constraint::{Reduction, State};
use super::error::FeError;
use super::grid_frames::{to_basic, to_local};
use super::prepared_model::PreparedModel;
use super::scalar_points::carry_to_grids;
use crate::model::{ElementRef, GridIx, Model};
use std::collections::BTreeMap;

/// Element that joins a grid to ground.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ground {
    /// A CELAS: its number, its end at the grid, and the scalar point at the other end, if any.
    Spring(usize, usize, Option<GridIx>),
    /// A CBUSH without GB.
    Bush(usize),
}

/// Returns whether each grid is a scalar point that is grounded by a constraint, a spring, or a chain of springs over other scalar points.
pub(super) fn grounded_points(model: &Model, reduction: &Reduction) -> Vec<bool> {
    let state = |g: GridIx| reduction.state[6 * g.us()];
    let point =
        |g: GridIx| model.grids[g.us()].is_scalar() && !matches!(state(g), State::Dependent(_));
    let mut grounded = vec![false; model.grids.len()];
    let mut next: Vec<GridIx> = Vec::new();
    let mut links: BTreeMap<GridIx, Vec<GridIx>> = BTreeMap::new();
    for s in model.springs.iter().filter(|s| s.k != 0.0) {
        match s.ends {
            [Some((g, _)), None] | [None, Some((g, _))] if point(g) => next.push(g),
            [Some((a, _)), Some((b, _))] if point(a) && point(b) => {
                links.entry(a).or_default().push(b);
                links.entry(b).or_default().push(a);
            }
            _ => {}
        }
    }
    let all = (0..model.grids.len() as u32).map(GridIx);
    next.extend(all.filter(|g| point(*g) && state(*g) == State::Held));
    while let Some(g) = next.pop() {
        if !std::mem::replace(&mut grounded[g.us()], true) {
            next.extend(links.get(&g).into_iter().flatten());
        }
    }
    grounded
}

/// Returns every spring and bush to ground. For springs between grids and a grounded scalar point, this point is ground.
pub(super) fn grounds(model: &Model, reduction: &Reduction) -> Vec<Ground> {
    let scalar = |g: GridIx| model.grids[g.us()].is_scalar();
    let state = |g: GridIx| reduction.state[6 * g.us()];
    let grounded = grounded_points(model, reduction);
    let is_ground = |g: GridIx| grounded[g.us()];
    let mut all = Vec::new();
    for (i, s) in model.springs.iter().enumerate() {
        if s.k == 0.0 {
            continue;
        }
        // A free scalar point counts at the grids of its other springs. A dependent scalar point transfers the spring's force to its grids.
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

/// Returns held grids that only springs and bushes join to the structure. They represent ground and are not part of the moving structure.
pub(super) fn anchors(model: &Model, reduction: &Reduction) -> Vec<bool> {
    if model.springs.is_empty() && model.bushes.is_empty() {
        return vec![false; model.grids.len()];
    }
    let held = |g: usize, i: usize| reduction.state[6 * g + i] == State::Held;
    let mut anchors: Vec<bool> = (0..model.grids.len())
        .map(|g| !model.grids[g].is_scalar() && (0..6).any(|i| held(g, i)))
        .collect();
    for element in model.elements() {
        let springs_alone = |g: &GridIx| match element {
            ElementRef::Spring(_) => true,
            ElementRef::Bush(_) => (0..6).all(|i| held(g.us(), i)),
            _ => false,
        };
        for g in model.element_grids(element) {
            anchors[g.us()] &= springs_alone(&g);
        }
    }
    for row in &reduction.rows {
        for (dof, _) in &row.held {
            anchors[(*dof / 6) as usize] = false;
        }
    }
    anchors
}

/// Returns the springs and bushes between the structure and an anchor.
pub(super) fn to_anchors(model: &Model, reduction: &Reduction) -> Vec<Ground> {
    let anchors = anchors(model, reduction);
    let is_anchor = |g: GridIx| anchors[g.us()];
    let mut all = Vec::new();
    for (i, s) in model.springs.iter().enumerate().filter(|s| s.1.k != 0.0) {
        let [Some((a, a_dof)), Some((b, b_dof))] = s.ends else {
            continue;
        };
        let held = |g: GridIx, dof: u8| {
            is_anchor(g) && reduction.state[6 * g.us() + usize::from(dof).min(5)] == State::Held
        };
        match (held(a, a_dof), held(b, b_dof)) {
            (false, true) => all.push(Ground::Spring(i, 0, None)),
            (true, false) => all.push(Ground::Spring(i, 1, None)),
            _ => {}
        }
    }
    let bushes = model.bushes.iter().enumerate();
    let bushes = bushes.filter(|(_, b)| {
        b.grids
            .1
            .is_some_and(|g| is_anchor(g) != is_anchor(b.grids.0))
    });
    all.extend(bushes.map(|(i, _)| Ground::Bush(i)));
    all
}

/// Returns the forces that the springs and bushes to ground apply to the grids under given displacements, basic frame.
///
/// # Errors
/// Elements that can't be formed.
pub(super) fn ground_forces(
    prepared: &PreparedModel<'_>,
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
