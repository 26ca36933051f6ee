//! Parameters of a vehicle from a record, with intervals, verdicts and checks.

use super::adequacy::{DeclaredErrors, channel_floors};
use super::adjustment::Adjustment;
use super::checks::{check_mass_closure, check_sides};
use super::equations::{Equation, equations};
use super::fit::{Fit, ParameterRange, fit};
use super::identifiability::is_known;
use super::interval::spread;
use super::known_body::{bodies_of_known_inertia, identify_known};
use super::layout::Vehicle;
use super::loads::best_blend;
use super::motion::motion;
use super::part_answer::{PartAnswer, collect};
use super::part_problem::{PartProblem, prepare_identification};
use super::stretch::slow_stretches;
use super::treatment::{Treatment, VehicleError};
use super::wrong_inputs::wrong_input;
use crate::estimate::NORMAL_95;
use crate::finding::Severity;
use crate::series::channels::Channels;
use crate::series::detrend::rms;

pub use super::identification::{ChannelFit, Estimate, Identification, IdentifyTask};

/// Identifies the parameters of the vehicle from a record. A second record takes no part in the fit and tests them.
///
/// # Errors
/// [`VehicleError`] if channels are missing, the record is too short, a known parameter is not in the model, or no equation remains.
pub fn identify(
    task: &IdentifyTask,
    record: &Channels,
    hold_out: Option<&Channels>,
) -> Result<Identification, VehicleError> {
    if let Some(vehicle) = bodies_of_known_inertia(task, record) {
        return Ok(identify_known(task, vehicle, record));
    }
    let (treatment, vehicle) = prepare_identification(task, record)?;
    let all = vehicle.parameters();
    let mut answer = Identification {
        values: vec![f64::NAN; all.len()],
        sigmas: vec![f64::NAN; all.len()],
        covariance: vec![vec![0.0; all.len()]; all.len()],
        scaled: vec![false; all.len()],
        coverage_factor: NORMAL_95,
        parameters: vec![],
        unidentifiable: vec![],
        fit: vec![],
        mass_closure: None,
        blend: vec![vec![]; vehicle.wheels.len()],
        wheel_force_sigma: vec![None; vehicle.wheels.len()],
        conditioning: 1.0,
        findings: vec![],
        vehicle: vehicle.clone(),
    };
    let mut any = false;
    let all_of = record;
    for bodies in vehicle.components() {
        let part = fit_part(task, &vehicle.part(&bodies), record, &treatment)?;
        any |= part.fit.is_some();
        let in_record = |record: &Channels| {
            let adjust = if std::ptr::eq(record, all_of) {
                treatment.adjust.clone()
            } else {
                Adjustment::without_slips(&treatment.adjust)
            };
            Treatment {
                slow: slow_stretches(&part.part, &part.values, record, &adjust),
                adjust,
                ..treatment.clone()
            }
        };
        let held = hold_out
            .map(|h| motion(&part.part, h, &in_record(h)))
            .transpose()
            .map_err(|e| VehicleError::HeldOut(Box::new(e)))?;
        // A change of mass or spring occurs at a time of the fitted record. Only this record can test it.
        let tested = hold_out.filter(|_| !part.part.changes()).unwrap_or(record);
        let floors = if part.fit.is_some() {
            let (values, blend) = (&part.values, &part.blend);
            let treatment = in_record(tested);
            channel_floors(
                &part.part,
                values,
                blend,
                tested,
                &treatment,
                &declared_tolerances(task),
            )?
        } else {
            vec![]
        };
        collect(task, &mut answer, &all, part, held.as_ref(), &floors);
    }
    if !any {
        return Err(VehicleError::NoEquation(vehicle.name.clone()));
    }
    answer
        .findings
        .extend(check_sides(&all, &answer.values, &answer.sigmas));
    close_masses(task, &mut answer, record);
    report_wrong_inputs(task, &mut answer, record);
    Ok(answer)
}

