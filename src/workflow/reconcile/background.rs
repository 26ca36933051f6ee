//! Errors that are always present: position and angle of gauges, and the mesh.

use super::influence::influence;
use super::model_part::ModelPart;
use crate::fe::Solution;
use crate::gauge::{Gauge, strain_gradient_gauge};
use crate::job::Job;
use crate::model::Model;
use crate::reconcile::strain::Scatter;

/// Error of the angle of a gauge, 1 sd, if the job states no tolerance: a technician glues to half a degree. No error of the place is assumed. Near a
/// bracket a millimetre changes strain by several percent, and such a high floor hides all other effects.
const ANGLE_DEG: f64 = 0.5;
/// Remaining mesh error, 1 sd, over the change by halving the mesh. Where strain is smooth it is a third of the change (errors fall with the square
/// of the width). At a point load or a corner it is as large as the change.
const STILL_TO_COME: f64 = 1.0;
/// Remaining mesh error, 1 sd, over the change if the mesh was divided around the gauges only. In open rails this change is two thirds of the whole
/// change. Single coefficients have the error of [`ENTRY_SHARE`] in addition, as without a finer mesh.
const STILL_TO_COME_IN_PART: f64 = 1.5;
/// Share of the stated model uncertainty that single coefficients have in addition to the common factor, if no finer mesh was solved.
pub(super) const ENTRY_SHARE: f64 = 0.5;

/// A direction of a gauge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    Along,
    Across,
}

/// Returns the change of the influence matrix per mm of gauge movement; zero if the mesh does not determine it.
pub(super) fn gradients(
    job: &Job,
    model: &Model,
    gauges: &[Gauge],
    solution: &Solution,
    n_columns: usize,
    axis: Axis,
) -> Vec<f64> {
    let mm = 1e-3 / job.units.length_m();
    let mut out = Vec::with_capacity(gauges.len() * n_columns);
    for g in gauges {
        let direction = match axis {
            Axis::Along => g.direction,
            Axis::Across => g.normal.cross(&g.direction),
        };
        let row = strain_gradient_gauge(g, model, direction)
            .map(|m| influence(job, model, &[m], solution, n_columns))
            .filter(|row| row.iter().all(|v| v.is_finite()));
        match row {
            Some(row) => out.extend(row.iter().map(|v| v * mm)),
            None => out.extend(std::iter::repeat_n(0.0, n_columns)),
        }
    }
    out
}

/// Returns the errors of angle, place and mesh, one standard deviation each. `own` is the influence on the analyst's own mesh if a finer mesh was
/// solved, and whether that mesh is finer everywhere. `per_mm` contains the gradients along and across. A model that is stated to be exact has no
/// errors.
pub(super) fn background(
    job: &Job,
    part: &ModelPart,
    own: Option<(&Vec<f64>, bool)>,
    per_mm: [&Vec<f64>; 2],
) -> Vec<Scatter> {
    let model_rel = job
        .measured
        .as_ref()
        .map_or(0.0, |m| m.model_uncertainty_rel);
    if model_rel == 0.0 {
        return Vec::new();
    }
    let reconcile = job.reconcile.as_ref();
    let placement = Some(job.placement.angle_tolerance_deg).filter(|a| *a > 0.0);
    let angle = reconcile.and_then(|r| r.angle_tolerance_deg).or(placement);
    let angle = angle.unwrap_or(ANGLE_DEG).to_radians();
    let place = reconcile
        .and_then(|r| r.position_tolerance_mm)
        .unwrap_or(0.0);
    // The derivative of the strain along a gauge by the angle of the gauge is the shear strain.
    let turned = part
        .tensors
        .iter()
        .flatten()
        .map(|t| angle * t[2])
        .collect();
    let mut out = vec![Scatter::Together(turned)];
    for gradient in per_mm {
        out.push(Scatter::Together(
            gradient.iter().map(|v| place * v).collect(),
        ));
    }
    if let Some((own, is_whole)) = own {
        // The remaining mesh error has the pattern of the change by refinement. Loads that cancel in the strain also cancel in its error.
        let still = match is_whole {
            true => STILL_TO_COME,
            false => STILL_TO_COME_IN_PART,
        };
        let rest = part.influence.iter().zip(own);
        out.push(Scatter::Together(
            rest.map(|(a, own)| still * (a - own)).collect(),
        ));
    }
    if own.is_none_or(|(_, is_whole)| !is_whole) {
        let entries = part.influence.iter();
        let each = entries.map(|a| ENTRY_SHARE * model_rel * a).collect();
        out.push(Scatter::Single(each));
    }
    out
}
