//! Measured channels made comparable: one band for all, body motions, stretch of links, terms formed wide-band.

use super::body_motion::{ChannelSpectra, body_motions, body_spectra, check_rigid};
use super::layout::Vehicle;
use super::limiter::Limiter;
use super::link_motion::{link_motion, step_columns};
use super::term::Term;
pub use super::treatment::{Treatment, VehicleError};
use crate::finding::{Finding, Severity};
use crate::series::channels::Channels;
use crate::series::detrend::{mean, rms};

/// Band-limited, trimmed signals of a record. All have one length and rate.
#[derive(Clone, Debug)]
pub struct Motion {
    /// Samples per second.
    pub rate_hz: f64,
    /// Time of the first sample, s.
    pub start_s: f64,
    /// Acceleration of each sensor.
    pub sensors: Vec<Vec<f64>>,
    /// Accelerations of each body, one for each of its motions.
    pub bodies: Vec<Vec<Vec<f64>>>,
    /// Stretch of each link.
    pub stretch: Vec<Vec<f64>>,
    /// Rate of stretch of each link.
    pub rate: Vec<Vec<f64>>,
    /// Each term of each link for a coefficient of one, computed without the band and then limited to the band.
    pub terms: Vec<Vec<Vec<f64>>>,
    /// Column of each mass change: its active share times acceleration.
    pub steps: Vec<Vec<f64>>,
    /// Force of each wheel, if measured.
    pub forces: Vec<Option<Vec<f64>>>,
    /// Mean force of each wheel over the whole record, if measured.
    pub mean_forces: Vec<Option<f64>>,
    /// Findings on the record.
    pub findings: Vec<Finding>,
}

impl Motion {
    /// Returns the number of samples.
    pub fn n_samples(&self) -> usize {
        self.sensors.first().map_or(0, Vec::len)
    }

    /// Returns the samples of the channel of a sensor or of a wheel's force.
    pub fn signal(&self, vehicle: &Vehicle, channel: &str) -> Option<&[f64]> {
        let sensor = vehicle.sensors.iter().position(|s| s.channel == channel);
        if let Some(s) = sensor {
            return self.sensors.get(s).map(Vec::as_slice);
        }
        let wheel = vehicle.wheels.iter().position(|w| w.channel == channel)?;
        self.forces.get(wheel)?.as_deref()
    }

    /// Returns the stretch of `length` samples from sample `from`. It is shorter if the motion ends earlier.
    pub fn stretch_of(&self, from: usize, length: usize) -> Self {
        let cut =
            |x: &Vec<f64>| -> Vec<f64> { x.iter().skip(from).take(length).copied().collect() };
        let all = |x: &Vec<Vec<f64>>| -> Vec<Vec<f64>> { x.iter().map(cut).collect() };
        Self {
            rate_hz: self.rate_hz,
            start_s: self.start_s + from as f64 / self.rate_hz,
            sensors: all(&self.sensors),
            bodies: self.bodies.iter().map(all).collect(),
            stretch: all(&self.stretch),
            rate: all(&self.rate),
            terms: self.terms.iter().map(all).collect(),
            steps: all(&self.steps),
            forces: self.forces.iter().map(|f| f.as_ref().map(cut)).collect(),
            mean_forces: self.mean_forces.clone(),
            findings: vec![],
        }
    }

    /// Returns the motion of the part of the vehicle made of the given bodies, in the order of [`Vehicle::part`].
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

/// Returns the vehicle with constants from the record for terms that the job leaves open (0). Friction velocity is 2 % of the rms rate of stretch,
/// free travel of a bump stop is 70 % of the largest stretch.
///
/// # Errors
/// Errors of [`motion`].
pub fn resolve_constants(
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

/// Computes the motion of a vehicle in a record. The band's lower edge removes constant offsets and gravity. Nonlinear terms use stretch and rate
/// down to half of the lower edge, without an upper edge. They are then limited to the band like all other columns.
///
/// # Errors
/// [`VehicleError`] if a channel is missing, a body's motion is not measured, or the record is shorter than the band needs.
pub fn motion(
    vehicle: &Vehicle,
    record: &Channels,
    treatment: &Treatment,
) -> Result<Motion, VehicleError> {
    let mut limit = Limiter::new(vehicle, record, treatment)?;
    let (record, mut findings) = bridge_gaps(record);
    let spectra = ChannelSpectra::from_record(vehicle, &record, treatment, &mut limit.fourier)?;
    let body_spectra = body_spectra(vehicle, &spectra.sensors)?;
    let sensors: Vec<Vec<f64>> = spectra
        .sensors
        .iter()
        .map(|s| limit.samples_in_band(s, 0))
        .collect();
    let bodies = body_motions(vehicle, &body_spectra, &sensors, &mut limit);
    findings.extend(check_rigid(vehicle, &sensors, &bodies));
    let forces = spectra
        .forces
        .iter()
        .map(|s| s.as_ref().map(|s| limit.samples_in_band(s, 0)))
        .collect();
    let (mut stretch, mut rate, mut terms) = (vec![], vec![], vec![]);
    for l in 0..vehicle.links.len() {
        let Some(link) = link_motion(vehicle, &record, treatment, &body_spectra, l, &mut limit)
        else {
            continue;
        };
        stretch.push(link.stretch);
        rate.push(link.rate);
        terms.push(link.terms);
    }
    let wheels = vehicle.wheels.iter();
    Ok(Motion {
        rate_hz: limit.rate_hz / limit.keep as f64,
        start_s: record.start_s + (limit.trim * limit.keep) as f64 / limit.rate_hz,
        steps: step_columns(vehicle, &record, &body_spectra, &mut limit),
        mean_forces: wheels
            .map(|w| record.samples(&w.channel).ok().map(mean))
            .collect(),
        sensors,
        bodies,
        stretch,
        rate,
        terms,
        forces,
        findings,
    })
}

/// Returns the record with missing samples bridged, and the findings on them.
fn bridge_gaps(record: &Channels) -> (Channels, Vec<Finding>) {
    let (record, gaps) = record.with_gaps_filled();
    let findings = record
        .list
        .iter()
        .zip(&gaps)
        .filter(|(_, n)| **n > 0)
        .map(|(channel, n)| {
            let message = format!("{n} missing samples are replaced by straight lines.");
            Finding::new(
                Severity::Info,
                "gaps-filled",
                &channel.name,
                message,
                "Choose a stretch without gaps.",
            )
        })
        .collect();
    (record, findings)
}
