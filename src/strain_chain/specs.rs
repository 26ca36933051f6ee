//! The job's gauges with their ids resolved on the model.

use super::stated_points::side_of;
use crate::gauge::{GaugePlace, GaugeSpec, Pair, away_from, centre, nearest_skin, opposite_side};
use crate::host::fault::Fault;
use crate::job::correct::turned_by;
use crate::job::readings::readings_of;
use crate::job::{Job, JobGauge, SAME_SIDE, SAME_SIDE_REMEDY, StatedPlace};
use crate::model::{Frame, Mat3, Model, Vec3};
use nastran::cards::CoordKind;

/// Returns the spec of a gauge of the job as installed: rotated by `[[correction]]`.
///
/// # Errors
/// Ids that the deck lacks.
pub fn corrected_spec_of(model: &Model, job: &Job, g: &JobGauge) -> Result<GaugeSpec, Fault> {
    let mut spec = spec_of(model, g)?;
    spec.angle_rad += turned_by(&job.corrections, &g.name).to_radians();
    if g.rosette.is_some() {
        for (turn, leg) in spec.leg_turns_rad.iter_mut().zip(readings_of(g)) {
            *turn = turned_by(&job.corrections, &leg).to_radians();
        }
    }
    Ok(spec)
}

/// Returns the spec of a gauge of the job, with its ids resolved on the model.
///
/// # Errors
/// Ids that the deck lacks.
fn spec_of(model: &Model, g: &JobGauge) -> Result<GaugeSpec, Fault> {
    let fault = |field: &str, wrong: String, remedy: &str| {
        Fault::with_line(&*g.file, g.line, field, wrong, remedy)
    };
    let lacks = |field: &str, what: String| {
        fault(
            field,
            format!("gauge `{}`: the deck has no {what}", g.name),
            "correct the id, or name the deck of this gauge",
        )
    };
    let frame = match model.frame_ix(g.cid) {
        Some(ix) => model.frames.get(ix.us()),
        None => None,
    }
    .ok_or_else(|| lacks("cid", format!("coordinate system {}", g.cid)))?;
    let shell = |id: u32, field: &str| {
        model
            .shell_ix(id)
            .ok_or_else(|| lacks(field, format!("shell {id}")))
    };
    let place = match g.place {
        StatedPlace::Element(id) => GaugePlace::Shell(shell(id, "element")?),
        StatedPlace::Position(x, _) => GaugePlace::Nearest(frame.to_basic(x)),
        StatedPlace::BeamPoint {
            element,
            point,
            station,
        } => GaugePlace::Beam {
            beam: model
                .beam_ix(element)
                .ok_or_else(|| lacks("element", format!("bar or beam {element}")))?,
            point: usize::from(point),
            station,
        },
        StatedPlace::Unstated => {
            return Err(fault(
                "element",
                format!("gauge `{}` has no place", g.name),
                "state `element` and `surface`, or `position`",
            ));
        }
    };
    let no_axes = || {
        fault(
            "direction",
            format!(
                "gauge `{}`: it is on the axis of coordinate system {}, where radial and tangential directions do not exist",
                g.name, g.cid
            ),
            "give the direction in a rectangular system, or along the axis",
        )
    };
    let axes_at = |place: GaugePlace| match g.direction {
        Some(d) => axes_of_direction(model, frame, d, place).ok_or_else(no_axes),
        None => Ok(Mat3::identity()),
    };
    let axes = axes_at(place)?;
    let stated = g.surface_stated.then_some(g.surface);
    // Shell and side of the first pair at the installed position of the gauge.
    let seat = match place {
        GaugePlace::Shell(own) => Some((own, side_of(model, g))),
        GaugePlace::Nearest(x) if g.pair.is_some() => {
            nearest_skin(model, x, stated).map(|f| (f.shell, stated.unwrap_or(f.side)))
        }
        _ => None,
    };
    let across = || {
        fault(
            "surface2",
            format!(
                "gauge `{}`: `element2` is not parallel to `element`, and none of its sides is the opposite side",
                g.name
            ),
            "state `surface2`",
        )
    };
    let pair = match g.pair {
        Some((id, surface2)) => {
            let ix = shell(id, "element2")?;
            let turn = axes_at(GaugePlace::Shell(ix))?.tr_mul(&axes);
            let surface = match (surface2, seat) {
                (Some(surface), _) => surface,
                (None, Some(seat)) => away_from(model, seat, ix).ok_or_else(across)?,
                (None, None) => opposite_side(g.surface),
            };
            if seat == Some((ix, surface)) {
                return Err(fault(
                    "surface2",
                    format!("gauge `{}`: {SAME_SIDE}", g.name),
                    SAME_SIDE_REMEDY,
                ));
            }
            Some(Pair {
                turn,
                ..Pair::with_parallel_axis(ix, surface)
            })
        }
        None => None,
    };
    Ok(GaugeSpec {
        name: g.name.clone(),
        place,
        surface: match place {
            GaugePlace::Shell(_) => seat.map(|s| s.1),
            _ => stated,
        },
        direction: g.direction.map(|d| axes.tr_mul(&Vec3::from(d))),
        angle_rad: g.angle_deg.to_radians(),
        bridge: g.bridge,
        bridge_factor: g.bridge_factor,
        grid_length: g.grid_length,
        pair,
        rosette: g.rosette,
        leg_turns_rad: [0.0; 3],
        transverse_sensitivity: g.transverse_sensitivity,
    })
}

/// Returns the axes, by rows in the basic frame, to which the direction `d` of a gauge at `place` refers. These are the axes of its system at the
/// gauge. `None` if `d` has a component that does not exist there, such as radial or tangential on the axis of a cylindrical or spherical system.
fn axes_of_direction(model: &Model, frame: &Frame, d: [f64; 3], place: GaugePlace) -> Option<Mat3> {
    if frame.kind == CoordKind::Rectangular {
        return Some(frame.axes);
    }
    let (at, size) = location(model, place)?;
    let local = frame.axes * (at - frame.origin);
    let along_axis = frame.kind == CoordKind::Cylindrical && d[0] == 0.0 && d[1] == 0.0;
    let off_axis = local.x.hypot(local.y) > ON_AXIS * size;
    (along_axis || off_axis).then(|| frame.axes_at(at))
}

/// Share of the size of an element within which its centre counts as on the axis of a system. Decks state coordinates with six to eight digits.
const ON_AXIS: f64 = 1e-6;

/// Returns the location of a gauge in the basic frame, and the size of its element. The location is the centre of a shell, or the station on the axis
/// of a bar.
fn location(model: &Model, place: GaugePlace) -> Option<(Vec3, f64)> {
    match place {
        GaugePlace::Nearest(x) => Some((x, 0.0)),
        GaugePlace::Shell(ix) => {
            let shell = model.shells.get(ix.us())?;
            let (middle, first) = (centre(model, shell)?, shell.grids.first()?);
            let corner = model.grids.get(first.us())?.x;
            Some((middle, (corner - middle).norm()))
        }
        GaugePlace::Beam { beam, station, .. } => {
            let beam = model.beams.get(beam.us())?;
            let end = |i: usize| Some(model.grids.get(beam.grids[i].us())?.x + beam.offsets[i]);
            let (a, b) = (end(0)?, end(1)?);
            Some((a + (b - a) * station, (b - a).norm()))
        }
    }
}
