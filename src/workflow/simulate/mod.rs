//! `simulate`: the response of a vehicle with known parameters to wheel forces, to a road, or to recorded accelerations.

mod columns;
mod inputs;
mod rest;

use crate::finding::{Finding, Severity};
use crate::host::context::Context;
use crate::host::fault::{Fault, Faults};
use crate::host::outcome::{Answer, Outcome, StatedUnits};
use crate::host::words::format_number;
use crate::host::work::Work;
use crate::job::Job;
use crate::strain_chain::named_results::check_tables;
use crate::units::number;
use crate::vehicle::response::{
    Response, ResponseError, ResponseRules, compute_response, static_wheel_loads,
};
use crate::workflow::vehicle::section_of;
pub use columns::{ChannelRange, Column};
use inputs::{Simulation, read_simulation};
use serde::Serialize;

/// Response of a vehicle with known parameters.
#[derive(Serialize)]
pub struct SimulatedResponse {
    /// The vehicle model.
    pub model: String,
    /// Channels of the record that drive the vehicle.
    pub driven_by: Vec<String>,
    /// Samples.
    pub samples: usize,
    /// Samples per second.
    pub sample_rate_hz: f64,
    /// Highest natural frequency of the bodies that move freely, Hz; 0 without springs.
    pub fastest_mode_hz: f64,
    /// How the equations were integrated.
    pub integration: String,
    /// Change of the results, relative to their largest value, when the steps were halved for the last time; 0 for exact integration.
    pub step_error: f64,
    /// Parameters of the job.
    pub parameters: Vec<UsedParameter>,
    /// Range of each channel.
    pub response: Vec<ChannelRange>,
    /// Time of the first sample, s.
    #[serde(skip)]
    pub start_s: f64,
    /// Samples of each channel.
    #[serde(skip)]
    pub columns: Vec<Column>,
    /// The job.
    #[serde(skip)]
    pub job: Job,
}

/// Parameter that a simulation used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct UsedParameter {
    /// Name.
    pub name: String,
    /// Value of the job.
    pub value: f64,
    /// Unit as text.
    pub unit: String,
}

impl SimulatedResponse {
    /// Samples of a channel of `response.csv`, such as `f_wheel` or `s.stretch`.
    pub fn channel(&self, name: &str) -> Option<&[f64]> {
        let column = self.columns.iter().find(|c| c.name == name);
        column.map(|c| c.values.as_slice())
    }
}

impl Answer for SimulatedResponse {
    const COMMAND: &'static str = "simulate";
    const RESULT: &'static str = "The response";

    fn verdict(&self) -> String {
        let size = |r: &ChannelRange| r.max.abs().max(r.min.abs());
        let largest = |kind: &str, word: &str| {
            let of_kind = |c: &&Column| c.kind == kind;
            let names: Vec<&str> = (self.columns.iter().filter(of_kind))
                .map(|c| c.name.as_str())
                .collect();
            let rows = self
                .response
                .iter()
                .filter(|r| names.contains(&r.channel.as_str()));
            let row = rows.max_by(|a, b| size(a).total_cmp(&size(b)));
            row.map_or_else(String::new, |r| {
                format!(
                    ", largest {word} {} {} ({})",
                    number(size(r)),
                    r.unit,
                    r.channel
                )
            })
        };
        format!(
            "{} s of `{}` simulated from {}{}{}.",
            number(self.samples as f64 / self.sample_rate_hz),
            self.model,
            self.driven_by.join(", "),
            largest(columns::WHEEL, "wheel force"),
            largest(columns::LINK, "force of a spring and damper")
        )
    }
}

/// Reads the vehicle and its inputs as [`simulate`] does, and integrates nothing.
///
/// # Errors
/// Every fault of the job and its record.
pub(crate) fn check_inputs(work: &mut Work, job: &Job) -> Result<(), Faults> {
    read_simulation(work, job).map(|_| ())
}

/// Returns whether a job asks for a simulation: it names the input, or knows every parameter of the model.
pub(crate) fn is_asked(job: &Job) -> bool {
    let Some(section) = &job.vehicle else {
        return false;
    };
    section.input.is_some() || inputs::knows_all(section)
}

