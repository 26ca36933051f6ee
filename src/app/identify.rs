//! `identify`: vehicle parameters and wheel loads from accelerations.

use super::fault::Faults;
use super::vehicle::{VehicleRecords, read_vehicle, vehicle_fault};
use super::{JobArguments, Session, job};
use crate::report::vehicle::{
    Curve, identify_page, restoring_curves, write_chassis_forces, write_parameters,
    write_restoring_force, write_wheel_forces,
};
use crate::series::channels::Channels;
use crate::series::detrend::rms;
use crate::series::welch::cross_spectra;
use crate::units::ReportUnits;
use crate::vehicle::chassis::chassis_forces;
use crate::vehicle::identify::{Identification, identify};
use crate::vehicle::loads::{LoadHistory, static_loads, wheel_force_history};
use crate::vehicle::motion::{Motion, Treatment, motion};
use crate::vehicle::stretch::slow_stretches;
use serde::Serialize;

/// A recovered load in `result.json`: dynamic part of a wheel force over its record, and its mean where masses tell it.
#[derive(Serialize)]
struct LoadRow {
    run: String,
    name: String,
    value: Option<f64>,
    sigma: Option<f64>,
    unit: String,
    min: f64,
    max: f64,
    sample_sigma: Option<f64>,
}

/// The force on a sprung body in `result.json`.
#[derive(Serialize)]
struct ChassisRow {
    body: String,
    rms_by_mass: f64,
    rms_by_springs: f64,
    rms_difference: f64,
    unit: String,
}

/// Reads the job and its records, identifies, writes parameters, wheel loads and restoring forces.
pub fn run(arguments: &JobArguments, session: &mut Session) -> Result<(), Faults> {
    let job = session.stage("read", |s| job::read_job(&mut s.inputs, &arguments.job))?;
    session.put_units(job.units, &ReportUnits::of(job.units));
    let records = session.stage("read", |s| read_vehicle(s, &job))?;
    let VehicleRecords {
        question,
        data,
        hold_out,
    } = &records;
    let data_name = job.vehicle.as_ref().map_or("", |v| v.data.given.as_str());
    let found = session
        .stage("identify", |_| identify(question, data, hold_out.as_ref()))
        .map_err(|e| Faults::from(vehicle_fault(&job, data_name, &e)))?;
    session.findings.extend(found.findings.iter().cloned());
    session.findings.extend(found.verdict());

    session.put("model", &found.vehicle.name)?;
    session.put("band_hz", [question.band.low_hz, question.band.high_hz])?;
    session.put("parameters", &found.parameters)?;
    session.put("unidentifiable", &found.unidentifiable)?;
    session.put("fit", &found.fit)?;
    session.put("mass_closure", found.mass_closure.map(|m| m.ratio))?;
    session.put("mass_closure_detail", found.mass_closure)?;
    session.put("conditioning", found.conditioning)?;

    let history = |record: &Channels| {
        let treatment = Treatment {
            keep_every: 1,
            adjust: question.corrections.clone(),
            slow: slow_stretches(&found.vehicle, &found.values, record, &question.corrections),
            ..Treatment::of(question.band)
        };
        motion(&found.vehicle, record, &treatment).map(|m| (wheel_force_history(&found, &m), m))
    };
    let (loads, measured) =
        history(data).map_err(|e| Faults::from(vehicle_fault(&job, data_name, &e)))?;
    let mut rows = load_rows(
        &found,
        question.gravity,
        &question.units.force,
        data_name,
        &loads,
    );
    let held = match (
        hold_out,
        job.vehicle.as_ref().and_then(|v| v.hold_out.as_ref()),
    ) {
        (Some(record), Some(named)) => {
            let (h, m) =
                history(record).map_err(|e| Faults::from(vehicle_fault(&job, &named.given, &e)))?;
            rows.extend(load_rows(
                &found,
                question.gravity,
                &question.units.force,
                &named.given,
                &h,
            ));
            Some((h, m))
        }
        _ => None,
    };
    session.put("loads", rows)?;

    let out = session.output_for(&arguments.job)?;
    let mut write =
        |name: &str, text: String| out.write_bytes(name, text.as_bytes()).map_err(Faults::from);
    write("parameters.csv", write_parameters(&found))?;
    write("loads.csv", write_wheel_forces(&found, &loads, &measured))?;
    if let Some((h, m)) = &held {
        write("loads_hold_out.csv", write_wheel_forces(&found, h, m))?;
    }
    write(
        "restoring_force.csv",
        write_restoring_force(&found, &measured),
    )?;
    let forces = chassis_forces(&found, &measured);
    let leaves = job.vehicle.as_ref().map(|v| v.leaf.clone());
    let leaves = leaves.unwrap_or_default();
    if !forces.is_empty() {
        write(
            "chassis_forces.csv",
            write_chassis_forces(&forces, &leaves, &measured),
        )?;
    }
    let (shown, shown_motion) = held.as_ref().map_or((&loads, &measured), |(h, m)| (h, m));
    let page = identify_page(
        &job.title,
        &found,
        &session.findings,
        &history_curves(shown, shown_motion),
        &spectrum_curves(shown, shown_motion),
        &restoring_curves(&found, shown_motion),
        &forces,
    );
    let rows: Vec<ChassisRow> = forces
        .iter()
        .map(|f| ChassisRow {
            body: f.body.clone(),
            rms_by_mass: rms(&f.by_mass),
            rms_by_springs: rms(&f.by_springs),
            rms_difference: f.difference(),
            unit: question.units.force.clone(),
        })
        .collect();
    session.put("chassis_forces", rows)?;
    session.write_page(&arguments.job, page)?;
    for p in &found.parameters {
        match (p.value, p.sigma) {
            (Some(v), Some(s)) => {
                session.say(format!("{:12} {v:>14.6e} +- {s:.2e} {}", p.name, p.unit))
            }
            _ => session.say(format!("{:12} {:>14} {}", p.name, "not told", p.unit)),
        }
    }
    for sentence in &found.unidentifiable {
        session.say(sentence);
    }
    for f in &found.fit {
        session.say(format!(
            "{:12} left over {:.2} % ({})",
            f.channel,
            100.0 * f.relative_rms,
            f.on
        ));
    }
    if let Some(m) = found.mass_closure {
        session.say(format!("identified mass / weighed mass: {:.4}", m.ratio));
    }
    Ok(())
}

