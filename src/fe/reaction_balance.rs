//! Whether the reactions balance what acts, and what it means where they don't.

use super::error::FeError;
use super::formulation::{gap_leaves_moment, held_off_axes};
use super::prepared_model::PreparedModel;
use crate::finding::{Finding, Severity};
use crate::model::{ElementRef, Model, Spring, Vec3};

/// Share of forces, or moments, that may be unbalanced: the share in a solution whose equations are satisfied to six digits.
const LIMIT: f64 = 1e-6;
/// Rounding of K u relative to the sum of |K| |u|: supports that all move equally strain nothing, and the remaining forces are rounding.
const ROUNDING: f64 = 1e-10;

/// Unbalanced sum of loads and reactions, and the sizes of the summands: forces, moments.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LoadImbalance {
    pub(super) left: [f64; 2],
    pub(super) size: [f64; 2],
}

impl LoadImbalance {
    /// Returns the unbalanced sum of `applied` and `held`, fields over grids at `x`, with these resultants.
    pub(super) fn from_forces(
        x: &[Vec3],
        applied: &[[f64; 6]],
        held: &[[f64; 6]],
        total_applied: &[f64; 6],
        total_held: &[f64; 6],
    ) -> Self {
        let mut size = [0.0; 2];
        for (x, v) in x.iter().zip(applied).chain(x.iter().zip(held)) {
            let f = Vec3::new(v[0], v[1], v[2]);
            size[0] += f.norm();
            size[1] += x.cross(&f).norm() + Vec3::new(v[3], v[4], v[5]).norm();
        }
        let left = [0..3, 3..6].map(|range| {
            range
                .map(|i| (total_applied[i] + total_held[i]).abs())
                .fold(0.0, f64::max)
        });
        Self { left, size }
    }

    /// Returns the larger share.
    pub(super) fn share(&self) -> f64 {
        let share = |i: usize| match self.size[i] > 0.0 {
            true => self.left[i] / self.size[i],
            false => 0.0,
        };
        share(0).max(share(1))
    }
}

/// Returns a finding if reactions do not balance the loads. `elements` are the elements at supports. `mpc` states whether equations of an MPC set
/// act.
///
/// # Errors
/// Elements that can't be formed.
pub(super) fn check_balance(
    prepared: &PreparedModel<'_>,
    elements: &[ElementRef],
    (subcase, mpc): (u32, bool),
    left: &LoadImbalance,
    u: &[[f64; 6]],
) -> Result<Option<Finding>, FeError> {
    let model = prepared.model;
    let share = left.share();
    if !(share > LIMIT) || is_reported_elsewhere(model) {
        return Ok(None);
    }
    let rounding = estimate_rounding(prepared, elements, u)?;
    if (0..2).all(|i| left.left[i] <= LIMIT * left.size[i] + rounding[i]) {
        return Ok(None);
    }
    let mut holds: Vec<String> = Vec::new();
    let askew = model.springs.iter().filter(|s| pushes_ground(prepared, s));
    holds.extend(askew.take(3).map(|s| format!("CELAS {}", s.id)));
    if mpc {
        holds.push("MPC equations".to_owned());
    }
    let (severity, message, remedy) = match holds.is_empty() {
        true => (
            Severity::Error,
            "the reactions do not balance the loads: a part of them is lost in the solution, and displacement and strain are wrong".to_owned(),
            "check for stiffnesses that differ by many powers of ten (make the stiffest rigid elements)",
        ),
        false => (
            Severity::Warning,
            format!(
                "the supports do not balance the loads alone: {} can hold the structure to ground as well, and their force is not among the reactions",
                holds.join(", ")
            ),
            "join springs to coincident grids in one direction, and check that the equations allow every rigid motion, if they are not supports",
        ),
    };
    Ok(Some(
        Finding::new(
            severity,
            "loads-unbalanced",
            format!("subcase {subcase}"),
            message,
            remedy,
        )
        .with_numbers(share, LIMIT),
    ))
}

/// Returns whether another finding on the model already reports what takes force or moment in addition to the supports.
fn is_reported_elsewhere(model: &Model) -> bool {
    model.joints.iter().any(gap_leaves_moment) || model.rigids.iter().any(held_off_axes)
}

/// Returns whether the forces of a spring between two points leave a force or moment: unlike directions, or not along the line between them.
fn pushes_ground(prepared: &PreparedModel<'_>, spring: &Spring) -> bool {
    let [Some((a, dof_a)), Some((b, dof_b))] = spring.ends else {
        return false;
    };
    let grids = &prepared.model.grids;
    let (ga, gb) = (&grids[a.us()], &grids[b.us()]);
    if ga.is_scalar() || gb.is_scalar() {
        return true;
    }
    let direction = |g: usize, dof: u8| {
        let mut unit = Vec3::zeros();
        unit[usize::from(dof % 3)] = 1.0;
        prepared.axes[g].map_or(unit, |axes| axes.tr_mul(&unit))
    };
    let (da, db) = (direction(a.us(), dof_a), direction(b.us(), dof_b));
    let line = gb.x - ga.x;
    let apart = dof_a < 3 && line.cross(&da).norm() > LIMIT * line.norm();
    dof_a / 3 != dof_b / 3 || (da - db).norm() > LIMIT || apart
}

/// Returns the unbalanced forces and moments that rounding may cause: [`ROUNDING`] of the sum of |K| |u| over elements.
fn estimate_rounding(
    prepared: &PreparedModel<'_>,
    elements: &[ElementRef],
    u: &[[f64; 6]],
) -> Result<[f64; 2], FeError> {
    let mut sum = [0.0; 2];
    for element in elements {
        let mut k = prepared
            .stiffness(*element)
            .map_err(|r| FeError::Refused(vec![r]))?;
        k.values.iter_mut().for_each(|v| *v = v.abs());
        let own: Vec<f64> = k
            .grids
            .iter()
            .flat_map(|g| u[g.us()].map(f64::abs))
            .collect();
        for (g, v) in k.grids.iter().zip(k.times(&own).chunks_exact(6)) {
            let force: f64 = v[..3].iter().sum();
            sum[0] += force;
            sum[1] += v[3..].iter().sum::<f64>() + prepared.model.grids[g.us()].x.norm() * force;
        }
    }
    Ok(sum.map(|v| v * ROUNDING))
}