/// Simulates a vehicle with known parameters, from wheel forces, from a road or from recorded accelerations.
///
/// All motions and forces are about the position at rest. The vehicle starts at rest.
///
/// # Errors
/// Returns every fault of the job and its record.
///
/// # Example
/// A mass of 2 kg is on a spring of 8000 N/m. Under a constant force of 16 N it swings about the static displacement of 2 mm:
/// ```
/// use std::path::Path;
/// use strainbridge::host::context::InMemory;
/// use strainbridge::{Context, Job, simulate};
///
/// let job = "units = \"m-kg-s\"\n[vehicle]\nmodel = \"oscillator\"\ndata = \"u.csv\"\nknown = { m_b = 2.0, k_s = 8000.0, c_s = 0.0 }\n";
/// let mut force = String::from("time [s],u [N]\n");
/// (0..400).for_each(|i| force += &format!("{:.3},16\n", f64::from(i) / 1000.0));
/// let files = InMemory::default().with_file("job.toml", job).with_file("u.csv", force);
/// let found = simulate(&Job::read(Path::new("job.toml"), &files)?, &Context::new(&files))?;
/// for (i, y) in found.channel("y").unwrap().iter().enumerate() {
///     let time = i as f64 / 1000.0;
///     let expected = 0.002 * (1.0 - (4000.0f64.sqrt() * time).cos());
///     assert!((y - expected).abs() < 1e-9);
/// }
/// # Ok::<(), strainbridge::Faults>(())
/// ```
pub fn simulate(job: &Job, cx: &Context) -> Result<Outcome<SimulatedResponse>, Faults> {
    let mut work = Work::of_job(cx, job);
    check_tables(&work, job)?;
    let simulation = work.stage("read", |w| read_simulation(w, job))?;
    let Simulation {
        vehicle, values, ..
    } = &simulation;
    let rules = ResponseRules::default();
    let found = work
        .stage("simulate", |_| {
            compute_response(vehicle, values, &simulation.inputs, &rules)
        })
        .map_err(|e| response_fault(job, &e, &rules))?;
    let gravity = job.units.standard_gravity();
    let rest = static_wheel_loads(vehicle, values, &simulation.inputs, gravity);
    let rest = rest.map_err(|e| response_fault(job, &e, &rules))?;
    work.findings
        .extend(lifted_wheels(&simulation, &found, &rest));
    work.findings.extend(drifting_motion(&simulation, &found));
    let columns = columns::columns_of(&simulation, &found, job.units);
    let integration = match found.steps {
        None => "exact for inputs that are cubic curves between samples".to_owned(),
        Some(steps) => format!("Runge-Kutta of order 4, {steps} steps a sample"),
    };
    let parameters = vehicle.parameters().into_iter().zip(values);
    let answer = SimulatedResponse {
        model: vehicle.name.clone(),
        driven_by: simulation.channels.clone(),
        samples: columns.first().map_or(0, |c| c.values.len()),
        sample_rate_hz: simulation.inputs.rate_hz,
        fastest_mode_hz: found.fastest_hz,
        integration,
        step_error: found.step_error,
        parameters: parameters
            .map(|(p, value)| UsedParameter {
                unit: simulation.units.unit_name(p.quantity),
                name: p.name,
                value: *value,
            })
            .collect(),
        response: columns.iter().map(Column::range).collect(),
        start_s: simulation.start_s,
        columns,
        job: job.clone(),
    };
    Ok(work.finish(StatedUnits::of_model(job.units), answer))
}

