//! What frequencies and damping that are not known exactly put into the loads of a record, and what motion makes of them.

use super::plant::Plant;
use super::types::BAND_END;
use crate::linalg::complex::ComplexMatrix;
use crate::linalg::{Complex, Matrix};
use crate::series::plans::forward;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Mean squares by load of S, over stretches of a record.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Doubt {
    /// Of the error that one standard deviation of every mode's frequency and of its damping makes.
    pub error: Vec<f64>,
    /// Of what loads recovered as if at rest are off by.
    pub motion: Vec<f64>,
    /// Of the loads, their means left out.
    pub load: Vec<f64>,
}

/// Of stretches of one length (a power of two), a channel each, sampled at `rate_hz`. `None` where a frequency can't be told.
pub(super) fn doubt(
    plant: &Plant<'_>,
    at_rest: &Matrix,
    stretches: &[Vec<&[f64]>],
    rate_hz: f64,
) -> Option<Doubt> {
    let length = stretches.first()?.first()?.len();
    let end_hz = BAND_END * plant.dynamics().up_to_hz;
    let n_bins = ((end_hz / rate_hz * length as f64) as usize + 1).min(length / 2 + 1);
    let spectra: Vec<Vec<Vec<Complex<f64>>>> = stretches
        .par_iter()
        .map(|channels| channels.iter().map(|c| tapered(c)).collect())
        .collect();
    let rest = at_rest.map(|v| Complex::new(v, 0.0));
    let of_bin = |b: usize| {
        let hz = b as f64 * rate_hz / length as f64;
        let readings = spectra.iter().map(|channels| {
            let n = plant.n_gauges();
            ComplexMatrix::from_fn(n, 1, |g, _| channels[g][b] * plant.band(hz))
        });
        bin(plant, hz, &rest, readings)
    };
    let bins: Vec<Doubt> = (1..n_bins)
        .into_par_iter()
        .map(of_bin)
        .collect::<Option<_>>()?;
    // Both signs of every frequency; the taper leaves three eighths of the power.
    let scale = 2.0 / (0.375 * (length as f64).powi(2) * stretches.len() as f64);
    let mean = |part: fn(&Doubt) -> &Vec<f64>| -> Vec<f64> {
        let of_load = |l: usize| scale * bins.iter().map(|b| part(b)[l]).sum::<f64>();
        (0..plant.n_loads()).map(of_load).collect()
    };
    Some(Doubt {
        error: mean(|d| &d.error),
        motion: mean(|d| &d.motion),
        load: mean(|d| &d.load),
    })
}

/// The squares at one frequency.
fn bin(
    plant: &Plant<'_>,
    hz: f64,
    at_rest: &ComplexMatrix,
    readings: impl Iterator<Item = ComplexMatrix>,
) -> Option<Doubt> {
    let k = plant.n_loads();
    let d = plant.dynamics();
    let gain = plant.gain(hz)?;
    let of_motion = &gain * &plant.shapes;
    let moved_by = plant.moved_by(&gain);
    let mut out = Doubt {
        error: vec![0.0; k],
        motion: vec![0.0; k],
        load: vec![0.0; k],
    };
    let answers: Vec<f64> = (0..plant.n_modes())
        .map(|j| {
            let a = plant.answer(j, hz);
            (a.by_frequency * d.frequency_sd).norm_sqr() + (a.by_damping * d.damping_sd).norm_sqr()
        })
        .collect();
    for y in readings {
        let loads = &gain * &y;
        let change = at_rest * &y - &loads;
        let moved = &moved_by * &y;
        for l in 0..k {
            out.load[l] += loads[l].norm_sqr();
            out.motion[l] += change[l].norm_sqr();
            let of_mode = answers.iter().enumerate();
            out.error[l] += of_mode
                .map(|(j, a)| a * of_motion[(l, j)].norm_sqr() * moved[j].norm_sqr())
                .sum::<f64>();
        }
    }
    Some(out)
}

/// The transform of a channel less its mean under a Hann taper.
fn tapered(channel: &[f64]) -> Vec<Complex<f64>> {
    let n = channel.len();
    let mean = channel.iter().sum::<f64>() / n as f64;
    let plan = forward(n);
    let mut input = plan.make_input_vec();
    for (i, (v, x)) in input.iter_mut().zip(channel).enumerate() {
        let taper = 0.5 * (1.0 - (2.0 * PI * i as f64 / n as f64).cos());
        *v = taper * (x - mean);
    }
    let mut out = plan.make_output_vec();
    let done = plan.process(&mut input, &mut out);
    debug_assert!(done.is_ok());
    out
}
