//! Refines parameters by the error of simulation. This decides on nonlinear terms, since stretch is simulated, not integrated.

use super::layout::{Measures, Vehicle};
use super::simulate::{Drive, SimulatedMotion, SimulationError, simulate};
use crate::linalg::levenberg::{Minimum, levenberg_marquardt};
use crate::series::detrend::{rms, without_mean};
use crate::series::integrate::integrate_in_band;
use crate::series::spectrum::{Band, Fourier};
use crate::series::{Channels, SeriesError};

/// Measured signals for comparison with a simulation, and the inputs of the simulation.
#[derive(Clone, Debug)]
pub struct Comparison {
    drive: Drive,
    /// Sensor index and the measured signal, in band and trimmed.
    measured: Vec<(usize, Vec<f64>)>,
    band: Band,
    trim: usize,
}

/// A refined fit.
#[derive(Clone, Debug, PartialEq)]
pub struct Refinement {
    /// Values of all parameters.
    pub values: Vec<f64>,
    /// Constant force on each body (from the offset of a displacement sensor).
    pub constant: Vec<f64>,
    /// RMS of measured minus simulated signal of each compared sensor, before and after, in the unit of the sensor.
    pub error_rms: Vec<(String, f64, f64)>,
    /// Minimum in the free parameters (then constants, then offsets). The residuals are divided by the RMS of each sensor.
    pub minimum: Minimum,
}

/// Band without limits. Residuals are used unchanged.
pub const OPEN: Band = Band {
    low_hz: 0.0,
    high_hz: f64::INFINITY,
};

/// Sets up the simulation of a record. Measured wheel forces drive the bodies whose wheels are all measured. The motion of a body with an unmeasured
/// wheel, or of a body in `witnesses`, is given. It is integrated from the accelerometer down to half the band's lower edge.
///
/// # Errors
/// [`SeriesError`] if a channel is missing or the record is too short for the band.
pub fn comparison(
    vehicle: &Vehicle,
    record: &Channels,
    band: Band,
    witnesses: &[usize],
) -> Result<Comparison, SeriesError> {
    let (record, _) = record.with_gaps_filled();
    let trim = if band == OPEN {
        0
    } else {
        (1.5 * band.settling_s() * record.rate_hz) as usize
    };
    if record.n_samples() < 3 * trim + 10 {
        let needed_s = 3.0 * trim as f64 / record.rate_hz;
        return Err(SeriesError::TooShort {
            found_s: record.duration_s(),
            needed_s,
            low_hz: band.low_hz,
        });
    }
    let measured_wheels = |b: usize| {
        vehicle
            .wheels
            .iter()
            .all(|w| w.at.body != b || record.has(&w.channel))
    };
    let mut drive = Drive {
        rate_hz: record.rate_hz,
        forces: vec![],
        given: vec![],
        constant: vec![0.0; vehicle.bodies.len()],
        steps: 2,
    };
    let absolute = vehicle
        .sensors
        .iter()
        .any(|s| s.measures == Measures::Displacement);
    for w in &vehicle.wheels {
        let force = record.samples(&w.channel).ok().map(|x| {
            if absolute {
                x.to_vec()
            } else {
                without_mean(x)
            }
        });
        drive.forces.push(force);
    }
    let wide = Band {
        low_hz: 0.5 * band.low_hz,
        high_hz: f64::INFINITY,
    };
    for (b, body) in vehicle.bodies.iter().enumerate() {
        let own = vehicle
            .sensors
            .iter()
            .find(|s| s.at.body == b && body.shape.n() == 1);
        drive.given.push(match own {
            Some(s) if !measured_wheels(b) || witnesses.contains(&b) => {
                let a = record.samples(&s.channel)?;
                Some(vec![[
                    integrate_in_band(a, record.rate_hz, wide, 2),
                    integrate_in_band(a, record.rate_hz, wide, 1),
                ]])
            }
            _ => None,
        });
    }
    let mut measured = Vec::new();
    for (i, s) in vehicle
        .sensors
        .iter()
        .enumerate()
        .filter(|(_, s)| drive.given[s.at.body].is_none())
    {
        let x = record.samples(&s.channel)?;
        let x = if absolute {
            x.to_vec()
        } else {
            without_mean(x)
        };
        measured.push((i, in_band(&x, record.rate_hz, band, trim)));
    }
    Ok(Comparison {
        drive,
        measured,
        band,
        trim,
    })
}

fn in_band(x: &[f64], rate_hz: f64, band: Band, trim: usize) -> Vec<f64> {
    let kept = |x: &[f64]| x[trim..x.len() - trim].to_vec();
    if band == OPEN {
        return kept(x);
    }
    let mut fourier = Fourier::default();
    let s = fourier.spectrum(x, rate_hz).band_integrated(band, 0);
    kept(&fourier.samples(&s, 1))
}

