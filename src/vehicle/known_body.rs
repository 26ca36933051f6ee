//! Sprung bodies of stated inertia on whose wheels no accelerometer is: the force on the chassis is all that the record determines.

use super::identification::{Estimate, Identification, IdentifyTask};
use super::layout::Vehicle;
use super::wrong_inputs::unit_of_accelerations;
use crate::estimate::NORMAL_95;
use crate::series::channels::Channels;

/// Returns the sprung bodies of stated inertia whose motion is measured, without links and wheels. The result is `None` if the motion of every body
/// is measured, or if no inertia is stated.
pub(super) fn bodies_of_known_inertia(task: &IdentifyTask, record: &Channels) -> Option<Vehicle> {
    let v = &task.vehicle;
    let is_measured = |b: usize| {
        let own = v.sensors.iter().filter(|s| s.at.body == b);
        own.filter(|s| record.has(&s.channel)).count() >= v.bodies[b].shape.n()
    };
    if (0..v.bodies.len()).all(is_measured) {
        return None;
    }
    let names = v.parameters();
    let is_known = |b: usize| {
        let n = v.bodies[b].shape.n();
        let index = (0..n).flat_map(|i| (i..n).map(move |j| v.inertia_index(b, i, j)));
        let mut stated = index.map(|k| task.known.get(&names[k].name));
        stated.all(|value| value.is_some())
    };
    let sprung = (0..v.bodies.len()).filter(|b| v.bodies[*b].sprung && !v.is_witness(*b));
    let kept: Vec<usize> = sprung.filter(|b| is_measured(*b) && is_known(*b)).collect();
    if kept.is_empty() {
        return None;
    }
    let mut out = v.part(&kept);
    out.links.clear();
    out.wheels.clear();
    out.sensors.retain(|s| record.has(&s.channel));
    Some(out)
}

/// Returns the identification of [`bodies_of_known_inertia`]: it contains the stated inertias, but no links and wheels.
pub(super) fn identify_known(
    task: &IdentifyTask,
    vehicle: Vehicle,
    record: &Channels,
) -> Identification {
    let values: Vec<f64> = vehicle
        .parameters()
        .iter()
        .map(|p| task.known.get(&p.name).copied().unwrap_or(f64::NAN))
        .collect();
    let n = values.len();
    let all = task.vehicle.parameters();
    let parameters = all.iter().map(|p| {
        let value = task.known.get(&p.name).copied();
        Estimate {
            name: p.name.clone(),
            value,
            sigma: value.map(|_| 0.0),
            unit: task.units.unit_name(p.quantity),
            identifiable: value.is_some(),
            interval: value.map(|v| [v, v]),
            known: value.is_some(),
        }
    });
    let open: Vec<&str> = all
        .iter()
        .filter(|p| !task.known.contains_key(&p.name))
        .map(|p| p.name.as_str())
        .collect();
    let absent: Vec<&str> = task
        .vehicle
        .sensors
        .iter()
        .map(|s| s.channel.as_str())
        .filter(|c| !record.has(c))
        .collect();
    let unidentifiable = format!(
        "{} cannot be determined without {}. The force on the chassis follows from the stated mass and its acceleration.",
        open.join(", "),
        absent.join(", ")
    );
    let findings = unit_of_accelerations(task, &vehicle, record);
    Identification {
        values,
        sigmas: vec![0.0; n],
        covariance: vec![vec![0.0; n]; n],
        scaled: vec![true; n],
        coverage_factor: NORMAL_95,
        parameters: parameters.collect(),
        unidentifiable: vec![unidentifiable],
        fit: vec![],
        mass_closure: None,
        blend: vec![],
        wheel_force_sigma: vec![],
        conditioning: 1.0,
        findings: findings.into_iter().collect(),
        vehicle,
    }
}
