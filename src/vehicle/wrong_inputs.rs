//! Wrong inputs of a vehicle record. This module gives the search of [`crate::input_faults`] the data of record and vehicle.

use super::checks::is_static;
use super::fit::{Fit, fit};
use super::identification::{Identification, IdentifyTask};
use super::layout::{Measures, Vehicle};
use super::part_problem::{PartProblem, prepare_identification};
use super::treatment::VehicleError;
use crate::finding::Finding;
use crate::input_faults::{
    ChannelKind, ChannelSource, MotionChannel, MotionRecord, MotionScale, finding_of_motion,
    finding_of_scale,
};
use crate::series::channels::Channels;
use crate::series::detrend::{mean, rms, without_mean};
use crate::units::{Quantity, find_unit};

/// Returns the channels of a record that the equations of a vehicle use; `unit_of` gives the unit of the job for a kind of channel.
pub fn motion_channels<'a>(
    vehicle: &Vehicle,
    record: &'a Channels,
    unit_of: impl Fn(ChannelKind) -> String,
) -> Vec<MotionChannel<'a>> {
    let sensors = vehicle.sensors.iter();
    let accelerations = sensors.filter(|s| s.measures == Measures::Acceleration);
    let accelerations = accelerations.map(|s| (&s.channel, ChannelKind::Acceleration));
    let forces = vehicle
        .wheels
        .iter()
        .map(|w| (&w.channel, ChannelKind::Force));
    let used = accelerations.chain(forces).filter_map(|(name, kind)| {
        let c = record.list.iter().find(|c| c.name == *name)?;
        let samples: Vec<f64> = c
            .samples
            .iter()
            .copied()
            .filter(|v| v.is_finite())
            .collect();
        Some(MotionChannel {
            name: &c.name,
            kind,
            is_unit_stated: !c.unit.is_empty(),
            unit: match c.unit.is_empty() {
                true => unit_of(kind),
                false => c.unit.clone(),
            },
            mean: mean(&samples),
            scatter: rms(&without_mean(&samples)),
        })
    });
    used.collect()
}

fn channels_of<'a>(task: &IdentifyTask, record: &'a Channels) -> Vec<MotionChannel<'a>> {
    let units = &task.units;
    motion_channels(&task.vehicle, record, |kind| match kind {
        ChannelKind::Acceleration => format!("{}/s2", units.length),
        ChannelKind::Force => units.force.clone(),
    })
}

/// Returns the finding on the unit of accelerations that stated masses turn into forces.
pub(super) fn unit_of_accelerations(
    task: &IdentifyTask,
    vehicle: &Vehicle,
    record: &Channels,
) -> Option<Finding> {
    let mut channels = channels_of(task, record);
    channels.retain(|c| vehicle.sensors.iter().any(|s| s.channel == c.name));
    let scale = MotionScale {
        closure: None,
        mass_kg: None,
        is_stated: false,
    };
    finding_of_scale(&channels, task.gravity, scale)
}

/// Returns the finding on a channel of the record that is reversed, exchanged or in another unit, from the residual of the vehicle. Without such a
/// channel, returns the finding on the unit of all channels, from the identified masses.
pub(super) fn wrong_input(
    task: &IdentifyTask,
    record: &Channels,
    answer: &Identification,
) -> Option<Finding> {
    let channels = channels_of(task, record);
    let at: Vec<usize> = channels
        .iter()
        .filter_map(|c| record.list.iter().position(|r| r.name == c.name))
        .collect();
    let unexplained = |sources: &[ChannelSource]| {
        let mut corrected = record.clone();
        for (to, source) in at.iter().zip(sources) {
            let from = record.list.get(*at.get(source.from)?)?;
            let samples = from.samples.iter().map(|v| source.factor * v).collect();
            corrected.list.get_mut(*to)?.samples = samples;
        }
        unexplained_share(task, &corrected).ok().flatten()
    };
    let motion = MotionRecord {
        channels,
        gravity: task.gravity,
        unexplained: Box::new(unexplained),
    };
    finding_of_motion(&motion).or_else(|| {
        let scale = scale_of(task, answer)?;
        finding_of_scale(&motion.channels, task.gravity, scale)
    })
}