fn load_rows(
    found: &Identification,
    gravity: f64,
    unit: &str,
    run: &str,
    history: &LoadHistory,
) -> Vec<LoadRow> {
    let statics = static_loads(found, gravity, run);
    history
        .names
        .iter()
        .enumerate()
        .filter(|(i, _)| history.values[*i].iter().any(|v| v.is_finite()))
        .map(|(i, name)| {
            let at = statics.names.iter().position(|n| n == name);
            let extreme = |pick: fn(f64, f64) -> f64| {
                history.values[i]
                    .iter()
                    .copied()
                    .reduce(pick)
                    .unwrap_or(f64::NAN)
            };
            LoadRow {
                run: run.to_owned(),
                name: name.clone(),
                value: at.map(|k| statics.values[k]),
                sigma: at.map(|k| statics.sigma(k)),
                unit: unit.to_owned(),
                min: extreme(f64::min),
                max: extreme(f64::max),
                sample_sigma: Some(history.sigma[i]).filter(|s| s.is_finite()),
            }
        })
        .collect()
}

/// Seconds of wheel force that the page shows.
const SHOWN_S: f64 = 8.0;

fn told(history: &LoadHistory) -> impl Iterator<Item = usize> + '_ {
    (0..history.names.len()).filter(|&i| history.values[i].iter().any(|v| v.is_finite()))
}

fn history_curves(history: &LoadHistory, motion: &Motion) -> Vec<Curve> {
    let n = ((SHOWN_S * history.rate_hz) as usize).min(motion.n_samples());
    let cut = |x: &[f64]| x.iter().take(n).copied().collect::<Vec<f64>>();
    told(history)
        .map(|i| Curve {
            name: history.names[i].clone(),
            x: (0..n)
                .map(|t| history.start_s + t as f64 / history.rate_hz)
                .collect(),
            recovered: cut(&history.values[i]),
            measured: motion.forces[i].as_deref().map_or(vec![], cut),
        })
        .collect()
}

fn spectrum_curves(history: &LoadHistory, motion: &Motion) -> Vec<Curve> {
    let segment = (4.0 * history.rate_hz) as usize;
    told(history)
        .map(|i| {
            let measured = motion.forces[i].as_ref();
            let s = cross_spectra(
                &history.values[i],
                measured.unwrap_or(&history.values[i]),
                history.rate_hz,
                segment,
            );
            let measured = measured.map_or(vec![], |_| s.yy);
            Curve {
                name: history.names[i].clone(),
                x: s.f_hz,
                recovered: s.xx,
                measured,
            }
        })
        .collect()
}
