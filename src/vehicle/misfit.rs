//! Misfit of a fitted vehicle in every channel.

use super::layout::Vehicle;
use super::loads::{Blend, link_forces, needed_forces, wheel_forces};
use super::motion::Motion;
use crate::linalg::tall::left_inverse;
use crate::series::detrend::rms;

/// Returns for each channel the RMS of measured minus predicted signal and the RMS of the measured signal, from [`channel_residuals`].
pub fn channel_misfits(
    part: &Vehicle,
    values: &[f64],
    m: &Motion,
    blend: &Blend,
) -> Vec<(String, f64, f64)> {
    channel_residuals(part, values, m, blend)
        .into_iter()
        .map(|(channel, left, size)| (channel, rms(&left), size))
        .collect()
}

/// Returns for each channel its name, measured minus predicted value, and RMS of the measured value. The channels are every measured wheel force,
/// then the accelerometers of every body whose outside forces are measured. Accelerations are predicted from forces and stretch.
pub fn channel_residuals(
    part: &Vehicle,
    values: &[f64],
    m: &Motion,
    blend: &Blend,
) -> Vec<(String, Vec<f64>, f64)> {
    let mut out = Vec::new();
    let minus = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>();
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
        // Residual of each equation of the body, converted to an error of acceleration by the inertia.
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
            out.push((sensor.channel.clone(), error, rms(a)));
        }
    }
    out
}
