//! A gauge on a bar or beam.

use super::arms::{Arm, Gauge, Spot};
use super::bar_run::run_length;
use super::error::GaugeError;
use super::spec::{Bridge, GaugeSpec};
use crate::fe::section_at;
use crate::fe::strain_tensor::Surface;
use crate::finding::{Finding, Severity};
use crate::model::{BeamIx, Model, Vec3};

/// Position along a beam, and the recovery point C D E F (0 to 3) at this position.
#[derive(Clone, Copy, Debug)]
pub(super) struct BeamSeat {
    pub(super) beam: BeamIx,
    pub(super) point: usize,
    pub(super) station: f64,
}

/// Sine of the angle to the axis up to which a gauge counts as along it: the difference is 3e-4 of its strain.
const ALONG: f64 = 0.0175;

/// Returns, in words, the part of a gauge that is not along the axis of its beam.
fn find_off_axis_part(spec: &GaugeSpec, axis: &Vec3) -> Option<&'static str> {
    let turned = |d: &Vec3| d.cross(axis).norm() > ALONG * d.norm();
    if spec.bridge == Bridge::Shear {
        Some("a shear bridge")
    } else if spec.rosette.is_some() {
        Some("a rosette")
    } else if spec.angle_rad.sin().abs() > ALONG {
        Some("an angle to the axis")
    } else if spec.direction.as_ref().is_some_and(turned) {
        Some("a direction across the axis")
    } else if spec.pair.is_some() {
        Some("a second pair on a shell")
    } else {
        None
    }
}

/// Builds the gauge at a recovery point.
///
/// A bending bridge pairs the point with the point across the neutral axis, whose bending strain has the opposite sign. It reads twice (half
/// bridge) or four times (full bridge) the strain of the point minus the strain of the neutral axis.
///
/// # Errors
/// A missing beam; a gauge across the axis of its beam; a grid that is longer than the bars along it.
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
    if let Some(what) = find_off_axis_part(spec, &b.axes.row(0).transpose()) {
        return Err(GaugeError::AcrossBeam {
            gauge: spec.name.clone(),
            element: b.id,
            what,
        });
    }
    let part = run_length(model, beam, spec.grid_length).ok_or_else(missing)?;
    if part < spec.grid_length {
        return Err(GaugeError::GridBeyondPart {
            gauge: spec.name.clone(),
            element: b.id,
            grid_length: spec.grid_length,
            part,
        });
    }
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
        .and_then(|p| {
            section_at(&p.sections, station)
                .recovery
                .get(point)
                .copied()
        })
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
        // A shear bridge was refused, because shear is not strain along the axis.
        Bridge::Quarter | Bridge::Shear => vec![arm(here, 1.0)],
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

/// Returns a warning for a gauge at a recovery point on the neutral axis. Points without stated coordinates are on this axis.
pub(super) fn point_on_axis(model: &Model, spec: &GaugeSpec, seat: BeamSeat) -> Option<Finding> {
    let beam = model.beams.get(seat.beam.us())?;
    let property = model.beam_properties.get(beam.property.us())?;
    let section = section_at(&property.sections, seat.station);
    let [y, z] = *section.recovery.get(seat.point)?;
    let distance = (y - section.neutral[0]).hypot(z - section.neutral[1]);
    let point = ["C", "D", "E", "F"].get(seat.point)?;
    (distance == 0.0).then(|| {
        Finding::new(
            Severity::Warning,
            "bar-point-on-axis",
            &spec.name,
            format!(
                "gauge `{}` is at point {point} of element {}, and property {} does not state the distance of this point from the neutral \
                 axis: the gauge reads axial strain and no bending",
                spec.name, beam.id, property.id
            ),
            "state the stress recovery points of the property, or another `point`",
        )
    })
}
