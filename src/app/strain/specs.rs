//! The job's gauges with their ids resolved on the model.

use crate::app::fault::Fault;
use crate::app::job::correct::turned_by;
use crate::app::job::{Job, JobGauge, StatedPlace};
use crate::gauge::{GaugePlace, GaugeSpec};
use crate::model::{Model, Vec3};

/// A gauge of the job as it is glued: turned as `[[correction]]` says.
///
/// # Errors
/// Ids that the deck lacks.
pub fn corrected_spec_of(model: &Model, job: &Job, g: &JobGauge) -> Result<GaugeSpec, Fault> {
    let mut spec = spec_of(model, g)?;
    spec.angle_rad += turned_by(&job.corrections, &g.name).to_radians();
    Ok(spec)
}

/// A gauge of the job with its ids resolved on the model.
///
/// # Errors
/// Ids that the deck lacks.
fn spec_of(model: &Model, g: &JobGauge) -> Result<GaugeSpec, Fault> {
    let fault = |field: &str, wrong: String, remedy: &str| {
        Fault::at(&*g.file, g.line, field, wrong, remedy)
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
    let mut at = Vec3::zeros();
    let place = match g.place {
        StatedPlace::Element(id) => GaugePlace::Shell(shell(id, "element")?),
        StatedPlace::Position(x, _) => {
            at = frame.to_basic(x);
            GaugePlace::Nearest(at)
        }
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
    let pair = match g.pair {
        Some((id, s)) => Some((shell(id, "element2")?, s)),
        None => None,
    };
    Ok(GaugeSpec {
        name: g.name.clone(),
        place,
        surface: g.surface_stated.then_some(g.surface),
        direction: g.direction.map(|d| frame.vector_to_basic(d, at)),
        angle_rad: g.angle_deg.to_radians(),
        bridge: g.bridge,
        bridge_factor: g.bridge_factor,
        grid_length: g.grid_length,
        pair,
        rosette: g.rosette,
        transverse_sensitivity: g.transverse_sensitivity,
    })
}
