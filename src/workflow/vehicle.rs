//! The vehicle of a job and its records, in the job's units: what `identify` and `reconcile` start from.

use crate::finding::{Finding, Severity};
use crate::host::fault::{Fault, FaultList, Faults};
use crate::host::words::format_number;
use crate::host::work::Work;
use crate::input_faults::{ChannelKind, MotionChannel, channels_by_gravity, findings_by_gravity};
use crate::job::suggest::find_closest_name;
use crate::job::{ChannelCorrection, Job, NamedFile, Vehicle as VehicleJob};
use crate::measured::faults::record_fault;
use crate::recovery::clock;
use crate::series::Channels;
use crate::series::quality::{Kind, check_channels};
use crate::series::record::{Options, open_record, read_channels};
use crate::series::spectrum::Band;
use crate::units::{Quantity, find_unit};
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::identify::IdentifyTask;
use crate::vehicle::layout::{MassStep, Measures, Vehicle};
use crate::vehicle::motion::VehicleError;
use crate::vehicle::preset::{PresetError, PresetRequest, vehicle};
use crate::vehicle::term::UnitNames;
use crate::vehicle::wrong_inputs::motion_channels;
use std::sync::Arc;

/// Band if the job states none, Hz: rigid-body and axle motion of a truck.
const DEFAULT_BAND_HZ: [f64; 2] = [0.7, 20.0];

/// A task with its records.
pub struct VehicleRecords {
    /// Identification task.
    pub task: IdentifyTask,
    /// The record to fit.
    pub data: Channels,
    /// Held-out record, for tests.
    pub hold_out: Option<Channels>,
}

/// Reads `[vehicle]`, its records, converts units, and checks every channel; findings go to the work.
///
/// # Errors
/// Every fault of section, files and model.
pub fn read_vehicle(work: &mut Work, job: &Job) -> Result<VehicleRecords, Faults> {
    let section = section_of(job)?;
    let request = preset_request(section);
    let mut model = vehicle(&request).map_err(|e| Faults::from(preset_fault(job, section, &e)))?;
    if let Some(link) = section
        .leaf
        .keys()
        .find(|k| model.links.iter().all(|l| l.name != **k))
    {
        let links: Vec<String> = model
            .links
            .iter()
            .map(|l| format!("`{}`", l.name))
            .collect();
        return Err(Faults::from(Fault::with_line(
            &*job.file,
            section.line,
            format!("vehicle.leaf.{link}"),
            format!("model `{}` has no link `{link}`", section.model),
            format!("name one of {}", links.join(", ")),
        )));
    }
    let gravity = job.units.standard_gravity();
    if let Some(change) = &section.mass_change {
        let Some(body) = model.bodies.iter().position(|b| b.name == change.body) else {
            return Err(Faults::from(Fault::with_line(
                &*job.file,
                section.line,
                "vehicle.mass_change.body",
                format!("model `{}` has no body `{}`", section.model, change.body),
                "name a body as in its mass: `b` for `m_b`",
            )));
        };
        model.steps.push(MassStep {
            body,
            at_s: change.at_s,
            over_s: change.over_s,
            gravity: if change.weight { gravity } else { 0.0 },
        });
    }
    let data = read_record(work, job, section, &model, &section.data)?;
    let hold_out = section
        .hold_out
        .as_ref()
        .map(|h| read_record(work, job, section, &model, h))
        .transpose()?;
    let mut band = section.band_hz.unwrap_or(DEFAULT_BAND_HZ);
    if section.band_hz.is_none() {
        band[1] = band[1].min(0.4 * data.rate_hz);
        let message = format!(
            "The job names no band; {} to {} Hz is used for every channel.",
            band[0], band[1]
        );
        work.findings.push(Finding::new(
            Severity::Info,
            "default-band",
            "vehicle.band_hz",
            message,
            "State `band_hz` in [vehicle].",
        ));
    }
    for (named, record) in [
        (Some(&section.data), Some(&data)),
        (section.hold_out.as_ref(), hold_out.as_ref()),
    ] {
        if let (Some(named), Some(record)) = (named, record) {
            let used = |name: &str| match kind_in(&model, name) {
                Some(Quantity::Force) => Kind::Force,
                Some(_) => Kind::Acceleration,
                None if name.starts_with("a_") => Kind::Acceleration,
                None => Kind::Other,
            };
            check_samples(&named.given, record, |name| used(name) != Kind::Other)?;
            work.findings.extend(misspelt(&named.given, record, &model));
            let channels = channels_in_job_units(job, &model, record);
            let wrong = channels_by_gravity(&channels, gravity);
            let mut findings = check_channels(record, gravity, used);
            // A mean that indicates another sign or unit is not an offset.
            findings.retain(|f| f.code != "offset" || !wrong.contains(&f.subject.as_str()));
            work.findings.extend(findings.into_iter().map(|f| Finding {
                subject: format!("{}: {}", named.given, f.subject),
                ..f
            }));
            work.findings
                .extend(findings_by_gravity(&channels, gravity, &named.given));
        }
    }
    let task = IdentifyTask {
        vehicle: model,
        known: section.known.clone(),
        bounds: section.bounds.clone(),
        band: Band {
            low_hz: band[0],
            high_hz: band[1],
        },
        gravity,
        gain_tolerance: section.tolerance_gain.unwrap_or(0.0),
        sync_tolerance_s: section.tolerance_sync.unwrap_or(0.0),
        noise_acc: section.noise_acc,
        noise_force: section.noise_force,
        corrections: corrections_of(section),
        units: UnitNames::from_system(job.units),
    };
    Ok(VehicleRecords {
        task,
        data,
        hold_out,
    })
}

