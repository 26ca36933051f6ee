//! Vehicle, parameters and inputs of a simulation, from a job.

use super::rest::{GivenMeans, level_roads, remove_static_accelerations, remove_static_forces};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::work::Work;
use crate::input_faults::findings_by_gravity;
use crate::job::suggest::find_closest_name;
use crate::job::{InputKind, Job, SimulationInput, Vehicle as VehicleJob};
use crate::linalg::tall::left_inverse;
use crate::series::Channels;
use crate::vehicle::layout::{Measures, Vehicle};
use crate::vehicle::preset::vehicle;
use crate::vehicle::response::{Inputs, PrescribedMotion};
use crate::vehicle::term::{Term, UnitNames};
use crate::vehicle::tyre::{Tyre, add_tyres};
use crate::workflow::vehicle::{
    channels_in_job_units, check_samples, preset_fault, preset_request, read_record, section_of,
};

/// Vehicle with its parameters and inputs.
pub(super) struct Simulation {
    pub vehicle: Vehicle,
    /// Parameters in the order of the vehicle.
    pub values: Vec<f64>,
    pub inputs: Inputs,
    /// Channels that drive the vehicle.
    pub channels: Vec<String>,
    /// Time of the first sample, s.
    pub start_s: f64,
    pub units: UnitNames,
}

/// Model of a section, and the model on tyres; `tyres` is empty for a model without tyres.
struct Models {
    plain: Vehicle,
    on_tyres: Vehicle,
    tyres: Vec<Tyre>,
}

/// Returns whether the section states every parameter of its model.
pub(super) fn knows_all(section: &VehicleJob) -> bool {
    let model = vehicle(&preset_request(section));
    model.is_ok_and(|m| {
        let mut parameters = m.parameters().into_iter();
        parameters.all(|p| section.known.contains_key(&p.name))
    })
}

/// Reads the vehicle of a job, its parameters and its inputs. Findings go to the work.
///
/// # Errors
/// Every fault of section, record and model.
pub(super) fn read_simulation(work: &mut Work, job: &Job) -> Result<Simulation, Faults> {
    let section = section_of(job)?;
    let plain = vehicle(&preset_request(section))
        .map_err(|e| Faults::from(preset_fault(job, section, &e)))?;
    let mut on_tyres = plain.clone();
    let tyres = add_tyres(&mut on_tyres, &section.columns);
    let models = Models {
        plain,
        on_tyres,
        tyres,
    };
    Faults::check(unusable_keys(job, section, &models))?;
    let record = read_record(work, job, section, &models.on_tyres, &section.data)?;
    let fault = |wrong: String, remedy: &str| {
        Fault::with_line(&*job.file, section.line, "vehicle.input", wrong, remedy)
    };
    let channels = driving_channels(section, &models, &record, fault)?;
    let on_road = models.tyres.iter().any(|t| channels.contains(&t.channel));
    let (model, tyres) = match on_road {
        true => (models.on_tyres, models.tyres),
        false => (models.plain, Vec::new()),
    };
    let values = parameter_values(job, section, &model)?;
    let channels = with_witnesses(&model, &tyres, channels);
    check_columns(&section.data.given, &record, &channels)?;
    check_samples(&section.data.given, &record, |name| {
        channels.iter().any(|c| c == name)
    })?;
    let gravity = job.units.standard_gravity();
    let mut inputs = inputs_of(&model, &tyres, &record, &channels, fault)?;
    let mut driving = channels_in_job_units(job, &model, &record);
    driving.retain(|c| channels.iter().any(|name| name == c.name));
    let given = GivenMeans {
        channels: driving,
        gravity,
        file: &section.data.given,
    };
    let findings = &mut work.findings;
    findings.extend(findings_by_gravity(&given.channels, gravity, given.file));
    remove_static_forces(&model, &values, &given, &mut inputs, findings);
    remove_static_accelerations(&model, &record, &given, &mut inputs, findings).map_err(
        |body| {
            let wrong = format!("the accelerometers of `{body}` do not determine its motion");
            Faults::from(fault(wrong, "add an accelerometer, or another place"))
        },
    )?;
    level_roads(&mut inputs);
    Ok(Simulation {
        vehicle: model,
        values,
        inputs,
        channels,
        start_s: record.start_s,
        units: UnitNames::from_system(job.units),
    })
}

