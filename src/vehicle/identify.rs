//! Parameters of a vehicle from a record, with intervals, verdicts and checks.

use super::checks::{MassClosure, at_bound, check_mass_closure, check_sides};
use super::equations::{Equation, equations};
use super::fit::{Allowed, Fit, fit};
use super::identifiability::{absent_sentence, is_known, scale_sentence, weak_sentences};
use super::interval::{residual, spread};
use super::layout::{Parameter, Vehicle};
use super::loads::{Blend, best_blend, link_forces, needed_forces, wheel_forces};
use super::motion::{Adjustment, Motion, Treatment, VehicleError, motion, resolved};
use super::stretch::slow_stretches;
use super::term::{Quantity, UnitNames};
use crate::finding::{Finding, Severity};
use crate::linalg::tall::left_inverse;
use crate::series::channels::Channels;
use crate::series::detrend::rms;
use crate::series::spectrum::Band;
use serde::Serialize;
use std::collections::BTreeMap;

/// What is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// The model.
    pub vehicle: Vehicle,
    /// Parameters measured elsewhere.
    pub known: BTreeMap<String, f64>,
    /// Limits; positive parameters are limited to 0 and up anyway.
    pub bounds: BTreeMap<String, [f64; 2]>,
    /// The band of every equation.
    pub band: Band,
    /// Acceleration of gravity, job units.
    pub gravity: f64,
    /// Gain tolerance of every channel, 1 sd, as a share.
    pub gain_tolerance: f64,
    /// Synchronisation tolerance of every channel, 1 sd, s.
    pub sync_tolerance_s: f64,
    /// Names of the job's units.
    pub units: UnitNames,
    /// Known faults of channels, taken out before anything else.
    pub corrections: Vec<Adjustment>,
}

/// One parameter, or a ratio of two.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Estimate {
    /// Name, `k_s` or `k_s/m_b`.
    pub name: String,
    /// Value; none where it can't be told.
    pub value: Option<f64>,
    /// One standard deviation, coloured residuals and declared tolerances included.
    pub sigma: Option<f64>,
    /// Unit in words.
    pub unit: String,
    /// Whether record and model determine it.
    pub identifiable: bool,
    /// 95 % interval.
    pub interval: Option<[f64; 2]>,
    /// Whether it was declared, not estimated.
    pub known: bool,
}

/// How well a channel is explained.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelFit {
    /// Channel.
    pub channel: String,
    /// RMS of measured less predicted over RMS of measured, in band.
    pub relative_rms: f64,
    /// The same on the data that were fitted.
    pub relative_rms_fitted: f64,
    /// `hold-out` or `fitted`: where `relative_rms` comes from.
    pub on: &'static str,
}

/// The answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Identification {
    /// The vehicle with all constants of its terms.
    pub vehicle: Vehicle,
    /// Values of `vehicle.parameters()`; relative to the reference mass (1) where no force sets the scale; NaN where unknown.
    pub values: Vec<f64>,
    /// Standard deviations, 0 for known ones.
    pub sigmas: Vec<f64>,
    /// Covariance of `values`, by rows.
    pub covariance: Vec<Vec<f64>>,
    /// Whether `values` carry the scale of forces.
    pub scaled: Vec<bool>,
    /// Factor on sigma for 95 %.
    pub coverage_factor: f64,
    /// Parameters and ratios as reported.
    pub parameters: Vec<Estimate>,
    /// What can't be told, in words.
    pub unidentifiable: Vec<String>,
    /// How well each channel is explained.
    pub fit: Vec<ChannelFit>,
    /// Dynamics against statics.
    pub mass_closure: Option<MassClosure>,
    /// How wheel forces are best put together.
    pub blend: Blend,
    /// RMS of the wheel force error in band, where measured (the larger of fitted and held-out).
    pub wheel_force_sigma: Vec<Option<f64>>,
    /// Ratio of smallest to largest singular value, worst component, columns of unit norm.
    pub conditioning: f64,
    /// Everything noticed.
    pub findings: Vec<Finding>,
}

/// The fit of one connected part of a vehicle.
struct PartAnswer {
    part: Vehicle,
    names: Vec<Parameter>,
    values: Vec<f64>,
    covariance: Vec<Vec<f64>>,
    coverage_factor: f64,
    reference: Option<usize>,
    fit: Option<Fit>,
    unknown: Vec<usize>,
    blend: Blend,
    motion: Motion,
}