/// Returns the share of the motion that the vehicle does not explain. It is the root mean square over the equations, including weight, of the
/// residual divided by the measured force. Without a measured force, the divisor is the largest term. Parameters keep their limits. The result is
/// `None` without equations.
///
/// # Errors
/// Errors of [`super::identify::identify`].
fn unexplained_share(task: &IdentifyTask, record: &Channels) -> Result<Option<f64>, VehicleError> {
    let (treatment, vehicle) = prepare_identification(task, record)?;
    let mut shares = Vec::new();
    for bodies in vehicle.components() {
        let problem = PartProblem::from_part(task, &vehicle.part(&bodies), record, &treatment)?;
        if !problem.is_solvable() {
            continue;
        }
        let found = fit(&problem.equations, &problem.allowed);
        for (e, left) in problem.equations.iter().zip(&found.residual_rms) {
            let term = |(i, column): &(usize, Vec<f64>)| found.values[*i].abs() * rms(column);
            let terms = e.columns.iter().map(term).filter(|t| t.is_finite());
            let target = rms(&e.target);
            let size = match target > 0.0 {
                true => target,
                false => terms.fold(0.0, f64::max),
            };
            let share = left / size;
            // An equation whose parameters are all zero explains none of the motion.
            shares.push(match share.is_finite() {
                true => share.min(1.0),
                false => 1.0,
            });
        }
        shares.extend(unexplained_weight(
            task, &vehicle, &bodies, &problem, &found,
        ));
    }
    Ok((!shares.is_empty()).then(|| rms(&shares)))
}

/// Returns the relative difference between the mean wheel forces of a part and the weight of its masses, at most 1. The result is `None` if the
/// wheels do not carry the whole part, or if their channels do not contain the static load.
fn unexplained_weight(
    task: &IdentifyTask,
    vehicle: &Vehicle,
    bodies: &[usize],
    problem: &PartProblem,
    found: &Fit,
) -> Option<f64> {
    if problem.reference.is_some() || !vehicle.rests_on_wheels(bodies) {
        return None;
    }
    let means: Option<Vec<f64>> = problem.motion.mean_forces.iter().copied().collect();
    let force: f64 = means?.iter().sum();
    let part = vehicle.part(bodies);
    let all: Vec<usize> = (0..part.bodies.len()).collect();
    let masses = part.masses(&all);
    let weight = masses.iter().map(|i| found.values[*i]).sum::<f64>() * task.gravity;
    is_static(force, weight).then(|| ((weight - force) / force).abs().min(1.0))
}

/// Returns what fixes the scale of accelerations and forces; `None` where no result depends on it.
fn scale_of(task: &IdentifyTask, answer: &Identification) -> Option<MotionScale> {
    let v = &answer.vehicle;
    let is_known = |i: &usize| answer.scaled[*i] && answer.values[*i].is_finite();
    let mut depends = false;
    let (mut mass, mut wheels) = (0.0, 0);
    for bodies in v.components() {
        let index = v.masses(&bodies);
        depends |= index.iter().any(|i| answer.scaled[*i]);
        if v.rests_on_wheels(&bodies) && index.iter().all(is_known) {
            mass += index.iter().map(|i| answer.values[*i]).sum::<f64>();
            wheels += v
                .wheels
                .iter()
                .filter(|w| bodies.contains(&w.at.body))
                .count();
        }
    }
    let kg = find_unit(Quantity::Mass, &task.units.mass)?.si;
    depends.then(|| MotionScale {
        closure: answer.mass_closure.map(|c| c.ratio),
        mass_kg: (wheels > 0).then(|| mass * kg / f64::from(wheels as u32)),
        is_stated: task.known.values().any(|v| *v != 0.0),
    })
}
