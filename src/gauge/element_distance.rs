//! Distance of a stated point from the element of its gauge.

use super::surface::{corners, foot_on, to_side};
use crate::fe::strain_tensor::Surface;
use crate::model::{BeamIx, Model, ShellIx, Vec3};

/// Distance of a point from an element, and size of the element, model units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElementDistance {
    /// Distance from the nearest point of the reference surface or axis of the element.
    pub distance: f64,
    /// Longest side or diagonal of the element, plus the distance of its faces or recovery points from the reference surface or axis.
    pub size: f64,
    /// Distance of the faces or recovery points from the reference surface or axis. `None` for a bar without stated recovery points.
    pub faces: Option<f64>,
}

/// Returns the distance of a point from a shell; `None` if the shell has no area.
pub fn distance_to_shell(model: &Model, ix: ShellIx, x: Vec3) -> Option<ElementDistance> {
    let shell = model.shells.get(ix.us())?;
    let p = corners(model, shell)?;
    let pairs = p.iter().flat_map(|a| p.iter().map(move |b| (a - b).norm()));
    let sides = [Surface::Bottom, Surface::Top].map(|s| to_side(model, shell, s).abs());
    Some(ElementDistance {
        distance: foot_on(model, ix, x)?.distance,
        size: pairs.fold(0.0, f64::max) + sides[0].max(sides[1]),
        faces: Some(sides[0].max(sides[1])),
    })
}

/// Returns the distance of a point from a bar or beam.
pub fn distance_to_beam(model: &Model, ix: BeamIx, x: Vec3) -> Option<ElementDistance> {
    let beam = model.beams.get(ix.us())?;
    let end = |i: usize| Some(model.grids.get(beam.grids[i].us())?.x + beam.offsets[i]);
    let (a, along) = (end(0)?, end(1)? - end(0)?);
    let share = (x - a).dot(&along) / along.norm_squared();
    let sections = &model.beam_properties.get(beam.property.us())?.sections;
    let recovery = sections.iter().flat_map(|s| s.1.recovery.iter());
    let depth = recovery.map(|[y, z]| y.hypot(*z)).fold(0.0, f64::max);
    Some(ElementDistance {
        distance: (x - a - along * share.clamp(0.0, 1.0)).norm(),
        size: along.norm() + depth,
        faces: Some(depth).filter(|d| *d > 0.0),
    })
}