/// Parameters of the vehicle from a record; a second record, never fitted, judges them.
///
/// # Errors
/// [`VehicleError`] when channels are missing, the record is too short, a known parameter is not one of the model's, or no
/// equation is left.
pub fn identify(
    question: &Question,
    record: &Channels,
    hold_out: Option<&Channels>,
) -> Result<Identification, VehicleError> {
    let treatment = Treatment {
        adjust: question.corrections.clone(),
        ..Treatment::of(question.band)
    };
    let measured = with_measured_sensors(&question.vehicle, record);
    let vehicle = resolved(&measured, record, &treatment)?;
    let all = vehicle.parameters();
    if let Some(name) = question
        .known
        .keys()
        .chain(question.bounds.keys())
        .find(|k| all.iter().all(|p| p.name != **k))
    {
        return Err(VehicleError::Known {
            name: name.clone(),
            present: all.iter().map(|p| p.name.clone()).collect(),
        });
    }
    let mut answer = Identification {
        values: vec![f64::NAN; all.len()],
        sigmas: vec![f64::NAN; all.len()],
        covariance: vec![vec![0.0; all.len()]; all.len()],
        scaled: vec![false; all.len()],
        coverage_factor: 1.96,
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
    for bodies in vehicle.components() {
        let part = fit_part(question, &vehicle.part(&bodies), record, &treatment)?;
        any |= part.fit.is_some();
        let held = hold_out
            .map(|h| {
                let slow = slow_stretches(&part.part, &part.values, h, &treatment.adjust);
                let treatment = Treatment {
                    slow,
                    ..treatment.clone()
                };
                motion(&part.part, h, &treatment)
            })
            .transpose()?;
        collect(question, &mut answer, &all, part, held.as_ref());
    }
    if !any {
        return Err(VehicleError::NoEquation(vehicle.name.clone()));
    }
    answer
        .findings
        .extend(check_sides(&all, &answer.values, &answer.sigmas));
    close_masses(question, &mut answer, record);
    Ok(answer)
}

/// The vehicle less sensors whose channels the record lacks, where the rest still gives the body's motion.
fn with_measured_sensors(vehicle: &Vehicle, record: &Channels) -> Vehicle {
    let mut out = vehicle.clone();
    let enough = |b: usize| {
        let present = vehicle
            .sensors
            .iter()
            .filter(|s| s.at.body == b && record.has(&s.channel))
            .count();
        present >= vehicle.bodies[b].shape.n()
    };
    out.sensors
        .retain(|s| record.has(&s.channel) || !enough(s.at.body));
    out
}

fn allowed(question: &Question, parameters: &[Parameter]) -> Vec<Allowed> {
    parameters
        .iter()
        .map(
            |p| match (question.known.get(&p.name), question.bounds.get(&p.name)) {
                (Some(v), _) => Allowed::Known(*v),
                (None, Some([lo, hi])) => Allowed::Within(*lo, *hi),
                (None, None) if p.positive => Allowed::Within(0.0, f64::INFINITY),
                (None, None) => Allowed::Free,
            },
        )
        .collect()
}

/// Index of the parameter that all others are measured by when no force sets the scale.
fn reference(part: &Vehicle, equations: &[Equation], allowed: &[Allowed]) -> Option<usize> {
    let occurs = |i: usize| equations.iter().any(|e| e.columns.iter().any(|c| c.0 == i));
    let driven = equations
        .iter()
        .any(|e| e.driven && e.target.iter().any(|t| *t != 0.0));
    let held = (0..allowed.len())
        .any(|i| matches!(allowed[i], Allowed::Known(v) if v != 0.0) && occurs(i));
    if driven || held {
        return None;
    }
    let mut bodies: Vec<usize> = (0..part.bodies.len()).collect();
    bodies.sort_by_key(|&b| !part.bodies[b].sprung);
    part.masses(&bodies).into_iter().find(|&i| occurs(i))
}

fn fit_part(
    question: &Question,
    part: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
) -> Result<PartAnswer, VehicleError> {
    let names = part.parameters();
    let m = motion(part, record, treatment)?;
    let mut eqs = equations(part, &m);
    let mut allow = allowed(question, &names);
    let reference = reference(part, &eqs, &allow);
    if let Some(r) = reference {
        allow[r] = Allowed::Known(1.0);
    }
    let n = names.len();
    let mut out = PartAnswer {
        part: part.clone(),
        values: allow
            .iter()
            .map(|a| {
                if let Allowed::Known(v) = a {
                    *v
                } else {
                    f64::NAN
                }
            })
            .collect(),
        covariance: vec![vec![0.0; n]; n],
        coverage_factor: 1.96,
        reference,
        fit: None,
        unknown: vec![],
        blend: vec![],
        motion: m,
        names,
    };
    let has_scale = reference.is_some()
        || eqs.iter().any(|e| e.target.iter().any(|t| *t != 0.0))
        || allow.iter().any(|a| matches!(a, Allowed::Known(_)));
    if eqs.is_empty() || !has_scale {
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
        question,
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
    question: &Question,
    part: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
    allow: &[Allowed],
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
        if question.gain_tolerance > 0.0 {
            trials.push(Adjustment {
                channel: channel.clone(),
                gain: 1.0 + question.gain_tolerance,
                delay_s: 0.0,
            });
        }
        if question.sync_tolerance_s > 0.0 {
            trials.push(Adjustment {
                channel: channel.clone(),
                gain: 1.0,
                delay_s: question.sync_tolerance_s,
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

/// Puts the answer of a part into the whole.
fn collect(
    question: &Question,
    answer: &mut Identification,
    all: &[Parameter],
    part: PartAnswer,
    held: Option<&Motion>,
) {
    let at: Vec<usize> = part
        .names
        .iter()
        .map(|p| all.iter().position(|q| q.name == p.name).unwrap_or(0))
        .collect();
    let units = &question.units;
    let reference_name = part.reference.map(|r| part.names[r].name.clone());
    let scaled = part.reference.is_none() && part.fit.is_some();
    answer.coverage_factor = answer.coverage_factor.max(part.coverage_factor);
    answer.findings.extend(part.motion.findings.iter().cloned());
    let mut absent = Vec::new();
    let mut group = Vec::new();
    for (i, p) in part.names.iter().enumerate() {
        let sigma = part.covariance[i][i].max(0.0).sqrt();
        let known = question.known.contains_key(&p.name);
        let value = part.values[i];
        answer.values[at[i]] = value;
        answer.sigmas[at[i]] = if known { 0.0 } else { sigma };
        answer.scaled[at[i]] = scaled;
        for j in 0..part.names.len() {
            answer.covariance[at[i]][at[j]] = part.covariance[i][j];
        }
        let told = value.is_finite() && (known || scaled && !part.unknown.contains(&i));
        let shown = scaled
            .then_some(value)
            .or(known.then_some(value))
            .filter(|v| v.is_finite());
        let half = part.coverage_factor * sigma;
        answer.parameters.push(Estimate {
            name: p.name.clone(),
            value: shown,
            sigma: shown.map(|_| if known { 0.0 } else { sigma }),
            unit: units.of(p.quantity),
            identifiable: told,
            interval: shown.map(|v| if known { [v, v] } else { [v - half, v + half] }),
            known,
        });
        if !value.is_finite() {
            absent.push(p.name.clone());
        } else if part.reference.is_some() {
            group.push(p.name.clone());
        }
    }
    if let (Some(r), Some(reference)) = (part.reference, &reference_name) {
        for (i, p) in part
            .names
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != r && part.values[*i].is_finite())
        {
            let sigma = part.covariance[i][i].max(0.0).sqrt();
            let half = part.coverage_factor * sigma;
            answer.parameters.push(Estimate {
                name: format!("{}/{reference}", p.name),
                value: Some(part.values[i]),
                sigma: Some(sigma),
                unit: format!("({})/({})", units.of(p.quantity), units.of(Quantity::Mass)),
                identifiable: !part.unknown.contains(&i),
                interval: Some([part.values[i] - half, part.values[i] + half]),
                known: false,
            });
        }
        let springs: Vec<String> = part
            .names
            .iter()
            .filter(|p| p.quantity == Quantity::Stiffness)
            .map(|p| p.name.clone())
            .collect();
        answer
            .unidentifiable
            .push(scale_sentence(&group, reference, &springs));
    }
    if !absent.is_empty() {
        let channels: Vec<String> = part
            .part
            .wheels
            .iter()
            .zip(&part.motion.forces)
            .filter(|(_, f)| f.is_none())
            .map(|(w, _)| w.channel.clone())
            .collect();
        answer
            .unidentifiable
            .push(absent_sentence(&absent, &channels));
    }
    if let Some(f) = &part.fit {
        answer
            .unidentifiable
            .extend(weak_sentences(f, &part.names, &part.unknown));
        for &i in &f.active {
            let p = &part.names[i];
            answer.findings.push(at_bound(
                &p.name,
                f.values[i],
                p.quantity == Quantity::Damping,
            ));
        }
        if let (Some(a), Some(b)) = (
            f.solution.singular_values.first(),
            f.solution.singular_values.last(),
        ) {
            answer.conditioning = answer.conditioning.min(b / a);
        }
    }
    if part.fit.is_none() {
        return;
    }
    let fitted = channel_misfits(&part.part, &part.values, &part.motion, &part.blend);
    let judged = held.map(|h| channel_misfits(&part.part, &part.values, h, &part.blend));
    for (i, (channel, error, size)) in fitted.iter().enumerate() {
        let on_hold_out = judged
            .as_ref()
            .and_then(|j| j.get(i))
            .map(|(_, e, s)| (e / s, *e));
        let own = error / size;
        answer.fit.push(ChannelFit {
            channel: channel.clone(),
            relative_rms: on_hold_out.map_or(own, |h| h.0),
            relative_rms_fitted: own,
            on: if on_hold_out.is_some() {
                "hold-out"
            } else {
                "fitted"
            },
        });
        if let Some(w) = answer
            .vehicle
            .wheels
            .iter()
            .position(|w| w.channel == *channel)
        {
            answer.wheel_force_sigma[w] = Some(error.max(on_hold_out.map_or(0.0, |h| h.1)));
        }
    }
    for (wheel, shares) in part.part.wheels.iter().zip(part.blend) {
        if let Some(w) = answer
            .vehicle
            .wheels
            .iter()
            .position(|x| x.channel == wheel.channel)
        {
            answer.blend[w] = shares;
        }
    }
}

/// Channel, RMS of measured less predicted, RMS of measured: every measured wheel force, then the accelerometers of every body
/// whose outside forces are measured, predicted from forces and stretch.
fn channel_misfits(
    part: &Vehicle,
    values: &[f64],
    m: &Motion,
    blend: &Blend,
) -> Vec<(String, f64, f64)> {
    let mut out = Vec::new();
    let minus =
        |a: &[f64], b: &[f64]| rms(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>());
    let forces = wheel_forces(part, values, m, blend);
    for ((wheel, force), measured) in part.wheels.iter().zip(&forces).zip(&m.forces) {
        if let Some(measured) = measured {
            out.push((wheel.channel.clone(), minus(measured, force), rms(measured)));
        }
    }
    let links = link_forces(part, values, m);
    for (b, body) in part.bodies.iter().enumerate() {
        let wheels: Vec<usize> = (0..part.wheels.len())
            .filter(|&w| part.wheels[w].at.body == b)
            .collect();
        if part.is_witness(b) || wheels.iter().any(|&w| m.forces[w].is_none()) {
            continue;
        }
        // Residual of each equation of the body, turned into an error of acceleration by its inertia.
        let mut r = needed_forces(part, values, m, &links, b);
        for &w in &wheels {
            if let Some(force) = &m.forces[w] {
                for (j, phi) in part.functions(&part.wheels[w].at).iter().enumerate() {
                    r[j].iter_mut().zip(force).for_each(|(r, f)| *r -= phi * f);
                }
            }
        }
        let n = body.shape.n();
        let inertia: Vec<Vec<f64>> = (0..n)
            .map(|i| {
                (0..n)
                    .map(|j| values[part.inertia_index(b, i, j)])
                    .collect()
            })
            .collect();
        let Some(inverse) =
            left_inverse(&inertia).filter(|_| inertia.iter().flatten().all(|v| v.is_finite()))
        else {
            continue;
        };
        for (sensor, a) in part
            .sensors
            .iter()
            .zip(&m.sensors)
            .filter(|(s, _)| s.at.body == b)
        {
            let phi = part.functions(&sensor.at);
            let row: Vec<f64> = (0..n)
                .map(|j| (0..n).map(|i| phi[i] * inverse[i][j]).sum())
                .collect();
            let error: Vec<f64> = (0..a.len())
                .map(|t| row.iter().zip(&r).map(|(c, r)| c * r[t]).sum())
                .collect();
            out.push((sensor.channel.clone(), rms(&error), rms(a)));
        }
    }
    out
}

/// Compares masses with the mean wheel forces, over the parts whose every wheel is measured.
fn close_masses(question: &Question, answer: &mut Identification, record: &Channels) {
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
        let grounded = v
            .links
            .iter()
            .any(|l| l.ends.iter().map(|e| e.0).sum::<f64>().abs() > 1e-9);
        if grounded
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
        check_mass_closure(mass, variance.max(0.0).sqrt(), force, question.gravity)
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

impl Identification {
    /// Value of a parameter by name, where the record tells it with its scale.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.parameters
            .iter()
            .find(|p| p.name == name)
            .and_then(|p| p.value)
    }

    /// Findings of error severity if nothing at all could be told.
    pub fn verdict(&self) -> Option<Finding> {
        let told = self.parameters.iter().any(|p| p.identifiable && !p.known);
        (!told).then(|| {
            let message = "No parameter can be told from this record.";
            Finding::new(
                Severity::Error,
                "nothing-identifiable",
                &self.vehicle.name,
                message,
                "Add a measurement named under `unidentifiable`.",
            )
        })
    }

    /// Residuals of every equation of a record in the band, by name: where the model fails.
    pub fn equation_residuals(&self, m: &Motion) -> Vec<(String, Vec<f64>)> {
        equations(&self.vehicle, m)
            .iter()
            .map(|e| (e.name.clone(), residual(e, &self.values)))
            .collect()
    }
}
