//! Loads that can't do what their case means: nothing, straight into a support, more than numbers hold.

use super::UnitLoad;
use super::constraint::Reduction;
use super::constraint::State;
use super::error::FeError;
use super::grid_frames::to_local;
use super::load_case::LoadCase;
use super::mass::MassProperties;
use crate::finding::{Finding, Severity};
use crate::model::{Load, Mat3, Model, Vec3};

/// Numbers beyond this can't be written to result files, which hold single precision.
const LARGEST: f64 = f32::MAX as f64;
/// Forces below this share of the point loads of a case count as rounding.
const ROUNDING: f64 = 1e-9;

/// # Errors
/// Numbers of a case that are infinite, not numbers, or larger than result files hold.
pub(super) fn check_finite(
    subcase: u32,
    what: &'static str,
    values: impl IntoIterator<Item = f64>,
) -> Result<(), FeError> {
    let fits = |v: f64| v.abs() <= LARGEST;
    match values.into_iter().all(fits) {
        true => Ok(()),
        false => Err(FeError::Overflow { subcase, what }),
    }
}

/// Returns a finding if no load acts in a case. `f` contains the forces at grids.
pub(super) fn nothing_acts(
    model: &Model,
    case: &LoadCase,
    f: &[[f64; 6]],
    mass: Option<&MassProperties>,
) -> Option<Finding> {
    let enforced = super::applied_loads::enforced_of(model, case);
    let moved = enforced.iter().any(|e| e.2 != 0.0) || spc_moves(model, case.spc);
    if moved || f.iter().flatten().any(|v| *v != 0.0) {
        return None;
    }
    let on_mass = |l: &(f64, Load)| {
        matches!(
            l.1,
            Load::Gravity(_) | Load::Acceleration { .. } | Load::Spin { .. }
        )
    };
    let gravity = sets_of(model, case).any(on_mass);
    let (message, remedy) = match gravity && mass.is_none() {
        true => (
            "GRAV, ACCEL, ACCEL1 and RFORCE act on mass, and the model has none where they act: displacement and strain are zero",
            "give the materials a density (RHO on MAT1), or add CONM2",
        ),
        false => (
            "nothing acts in this load case: displacement and strain are zero",
            "give the case a load, or delete it",
        ),
    };
    Some(Finding::new(
        Severity::Warning,
        "no-load",
        format!("subcase {}", case.subcase),
        message,
        remedy,
    ))
}

fn spc_moves(model: &Model, spc: Option<u32>) -> bool {
    let sets = model.spcs.iter().filter(|s| Some(s.sid) == spc);
    sets.flat_map(|s| &s.terms).any(|t| t.2 != 0.0)
}

fn sets_of<'a>(
    model: &'a Model,
    case: &'a LoadCase,
) -> impl Iterator<Item = &'a (f64, Load)> + use<'a> {
    case.loads
        .iter()
        .filter_map(|l| match l {
            UnitLoad::Set(sid) => Some(*sid),
            _ => None,
        })
        .flat_map(|sid| model.load_sets.iter().filter(move |s| s.sid == sid))
        .flat_map(|s| &s.loads)
}

/// Forces and moments at single grids of a case, basic frame.
fn point_loads(model: &Model, case: &LoadCase) -> Vec<[f64; 6]> {
    let mut f = vec![[0.0; 6]; model.grids.len()];
    let mut add = |g: usize, first: usize, v: &Vec3| {
        if let Some(f) = f.get_mut(g) {
            (0..3).for_each(|i| f[first + i] += v[i]);
        }
    };
    for load in &case.loads {
        if let UnitLoad::AtGrid {
            grid,
            force,
            moment,
        } = load
        {
            add(grid.us(), 0, force);
            add(grid.us(), 3, moment);
        }
    }
    for (factor, load) in sets_of(model, case) {
        match load {
            Load::Force(g, v) => add(g.us(), 0, &(v * *factor)),
            Load::Moment(g, v) => add(g.us(), 3, &(v * *factor)),
            _ => {}
        }
    }
    f
}

/// Rigid motions of a free structure.
const RIGID_MOTIONS: usize = 6;
/// Share of the loads up to which their sum counts as nothing: decks state loads with six to eight digits.
const EQUAL: f64 = 1e-6;

/// Whether point loads (basic frame) are in equilibrium with each other: supports that hold no more than the rigid motions then react with nothing.
fn are_balanced(model: &Model, loads: &[[f64; 6]]) -> bool {
    let (mut sum, mut size) = ([Vec3::zeros(); 2], [0.0; 2]);
    for (grid, f) in model.grids.iter().zip(loads) {
        let [force, moment] = [0, 3].map(|k| Vec3::new(f[k], f[k + 1], f[k + 2]));
        let lever = grid.x.cross(&force);
        sum = [sum[0] + force, sum[1] + lever + moment];
        size = [
            size[0] + force.norm(),
            size[1] + lever.norm() + moment.norm(),
        ];
    }
    sum.iter()
        .zip(size)
        .all(|(s, size)| s.norm() <= EQUAL * size)
}

/// Returns a finding if a part of a point load goes directly into a support. Supports are stiff, so this part causes no strain.
///
/// Measured: the share of the forces of point loads that supports take directly. Without forces, it is the share of the moments.
pub(super) fn load_into_support(
    model: &Model,
    axes: &[Option<Mat3>],
    reduction: &Reduction,
    case: &LoadCase,
) -> Option<Finding> {
    let mut f = point_loads(model, case);
    let held = reduction.state.iter().filter(|s| **s == State::Held);
    if held.count() <= RIGID_MOTIONS && are_balanced(model, &f) {
        return None;
    }
    for (f, axes) in f.iter_mut().zip(axes) {
        *f = to_local(axes, *f);
    }
    let held = reduction.onto_held(&f);
    let size = |field: &[[f64; 6]], dofs: std::ops::Range<usize>| -> f64 {
        let all = field.iter().flat_map(|v| &v[dofs.clone()]);
        all.map(|v| v.abs()).sum()
    };
    let shares = [0..3, 3..6].map(|dofs| {
        let (taken, all) = (size(&held, dofs.clone()), size(&f, dofs.clone()));
        (taken > ROUNDING * all && all > 0.0).then(|| (taken / all, dofs))
    });
    let (share, dofs) = shares.into_iter().flatten().next()?;
    let (grid, dof) = held
        .iter()
        .enumerate()
        .flat_map(|(g, v)| dofs.clone().map(move |i| (v[i].abs(), g, i)))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, g, i)| (g, i))?;
    let id = model.grids.get(grid).map_or(0, |g| g.id);
    Some(
        Finding::new(
            Severity::Warning,
            "load-into-support",
            format!("subcase {}", case.subcase),
            format!(
                "{:.0} % of the load goes straight into the support at grid {id}, dof {}: this share strains no element, and gauges cannot \
                 measure it",
                100.0 * share.min(1.0),
                dof + 1
            ),
            "move the load or the support; a real support is elastic (a spring CELAS or CBUSH), an SPC is not",
        )
        .with_numbers(share, 0.0),
    )
}
