//! Error of simulation of the named model. A simulation of the fitted record finds the parameters again, and a simulation of the held-out record, if
//! there is one, tests them.
//!
//! The search compares equations, which are linear in their unknowns. A simulation has no measured motion on its right-hand side, so neither sensor
//! noise in the regressors nor twice integrated stretch can hide an error. The analyst's model is simulated in the same way.

use super::frame::MotionFrame;
use super::gap::{Proof, RecordGap};
use super::outcome::MotionOutcome;
use crate::series::channels::Channels;
use crate::series::detrend::rms;
use crate::series::spectrum::Band;
use crate::vehicle::adjustment::Adjustment;
use crate::vehicle::layout::{Measures, Vehicle};
use crate::vehicle::refine::{Comparison, OPEN, comparison, refine};
use crate::vehicle::simulate::SimulationError;

/// Number of samples of the fitted record that are simulated repeatedly; further samples would hardly improve the parameters.
const FITTED: usize = 12_000;
/// Samples at the start that a comparison with displacement sensors excludes, while the simulation from rest settles.
const FORGOTTEN: usize = 200;
/// Integration steps for each sample; the first number that does not diverge is used.
const STEPS: [usize; 2] = [2, 8];

/// Error of simulation of one sensor, RMS in its unit.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedChannel {
    /// Channel.
    pub channel: String,
    /// RMS of the measured quantity.
    pub measured: f64,
    /// RMS error of the analyst's model.
    pub before: f64,
    /// RMS error of the named model.
    pub after: f64,
}

/// Gaps of both models, computed by simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedGap {
    /// Result for each simulated sensor.
    pub channels: Vec<SimulatedChannel>,
    /// Parameters of the named model: name, by regression, by simulation.
    pub parameters: Vec<(String, f64, f64)>,
    /// Data on which both models were simulated: the held-out record, or else the fitted record.
    pub judged_by: Proof,
}

/// Simulates both models, or returns the reason if that is impossible.
///
/// # Errors
/// A message if the model has inertance or a change of mass. Also if the inertia of a body is unknown, or if the motion diverges.
pub fn simulated_gap(frame: &MotionFrame, outcome: &MotionOutcome) -> Result<SimulatedGap, String> {
    let (Some(before), Some(after)) = (&outcome.before, &outcome.after) else {
        return Err("there is no model to simulate".into());
    };
    let one = validate_by_simulation(frame, before, &frame.corrections)?;
    let two = validate_by_simulation(frame, after, &outcome.corrections)?;
    let channels = two.errors.iter().filter_map(|(channel, measured, error)| {
        let plain = one.errors.iter().find(|e| e.0 == *channel)?;
        Some(SimulatedChannel {
            channel: channel.clone(),
            measured: *measured,
            before: plain.2,
            after: *error,
        })
    });
    let names = after.vehicle.parameters();
    Ok(SimulatedGap {
        channels: channels.collect(),
        parameters: (two.free.iter())
            .map(|&i| (names[i].name.clone(), after.values[i], two.values[i]))
            .collect(),
        judged_by: match frame.hold_out {
            Some(_) => Proof::HeldOut,
            None => Proof::Fitted,
        },
    })
}

struct SimulationFit {
    /// Channel, RMS of what was measured, RMS of the error.
    errors: Vec<(String, f64, f64)>,
    values: Vec<f64>,
    free: Vec<usize>,
}

/// Fits a model to the fitted record by simulation and compares it with the other record.
fn validate_by_simulation(
    frame: &MotionFrame,
    model: &RecordGap,
    adjust: &[Adjustment],
) -> Result<SimulationFit, String> {
    let v = &model.vehicle;
    let of_time = v
        .links
        .iter()
        .any(|l| l.terms.iter().any(|t| t.is_of_time()));
    if !v.steps.is_empty() || of_time {
        return Err("a mass or spring that changes cannot be simulated".into());
    }
    let fitted = truncate_record(&correct_record(&frame.data, adjust), FITTED);
    if adjust.iter().any(|a| !a.lines_hz.is_empty()) {
        return Err("a record with mains interference cannot be simulated".into());
    }
    let judging = match &frame.hold_out {
        Some(record) => correct_record(record, &Adjustment::without_slips(adjust)),
        None => correct_record(&frame.data, adjust),
    };
    let free = find_free_parameters(frame, v, &model.values);
    let mut last = SimulationError::Diverged { at_s: 0.0 };
    for steps in STEPS {
        let learn = prepare_comparison(frame, v, &fitted, steps)?;
        let judge = prepare_comparison(frame, v, &judging, steps)?;
        let tried = refine(v, &model.values, &free, &learn).and_then(|r| {
            let errors = judge.errors(v, &r.values, &r.constant)?;
            Ok((r.values, errors))
        });
        match tried {
            Ok((values, errors)) => {
                let sizes = judge.measured_rms();
                let errors = errors.iter().zip(&sizes).map(|((i, e), (_, size))| {
                    let kept: Vec<f64> = e.iter().copied().filter(|x| x.is_finite()).collect();
                    (v.sensors[*i].channel.clone(), *size, rms(&kept))
                });
                return Ok(SimulationFit {
                    errors: errors.collect(),
                    values,
                    free,
                });
            }
            Err(e @ SimulationError::Diverged { .. }) => last = e,
            Err(e) => return Err(e.to_string()),
        }
    }
    Err(last.to_string())
}

fn prepare_comparison(
    frame: &MotionFrame,
    v: &Vehicle,
    record: &Channels,
    steps: usize,
) -> Result<Comparison, String> {
    let witnesses: Vec<usize> = (0..v.bodies.len())
        .filter(|b| !frame.bodies.contains(b))
        .collect();
    let mut c = comparison(v, record, band(frame), &witnesses)
        .map_err(|e| e.to_string())?
        .with_steps(steps);
    if band(frame) == OPEN {
        c.forget(FORGOTTEN);
    }
    Ok(c)
}

/// Displacements are compared as they are, accelerations in the band.
fn band(frame: &MotionFrame) -> Band {
    let sensors = &frame.vehicle.sensors;
    if sensors.iter().all(|s| s.measures == Measures::Displacement) {
        OPEN
    } else {
        frame.band
    }
}

/// Returns the parameters that the equations determine, without those measured elsewhere and the mass that sets the scale if no force does.
fn find_free_parameters(frame: &MotionFrame, v: &Vehicle, values: &[f64]) -> Vec<usize> {
    let names = v.parameters();
    let is_known = |i: usize| frame.known.contains_key(&names[i].name);
    let driven = v.wheels.iter().any(|w| frame.data.has(&w.channel));
    let scale = (!driven && !(0..names.len()).any(is_known))
        .then(|| {
            let mut bodies = frame.bodies.clone();
            bodies.sort_by_key(|&b| !v.bodies[b].sprung);
            let mut masses = v.masses(&bodies).into_iter();
            masses.find(|&i| values[i].is_finite())
        })
        .flatten();
    (0..names.len())
        .filter(|&i| values[i].is_finite() && !is_known(i) && Some(i) != scale)
        .collect()
}

fn correct_record(record: &Channels, adjust: &[Adjustment]) -> Channels {
    let (mut record, _) = record.with_gaps_filled();
    for a in adjust {
        for c in record.list.iter_mut().filter(|c| c.name == a.channel) {
            c.samples = a.correct_samples(&c.samples, record.start_s, record.rate_hz);
        }
    }
    record
}

fn truncate_record(record: &Channels, samples: usize) -> Channels {
    let mut out = record.clone();
    for c in &mut out.list {
        c.samples.truncate(samples);
    }
    out
}
