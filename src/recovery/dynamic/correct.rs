//! A record put at rest, stretch by stretch between its gaps.

use super::block::Block;
use super::kernel::Kernel;
use super::plant::Plant;
use super::reading_covariance::ReadingCovariance;
use super::types::{Dynamics, Unfit};
use crate::sensitivity::Sensitivity;
use std::collections::BTreeMap;
use std::ops::Range;

/// Sets of gauges that read: samples of any further set are blank.
const MOST_SETS: usize = 8;
/// Largest count of numbers in the filters of all sets: 256 MB.
pub(super) const MOST_NUMBERS: usize = 32_000_000;

/// Quasi-static readings of a record, with their errors.
#[derive(Clone, Debug, PartialEq)]
pub struct AtRest {
    /// Every sample of each gauge. NaN if nothing is known.
    pub readings: Vec<Vec<f64>>,
    /// Samples with at least one reading.
    pub read: usize,
    /// Samples with a known quasi-static reading.
    pub known: usize,
    /// Samples without a known gauge although the gauges that read determine the loads. They are at the ends of stretches,
    /// and in stretches that are too short.
    pub blank: usize,
    /// Number of samples on either side on which a quasi-static sample depends, if all gauges read.
    pub reach: usize,
    /// Variance of the noise of a quasi-static reading over the variance of a reading's noise, mean of the gauges, if all gauges read.
    pub noise_share: f64,
    /// Further error of quasi-static readings, beyond this noise.
    pub doubt: ReadingCovariance,
    /// Mean square error of loads recovered without this correction, by load of S; NaN where no sample is known.
    pub motion: Vec<f64>,
    /// Mean square of the loads about their mean, by load of S; NaN where no sample is known.
    pub load: Vec<f64>,
}

/// Stretches of a record with the same active gauges.
pub(super) struct Stretches {
    /// Sets of active gauges. The set of all gauges is the first, the others are sorted by the duration of their samples.
    sets: Vec<Vec<usize>>,
    /// Index of the set, and samples. Samples without any reading are left out.
    list: Vec<(usize, Range<usize>)>,
}

/// Sums of squares of loads.
struct Squares {
    sample_count: f64,
    motion: Vec<f64>,
    load: Vec<f64>,
    sum: Vec<f64>,
}

/// Returns the quasi-static readings of a record. `readings` are strain by gauge of `s`, every sample at `rate_hz`, NaN where a reading is missing.
/// `noise` is the noise of one reading, strain.
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
    let stretches = Stretches::from_readings(readings, samples);
    let mut left = MOST_NUMBERS;
    let mut kernel_of = |used: &[usize]| -> Result<Kernel, Unfit> {
        let kernel = Kernel::new(&Plant::new(s, used, dynamics, noise), rate_hz, left)?;
        left -= kernel.numbers;
        Ok(kernel)
    };
    let mut kernels = Vec::with_capacity(MOST_SETS);
    for (i, used) in stretches.sets.iter().take(MOST_SETS).enumerate() {
        let kernel = kernel_of(used);
        // A set of gauges that does not determine the loads leaves its samples blank. The set of all gauges must determine them.
        kernels.push(if i == 0 { Some(kernel?) } else { kernel.ok() });
    }
    let whole = kernels.first().and_then(Option::as_ref);
    let (reach, noise_share) = whole.map_or((0, 0.0), |k| {
        (k.reach, k.noise.trace() / readings.len().max(1) as f64)
    });
    let mut doubt = ReadingCovariance::new(readings.len(), samples, window(dynamics, rate_hz));
    for (used, kernel) in stretches.sets.iter().zip(&kernels) {
        let Some(kernel) = kernel else { continue };
        let variance = noise * noise;
        doubt.add_noise(used, &(&kernel.noise * variance), noise_share * variance);
    }
    let mut out = vec![vec![f64::NAN; samples]; readings.len()];
    let mut squares = Squares::new(s.loads.len());
    let (mut read, mut known, mut could) = (0, 0, 0);
    for (set, span) in &stretches.list {
        read += span.len();
        let Some(Some(kernel)) = kernels.get(*set) else {
            continue;
        };
        could += span.len();
        let used = &stretches.sets[*set];
        let from: Vec<&[f64]> = used.iter().map(|g| &*readings[*g]).collect();
        kernel.apply(&from, span, |block| {
            for (g, values) in used.iter().zip(&block.readings) {
                out[*g][block.first..block.first + values.len()].copy_from_slice(values);
            }
            known += block.readings.first().map_or(0, Vec::len);
            doubt.add(used, block, squares.add(block));
        });
    }
    doubt.settle();
    let (motion, load) = squares.means();
    Ok(AtRest {
        readings: out,
        read,
        known,
        blank: could - known,
        reach,
        noise_share,
        doubt,
        motion,
        load,
    })
}