impl Comparison {
    /// Returns the simulated minus the measured signal of each compared sensor, in the band and trimmed.
    ///
    /// # Errors
    /// [`SimulationError`].
    pub fn errors(
        &self,
        vehicle: &Vehicle,
        values: &[f64],
        constant: &[f64],
    ) -> Result<Vec<(usize, Vec<f64>)>, SimulationError> {
        let drive = Drive {
            constant: constant.to_vec(),
            ..self.drive.clone()
        };
        let s = simulate(vehicle, values, &drive)?;
        Ok(self
            .measured
            .iter()
            .map(|(i, y)| {
                let x = in_band(
                    &sensor_signal(vehicle, &s, *i),
                    self.drive.rate_hz,
                    self.band,
                    self.trim,
                );
                (*i, x.iter().zip(y).map(|(a, b)| a - b).collect())
            })
            .collect())
    }

    /// Returns this comparison with `steps` integration steps for each sample.
    pub fn with_steps(mut self, steps: usize) -> Self {
        self.drive.steps = steps;
        self
    }

    /// Returns the RMS of each compared sensor. It includes the mean if the mean is compared.
    pub fn measured_rms(&self) -> Vec<(usize, f64)> {
        let size = |y: &[f64]| {
            let kept: Vec<f64> = y.iter().copied().filter(|v| v.is_finite()).collect();
            rms(&kept)
        };
        self.measured.iter().map(|(i, y)| (*i, size(y))).collect()
    }

    /// Excludes samples at the start from the comparison, while the initial state of the simulation decays.
    pub fn forget(&mut self, samples: usize) {
        let n = samples.min(self.measured.first().map_or(0, |m| m.1.len()) / 2);
        self.measured
            .iter_mut()
            .for_each(|m| m.1.iter_mut().take(n).for_each(|v| *v = f64::NAN));
    }
}

/// Returns the simulated reading of a sensor.
pub fn sensor_signal(vehicle: &Vehicle, s: &SimulatedMotion, sensor: usize) -> Vec<f64> {
    let at = &vehicle.sensors[sensor].at;
    let motions = match vehicle.sensors[sensor].measures {
        Measures::Acceleration => &s.acceleration[at.body],
        Measures::Displacement => &s.displacement[at.body],
    };
    let phi = vehicle.functions(at);
    let n = motions.first().map_or(0, Vec::len);
    (0..n)
        .map(|t| phi.iter().zip(motions).map(|(p, q)| p * q[t]).sum())
        .collect()
}

/// Minimises the simulation error over the parameters `free`, starting at `values`. With displacement sensors it also estimates a constant force on
/// each body.
///
/// # Errors
/// [`SimulationError`] when even the start can't be simulated.
pub fn refine(
    vehicle: &Vehicle,
    values: &[f64],
    free: &[usize],
    comparison: &Comparison,
) -> Result<Refinement, SimulationError> {
    let absolute = vehicle
        .sensors
        .iter()
        .any(|s| s.measures == Measures::Displacement);
    let n_bodies = if absolute { vehicle.bodies.len() } else { 0 };
    let finite = |x: &[f64]| {
        x.iter()
            .copied()
            .filter(|v| v.is_finite())
            .collect::<Vec<f64>>()
    };
    let sizes: Vec<f64> = comparison
        .measured
        .iter()
        .map(|(_, y)| rms(&finite(y)).max(f64::MIN_POSITIVE))
        .collect();
    let at = |u: &[f64]| {
        let mut v = values.to_vec();
        free.iter().zip(u).for_each(|(&i, x)| v[i] = *x);
        let mut constant = vec![0.0; vehicle.bodies.len()];
        constant
            .iter_mut()
            .zip(&u[free.len()..])
            .for_each(|(c, x)| *c = *x);
        (v, constant)
    };
    let error_rms = |u: &[f64]| -> Result<Vec<f64>, SimulationError> {
        let (v, c) = at(u);
        Ok(comparison
            .errors(vehicle, &v, &c)?
            .iter()
            .map(|(_, e)| rms(&finite(e)))
            .collect())
    };
    let residuals = |u: &[f64]| -> Option<Vec<f64>> {
        let (v, c) = at(u);
        let errors = comparison.errors(vehicle, &v, &c).ok()?;
        Some(
            errors
                .iter()
                .zip(&sizes)
                .flat_map(|((_, e), s)| finite(e).into_iter().map(move |x| x / s))
                .collect(),
        )
    };
    let mut start: Vec<f64> = free.iter().map(|&i| values[i]).collect();
    let largest_force = comparison
        .drive
        .forces
        .iter()
        .flatten()
        .map(|f| rms(f))
        .fold(0.0, f64::max);
    let mut scale: Vec<f64> = start.iter().map(|v| v.abs()).collect();
    start.extend(vec![0.0; n_bodies]);
    scale.extend(vec![largest_force; n_bodies]);
    let before = error_rms(&start)?;
    let minimum = levenberg_marquardt(residuals, &start, &scale);
    let after = error_rms(&minimum.x)?;
    let names = comparison
        .measured
        .iter()
        .map(|(i, _)| vehicle.sensors[*i].channel.clone());
    let (values, constant) = at(&minimum.x);
    Ok(Refinement {
        values,
        constant,
        error_rms: names
            .zip(before)
            .zip(after)
            .map(|((n, b), a)| (n, b, a))
            .collect(),
        minimum,
    })
}
