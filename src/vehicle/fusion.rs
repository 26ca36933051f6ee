//! Wheel force from strain bridges on the axle and an accelerometer at the hub.

use super::interval::effective_samples;
use crate::linalg::tall::solve_rows;
use crate::series::detrend::{mean, rms};
use thiserror::Error;

/// An axle bridge that has been calibrated: wheel force = factor . bridge + outboard mass . hub acceleration + offset.
///
/// The bridge (shear, or the difference of two bending bridges) reads the force that passes its section; what sits outboard of
/// it (wheel, hub, brake) takes its inertia before that.
#[derive(Clone, Debug, PartialEq)]
pub struct AxleBridge {
    /// Force per unit of bridge reading.
    pub factor: f64,
    /// Mass outboard of the bridge.
    pub outboard_mass: f64,
    /// Force at zero reading and zero acceleration.
    pub offset: f64,
    /// Standard deviations of the three, and of a single force sample.
    pub sigma: [f64; 4],
}

/// Why a calibration gave nothing.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum FusionError {
    /// Signals of different length, or too few samples.
    #[error(
        "bridge, hub and force have {0}, {1} and {2} samples: cut them to one length of at least 10"
    )]
    Length(usize, usize, usize),
    /// The signals do not tell factor and mass apart.
    #[error(
        "bridge and hub signals move together: the outboard mass can't be told; state it as known, or drive a rougher road"
    )]
    Alike,
}

/// Calibrates from a record with measured wheel force (or from weighing: known steps of force at rest); all signals in one band.
///
/// With `outboard_mass` known only factor and offset are fitted.
///
/// # Errors
/// [`FusionError`].
///
/// # Reference
/// LeBlanc, Woodrooffe & Papagiannakis, A comparison of the accuracy of two types of instrumentation for measuring vertical
/// wheel load, 1992.
pub fn calibrate(
    bridge: &[f64],
    hub: &[f64],
    force: &[f64],
    outboard_mass: Option<f64>,
) -> Result<AxleBridge, FusionError> {
    let n = force.len();
    if bridge.len() != n || hub.len() != n || n < 10 {
        return Err(FusionError::Length(bridge.len(), hub.len(), n));
    }
    let rows: Vec<Vec<f64>> = (0..n)
        .map(|i| match outboard_mass {
            Some(_) => vec![bridge[i], 1.0],
            None => vec![bridge[i], 1.0, hub[i]],
        })
        .collect();
    let target: Vec<f64> = (0..n)
        .map(|i| force[i] - outboard_mass.unwrap_or(0.0) * hub[i])
        .collect();
    let s = solve_rows(&rows, &target).ok_or(FusionError::Alike)?;
    if s.singular_values.last().copied().unwrap_or(0.0)
        < 1e-3 * s.singular_values.first().copied().unwrap_or(0.0)
    {
        return Err(FusionError::Alike);
    }
    let mass = outboard_mass.unwrap_or_else(|| s.x.get(2).copied().unwrap_or(f64::NAN));
    let residual: Vec<f64> = (0..n)
        .map(|i| target[i] - rows[i].iter().zip(&s.x).map(|(a, b)| a * b).sum::<f64>())
        .collect();
    let colour = n as f64 / effective_samples(&residual);
    let each = rms(&residual);
    let sigma = |i: usize| {
        s.inverse
            .get(i)
            .and_then(|r| r.get(i))
            .map_or(0.0, |v| each * (v * colour).sqrt())
    };
    Ok(AxleBridge {
        factor: s.x[0],
        outboard_mass: mass,
        offset: s.x[1],
        sigma: [sigma(0), sigma(2), sigma(1), each],
    })
}

impl AxleBridge {
    /// Wheel force history; one sigma of a sample is `self.sigma[3]`.
    pub fn wheel_force(&self, bridge: &[f64], hub: &[f64]) -> Vec<f64> {
        bridge
            .iter()
            .zip(hub)
            .map(|(b, a)| self.factor * b + self.outboard_mass * a + self.offset)
            .collect()
    }
}

/// Two histories of one load, from strain and from acceleration, as one: weighted by one over variance, means kept from the
/// first (accelerations know no mean). Returns the history and one sigma.
///
/// `alike` is the correlation of their errors (0 when the sensors are independent).
pub fn combined(
    strain_path: &[f64],
    sigma_strain: f64,
    acceleration_path: &[f64],
    sigma_acceleration: f64,
    alike: f64,
) -> (Vec<f64>, f64) {
    let (a, b) = (
        sigma_strain * sigma_strain,
        sigma_acceleration * sigma_acceleration,
    );
    let c = alike * sigma_strain * sigma_acceleration;
    let whole = a + b - 2.0 * c;
    let w = if whole > 0.0 {
        ((b - c) / whole).clamp(0.0, 1.0)
    } else {
        0.5
    };
    let (ma, mb) = (mean(strain_path), mean(acceleration_path));
    let history = strain_path
        .iter()
        .zip(acceleration_path)
        .map(|(s, x)| ma + w * (s - ma) + (1.0 - w) * (x - mb))
        .collect();
    (
        history,
        (w * w * a + (1.0 - w) * (1.0 - w) * b + 2.0 * w * (1.0 - w) * c)
            .max(0.0)
            .sqrt(),
    )
}
