//! What the model says, joined with what was measured and noted of the runs.

use super::model_part::ModelPart;
use crate::app::fault::{Fault, FaultList, Faults};
use crate::app::job::Job;
use crate::app::measured::runs_file::{RunRow, read_runs};
use crate::app::work::Work;
use crate::reconcile::Observations;
use crate::reconcile::strain::{PayloadWeight, StrainFrame, angle_scatter};
use crate::units::{KILO, Quantity};

/// Noise of a measured wheel force where the runs file states none: nothing is assumed better than this, kN.
const LOAD_NOISE_KN: f64 = 0.05;

/// Joins what the model says with what was measured.
pub(super) fn frame(
    job: &Job,
    work: &mut Work,
    observations: Observations,
    part: ModelPart,
) -> Result<StrainFrame, Faults> {
    let Some(runs) = &job.runs else {
        let remedy = "add `[runs]` with the wheel forces and the payload of each run";
        return Err(Faults::from(Fault::of(
            &*job.file,
            "runs",
            "no `[runs]`",
            remedy,
        )));
    };
    let rows = read_runs(&mut work.inputs, job, runs)?;
    let gravity = job.gravity_m_s2();
    let mut faults = FaultList::new();
    let (mut loads, mut payload) = (Vec::new(), Vec::new());
    for run in &observations.runs {
        let Some(row) = rows.iter().find(|r| r.run == *run) else {
            faults.push(Fault::of(
                &*runs.file.given,
                "run",
                format!("no row for run `{run}`"),
                "give every run of the strain file a row",
            ));
            continue;
        };
        for name in &part.load_names {
            match row.loads_si.get(name) {
                Some(n) => loads.push(n / KILO),
                None => faults.push(Fault::at(
                    &*runs.file.given,
                    row.line,
                    name.clone(),
                    format!("run `{run}` has no value for load `{name}`"),
                    "give the load in the runs file, and its column in `runs.columns`",
                )),
            }
        }
        payload.push(payload_of(row, gravity, part.payload_origin));
    }
    Faults::check(faults)?;
    let load_noise = runs
        .noise
        .force
        .map_or(LOAD_NOISE_KN, |f| f * runs.units.force.si / KILO);
    let measured = job.measured.as_ref();
    let mut frame = StrainFrame {
        rules: Default::default(),
        stop: work.cx.progress.stop(),
        observations,
        gauges: part.gauges,
        moments: part.load_names.iter().map(|n| is_moment(job, n)).collect(),
        load_names: part.load_names,
        load_positions: part.load_positions,
        influence: part.influence,
        tensors: part.tensors,
        per_mm: part.per_mm,
        loads,
        payload,
        payload_origin: part.payload_origin,
        payload_weight: if job.payload.as_ref().is_none_or(|p| p.weight_in_model) {
            PayloadWeight::InModel
        } else {
            PayloadWeight::Missing
        },
        wheel_forces: runs.wheel_forces,
        other_loads: part.other_loads,
        nuisance: part.nuisance,
        ground: runs.ground.map_or(0.0, |f| f * runs.units.force.si / KILO),
        thermal_uniform: part.thermal_uniform,
        thermal_gradient: part.thermal_gradient,
        masses: part.masses,
        stiffness: part.stiffness,
        noise: measured.map_or(1.0, |m| m.noise_microstrain),
        load_noise,
        model_rel: measured.map_or(0.0, |m| m.model_uncertainty_rel),
        as_modelled: part.as_modelled,
        scatter: part.scatter,
        learnt: part.learnt,
    };
    // From a deck it is known at the gauges themselves, and there already.
    let stated = job.reconcile.as_ref().and_then(|r| r.angle_tolerance_deg);
    if let (Some(_), Some(degrees)) = (&job.sensitivity, stated.filter(|d| *d > 0.0)) {
        let scatter = angle_scatter(&frame, degrees);
        frame.scatter.push(scatter);
    }
    Ok(frame)
}

fn payload_of(row: &RunRow, gravity: f64, origin: [f64; 2]) -> [f64; 3] {
    let mass = row
        .payload_mass_kg
        .or(row.payload_force_n.map(|f| f / gravity))
        .unwrap_or(0.0);
    [
        mass,
        row.payload_x_m.map_or(0.0, |x| x - origin[0]),
        row.payload_y_m.map_or(0.0, |y| y - origin[1]),
    ]
}

/// Whether a load of the job is a moment.
fn is_moment(job: &Job, name: &str) -> bool {
    job.quantity_of_load(name) == Some(Quantity::Moment)
}
