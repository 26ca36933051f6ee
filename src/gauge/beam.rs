//! A gauge on a bar or beam.

use super::arms::{Arm, Gauge, Spot};
use super::error::GaugeError;
use super::spec::{Bridge, GaugeSpec};
use crate::fe::strain_tensor::Surface;
use crate::model::{BeamIx, Model, Vec3};

/// Where along which beam, at which of its recovery points C D E F (0 to 3).
#[derive(Clone, Copy, Debug)]
pub(super) struct BeamSeat {
    pub(super) beam: BeamIx,
    pub(super) point: usize,
    pub(super) station: f64,
}

/// The gauge at a recovery point.
///
/// A bending bridge pairs the point with the one across the neutral axis, which bends by the same strain with its sign turned: it reads
/// twice (half bridge) or four times (full bridge) the strain of the point less that of the neutral axis.
///
/// # Errors
/// A beam that is not there; a shear bridge.
pub(super) fn on_beam(
    model: &Model,
    spec: &GaugeSpec,
    seat: BeamSeat,
) -> Result<Gauge, GaugeError> {
    let missing = || GaugeError::NoElement {
        gauge: spec.name.clone(),
    };
    let BeamSeat {
        beam,
        point,
        station,
    } = seat;
    let b = model.beams.get(beam.us()).ok_or_else(missing)?;
    let end = |i: usize| {
        model
            .grids
            .get(b.grids[i].us())
            .map(|g| g.x + b.offsets[i])
            .ok_or_else(missing)
    };
    let (a, e) = (end(0)?, end(1)?);
    let [y, z] = model
        .beam_properties
        .get(b.property.us())
        .and_then(|p| p.sections.first())
        .and_then(|s| s.1.recovery.get(point).copied())
        .unwrap_or_default();
    let arm = |spot: Spot, weight: f64| Arm {
        spot,
        coefficient: [weight / spec.bridge_factor, 0.0, 0.0],
    };
    let here = Spot::Beam {
        beam,
        point,
        station,
    };
    let bending = |factor: f64| {
        vec![
            arm(here, factor),
            arm(Spot::BeamAxis { beam, station }, -factor),
        ]
    };
    let arms = match spec.bridge {
        Bridge::Quarter => vec![arm(here, 1.0)],
        Bridge::Shear => {
            return Err(GaugeError::ShearOnBar {
                gauge: spec.name.clone(),
                element: b.id,
            });
        }
        Bridge::HalfBending => bending(2.0),
        Bridge::FullBending => bending(4.0),
    };
    Ok(Gauge {
        name: spec.name.clone(),
        arms,
        element: b.id,
        surface: Surface::Top,
        position: a + (e - a) * station + b.axes.transpose() * Vec3::new(0.0, y, z),
        direction: b.axes.row(0).transpose(),
        normal: b.axes.row(2).transpose(),
        angle_rad: 0.0,
    })
}
