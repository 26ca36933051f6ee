//! `identify`: vehicle parameters and wheel loads from accelerations.

use crate::host::context::Context;
use crate::host::fault::Faults;
use crate::host::outcome::{Answer, Outcome, StatedUnits, finite_or_none};
use crate::host::words::count_of;
use crate::host::work::Work;
use crate::job::Job;
use crate::series::channels::Channels;
use crate::series::detrend::rms;
use crate::strain_chain::named_results::check_tables;
use crate::units::number;
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::chassis::{ChassisForce, chassis_forces};
use crate::vehicle::checks::MassClosure;
use crate::vehicle::identify::{
    ChannelFit, Estimate, Identification, check_records, identify as fit_vehicle,
};
use crate::vehicle::loads::{LoadHistory, static_loads, wheel_force_history};
use crate::vehicle::motion::{Motion, Treatment, motion};
use crate::vehicle::stretch::slow_stretches;
use crate::workflow::vehicle::{VehicleRecords, read_vehicle, vehicle_fault};
use serde::Serialize;

/// Parameters of a vehicle and its wheel loads.
#[derive(Serialize)]
pub struct IdentifiedParameters {
    /// The vehicle model.
    pub model: String,
    /// The band of every equation, Hz.
    pub band_hz: [f64; 2],
    /// Parameters and ratios.
    pub parameters: Vec<Estimate>,
    /// Descriptions of the parameters that the data do not determine.
    pub unidentifiable: Vec<String>,
    /// Quality of the fit of each channel.
    pub fit: Vec<ChannelFit>,
    /// Ratio of the identified mass to the weighed mass.
    pub mass_closure: Option<f64>,
    /// Identified mass, weighed mass, and their ratio.
    pub mass_closure_detail: Option<MassClosure>,
    /// Smallest over largest singular value, worst component, columns of unit norm.
    pub conditioning: Option<f64>,
    /// Wheel loads.
    pub loads: Vec<WheelLoad>,
    /// Forces on sprung bodies.
    pub chassis_forces: Vec<ChassisForceOf>,
    /// Complete result of the identification.
    #[serde(skip)]
    pub found: Identification,
    /// Wheel forces of the fitted record.
    #[serde(skip)]
    pub fitted: WheelForceRecord,
    /// Wheel forces of the held-out record.
    #[serde(skip)]
    pub held_out: Option<WheelForceRecord>,
    /// Force histories on sprung bodies.
    #[serde(skip)]
    pub forces: Vec<ChassisForce>,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

impl Answer for IdentifiedParameters {
    const COMMAND: &'static str = "identify";
    const RESULT: &'static str = "The parameters";

    fn verdict(&self) -> String {
        let asked = || self.parameters.iter().filter(|p| !p.known);
        let worst = self
            .fit
            .iter()
            .max_by(|a, b| a.relative_rms.total_cmp(&b.relative_rms));
        let fit = worst.map_or_else(String::new, |f| {
            format!(
                ", largest residual {} % of {} ({})",
                number(100.0 * f.relative_rms),
                f.channel,
                f.on
            )
        });
        format!(
            "{} of {} identified{fit}.",
            asked().filter(|p| p.identifiable).count(),
            count_of(asked().count(), "parameter")
        )
    }
}

/// A record with the wheel forces recovered from it.
pub struct WheelForceRecord {
    /// Wheel forces.
    pub loads: LoadHistory,
    /// Accelerations, travels and measured forces.
    pub motion: Motion,
}

/// Recovered load: dynamic part of a wheel force over its record, and its mean if masses determine it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WheelLoad {
    /// The record.
    pub run: String,
    /// The load.
    pub name: String,
    /// Mean; `None` if no masses determine the mean.
    pub value: Option<f64>,
    /// Standard deviation of the wheel load.
    pub sigma: Option<f64>,
    /// Unit as text.
    pub unit: String,
    /// Smallest sample of the dynamic part.
    pub min: f64,
    /// Largest sample of the dynamic part.
    pub max: f64,
    /// Standard deviation of a sample.
    pub sample_sigma: Option<f64>,
}

/// The force on a sprung body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChassisForceOf {
    /// The body.
    pub body: String,
    /// Root mean square of the force from inertia.
    pub rms_by_mass: f64,
    /// Root mean square of the force from springs and dampers, if they were identified.
    pub rms_by_springs: Option<f64>,
    /// Root mean square of the difference between both forces, an estimate of the error of either; `None` if only one was identified.
    pub rms_difference: Option<f64>,
    /// Unit as text.
    pub unit: String,
}

