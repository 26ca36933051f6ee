//! Measured channels made comparable: one band for all, body motions, stretch of links, terms formed wide-band.

use super::layout::{Measures, Vehicle};
use super::stretch::SlowStretch;
use super::term::Term;
use crate::finding::{Finding, Severity};
use crate::linalg::tall::left_inverse;
use crate::series::detrend::{mean, rms, without_mean};
use crate::series::spectrum::{Band, Fourier, Spectrum};
use crate::series::{Channels, SeriesError};
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;
use thiserror::Error;

/// What stops the acceleration path.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum VehicleError {
    /// The record itself.
    #[error(transparent)]
    Series(#[from] SeriesError),
    /// A body whose motion the sensors don't give.
    #[error("body `{body}` moves in {needed} ways, its accelerometers ({}) give {found}: add accelerometers at other places", .channels.join(", "))]
    Sensors {
        /// The body.
        body: String,
        /// Its motions.
        needed: usize,
        /// Motions that the sensors span.
        found: usize,
        /// Its channels.
        channels: Vec<String>,
    },
    /// No equation is left.
    #[error(
        "no equation of motion of model `{0}` holds measured quantities only: measure wheel forces, or accelerations of the body and its wheels"
    )]
    NoEquation(String),
    /// A known parameter that the model has not.
    #[error("`{name}` is declared known, but the model's parameters are {}", .present.join(", "))]
    Known {
        /// As written.
        name: String,
        /// Names of the model.
        present: Vec<String>,
    },
}

/// A sensor taken as it may truly be: reading = gain . truth, late by delay.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustment {
    /// Channel.
    pub channel: String,
    /// The channel is divided by this.
    pub gain: f64,
    /// The channel is advanced by this, s.
    pub delay_s: f64,
}

/// How channels are treated.
#[derive(Clone, Debug, PartialEq)]
pub struct Treatment {
    /// The band of every equation and channel.
    pub band: Band,
    /// Keep every n-th sample of the band-limited signals (a power of two); 0: as few as the band allows.
    pub keep_every: usize,
    /// Corrections of channels, none for most.
    pub adjust: Vec<Adjustment>,
    /// Slow stretch of links, where known: nonlinear terms then need no double integration below the band.
    pub slow: Vec<SlowStretch>,
    /// What is cut off either end, s; none: as little as the terms need.
    pub settle_s: Option<f64>,
}

impl Treatment {
    /// Plain treatment: one band, samples thinned as far as it allows.
    pub fn of(band: Band) -> Self {
        Self {
            band,
            keep_every: 0,
            adjust: vec![],
            slow: vec![],
            settle_s: None,
        }
    }
}

/// Band-limited, trimmed signals of a record, all of one length and rate.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Samples per second.
    pub rate_hz: f64,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Acceleration of each sensor.
    pub sensors: Vec<Vec<f64>>,
    /// Accelerations of each body in each of its motions.
    pub bodies: Vec<Vec<Vec<f64>>>,
    /// Stretch of each link.
    pub stretch: Vec<Vec<f64>>,
    /// Rate of stretch of each link.
    pub rate: Vec<Vec<f64>>,
    /// Each term of each link for a coefficient of one, formed wide-band, then limited to the band.
    pub terms: Vec<Vec<Vec<f64>>>,
    /// Each mass change's column: what is there of it times acceleration.
    pub steps: Vec<Vec<f64>>,
    /// Each wheel's force, where measured.
    pub forces: Vec<Option<Vec<f64>>>,
    /// Each wheel's mean force over the whole record, where measured.
    pub mean_forces: Vec<Option<f64>>,
    /// What was noticed on the way.
    pub findings: Vec<Finding>,
}

impl Motion {
    /// Number of samples.
    pub fn n_samples(&self) -> usize {
        self.sensors.first().map_or(0, Vec::len)
    }
}

impl Motion {
    /// The motion of the part of the vehicle made of the given bodies, in the order of [`Vehicle::part`].
    pub fn part(&self, vehicle: &Vehicle, bodies: &[usize]) -> Self {
        let kept = |flags: Vec<bool>| {
            (0..flags.len())
                .filter(|&i| flags[i])
                .collect::<Vec<usize>>()
        };
        let sensors = kept(
            vehicle
                .sensors
                .iter()
                .map(|s| bodies.contains(&s.at.body))
                .collect(),
        );
        let wheels = kept(
            vehicle
                .wheels
                .iter()
                .map(|w| bodies.contains(&w.at.body))
                .collect(),
        );
        let links = kept(
            vehicle
                .links
                .iter()
                .map(|l| l.ends.iter().all(|e| bodies.contains(&e.1.body)))
                .collect(),
        );
        Self {
            rate_hz: self.rate_hz,
            start_s: self.start_s,
            sensors: sensors.iter().map(|&i| self.sensors[i].clone()).collect(),
            bodies: bodies.iter().map(|&i| self.bodies[i].clone()).collect(),
            stretch: links.iter().map(|&i| self.stretch[i].clone()).collect(),
            rate: links.iter().map(|&i| self.rate[i].clone()).collect(),
            terms: links.iter().map(|&i| self.terms[i].clone()).collect(),
            steps: (0..self.steps.len())
                .filter(|&i| bodies.contains(&vehicle.steps[i].body))
                .map(|i| self.steps[i].clone())
                .collect(),
            forces: wheels.iter().map(|&i| self.forces[i].clone()).collect(),
            mean_forces: wheels.iter().map(|&i| self.mean_forces[i]).collect(),
            findings: self.findings.clone(),
        }
    }
}