/// Returns a warning on channels of the model that the record lacks, if it has columns with similar names. A misspelt wheel force would count as not
/// measured. A column with another first letter is another quantity: `a_wheel` is not meant for `f_wheel`.
fn misspelt(file: &str, record: &Channels, model: &Vehicle) -> Option<Finding> {
    let wheels = model.wheels.iter().map(|w| w.channel.as_str());
    let all: Vec<&str> = wheels
        .chain(model.sensors.iter().map(|s| s.channel.as_str()))
        .collect();
    let others = record.list.iter().map(|c| c.name.as_str());
    let others: Vec<&str> = others.filter(|c| !all.contains(c)).collect();
    let missing = all.iter().filter(|c| !record.has(c));
    let pairs: Vec<String> = missing
        .filter_map(|c| {
            let first = |name: &str| name.chars().next().map(|f| f.to_ascii_lowercase());
            let alike = others.iter().filter(|o| first(o) == first(c));
            find_closest_name(c, alike.copied()).map(|o| format!("`{o}` for `{c}`"))
        })
        .collect();
    (!pairs.is_empty()).then(|| {
        Finding::new(
            Severity::Warning,
            "channel-misspelt",
            file,
            format!("did you mean {}? A channel with another name is treated as not measured", pairs.join(", ")),
            "Name the columns after the model's channels, or assign the columns with `columns` of [vehicle].",
        )
    })
}

/// No acceleration or force of a vehicle is larger in any system of units.
const LARGEST_SAMPLE: f64 = 1e15;

/// Checks that the samples of the used channels are possible readings.
///
/// # Errors
/// One fault for each channel with impossible samples.
pub(super) fn check_samples(
    file: &str,
    record: &Channels,
    used: impl Fn(&str) -> bool,
) -> Result<(), Faults> {
    let huge = |v: &f64| v.abs() > LARGEST_SAMPLE;
    let channels = record.list.iter().filter(|c| used(&c.name));
    let faults: FaultList = channels
        .filter_map(|c| {
            let at = c.samples.iter().position(huge)?;
            let wrong = format!(
                "sample {} reads {}: no acceleration and no force is so large",
                at + 1,
                format_number(c.samples[at])
            );
            let remedy = "leave the field blank if the logger recorded nothing";
            Some(Fault::new(file, c.name.clone(), wrong, remedy))
        })
        .collect();
    Faults::check(faults)
}

/// Returns known faults of channels.
fn corrections_of(section: &VehicleJob) -> Vec<Adjustment> {
    let one = |(channel, c): (&String, &ChannelCorrection)| Adjustment {
        gain: c.gain,
        delay_s: c.delay_s,
        clock: c.clock_ppm * 1e-6,
        slips: c.slip.into_iter().collect(),
        lags: c.lag.into_iter().collect(),
        lines_hz: c.line_hz.into_iter().collect(),
        ..Adjustment::none(channel)
    };
    section.corrections.iter().map(one).collect()
}

/// Returns `[vehicle]` of a job.
///
/// # Errors
/// A fault if the job has no `[vehicle]`.
pub fn section_of(job: &Job) -> Result<&VehicleJob, Faults> {
    job.vehicle.as_ref().ok_or_else(|| {
        Faults::from(Fault::new(
            &*job.file,
            "vehicle",
            "the job has no [vehicle] section",
            "add one with `model` and `data`",
        ))
    })
}

/// Returns the vehicle request of a section.
pub fn preset_request(section: &VehicleJob) -> PresetRequest {
    PresetRequest {
        model: section.model.clone(),
        terms: section.terms.clone(),
        places: section.places.clone(),
        channels: section.columns.clone(),
    }
}

