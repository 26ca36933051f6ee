//! The static frame of a job whose S and signatures are given as CSV files.

use super::described;
use super::frame_columns::FrameColumns;
use super::model_part::{ModelPart, facts, nominal_x_m, nominal_y_m};
use super::signature_table::SignatureTable;
use crate::app::fault::{Fault, Faults};
use crate::app::job::quantity::quantity_of_name;
use crate::app::job::{GivenSensitivity, Job, JobLoad, LoadRole};
use crate::app::strain::read_given;
use crate::app::work::Work;
use crate::reconcile::strain::{
    GaugeFacts, MassSignature, N_PAYLOAD_COLUMNS, PlaneStrainRow, StiffnessOf, StiffnessSignature,
    Wiring,
};
use crate::units::{KILO, Quantity};

/// Ratio of the transverse to the axial strain where a table gives the axial one alone: a rail flange in bending.
const POISSON: f64 = 0.29;

/// Reads everything that `[sensitivity]` names. `channels` are the gauges in the order of the strain file.
pub(super) fn read(
    work: &mut Work,
    job: &Job,
    given: &GivenSensitivity,
    channels: &[String],
) -> Result<ModelPart, Faults> {
    // The frame counts in kN, kN m, kg and m.
    let (per_kn, per_knm) = (KILO / given.per.force.si, KILO / given.per.moment.si);
    let (per_kg, per_m) = (1.0 / given.per.mass.si, 1.0 / given.per.length.si);
    let s = FrameColumns::of(job, read_given(work, job)?, channels)?;
    let scale = |name: &str| match quantity_of_load(job, name) {
        Quantity::Moment => per_knm,
        _ => per_kn,
    };
    let nuisance = s.nuisance();
    // Tables name their columns as that of S does.
    let column_of = |name: &String| {
        let stated = given.columns.iter().find(|c| c.0 == *name);
        stated.map_or_else(|| name.clone(), |c| c.1.clone())
    };
    let (columns, mut by_column): (Vec<(String, String)>, Vec<Vec<f64>>) = s
        .wanted_columns()
        .into_iter()
        .map(|(name, values)| ((name.clone(), column_of(&name)), values))
        .unzip();
    // Payload columns: weight, times dx, times dy, times dx dy.
    let payload_names = [
        ["b0", ""],
        ["b_dx", "b_x"],
        ["b_dy", "b_y"],
        ["b_dxdy", "b_xy"],
    ];
    let payload_scale = [
        per_kg,
        per_kg * per_m,
        per_kg * per_m,
        per_kg * per_m * per_m,
    ];
    let n = channels.len();
    let mut payload = vec![vec![0.0; n]; N_PAYLOAD_COLUMNS];
    if let Some(file) = &given.signatures.payload {
        let t = SignatureTable::read(&mut work.inputs, job, file, channels)?;
        for ((column, names), f) in payload.iter_mut().zip(payload_names).zip(payload_scale) {
            if let Some(name) = names.iter().find(|n| t.has(n)) {
                *column = t.column(name, f)?;
            }
        }
    }
    by_column.extend(payload);
    let n_c = by_column.len();
    let n_l = columns.len();
    let influence: Vec<f64> = (0..n)
        .flat_map(|g| by_column.iter().map(move |c| c[g]))
        .collect();
    let gauges: Vec<GaugeFacts> = channels.iter().map(|name| facts(job, name)).collect();
    let mut part = ModelPart {
        nuisance,
        learnt: s.learnt(),
        load_names: columns.iter().map(|c| c.0.clone()).collect(),
        payload_origin: [
            nominal_x_m(job).unwrap_or(0.0),
            nominal_y_m(job).unwrap_or(0.0),
        ],
        influence,
        ..ModelPart::default()
    };
    part.tensors = vec![Vec::new(); n];
    if let Some(file) = &given.signatures.gauge_angle {
        let t = SignatureTable::read(&mut work.inputs, job, file, channels)?;
        let mut names: Vec<(String, f64)> = columns
            .iter()
            .map(|(name, c)| (c.clone(), scale(name)))
            .collect();
        names.extend(
            payload_names
                .iter()
                .zip(payload_scale)
                .map(|(n, f)| (n[0].to_owned(), f)),
        );
        // Columns as far as the table goes: payload columns may end with b_dx.
        let known: Vec<&(String, f64)> = names
            .iter()
            .take_while(|(c, _)| t.has(&format!("exx_{c}")))
            .collect();
        let mut planes = vec![PlaneStrainRow::new(); n];
        for (c, f) in known {
            let exx = t.column(&format!("exx_{c}"), *f)?;
            let gxy = t.column(&format!("gxy_{c}"), *f)?;
            let eyy = if t.has(&format!("eyy_{c}")) {
                t.column(&format!("eyy_{c}"), *f)?
            } else {
                exx.iter().map(|e| -POISSON * e).collect()
            };
            for (g, plane) in planes.iter_mut().enumerate() {
                plane.push([exx[g], eyy[g], gxy[g]]);
            }
        }
        for (g, plane) in planes.into_iter().enumerate() {
            part.tensors[g] = match gauges[g].wiring {
                Wiring::Quarter => plane,
                // A bridge: its own reading along its axis, with the shear of both sides cancelled.
                Wiring::Bending => (0..n_l + 2)
                    .map(|c| part.influence[g * n_c + c])
                    .map(|a| [a, -POISSON * a, 0.0])
                    .collect(),
                Wiring::Shear => Vec::new(),
            };
        }
    }
    part.gauges = gauges;
    if let Some(file) = &given.signatures.lateral_wheel_loads {
        let t = SignatureTable::read(&mut work.inputs, job, file, channels)?;
        for name in t.names().into_iter().filter(|n| !is_nuisance(job, n)) {
            let column = t.column(&name, scale(&name))?;
            part.other_loads.push((name, column));
        }
    }
    if let Some(file) = &given.signatures.thermal {
        let t = SignatureTable::read(&mut work.inputs, job, file, channels)?;
        let one = |names: [&str; 2]| {
            names
                .iter()
                .find(|n| t.has(n))
                .map(|n| t.column(n, 1.0))
                .transpose()
        };
        // What the job has as a nuisance load is no effect that is missing.
        if !is_nuisance(job, "thermal_uniform") {
            part.thermal_uniform = one(["thermal_uniform", "uniform"])?;
        }
        if !is_nuisance(job, "thermal_gradient") {
            part.thermal_gradient = one(["thermal_gradient", "gradient"])?;
        }
    }
    if let Some(file) = &given.signatures.unaccounted_mass {
        let t = SignatureTable::read(&mut work.inputs, job, file, channels)?;
        for place in t.names() {
            part.masses.push(MassSignature {
                per_kg: t.column(&place, per_kg)?,
                place,
            });
        }
    }
    for (zone, file) in &given.signatures.rail_stiffness {
        let t = SignatureTable::read(&mut work.inputs, job, file, channels)?;
        let mut change = vec![0.0; n * n_c];
        let mut names: Vec<(String, f64)> = columns
            .iter()
            .map(|(name, c)| (c.clone(), scale(name)))
            .collect();
        names.extend(
            payload_names
                .iter()
                .zip(payload_scale)
                .map(|(n, f)| (n[0].to_owned(), f)),
        );
        for (c, (name, f)) in names
            .iter()
            .enumerate()
            .filter(|(_, (name, _))| t.has(name))
        {
            for (g, v) in t.column(name, *f)?.into_iter().enumerate() {
                change[g * n_c + c] = v;
            }
        }
        part.stiffness.push(StiffnessSignature {
            of: StiffnessOf::Zone,
            place: zone.clone(),
            at_percent: vec![(1.0, change)],
            prior_percent: 15.0,
        });
    }
    let known: Vec<(String, f64)> = columns
        .iter()
        .map(|(name, c)| (c.clone(), scale(name)))
        .collect();
    part.stiffness.extend(described::from_tables(
        &mut work.inputs,
        job,
        channels,
        &known,
        n_c,
    )?);
    if n_l == 0 {
        return Err(Faults::from(Fault::of(
            &*given.file.given,
            "columns",
            "no load column",
            "give S a column a load",
        )));
    }
    Ok(part)
}

/// Has the job a nuisance load of this name?
fn is_nuisance(job: &Job, name: &str) -> bool {
    job.loads
        .iter()
        .any(|l| l.name == name && l.role == LoadRole::Nuisance)
}

/// Force or moment: what a stated load is, else what the name says.
fn quantity_of_load(job: &Job, name: &str) -> Quantity {
    let stated = job.loads.iter().find(|l| l.name == name);
    stated
        .and_then(JobLoad::quantity)
        .unwrap_or_else(|| quantity_of_name(name))
}