/// Puts the finding on wrong inputs first. The misfit and the bounds that they cause are no findings of their own.
fn report_wrong_inputs(task: &IdentifyTask, answer: &mut Identification, record: &Channels) {
    let Some(wrong) = wrong_input(task, record, answer) else {
        return;
    };
    if wrong.severity == Severity::Error {
        let caused = ["model-incomplete", "parameter-at-bound", "mass-closure"];
        answer.findings.retain(|f| !caused.contains(&f.code));
    }
    answer.findings.insert(0, wrong);
}

fn declared_tolerances(task: &IdentifyTask) -> DeclaredErrors {
    DeclaredErrors {
        noise_acc: task.noise_acc,
        noise_force: task.noise_force,
        gain: task.gain_tolerance,
        sync_s: task.sync_tolerance_s,
    }
}

/// Checks that [`identify`] can begin with these records: channels, rate and length, and the parameters that the task names.
///
/// # Errors
/// Errors of [`identify`].
pub fn check_records(
    task: &IdentifyTask,
    record: &Channels,
    hold_out: Option<&Channels>,
) -> Result<(), VehicleError> {
    if let Some(vehicle) = bodies_of_known_inertia(task, record) {
        let treatment = Treatment {
            adjust: task.corrections.clone(),
            ..Treatment::from_band(task.band)
        };
        return motion(&vehicle, record, &treatment).map(|_| ());
    }
    let (treatment, vehicle) = prepare_identification(task, record)?;
    let elsewhere = Treatment {
        adjust: Adjustment::without_slips(&treatment.adjust),
        ..treatment.clone()
    };
    for bodies in vehicle.components() {
        let part = vehicle.part(&bodies);
        motion(&part, record, &treatment)?;
        if let Some(held) = hold_out {
            motion(&part, held, &elsewhere).map_err(|e| VehicleError::HeldOut(Box::new(e)))?;
        }
    }
    Ok(())
}

fn fit_part(
    task: &IdentifyTask,
    part: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
) -> Result<PartAnswer, VehicleError> {
    let problem = PartProblem::from_part(task, part, record, treatment)?;
    let is_solvable = problem.is_solvable();
    let PartProblem {
        names,
        motion: m,
        equations: mut eqs,
        allowed: allow,
        reference,
    } = problem;
    let n = names.len();
    let mut out = PartAnswer {
        part: part.clone(),
        values: allow
            .iter()
            .map(|a| {
                if let ParameterRange::Known(v) = a {
                    *v
                } else {
                    f64::NAN
                }
            })
            .collect(),
        covariance: vec![vec![0.0; n]; n],
        coverage_factor: NORMAL_95,
        reference,
        fit: None,
        unknown: vec![],
        blend: vec![],
        motion: m,
        names,
    };
    if !is_solvable {
        return Ok(out);
    }
    let mut f = fit(&eqs, &allow);
    let slow = slow_stretches(part, &f.values, record, &treatment.adjust);
    if !slow.is_empty() {
        let again = Treatment {
            slow,
            ..treatment.clone()
        };
        out.motion = motion(part, record, &again)?;
        eqs = equations(part, &out.motion);
        f = fit(&eqs, &allow);
    }
    let s = spread(
        &eqs,
        &f,
        out.motion.rate_hz,
        1.5 / treatment.band.low_hz.max(0.1),
    );
    for (a, &i) in f.free.iter().enumerate() {
        for (b, &j) in f.free.iter().enumerate() {
            out.covariance[i][j] = s.covariance[a][b];
        }
    }
    add_tolerances(
        task,
        part,
        record,
        treatment,
        &allow,
        &f,
        &mut out.covariance,
    )?;
    out.values.clone_from(&f.values);
    out.coverage_factor = s.coverage_factor;
    out.unknown = (0..n)
        .filter(|&i| {
            f.free.contains(&i) && !known_enough(&eqs, &f, i, out.covariance[i][i].max(0.0).sqrt())
        })
        .collect();
    if reference.is_none() {
        out.blend = best_blend(part, &f.values, &out.motion);
    }
    out.fit = Some(f);
    Ok(out)
}