/// Returns the fault for an error of the vehicle layer, at the line of the job.
pub fn vehicle_fault(job: &Job, file: &str, e: &VehicleError) -> Fault {
    let line = job.vehicle.as_ref().map_or(0, |v| v.line);
    let (wrong, remedy) = e.parts();
    match e {
        VehicleError::HeldOut(inner) => {
            let hold_out = job.vehicle.as_ref().and_then(|v| v.hold_out.as_ref());
            vehicle_fault(job, hold_out.map_or(file, |h| &h.given), inner)
        }
        VehicleError::Series(_) => Fault::new(file, "record", wrong, remedy),
        VehicleError::Bounds { name, .. } => {
            let key = format!("vehicle.bounds.{name}");
            Fault::with_line(&*job.file, line, key, wrong, remedy)
        }
        _ => Fault::with_line(&*job.file, line, "vehicle", wrong, remedy),
    }
}

/// Returns the fault for an error in the request of a vehicle, at the line of the job.
pub(super) fn preset_fault(job: &Job, section: &VehicleJob, e: &PresetError) -> Fault {
    let key = match e {
        PresetError::Model { .. } => "vehicle.model",
        PresetError::Term { .. } => "vehicle.terms",
        PresetError::Place { .. } => "vehicle.places",
    };
    let (wrong, remedy) = e.parts();
    Fault::with_line(&*job.file, section.line, key, wrong, remedy)
}

/// Returns the accelerations and wheel forces of a record that the model uses.
pub(super) fn channels_in_job_units<'a>(
    job: &Job,
    model: &Vehicle,
    record: &'a Channels,
) -> Vec<MotionChannel<'a>> {
    motion_channels(model, record, |kind| {
        let quantity = match kind {
            ChannelKind::Acceleration => Quantity::Acceleration,
            ChannelKind::Force => Quantity::Force,
        };
        job.units.unit(quantity).name.to_owned()
    })
}

/// Reads a record of any format that a record of strain may have, in the job's units.
pub(super) fn read_record(
    work: &mut Work,
    job: &Job,
    section: &VehicleJob,
    model: &Vehicle,
    named: &NamedFile,
) -> Result<Channels, Faults> {
    let bytes = work.inputs.read_named(job, named).map_err(Faults::from)?;
    let used = |name: &str| kind_in(model, name);
    let sensors = model.sensors.iter().map(|s| s.channel.clone());
    let options = Options {
        declared_hz: section.sample_rate,
        wanted: sensors
            .chain(model.wheels.iter().map(|w| w.channel.clone()))
            .collect(),
        ..Options::default()
    };
    let read = open_record(Arc::new(bytes), &options).and_then(|record| {
        // A sampling rate that the job states confirms the unit of time.
        let is_open = !record.is_time_unit_stated() && section.sample_rate.is_none();
        let rate_hz = record.clock.rate_hz;
        let doubtful = is_open.then(|| clock::check_rate(rate_hz)).flatten();
        let of_clock = clock::check_time_steps(&named.given, &record.clock);
        work.findings.extend(of_clock.into_iter().chain(doubtful));
        read_channels(&record)
    });
    let mut record = read.map_err(|e| record_fault(&named.given, &e))?;
    let mut faults = FaultList::new();
    for channel in record.list.iter_mut().filter(|c| !c.unit.is_empty()) {
        let kind = used(&channel.name);
        match factor(job, kind, &channel.unit) {
            Some(f) => channel.samples.iter_mut().for_each(|v| *v *= f),
            None => faults.extend(kind.map(|kind| {
                Fault::with_line(
                    &*named.given,
                    1,
                    channel.name.clone(),
                    format!("`{}` is not a unit of {}", channel.unit, kind.word()),
                    "write m/s2, mm/s2, g, N, kN or another unit that the job may use",
                )
            })),
        }
    }
    Faults::check(faults)?;
    Ok(record)
}

/// Returns the quantity of a channel that the model uses.
fn kind_in(model: &Vehicle, name: &str) -> Option<Quantity> {
    let sensor = model.sensors.iter().find(|s| s.channel == name);
    let force = model.wheels.iter().find(|w| w.channel == name);
    let of_sensor = sensor.map(|s| match s.measures {
        Measures::Acceleration => Quantity::Acceleration,
        Measures::Displacement => Quantity::Length,
    });
    of_sensor.or(force.map(|_| Quantity::Force))
}

/// Returns the factor that converts a number in that unit into the job's units. For a channel that the model does not use, the unit determines the
/// quantity.
fn factor(job: &Job, kind: Option<Quantity>, unit: &str) -> Option<f64> {
    // A voltage, for example, is not converted.
    if matches!(unit, "-" | "1" | "V") {
        return Some(1.0);
    }
    let of = |q: Quantity| {
        let si = match q {
            Quantity::Acceleration => ChannelKind::Acceleration.unit_si(unit),
            _ => find_unit(q, unit).map(|u| u.si),
        };
        Some(si? / job.units.si(q))
    };
    match kind {
        Some(q) => of(q),
        None => [Quantity::Acceleration, Quantity::Force]
            .into_iter()
            .find_map(of),
    }
}