/// Faults of keys that a simulation cannot follow.
fn unusable_keys(job: &Job, section: &VehicleJob, models: &Models) -> FaultList {
    let at = |key: &str, wrong: String, remedy: &str| {
        Fault::with_line(&*job.file, section.line, key, wrong, remedy)
    };
    let mut faults = FaultList::new();
    if !section.corrections.is_empty() {
        let wrong = "`simulate` uses the channels as they are and corrects none".to_owned();
        let remedy = "correct the record, and delete `corrections`";
        faults.push(at("vehicle.corrections", wrong, remedy));
    }
    if section.mass_change.is_some() {
        let wrong = "`simulate` has no mass that changes during the record".to_owned();
        let remedy = "simulate the two parts of the record with one job each";
        faults.push(at("vehicle.mass_change", wrong, remedy));
    }
    for link in &models.plain.links {
        for term in &link.terms {
            let open = matches!(term, Term::Friction { velocity } if *velocity == 0.0)
                || matches!(term, Term::BumpStop { gap, .. } if *gap == 0.0);
            if open {
                let wrong = format!(
                    "`{}` has no constant, and no record from which to take it",
                    term.text()
                );
                let remedy = "state it in brackets: coulomb_friction(0.006) fades below 0.006 m/s, bump_stop(0.03 compression) has a gap of 0.03 m";
                faults.push(at("vehicle.terms", wrong, remedy));
            }
            if term.is_of_time() {
                let wrong = format!(
                    "`{}` changes with time, which `simulate` does not follow",
                    term.text()
                );
                faults.push(at("vehicle.terms", wrong, "delete the term"));
            }
        }
    }
    let parameters = models.on_tyres.parameters();
    let names: Vec<&str> = parameters.iter().map(|p| p.name.as_str()).collect();
    for name in section
        .known
        .keys()
        .filter(|n| !names.contains(&n.as_str()))
    {
        let wrong = format!("model `{}` has no parameter `{name}`", section.model);
        let remedy = format!("name one of {}", names.join(", "));
        faults.push(at(&format!("vehicle.known.{name}"), wrong, &remedy));
    }
    faults
}

/// Values of the parameters in the order of the model.
///
/// # Errors
/// One fault with the names of all parameters that the job does not state.
fn parameter_values(job: &Job, section: &VehicleJob, model: &Vehicle) -> Result<Vec<f64>, Fault> {
    let parameters = model.parameters();
    let missing: Vec<&str> = (parameters.iter().map(|p| p.name.as_str()))
        .filter(|name| !section.known.contains_key(*name))
        .collect();
    if !missing.is_empty() {
        let wrong = format!(
            "a simulation needs every parameter; {} missing: {}",
            missing.len(),
            missing.join(", ")
        );
        let remedy = "state them in `known`, in the units of the job; `identify` estimates them from a record";
        let line = section.line;
        return Err(Fault::with_line(
            &*job.file,
            line,
            "vehicle.known",
            wrong,
            remedy,
        ));
    }
    let value = |name: &str| section.known.get(name).copied();
    Ok(parameters.iter().filter_map(|p| value(&p.name)).collect())
}

/// Accelerometers of bodies of the model.
fn accelerometers(model: &Vehicle) -> impl Iterator<Item = &str> {
    let of_body = |s: &&crate::vehicle::layout::Sensor| {
        s.measures == Measures::Acceleration && !model.is_witness(s.at.body)
    };
    model
        .sensors
        .iter()
        .filter(of_body)
        .map(|s| s.channel.as_str())
}