/// Wide-band signals of links reach down to this share of the lower band edge.
const WIDE: f64 = 0.5;
/// Below this multiple of the lower band edge the stretch of nonlinear terms comes from force, where that is known.
const SLOW: f64 = 1.4;
/// Redundant accelerometers may miss the rigid motion by this share of their signal before it is reported.
const RIGID_LIMIT: f64 = 0.15;

/// The vehicle with constants of terms that the job left open (0) set from the record: friction velocity 2 % of the rms rate of
/// stretch, free travel of a bump stop 70 % of the largest stretch.
///
/// # Errors
/// As [`motion`].
pub fn resolved(
    vehicle: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
) -> Result<Vehicle, VehicleError> {
    let open = |t: &Term| {
        matches!(
            t,
            Term::Friction { velocity: 0.0 } | Term::BumpStop { gap: 0.0, .. }
        )
    };
    let mut out = vehicle.clone();
    if !vehicle.links.iter().any(|l| l.terms.iter().any(open)) {
        return Ok(out);
    }
    out.links
        .iter_mut()
        .for_each(|l| l.terms.retain(Term::is_linear));
    let m = motion(&out, record, treatment)?;
    out = vehicle.clone();
    for (i, link) in out.links.iter_mut().enumerate() {
        for term in &mut link.terms {
            match term {
                Term::Friction { velocity } if *velocity == 0.0 => {
                    *velocity = 0.02 * rms(&m.rate[i])
                }
                Term::BumpStop { gap, .. } if *gap == 0.0 => {
                    *gap = 0.7 * m.stretch[i].iter().fold(0.0, |a: f64, d| a.max(d.abs()))
                }
                _ => {}
            }
        }
    }
    Ok(out)
}