/// Returns the fault of a response that cannot be computed.
fn response_fault(job: &Job, e: &ResponseError, rules: &ResponseRules) -> Fault {
    let section = section_of(job).ok();
    let line = section.map_or(0, |v| v.line);
    let data = section.map_or("", |v| v.data.given.as_str());
    let at =
        |key: &str, remedy: String| Fault::with_line(&*job.file, line, key, e.to_string(), remedy);
    match e {
        ResponseError::Inertia(_) => at(
            "vehicle.known",
            "state masses above 0, and products of inertia that a body can have".to_owned(),
        ),
        ResponseError::Inertance(_) => at("vehicle.terms", "delete the term".to_owned()),
        ResponseError::NothingFree => at(
            "vehicle.input",
            "name the channels that drive the vehicle, such as input = [\"a_wheel\"]".to_owned(),
        ),
        ResponseError::Length { .. } => Fault::new(
            data,
            "record",
            e.to_string(),
            "give a record of two samples or more",
        ),
        ResponseError::TooCoarse { needed_hz, .. } => Fault::new(
            data,
            "vehicle.sample_rate",
            format!(
                "{e}, {} samples a period, so that the curve between samples follows the input to 0.1 %",
                number(rules.samples_per_period)
            ),
            format!(
                "resample the record to {} Hz or more, or correct masses and stiffnesses",
                format_number(*needed_hz)
            ),
        ),
        ResponseError::Diverged { .. } => at(
            "vehicle.known",
            "correct the sign of a stiffness or damping".to_owned(),
        ),
        ResponseError::Unsettled { .. } => at(
            "vehicle.terms",
            "state a larger velocity for friction, such as coulomb_friction(0.01), or resample the record to a higher rate".to_owned(),
        ),
    }
}

/// Returns an error for each wheel whose tyre would have to pull at the road.
fn lifted_wheels(simulation: &Simulation, found: &Response, rest: &[Option<f64>]) -> Vec<Finding> {
    let wheels = simulation
        .vehicle
        .wheels
        .iter()
        .zip(&found.wheels)
        .zip(rest);
    let force = &simulation.units.force;
    wheels
        .filter_map(|((wheel, dynamic), rest)| {
            let (dynamic, rest) = (dynamic.as_ref()?, (*rest)?);
            let lifted = dynamic.iter().filter(|f| **f + rest < 0.0).count();
            let lowest = dynamic.iter().copied().fold(f64::INFINITY, f64::min) + rest;
            (lifted > 0).then(|| {
                let share = 100.0 * lifted as f64 / dynamic.len() as f64;
                let message = format!(
                    "the tyre pulls at the road in {} % of the samples, with up to {} {force}; its static load is {} {force}. The model has no lift-off",
                    number(share),
                    number(-lowest),
                    number(rest)
                );
                let remedy = "Use a smoother road or a lower speed, or correct masses and tyre stiffness.";
                Finding::new(Severity::Error, "wheel-lifts-off", &wheel.channel, message, remedy)
                    .with_numbers(lowest, 0.0)
            })
        })
        .collect()
}

/// Largest displacement of a body over the largest stretch of a spring. Springs of vehicles stretch by some centimetres, and no
/// vehicle on a test moves up or down by a hundred times that.
const MOST_DISPLACEMENT: f64 = 100.0;

/// Returns a warning if the integration of forces or accelerations drifts.
fn drifting_motion(simulation: &Simulation, found: &Response) -> Option<Finding> {
    if simulation.inputs.tyres.iter().any(Option::is_some) {
        return None;
    }
    let largest = |x: &[f64]| x.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let stretch = found.stretch.iter().map(|x| largest(x)).fold(0.0, f64::max);
    let names = simulation.vehicle.bodies.iter().map(|b| b.name.as_str());
    let sizes = found
        .displacement
        .iter()
        .map(|d| d.first().map_or(0.0, |x| largest(x)));
    let (body, size) = names.zip(sizes).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (stretch > 0.0 && size > MOST_DISPLACEMENT * stretch).then(|| {
        let length = &simulation.units.length;
        let message = format!(
            "the displacement of body `{body}` drifts to {} {length}, the largest stretch of a spring is {} {length}. The drift is the double integral of \
             the offset of the input. Stretches, accelerations and forces contain the offset once, not its integral",
            number(size),
            number(stretch)
        );
        let remedy = "Use stretches, accelerations and forces. For displacements, remove the offset of the input.";
        Finding::new(Severity::Warning, "integrated-motion-drifts", body, message, remedy)
            .with_numbers(size, MOST_DISPLACEMENT * stretch)
    })
}