/// Reads the vehicle and its records as [`identify`] does, runs the checks before the fit, and discards the data.
///
/// # Errors
/// Every fault of the job and its records.
pub(crate) fn check_inputs(work: &mut Work, job: &Job) -> Result<(), Faults> {
    let records = read_vehicle(work, job)?;
    let data_name = job.vehicle.as_ref().map_or("", |v| v.data.given.as_str());
    check_records(&records.task, &records.data, records.hold_out.as_ref())
        .map_err(|e| vehicle_fault(job, data_name, &e).into())
}

/// Identifies vehicle parameters from accelerations, and recovers wheel loads with them. The intervals include coloured residuals.
///
/// # Errors
/// Returns every fault of the job and its records.
///
/// # Example
/// A mass of 2 kg on a spring of 8000 N/m and a damper of 15 N s/m, from displacement and force:
/// ```
/// use strainbridge::{Context, Disk, Job, identify};
///
/// let job = concat!(env!("CARGO_MANIFEST_DIR"), "/examples/rig/oscillator.toml");
/// let found = identify(&Job::read(job, &Disk)?, &Context::new(&Disk))?;
/// for (name, truth) in [("m_b", 2.0), ("k_s", 8000.0), ("c_s", 15.0)] {
///     let parameter = found.parameters.iter().find(|p| p.name == name).unwrap();
///     let error = parameter.value.unwrap() - truth;
///     assert!(error.abs() < 4.0 * parameter.sigma.unwrap(), "{name}");
/// }
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn identify(job: &Job, cx: &Context) -> Result<Outcome<IdentifiedParameters>, Faults> {
    let mut work = Work::of_job(cx, job);
    check_tables(&work, job)?;
    let records = work.stage("read", |w| read_vehicle(w, job))?;
    let VehicleRecords {
        task,
        data,
        hold_out,
    } = &records;
    let data_name = job.vehicle.as_ref().map_or("", |v| v.data.given.as_str());
    let found = work
        .stage("identify", |_| fit_vehicle(task, data, hold_out.as_ref()))
        .map_err(|e| vehicle_fault(job, data_name, &e))?;
    work.findings.extend(found.findings.iter().cloned());
    work.findings.extend(found.verdict());
    let drive = |record: &Channels,
                 name: &str,
                 adjust: &[Adjustment]|
     -> Result<WheelForceRecord, Faults> {
        let treatment = Treatment {
            keep_every: 1,
            adjust: adjust.to_vec(),
            slow: slow_stretches(&found.vehicle, &found.values, record, adjust),
            ..Treatment::from_band(task.band)
        };
        let motion = motion(&found.vehicle, record, &treatment);
        let motion = motion.map_err(|e| vehicle_fault(job, name, &e))?;
        Ok(WheelForceRecord {
            loads: wheel_force_history(&found, &motion),
            motion,
        })
    };
    let unit = &task.units.force;
    let rows =
        |name: &str, d: &WheelForceRecord| load_rows(&found, task.gravity, unit, name, &d.loads);
    let fitted = drive(data, data_name, &task.corrections)?;
    let mut loads = rows(data_name, &fitted);
    let named = job.vehicle.as_ref().and_then(|v| v.hold_out.as_ref());
    let held_out = match (hold_out, named) {
        (Some(record), Some(named)) => {
            let driven = drive(
                record,
                &named.given,
                &Adjustment::without_slips(&task.corrections),
            )?;
            loads.extend(rows(&named.given, &driven));
            Some(driven)
        }
        _ => None,
    };
    let forces = chassis_forces(task, &found, &fitted.motion);
    let answer = IdentifiedParameters {
        model: found.vehicle.name.clone(),
        band_hz: [task.band.low_hz, task.band.high_hz],
        parameters: found.parameters.clone(),
        unidentifiable: found.unidentifiable.clone(),
        fit: found.fit.clone(),
        mass_closure: found.mass_closure.map(|m| m.ratio),
        mass_closure_detail: found.mass_closure,
        conditioning: finite_or_none(found.conditioning),
        loads,
        chassis_forces: forces.iter().map(|f| force_row(f, unit)).collect(),
        fitted,
        held_out,
        forces,
        job: job.clone(),
        found,
    };
    let units = StatedUnits::of_model(job.units);
    Ok(work.finish(units, answer))
}

fn force_row(f: &ChassisForce, unit: &str) -> ChassisForceOf {
    ChassisForceOf {
        body: f.body.clone(),
        rms_by_mass: rms(&f.by_mass),
        rms_by_springs: f.difference().map(|_| rms(&f.by_springs)),
        rms_difference: f.difference(),
        unit: unit.to_owned(),
    }
}

fn load_rows(
    found: &Identification,
    gravity: f64,
    unit: &str,
    run: &str,
    history: &LoadHistory,
) -> Vec<WheelLoad> {
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
            WheelLoad {
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
