//! Static frame: the model part joined with the measured strain and the recorded loads of the runs.

use super::model_part::ModelPart;
use crate::finding::list_few;
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::job::Job;
use crate::job::suggest::header_remedy;
use crate::measured::runs_file::{RunRow, no_load_column, read_runs};
use crate::reconcile::Observations;
use crate::reconcile::strain::{PayloadWeight, StrainFrame, angle_scatter};
use crate::units::{KILO, Quantity};

/// Noise of a measured wheel force if the runs file states no noise, kN. No smaller noise is assumed.
const LOAD_NOISE_KN: f64 = 0.05;

/// Joins the model part with the measurements.
pub(super) fn frame(
    job: &Job,
    work: &mut Work,
    observations: Observations,
    part: ModelPart,
) -> Result<StrainFrame, Faults> {
    let Some(runs) = &job.runs else {
        let remedy = "add `[runs]` with the wheel forces and the payload of each run";
        return Err(Faults::from(Fault::new(
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
    let mut without_row = Vec::new();
    let mut without_value: Vec<Vec<&RunRow>> = vec![Vec::new(); part.load_names.len()];
    for run in &observations.runs {
        let Some(row) = rows.iter().find(|r| r.run == *run) else {
            without_row.push(run.as_str());
            continue;
        };
        for (name, without) in part.load_names.iter().zip(&mut without_value) {
            match row.loads_si.get(name) {
                Some(n) => loads.push(n / KILO),
                None => without.push(row),
            }
        }
        payload.push(payload_of(row, gravity, part.payload_origin));
    }
    if let Some(first) = without_row.first() {
        let of_file = rows.iter().map(|r| r.run.as_str());
        let general = "add a row for every run of the strain file";
        faults.push(Fault::new(
            &*runs.file.given,
            "run",
            format!("no row for {}", list_few(&without_row)),
            header_remedy(first, of_file, general),
        ));
    }
    for (name, without) in part.load_names.iter().zip(&without_value) {
        faults.extend(match without.first() {
            Some(_) if rows.iter().all(|r| !r.loads_si.contains_key(name)) => {
                Some(no_load_column(&mut work.inputs, job, runs, name)?)
            }
            Some(first) => {
                let names: Vec<&str> = without.iter().map(|r| r.run.as_str()).collect();
                Some(Fault::with_line(
                    &*runs.file.given,
                    first.line,
                    name.clone(),
                    format!("load `{name}` has no value in {}", list_few(&names)),
                    "state the load in every run, 0 if it does not act",
                ))
            }
            None => None,
        });
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
        gauge_noise: part.gauge_noise,
        load_noise,
        model_rel: measured.map_or(0.0, |m| m.model_uncertainty_rel),
        coefficient_rel: 0.0,
        as_modelled: part.as_modelled,
        scatter: part.scatter,
        learnt: part.learnt,
    };
    // With a deck, the scatter of the angle is already computed at the gauges.
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

/// Returns whether a load of the job is a moment.
fn is_moment(job: &Job, name: &str) -> bool {
    job.quantity_of_load(name) == Some(Quantity::Moment)
}