/// Returns the number of samples over which errors are averaged: a period of the highest wanted frequency.
pub fn window(dynamics: &Dynamics, rate_hz: f64) -> usize {
    ((rate_hz / dynamics.up_to_hz) as usize).max(1)
}

impl Stretches {
    /// Returns the stretches in which the same gauges read.
    pub fn from_readings(readings: &[Vec<f64>], samples: usize) -> Self {
        let reads = |i: usize| readings.iter().map(move |c| c[i].is_finite());
        let mut numbers: BTreeMap<Vec<bool>, usize> = BTreeMap::new();
        numbers.insert(vec![true; readings.len()], 0);
        // The set of all gauges comes first, even if all gauges rarely read together.
        let mut lengths = vec![usize::MAX];
        let mut list = Vec::new();
        let mut first = 0;
        for i in 1..=samples {
            if i < samples && reads(i).eq(reads(first)) {
                continue;
            }
            if reads(first).any(|r| r) {
                let next = numbers.len();
                let set = *numbers.entry(reads(first).collect()).or_insert(next);
                lengths.resize(lengths.len().max(set + 1), 0);
                lengths[set] = lengths[set].saturating_add(i - first);
                list.push((set, first..i));
            }
            first = i;
        }
        let mut order: Vec<usize> = (0..lengths.len()).collect();
        order.sort_by_key(|set| std::cmp::Reverse(lengths[*set]));
        let mut place = vec![0; order.len()];
        (0..).zip(&order).for_each(|(i, set)| place[*set] = i);
        let mut sets = vec![Vec::new(); order.len()];
        for (reads, set) in numbers {
            sets[place[set]] = (0..reads.len()).filter(|g| reads[*g]).collect();
        }
        list.iter_mut().for_each(|(set, _)| *set = place[*set]);
        Self { sets, list }
    }
}

impl Stretches {
    /// Returns the stretches in which all gauges read.
    pub fn of_all_gauges(self) -> Vec<Range<usize>> {
        let all = self.list.into_iter().filter(|(set, _)| *set == 0);
        all.map(|(_, span)| span).collect()
    }
}

impl Squares {
    fn new(k: usize) -> Self {
        Self {
            sample_count: 0.0,
            motion: vec![0.0; k],
            load: vec![0.0; k],
            sum: vec![0.0; k],
        }
    }

    /// Adds the squares of a block and returns the number of its samples.
    fn add(&mut self, block: &Block) -> usize {
        let added = block.loads.first().map_or(0, Vec::len);
        self.sample_count += added as f64;
        for (l, (moves, load)) in block.motion.iter().zip(&block.loads).enumerate() {
            self.motion[l] += moves.iter().map(|v| v * v).sum::<f64>();
            self.load[l] += load.iter().map(|v| v * v).sum::<f64>();
            self.sum[l] += load.iter().sum::<f64>();
        }
        added
    }

    /// Returns the mean squares of the motion errors of the loads, and of the loads minus their means.
    fn means(&self) -> (Vec<f64>, Vec<f64>) {
        let load = self.load.iter().zip(&self.sum);
        let load =
            load.map(|(q, s)| (q / self.sample_count - (s / self.sample_count).powi(2)).max(0.0));
        let known = |v: f64| if self.sample_count > 0.0 { v } else { f64::NAN };
        (
            self.motion.iter().map(|q| q / self.sample_count).collect(),
            load.map(known).collect(),
        )
    }
}