/// Returns the channels that drive the vehicle, as stated or by the columns of the record.
fn driving_channels(
    section: &VehicleJob,
    models: &Models,
    record: &Channels,
    fault: impl Fn(String, &str) -> Fault,
) -> Result<Vec<String>, Fault> {
    let forces: Vec<&str> = models
        .plain
        .wheels
        .iter()
        .map(|w| w.channel.as_str())
        .collect();
    let roads: Vec<&str> = models.tyres.iter().map(|t| t.channel.as_str()).collect();
    let accelerations: Vec<&str> = accelerometers(&models.plain).collect();
    let owned = |list: &[&str]| {
        list.iter()
            .map(|c| (*c).to_owned())
            .collect::<Vec<String>>()
    };
    let all = [forces.as_slice(), &roads, &accelerations].concat();
    let kind = match &section.input {
        Some(SimulationInput::Channels(names)) => {
            if names.is_empty() {
                return Err(fault(
                    "the list is empty".to_owned(),
                    "name a channel of the model",
                ));
            }
            let Some(unknown) = names.iter().find(|n| !all.contains(&n.as_str())) else {
                return Ok(names.clone());
            };
            let close = find_closest_name(unknown, all.iter().copied());
            let hint = close.map_or_else(String::new, |c| format!("; did you mean `{c}`?"));
            let wrong = format!("model `{}` has no channel `{unknown}`{hint}", section.model);
            return Err(fault(
                wrong,
                &format!("name channels of {}", all.join(", ")),
            ));
        }
        Some(SimulationInput::Kind(kind)) => *kind,
        None => {
            let has = |list: &[&str]| list.iter().any(|c| record.has(c));
            let present: Vec<(&str, InputKind)> = InputKind::WORDS
                .into_iter()
                .filter(|(_, kind)| match kind {
                    InputKind::WheelForce => has(&forces),
                    InputKind::Road => has(&roads),
                    InputKind::Acceleration => has(&accelerations),
                })
                .collect();
            match present.as_slice() {
                [(_, kind)] => *kind,
                [] => {
                    let wrong = format!(
                        "{} contains no channel that can drive model `{}`",
                        section.data.given, section.model
                    );
                    return Err(fault(
                        wrong,
                        &format!("name the columns of one kind: {}", all.join(", ")),
                    ));
                }
                several => {
                    let words: Vec<String> =
                        several.iter().map(|p| format!("\"{}\"", p.0)).collect();
                    let wrong = format!(
                        "{} contains more than one kind of input: {}",
                        section.data.given,
                        words.join(", ")
                    );
                    return Err(fault(
                        wrong,
                        "state `input` as one of these words, or as a list of channels: input = [\"a_wheel\"]",
                    ));
                }
            }
        }
    };
    match kind {
        InputKind::WheelForce => Ok(owned(&forces)),
        InputKind::Road if roads.is_empty() => Err(fault(
            format!("the wheels of model `{}` have no tyres", section.model),
            "state input = \"wheel_force\" or \"acceleration\"",
        )),
        InputKind::Road => Ok(owned(&roads)),
        InputKind::Acceleration => {
            let present: Vec<&str> = accelerations
                .iter()
                .copied()
                .filter(|c| record.has(c))
                .collect();
            if present.is_empty() {
                let wrong = format!(
                    "{} contains no acceleration of the model",
                    section.data.given
                );
                return Err(fault(
                    wrong,
                    &format!("add a column, one of {}", accelerations.join(", ")),
                ));
            }
            Ok(owned(&present))
        }
    }
}

/// Adds the channels of bodies beyond the model, whose motion is always an input.
fn with_witnesses(model: &Vehicle, tyres: &[Tyre], mut channels: Vec<String>) -> Vec<String> {
    let of_road = |channel: &String| tyres.iter().any(|t| t.channel == *channel);
    for sensor in &model.sensors {
        let is_new = !of_road(&sensor.channel) && !channels.contains(&sensor.channel);
        if model.is_witness(sensor.at.body) && is_new {
            channels.push(sensor.channel.clone());
        }
    }
    channels
}

