//! Position at rest: static parts of the inputs.

use crate::finding::{Finding, Severity};
use crate::input_faults::{MotionChannel, channels_by_gravity, finding_by_weight, shows};
use crate::linalg::tall::left_inverse;
use crate::series::Channels;
use crate::series::detrend::mean;
use crate::units::{number, percent};
use crate::vehicle::layout::Vehicle;
use crate::vehicle::response::{Inputs, PrescribedMotion};

/// Share of the weight below which a mean counts as zero.
const ZERO_SHARE: f64 = 0.05;

/// Channels that drive the vehicle, with their means.
pub(super) struct GivenMeans<'a> {
    pub channels: Vec<MotionChannel<'a>>,
    pub gravity: f64,
    /// File of the record.
    pub file: &'a str,
}

/// The mean of an input against weight or gravity.
enum Mean {
    Zero,
    Static,
    Neither,
}

fn compare_mean(mean: f64, full: f64) -> Mean {
    match mean / full {
        share if share.abs() <= ZERO_SHARE => Mean::Zero,
        _ if shows(mean, full) => Mean::Static,
        _ => Mean::Neither,
    }
}

/// Subtracts the static load from wheel forces that contain it. Forces of a part that does not rest on wheels alone stay unchanged.
pub(super) fn remove_static_forces(
    model: &Vehicle,
    values: &[f64],
    given: &GivenMeans,
    inputs: &mut Inputs,
    findings: &mut Vec<Finding>,
) {
    for bodies in model.components() {
        let is_free = bodies.iter().all(|&b| inputs.motions[b].is_none());
        if !model.rests_on_wheels(&bodies) {
            continue;
        }
        let wheels: Vec<usize> = (0..model.wheels.len())
            .filter(|&w| bodies.contains(&model.wheels[w].at.body))
            .collect();
        let masses = model.masses(&bodies);
        let weight = given.gravity * masses.iter().filter_map(|&i| values.get(i)).sum::<f64>();
        let forces = wheels.iter().filter_map(|&w| inputs.forces[w].as_ref());
        let total: f64 = forces.map(|f| mean(f)).sum();
        let names: Vec<&str> = wheels
            .iter()
            .map(|&w| model.wheels[w].channel.as_str())
            .collect();
        let own = |c: &&MotionChannel| names.contains(&c.name);
        let own: Vec<MotionChannel> = given.channels.iter().filter(own).cloned().collect();
        if let Some(wrong) = finding_by_weight(&own, weight, given.file) {
            findings.push(wrong);
            continue;
        }
        let subject = format!("{}: {}", given.file, names.join(", "));
        let share = percent(total / weight);
        let (severity, message, remedy) = match compare_mean(total, weight) {
            Mean::Zero => continue,
            _ if wheels.iter().all(|&w| inputs.forces[w].is_none()) => continue,
            Mean::Static if is_free => {
                for &w in &wheels {
                    if let Some(force) = &mut inputs.forces[w] {
                        let level = mean(force);
                        force.iter_mut().for_each(|v| *v -= level);
                    }
                }
                (
                    Severity::Info,
                    format!(
                        "the mean is {share} of the weight. It is the static load and is subtracted: the response is about the position at rest"
                    ),
                    "",
                )
            }
            Mean::Static => (
                Severity::Warning,
                format!(
                    "the mean is {share} of the weight. It is not subtracted, as accelerations prescribe some bodies, and loads the springs"
                ),
                "Subtract the static load.",
            ),
            Mean::Neither => (
                Severity::Warning,
                format!(
                    "the mean is {share} of the weight, neither 0 nor the static load. It accelerates the vehicle"
                ),
                "Subtract the static load, or correct masses, sign or unit of the forces.",
            ),
        };
        let finding = Finding::new(severity, "static-part-in-input", subject, message, remedy);
        findings.push(finding.with_numbers(total, weight));
    }
}

/// Converts the accelerometers of prescribed bodies to motions of the bodies. The mean of an accelerometer that shows gravity is subtracted.
///
/// # Errors
/// The name of a body whose motion its accelerometers do not determine.
pub(super) fn remove_static_accelerations(
    model: &Vehicle,
    record: &Channels,
    given: &GivenMeans,
    inputs: &mut Inputs,
    findings: &mut Vec<Finding>,
) -> Result<(), String> {
    let gravity = given.gravity;
    let drives = |name: &str| given.channels.iter().any(|c| c.name == name);
    let wrong = channels_by_gravity(&given.channels, gravity);
    for (b, body) in model.bodies.iter().enumerate() {
        if !matches!(inputs.motions[b], Some(PrescribedMotion::Accelerations(_))) {
            continue;
        }
        let own = model.sensors.iter().filter(|s| s.at.body == b);
        let driving: Vec<_> = own.filter(|s| drives(&s.channel)).collect();
        let rows: Vec<Vec<f64>> = driving.iter().map(|s| model.functions(&s.at)).collect();
        let inverse = left_inverse(&rows).ok_or_else(|| body.name.clone())?;
        let mut readings = Vec::new();
        for sensor in &driving {
            let mut x = record.samples(&sensor.channel).unwrap_or_default().to_vec();
            let level = mean(&x);
            let (severity, message, remedy) = match compare_mean(level, gravity) {
                Mean::Zero => {
                    readings.push(x);
                    continue;
                }
                // An error states the sign or the unit.
                Mean::Neither if wrong.contains(&sensor.channel.as_str()) => {
                    readings.push(x);
                    continue;
                }
                Mean::Static => {
                    x.iter_mut().for_each(|v| *v -= level);
                    (
                        Severity::Info,
                        format!("the mean of {} is gravity and is subtracted", number(level)),
                        "",
                    )
                }
                Mean::Neither => (
                    Severity::Warning,
                    format!(
                        "the mean is {}, neither 0 nor gravity ({})",
                        number(level),
                        number(gravity)
                    ),
                    "Check zero, sign and unit of this channel. The mean acts as a constant acceleration.",
                ),
            };
            let subject = sensor.channel.as_str();
            let finding = Finding::new(severity, "static-part-in-input", subject, message, remedy);
            findings.push(finding.with_numbers(level, gravity));
            readings.push(x);
        }
        let n = readings.first().map_or(0, Vec::len);
        let motion = |row: &Vec<f64>| -> Vec<f64> {
            let sum = |t: usize| row.iter().zip(&readings).map(|(w, x)| w * x[t]).sum();
            (0..n).map(sum).collect()
        };
        let motions = inverse.iter().map(motion).collect();
        inputs.motions[b] = Some(PrescribedMotion::Accelerations(motions));
    }
    Ok(())
}

/// Counts the heights of all roads from the mean of their first samples, where the vehicle is at rest.
pub(super) fn level_roads(inputs: &mut Inputs) {
    let mut roads: Vec<&mut Vec<f64>> = inputs
        .motions
        .iter_mut()
        .flatten()
        .filter_map(|m| match m {
            PrescribedMotion::Displacements(d) => d.first_mut(),
            PrescribedMotion::Accelerations(_) => None,
        })
        .collect();
    let starts = roads.iter().filter_map(|r| r.first().copied());
    let level = mean(&starts.collect::<Vec<f64>>());
    roads
        .iter_mut()
        .flat_map(|r| r.iter_mut())
        .for_each(|v| *v -= level);
}
