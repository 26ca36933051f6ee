//! Candidates from the strain fields of unit loads: every surface of every shell allowed.

use super::candidates::{Angles, Candidates, Scatter};
use crate::fe::shell_frame::{ShellPlace, shell_axes};
use crate::fe::strain_tensor::Surface;
use crate::gauge::{centre, shell_strain, to_side};
use crate::model::{Model, ShellIx};
use crate::sensitivity::LoadCaseOf;

/// A place where a gauge can go.
pub type Site = (ShellIx, Surface);

/// Candidates of these sites, columns times `scales` (the loads' expected sizes), strain in microstrain so that the scatter is too.
///
/// Positions are those of the surfaces. Sites without strain in some case must not be among them.
pub fn candidates(
    model: &Model,
    sites: &[Site],
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
        let (shell, side) = sites[place];
        for (l, load) in loads.iter().enumerate() {
            let strain =
                shell_strain(load.case, shell, side, ShellPlace::Centre).unwrap_or_default();
            let factor = scales[l] / load.applied / MICRO;
            for (c, v) in strain.iter().enumerate() {
                out[3 * l + c] = v * factor;
            }
        }
    })
    .with_positions(positions)
}

/// Strain in one microstrain.
const MICRO: f64 = 1e-6;