fn known_enough(eqs: &[Equation], f: &Fit, i: usize, sigma: f64) -> bool {
    let mut effect: f64 = f64::INFINITY;
    for e in eqs {
        let size = |k: usize| {
            e.columns
                .iter()
                .find(|c| c.0 == k)
                .map_or(0.0, |c| rms(&c.1))
        };
        let largest = e
            .columns
            .iter()
            .map(|c| f.values[c.0].abs() * rms(&c.1))
            .filter(|v| v.is_finite())
            .fold(0.0, f64::max);
        let own = size(i);
        if own > 0.0 && largest > 0.0 {
            effect = effect.min(sigma * own / largest);
        }
    }
    is_known(f.values[i], sigma, effect)
}

/// Adds what one standard deviation of each channel's gain and timing does to the parameters.
fn add_tolerances(
    task: &IdentifyTask,
    part: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
    allow: &[ParameterRange],
    base: &Fit,
    covariance: &mut [Vec<f64>],
) -> Result<(), VehicleError> {
    let channels = part
        .sensors
        .iter()
        .map(|s| &s.channel)
        .chain(part.wheels.iter().map(|w| &w.channel))
        .filter(|c| record.has(c));
    let mut trials = Vec::new();
    for channel in channels {
        if task.gain_tolerance > 0.0 {
            trials.push(Adjustment {
                gain: 1.0 + task.gain_tolerance,
                ..Adjustment::none(channel)
            });
        }
        if task.sync_tolerance_s > 0.0 {
            trials.push(Adjustment {
                delay_s: task.sync_tolerance_s,
                ..Adjustment::none(channel)
            });
        }
    }
    for trial in trials {
        let m = motion(
            part,
            record,
            &Treatment {
                adjust: treatment.adjust.iter().cloned().chain([trial]).collect(),
                ..treatment.clone()
            },
        )?;
        let f = fit(&equations(part, &m), allow);
        let change: Vec<f64> = f
            .values
            .iter()
            .zip(&base.values)
            .map(|(a, b)| if (a - b).is_finite() { a - b } else { 0.0 })
            .collect();
        for (i, a) in change.iter().enumerate() {
            for (j, b) in change.iter().enumerate() {
                covariance[i][j] += a * b;
            }
        }
    }
    Ok(())
}

/// Compares masses with the mean wheel forces. Only parts that rest on their wheels alone count, and only if every wheel force is measured.
fn close_masses(task: &IdentifyTask, answer: &mut Identification, record: &Channels) {
    let v = &answer.vehicle;
    let (mut mass, mut variance, mut force, mut parts) = (0.0, 0.0, 0.0, 0);
    for bodies in v.components() {
        let wheels: Vec<&str> = v
            .wheels
            .iter()
            .filter(|w| bodies.contains(&w.at.body))
            .map(|w| w.channel.as_str())
            .collect();
        let index = v.masses(&bodies);
        if !v.rests_on_wheels(&bodies)
            || wheels.is_empty()
            || !index
                .iter()
                .all(|&i| answer.scaled[i] && answer.values[i].is_finite())
        {
            continue;
        }
        let means: Option<Vec<f64>> = wheels
            .iter()
            .map(|w| record.samples(w).ok().map(mean_finite))
            .collect();
        let Some(means) = means else { continue };
        mass += index.iter().map(|&i| answer.values[i]).sum::<f64>();
        variance += index
            .iter()
            .map(|&i| index.iter().map(|&j| answer.covariance[i][j]).sum::<f64>())
            .sum::<f64>();
        force += means.iter().sum::<f64>();
        parts += 1;
    }
    if parts == 0 {
        return;
    }
    if let Some((closure, finding)) =
        check_mass_closure(mass, variance.max(0.0).sqrt(), force, task.gravity)
    {
        answer.mass_closure = Some(closure);
        answer.findings.extend(finding);
    }
}

fn mean_finite(x: &[f64]) -> f64 {
    let (mut sum, mut n) = (0.0, 0usize);
    for v in x.iter().filter(|v| v.is_finite()) {
        sum += v;
        n += 1;
    }
    sum / n.max(1) as f64
}
