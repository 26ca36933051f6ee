//! Channels as spectra, and the motion of bodies as weighted sums of them.

use super::adjustment::Adjustment;
use super::layout::{Measures, Vehicle};
use super::limiter::Limiter;
use super::treatment::{Treatment, VehicleError};
use crate::finding::{Finding, Severity};
use crate::linalg::tall::left_inverse;
use crate::series::channels::Channels;
use crate::series::detrend::{rms, without_mean};
use crate::series::spectrum::{Fourier, Spectrum};
use rustfft::num_complex::Complex64;
use std::f64::consts::PI;

/// Redundant accelerometers may miss the rigid motion by this share of their signal before it is reported.
const RIGID_LIMIT: f64 = 0.15;

/// Transforms of the corrected channels. Displacements are converted to accelerations.
pub(super) struct ChannelSpectra {
    pub sensors: Vec<Spectrum>,
    pub forces: Vec<Option<Spectrum>>,
}

impl ChannelSpectra {
    /// # Errors
    /// A sensor without a channel.
    pub fn from_record(
        vehicle: &Vehicle,
        record: &Channels,
        treatment: &Treatment,
        fourier: &mut Fourier,
    ) -> Result<Self, VehicleError> {
        let mut transform = |name: &str, measures: Measures| -> Result<Spectrum, VehicleError> {
            let mut x = without_mean(record.samples(name)?);
            let adjust = Adjustment::of_channel(&treatment.adjust, name);
            if let Some(right) =
                (adjust.as_ref()).and_then(|a| a.correct_clock(&x, record.start_s, record.rate_hz))
            {
                x = right;
            }
            let spectrum = fourier.spectrum(&x, record.rate_hz);
            if adjust.is_none() && measures == Measures::Acceleration {
                return Ok(spectrum);
            }
            Ok(spectrum.times(|f| {
                let w = 2.0 * PI * f;
                let twice = if measures == Measures::Displacement {
                    -w * w
                } else {
                    1.0
                };
                let undone = adjust.as_ref().map(|a| a.inverse_response(w));
                undone.unwrap_or(Complex64::new(1.0, 0.0)) * twice
            }))
        };
        let sensors = vehicle
            .sensors
            .iter()
            .map(|s| transform(&s.channel, s.measures))
            .collect::<Result<_, _>>()?;
        let forces = vehicle
            .wheels
            .iter()
            .map(|w| {
                let measured = record.has(&w.channel);
                let force = measured.then(|| transform(&w.channel, Measures::Acceleration));
                force.transpose()
            })
            .collect::<Result<_, _>>()?;
        Ok(Self { sensors, forces })
    }
}

/// Returns the accelerations of each body in each of its motions. A body with one sensor has the acceleration of the sensor.
pub(super) fn body_motions(
    vehicle: &Vehicle,
    spectra: &[Vec<Spectrum>],
    sensors: &[Vec<f64>],
    limit: &mut Limiter,
) -> Vec<Vec<Vec<f64>>> {
    let own = |b: usize| -> Vec<usize> {
        (0..vehicle.sensors.len())
            .filter(|&s| vehicle.sensors[s].at.body == b)
            .collect()
    };
    spectra
        .iter()
        .enumerate()
        .map(
            |(b, motions)| match (motions.as_slice(), own(b).as_slice()) {
                ([_], [s]) => vec![sensors[*s].clone()],
                _ => motions
                    .iter()
                    .map(|s| limit.samples_in_band(s, 0))
                    .collect(),
            },
        )
        .collect()
}

/// Returns the motions of each body as weighted sums of its sensors.
pub(super) fn body_spectra(
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

/// Returns findings on sensors of one body that do not move as one rigid body.
pub(super) fn check_rigid(
    vehicle: &Vehicle,
    sensors: &[Vec<f64>],
    bodies: &[Vec<Vec<f64>>],
) -> Vec<Finding> {
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
            let remedy = "Check places, signs and order of the accelerometers. The frame may also bend or twist in the band.";
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
