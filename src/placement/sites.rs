//! Candidates from the strain fields of unit loads: every surface of every shell allowed, as single grids or as bridges.

use super::candidates::{Angles, Candidates, Scatter};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::fe::{CaseResult, PlaneStrain};
use crate::gauge::{Bridge, centre, shell_strain, to_side};
use crate::model::{Model, ShellIx};
use crate::sensitivity::LoadCaseOf;
use crate::units::MICROSTRAIN;

/// A place where a gauge can go.
pub type Site = (ShellIx, Surface);

/// Returns candidates of single grids at these sites. Columns are times `scales`, the expected sizes of the loads. Strain is in microstrain, and so
/// is the scatter.
///
/// Positions are on the surfaces. Every site must have strain in all cases.
pub fn candidates(
    model: &Model,
    sites: &[Site],
    loads: &[LoadCaseOf],
    scales: &[f64],
    angles: Angles,
    scatter: Scatter,
) -> Candidates {
    bridges(
        model,
        sites,
        Bridge::Quarter,
        loads,
        scales,
        angles,
        scatter,
    )
}

/// Returns the candidates for gauges wired as `bridge` (bridge factor 1): readings are sums of signed arm strains.
///
/// A shear bridge is a candidate by the angle of its first grid; [`axis_of`] gives the angle of its axis.
pub fn bridges(
    model: &Model,
    sites: &[Site],
    bridge: Bridge,
    loads: &[LoadCaseOf],
    scales: &[f64],
    angles: Angles,
    scatter: Scatter,
) -> Candidates {
    let k = loads.len();
    let positions = sites
        .iter()
        .map(|&(ix, side)| {
            let at = model.shells.get(ix.us()).and_then(|s| {
                let z = shell_axes(model, s, ShellPlace::Centre)?.row(2).transpose();
                Some(centre(model, s)? + z * to_side(model, s, side))
            });
            at.map_or([f64::NAN; 3], |v| [v.x, v.y, v.z])
        })
        .collect();
    Candidates::from_tensors(k, sites.len(), angles, scatter, |place, out| {
        for (l, load) in loads.iter().enumerate() {
            let strain = bridge_strain(bridge, load.case, sites[place]).unwrap_or_default();
            let factor = scales[l] / load.applied / MICROSTRAIN;
            for (c, v) in strain.iter().enumerate() {
                out[3 * l + c] = v * factor;
            }
        }
    })
    .with_positions(positions)
}

/// Returns a tensor for each side (element frame, engineering shear). Its strain along a direction is the reading of a bridge whose first grid has
/// this direction.
///
/// Bending: this side minus the other side, once or twice. Shear: the strain along the first grid minus the strain normal to it.
pub fn bridge_strain(
    bridge: Bridge,
    case: &CaseResult,
    (shell, side): Site,
) -> Option<PlaneStrain> {
    let here = shell_strain(case, shell, side, ShellPlace::Centre)?;
    let other = || {
        let opposite = match side {
            Surface::Top => Surface::Bottom,
            Surface::Bottom => Surface::Top,
        };
        shell_strain(case, shell, opposite, ShellPlace::Centre)
    };
    Some(match bridge {
        Bridge::Quarter => here,
        Bridge::HalfBending | Bridge::FullBending => {
            let there = other()?;
            let twice = if bridge == Bridge::FullBending {
                2.0
            } else {
                1.0
            };
            std::array::from_fn(|i| twice * (here[i] - there[i]))
        }
        Bridge::Shear => {
            let [x, y, g] = here;
            [x - y, y - x, 2.0 * g]
        }
    })
}

/// Returns the angle of the axis of a bridge from the element x axis, given the angle of its first grid.
pub fn axis_of(bridge: Bridge, angle: f64) -> f64 {
    match bridge {
        Bridge::Shear => angle - std::f64::consts::FRAC_PI_4,
        _ => angle,
    }
}