/// Refuses a record without a driving channel, or with a gap in one.
fn check_columns(file: &str, record: &Channels, channels: &[String]) -> Result<(), Faults> {
    let mut faults = FaultList::new();
    let names: Vec<&str> = record.list.iter().map(|c| c.name.as_str()).collect();
    for channel in channels {
        let Ok(samples) = record.samples(channel) else {
            let close = find_closest_name(channel, names.iter().copied());
            let hint = close.map_or_else(String::new, |c| format!("; did you mean `{c}`?"));
            let wrong =
                format!("the record has no column `{channel}`, which drives the model{hint}");
            let remedy = "add the column, or assign it with `columns` of [vehicle]; write 0 in every row if nothing acts";
            faults.push(Fault::new(file, channel.clone(), wrong, remedy));
            continue;
        };
        if let Some(at) = samples.iter().position(|v| !v.is_finite()) {
            let time = record.start_s + at as f64 / record.rate_hz;
            let wrong = format!(
                "sample {} (at {time:.4} s) is missing: an input cannot have a gap",
                at + 1
            );
            let remedy =
                "simulate a part of the record without gaps, or fill the gap in the record";
            faults.push(Fault::new(file, channel.clone(), wrong, remedy));
        }
    }
    Faults::check(faults)
}

/// Returns the inputs of the model from the driving channels.
///
/// # Errors
/// One fault a wheel or body with too few or too many inputs.
fn inputs_of(
    model: &Vehicle,
    tyres: &[Tyre],
    record: &Channels,
    channels: &[String],
    fault: impl Fn(String, &str) -> Fault,
) -> Result<Inputs, Faults> {
    let drives = |channel: &str| channels.iter().any(|c| c == channel);
    let samples = |channel: &str| record.samples(channel).unwrap_or_default().to_vec();
    let mut faults = FaultList::new();
    let mut inputs = Inputs {
        rate_hz: record.rate_hz,
        forces: vec![None; model.wheels.len()],
        motions: vec![None; model.bodies.len()],
        tyres: vec![None; model.wheels.len()],
    };
    for (b, body) in model.bodies.iter().enumerate() {
        let own = model.sensors.iter().filter(|s| s.at.body == b);
        let driving: Vec<_> = own.filter(|s| drives(&s.channel)).collect();
        let Some(first) = driving.first() else {
            continue;
        };
        if first.measures == Measures::Displacement {
            let height = samples(&first.channel);
            inputs.motions[b] = Some(PrescribedMotion::Displacements(vec![height]));
            continue;
        }
        let rows: Vec<Vec<f64>> = driving.iter().map(|s| model.functions(&s.at)).collect();
        if left_inverse(&rows).is_none() {
            let wrong = format!(
                "body `{}` has {} motions, and {} of its accelerometers drive it",
                body.name,
                body.shape.n(),
                driving.len()
            );
            faults.push(fault(
                wrong,
                "name accelerometers at as many places as the body has motions",
            ));
        }
        inputs.motions[b] = Some(PrescribedMotion::Accelerations(Vec::new()));
    }
    for (w, wheel) in model.wheels.iter().enumerate() {
        let tyre = tyres.iter().find(|t| t.wheel == w);
        let body = &model.bodies[wheel.at.body].name;
        let is_given = inputs.motions[wheel.at.body].is_some();
        let road = tyre.filter(|t| drives(&t.channel));
        match (is_given, drives(&wheel.channel), road) {
            (false, true, None) => inputs.forces[w] = Some(samples(&wheel.channel)),
            (false, false, Some(t)) => inputs.tyres[w] = Some(t.link),
            (true, false, None) => {}
            (false, false, None) => {
                let wrong = format!(
                    "wheel `{}` acts on body `{body}`, which moves freely, and nothing drives it",
                    wheel.channel
                );
                let remedy = "add its force or the height of its road to `input`, or prescribe the acceleration of the body";
                faults.push(fault(wrong, remedy));
            }
            _ => {
                let wrong = format!(
                    "wheel `{}` on body `{body}` is driven in more than one way",
                    wheel.channel
                );
                let remedy = "keep one of force, road and acceleration in `input`";
                faults.push(fault(wrong, remedy));
            }
        }
    }
    Faults::check(faults)?;
    Ok(inputs)
}
