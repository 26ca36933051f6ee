//! A record put at rest, stretch by stretch between its gaps.

use super::doubt::{Doubt, doubt};
use super::kernel::Kernel;
use super::plant::Plant;
use super::types::{Dynamics, Unfit};
use crate::sensitivity::Sensitivity;
use std::collections::BTreeMap;
use std::ops::Range;

/// Stretches on which the doubt is judged.
const JUDGED: usize = 8;
/// Sets of gauges that read: samples of any further set are blank.
const MOST_SETS: usize = 8;

/// Readings at rest.
#[derive(Clone, Debug, PartialEq)]
pub struct AtRest {
    /// By gauge, every sample; NaN where nothing is known.
    pub readings: Vec<Vec<f64>>,
    /// Samples at the ends of stretches, and in stretches too short to say anything, of which no gauge is known though some was read.
    pub blank: usize,
    /// Samples to either side that a sample at rest hangs on, all gauges reading.
    pub reach: usize,
    /// Variance of a reading at rest over that of a reading.
    pub noise_share: f64,
    /// By load of S: variance beyond that of readings at rest with that noise.
    pub load_variance: Vec<f64>,
    /// By load of S: mean square of what loads recovered as if at rest are off by.
    pub motion: Vec<f64>,
    /// By load of S: mean square, mean left out.
    pub load: Vec<f64>,
}

/// The readings (strain, by gauge of `s`, every sample at `rate_hz`; NaN where there is none) of a record at rest. `noise` is that of a reading,
/// strain.
///
/// # Errors
/// See [`Unfit`].
pub fn readings_at_rest(
    s: &Sensitivity,
    dynamics: &Dynamics,
    noise: f64,
    readings: &[Vec<f64>],
    rate_hz: f64,
) -> Result<AtRest, Unfit> {
    let samples = readings.first().map_or(0, Vec::len);
    let all: Vec<usize> = (0..readings.len()).collect();
    let plant = Plant::new(s, &all, dynamics, noise);
    let kernel = Kernel::new(&plant, rate_hz)?;
    let stretches = stretches(readings, samples);
    let judged = judged(&plant, &kernel, readings, &stretches, rate_hz);
    let (reach, noise_share) = (kernel.reach, kernel.noise_share);
    let excess = kernel.excess.iter();
    let load_variance = match judged.error.is_empty() {
        true => excess.map(|e| e * noise * noise).collect(),
        false => excess
            .zip(&judged.error)
            .map(|(e, d)| e * noise * noise + d)
            .collect(),
    };
    let mut kernels: BTreeMap<Vec<usize>, Option<Kernel>> = BTreeMap::new();
    kernels.insert(all, Some(kernel));
    let mut out = vec![vec![f64::NAN; samples]; readings.len()];
    let mut known = 0;
    let mut read = 0;
    for (used, span) in stretches.into_iter().filter(|s| !s.0.is_empty()) {
        read += span.len();
        if !kernels.contains_key(&used) {
            if kernels.len() == MOST_SETS {
                continue;
            }
            let plant = Plant::new(s, &used, dynamics, noise);
            // Gauges that tell too little leave their samples blank, as they do at rest.
            kernels.insert(used.clone(), Kernel::new(&plant, rate_hz).ok());
        }
        let Some(Some(kernel)) = kernels.get(&used) else {
            continue;
        };
        let from: Vec<&[f64]> = used.iter().map(|g| &*readings[*g]).collect();
        kernel.apply(&from, span, |first, block| {
            for (g, values) in used.iter().zip(block) {
                out[*g][first..first + values.len()].copy_from_slice(values);
            }
            known += block.first().map_or(0, Vec::len);
        });
    }
    Ok(AtRest {
        readings: out,
        blank: read - known,
        reach,
        noise_share,
        load_variance,
        motion: judged.motion,
        load: judged.load,
    })
}

/// Stretches in which the same gauges read.
fn stretches(readings: &[Vec<f64>], samples: usize) -> Vec<(Vec<usize>, Range<usize>)> {
    let reads = |i: usize| readings.iter().map(move |c| c[i].is_finite());
    let mut out = Vec::new();
    let mut first = 0;
    for i in 1..=samples {
        if i < samples && reads(i).eq(reads(first)) {
            continue;
        }
        let used = reads(first).enumerate().filter(|(_, r)| *r).map(|(g, _)| g);
        out.push((used.collect(), first..i));
        first = i;
    }
    out
}

/// The doubt, on stretches in which all gauges read; empty where none is long enough.
fn judged(
    plant: &Plant<'_>,
    kernel: &Kernel,
    readings: &[Vec<f64>],
    stretches: &[(Vec<usize>, Range<usize>)],
    rate_hz: f64,
) -> Doubt {
    let whole = |s: &&(Vec<usize>, Range<usize>)| s.0.len() == readings.len();
    let longest = stretches.iter().filter(whole).map(|s| s.1.len()).max();
    let longest = longest.unwrap_or(0);
    if longest < 4 {
        return Doubt::default();
    }
    // The largest power of two that fits, up to the length of the filter's transform.
    let length = ((longest / 2 + 1).next_power_of_two()).min(kernel.length());
    let firsts: Vec<usize> = stretches
        .iter()
        .filter(whole)
        .flat_map(|s| (s.1.start..(s.1.end + 1).saturating_sub(length)).step_by(length))
        .collect();
    let taken = firsts.len().min(JUDGED);
    let spread: Vec<Vec<&[f64]>> = (0..taken)
        .map(|i| firsts[i * firsts.len() / taken])
        .map(|first| readings.iter().map(|c| &c[first..first + length]).collect())
        .collect();
    let at_rest = plant.gain_at_rest();
    at_rest
        .and_then(|rest| doubt(plant, &rest, &spread, rate_hz))
        .unwrap_or_default()
}