/// The motion of a vehicle in a record. Constant offsets and gravity fall to the band's lower edge; nonlinear terms are formed
/// from stretch and rate down to half of that edge with no upper edge, then limited like everything else.
///
/// # Errors
/// [`VehicleError`] when a channel is missing, a body's motion is not measured, or the record is shorter than the band needs.
pub fn motion(
    vehicle: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
) -> Result<Motion, VehicleError> {
    let band = treatment.band;
    let rate_hz = record.rate_hz;
    if !(band.low_hz >= 0.0 && band.low_hz < band.high_hz && band.high_hz < rate_hz / 2.0) {
        return Err(SeriesError::Band {
            low_hz: band.low_hz,
            high_hz: band.high_hz,
            rate_hz,
        }
        .into());
    }
    let nonlinear = vehicle
        .links
        .iter()
        .any(|l| l.terms.iter().any(|t| !t.is_linear()));
    let settle_s = match treatment.settle_s {
        Some(s) => s,
        None if nonlinear => 1.5 * band.settling_s(),
        None => band.settling_s(),
    };
    let needed_s = 2.0 * settle_s + 5.0 / band.low_hz.max(0.1);
    if record.duration_s() < needed_s {
        return Err(SeriesError::TooShort {
            found_s: record.duration_s(),
            needed_s,
            low_hz: band.low_hz,
        }
        .into());
    }
    let mut keep = treatment.keep_every.max(1);
    if treatment.keep_every == 0 {
        while rate_hz / (2 * keep) as f64 >= 5.0 * band.high_hz {
            keep *= 2;
        }
    }
    let (record, gaps) = record.with_gaps_filled();
    let mut findings: Vec<Finding> = Vec::new();
    for (channel, n) in record.list.iter().zip(&gaps).filter(|(_, n)| **n > 0) {
        let message = format!("{n} missing samples were bridged by straight lines.");
        findings.push(Finding::new(
            Severity::Info,
            "gaps-filled",
            &channel.name,
            message,
            "Choose a stretch without gaps.",
        ));
    }
    let mut fourier = Fourier::default();
    let trim = ((settle_s * rate_hz).ceil() as usize).div_ceil(keep);
    let n_kept = record.n_samples().div_ceil(keep);
    let cut = |x: Vec<f64>| {
        x[trim.min(x.len())..n_kept.saturating_sub(trim).max(trim).min(x.len())].to_vec()
    };

    let mut transform = |name: &str, measures: Measures| -> Result<Spectrum, VehicleError> {
        let spectrum = fourier.spectrum(&without_mean(record.samples(name)?), rate_hz);
        let adjust = combined(&treatment.adjust, name);
        Ok(match (adjust, measures) {
            (None, Measures::Acceleration) => spectrum,
            (a, measures) => {
                let (gain, delay) = a.map_or((1.0, 0.0), |a| (a.gain, a.delay_s));
                spectrum.times(|f| {
                    let w = 2.0 * PI * f;
                    let twice = if measures == Measures::Displacement {
                        -w * w
                    } else {
                        1.0
                    };
                    Complex64::from_polar(twice.abs() / gain, w * delay) * twice.signum()
                })
            }
        })
    };
    let sensor_spectra = vehicle
        .sensors
        .iter()
        .map(|s| transform(&s.channel, s.measures))
        .collect::<Result<Vec<_>, _>>()?;
    let force_spectra = vehicle
        .wheels
        .iter()
        .map(|w| {
            if record.has(&w.channel) {
                transform(&w.channel, Measures::Acceleration).map(Some)
            } else {
                Ok(None)
            }
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mean_forces = vehicle
        .wheels
        .iter()
        .map(|w| record.samples(&w.channel).ok().map(mean))
        .collect();

    let body_spectra = body_spectra(vehicle, &sensor_spectra)?;
    let limited = |s: &Spectrum, times: i32, fourier: &mut Fourier| {
        cut(fourier.samples(&s.band_integrated(band, times), keep))
    };
    let sensors: Vec<Vec<f64>> = sensor_spectra
        .iter()
        .map(|s| limited(s, 0, &mut fourier))
        .collect();
    let single = |b: usize| vehicle.sensors.iter().position(|s| s.at.body == b);
    let bodies: Vec<Vec<Vec<f64>>> = body_spectra
        .iter()
        .enumerate()
        .map(|(b, motions)| match (motions.as_slice(), single(b)) {
            ([_], Some(s)) if vehicle.sensors.iter().filter(|s| s.at.body == b).count() == 1 => {
                vec![sensors[s].clone()]
            }
            _ => motions
                .iter()
                .map(|s| limited(s, 0, &mut fourier))
                .collect(),
        })
        .collect();
    findings.extend(check_rigid(vehicle, &sensors, &bodies));
    let forces: Vec<Option<Vec<f64>>> = force_spectra
        .iter()
        .map(|s| s.as_ref().map(|s| limited(s, 0, &mut fourier)))
        .collect();

    let (mut stretch, mut rate, mut terms) = (vec![], vec![], vec![]);
    for (l, link) in vehicle.links.iter().enumerate() {
        let mut parts = Vec::new();
        for (weight, end) in &link.ends {
            for (phi, s) in vehicle.functions(end).iter().zip(&body_spectra[end.body]) {
                parts.push((weight * phi, s));
            }
        }
        let Some(relative) = Spectrum::sum(&parts) else {
            continue;
        };
        let (d, v) = (
            limited(&relative, 2, &mut fourier),
            limited(&relative, 1, &mut fourier),
        );
        let mut columns = Vec::new();
        let wide = link.terms.iter().any(|t| !t.is_linear()).then(|| {
            let open = Band {
                low_hz: band.low_hz * WIDE,
                high_hz: f64::INFINITY,
            };
            let slow = treatment.slow.iter().find(|s| s.link == l);
            let Some(slow) = slow.filter(|s| s.stretch.len() == record.n_samples()) else {
                return (
                    fourier.samples(&relative.band_integrated(open, 2), 1),
                    fourier.samples(&relative.band_integrated(open, 1), 1),
                );
            };
            let fast = Band {
                low_hz: band.low_hz * SLOW,
                high_hz: f64::INFINITY,
            };
            let level = mean(&slow.stretch);
            let below = fourier
                .spectrum(&without_mean(&slow.stretch), rate_hz)
                .times(|f| Complex64::new(1.0 - fast.gain(f), 0.0));
            let rate = below.times(|f| Complex64::new(0.0, 2.0 * PI * f));
            let joined = |times: i32, slow: &Spectrum, fourier: &mut Fourier| {
                let whole =
                    Spectrum::sum(&[(1.0, &relative.band_integrated(fast, times)), (1.0, slow)]);
                whole.map_or(vec![], |s| fourier.samples(&s, 1))
            };
            let d = joined(2, &below, &mut fourier);
            (
                d.iter().map(|d| d + level).collect(),
                joined(1, &rate, &mut fourier),
            )
        });
        for term in &link.terms {
            columns.push(match (term, &wide) {
                (Term::Stiffness, _) => d.clone(),
                (Term::Damping, _) => v.clone(),
                (Term::Inertance, _) => limited(&relative, 0, &mut fourier),
                (term, Some((wd, wv))) => {
                    let force: Vec<f64> =
                        wd.iter().zip(wv).map(|(d, v)| term.basis(*d, *v)).collect();
                    let s = fourier.spectrum(&without_mean(&force), rate_hz);
                    limited(&s, 0, &mut fourier)
                }
                (_, None) => vec![0.0; d.len()],
            });
        }
        stretch.push(d);
        rate.push(v);
        terms.push(columns);
    }
    let start_s = record.start_s + (trim * keep) as f64 / rate_hz;
    let mut steps = Vec::new();
    for step in &vehicle.steps {
        let Some(heave) = body_spectra.get(step.body).and_then(|b| b.first()) else {
            continue;
        };
        let a = fourier.samples(heave, 1);
        let product: Vec<f64> = a
            .iter()
            .enumerate()
            .map(|(i, a)| step.done(record.start_s + i as f64 / rate_hz) * (a + step.gravity))
            .collect();
        let s = fourier.spectrum(&without_mean(&product), rate_hz);
        steps.push(limited(&s, 0, &mut fourier));
    }
    Ok(Motion {
        rate_hz: rate_hz / keep as f64,
        start_s,
        sensors,
        bodies,
        stretch,
        rate,
        terms,
        steps,
        forces,
        mean_forces,
        findings,
    })
}

/// All corrections of a channel in one.
fn combined(adjust: &[Adjustment], name: &str) -> Option<Adjustment> {
    let mut own = adjust.iter().filter(|a| a.channel == name);
    let first = own.next()?.clone();
    Some(own.fold(first, |sum, a| Adjustment {
        gain: sum.gain * a.gain,
        delay_s: sum.delay_s + a.delay_s,
        ..sum
    }))
}

/// Motions of each body as weighted sums of its sensors.
fn body_spectra(
    vehicle: &Vehicle,
    sensors: &[Spectrum],
) -> Result<Vec<Vec<Spectrum>>, VehicleError> {
    let mut out = Vec::new();
    for (b, body) in vehicle.bodies.iter().enumerate() {
        let own: Vec<usize> = (0..vehicle.sensors.len())
            .filter(|&i| vehicle.sensors[i].at.body == b)
            .collect();
        let rows: Vec<Vec<f64>> = own
            .iter()
            .map(|&i| vehicle.functions(&vehicle.sensors[i].at))
            .collect();
        let missing = || VehicleError::Sensors {
            body: body.name.clone(),
            needed: body.shape.n(),
            found: own.len().min(body.shape.n().saturating_sub(1)),
            channels: own
                .iter()
                .map(|&i| vehicle.sensors[i].channel.clone())
                .collect(),
        };
        let weights = left_inverse(&rows).ok_or_else(missing)?;
        let mut motions = Vec::new();
        for row in weights {
            let parts: Vec<(f64, &Spectrum)> = row
                .iter()
                .zip(&own)
                .map(|(w, &i)| (*w, &sensors[i]))
                .collect();
            motions.push(Spectrum::sum(&parts).ok_or_else(missing)?);
        }
        out.push(motions);
    }
    Ok(out)
}

/// Sensors of one body that don't move as one rigid body.
fn check_rigid(vehicle: &Vehicle, sensors: &[Vec<f64>], bodies: &[Vec<Vec<f64>>]) -> Vec<Finding> {
    let mut findings = Vec::new();
    for (sensor, a) in vehicle.sensors.iter().zip(sensors) {
        let phi = vehicle.functions(&sensor.at);
        let motions = &bodies[sensor.at.body];
        let miss: Vec<f64> = (0..a.len())
            .map(|t| a[t] - phi.iter().zip(motions).map(|(p, q)| p * q[t]).sum::<f64>())
            .collect();
        let share = rms(&miss) / rms(a).max(f64::MIN_POSITIVE);
        if share > RIGID_LIMIT {
            let message = format!(
                "{:.0} % of the acceleration does not fit the rigid motion of body `{}`.",
                100.0 * share,
                vehicle.bodies[sensor.at.body].name
            );
            let remedy = "Check places, signs and order of the accelerometers; the frame may also bend or twist in the band.";
            findings.push(
                Finding::new(
                    Severity::Warning,
                    "not-rigid",
                    &sensor.channel,
                    message,
                    remedy,
                )
                .with_numbers(share, RIGID_LIMIT),
            );
        }
    }
    findings
}
