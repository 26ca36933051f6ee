//! Samples of a record on which recovery tests whether the loads explain the strain. Some samples are spread evenly over the record. Others are the
//! extremes of each load, which determine the range to the power of the S-N slope. A single wrong sample can be an extreme.

use crate::finding::{Finding, Severity, list_few};
use crate::input_faults::AlternativeRows;
use crate::recovery::dynamic::ReadingCovariance;
use crate::recovery::{
    Alternatives, ErrorModel, NOT_SOLVABLE, Readings, Recovery, UNEXPLAINED,
    recover_samples_with_alternatives, uncalibrated_strain,
};
use crate::sensitivity::Sensitivity;
use std::collections::BTreeMap;

/// Number of samples that are tested, equal to the number on which recovery tests its gauges. More samples give no more information.
const TESTED_SAMPLES: usize = 200;
/// Smallest share of samples unlike the calibration (at least two samples) that is reported. One in a thousand correct samples is unlike by chance.
const UNLIKE: f64 = 0.05;

/// A sample at which a load is largest or smallest.
#[derive(Clone, Debug)]
struct Extreme {
    at: usize,
    /// The load, its sign turned for the smallest.
    value: f64,
    strain: Vec<f64>,
}

/// Samples that are tested, of a part of a record or of the whole record.
#[derive(Clone, Debug, Default)]
pub struct TestedSamples {
    n_gauges: usize,
    n_loads: usize,
    stride: usize,
    spread: BTreeMap<usize, Vec<f64>>,
    /// Samples with the largest and the smallest value of each load, in pairs.
    extremes: Vec<Extreme>,
}

impl TestedSamples {
    /// Creates a selection without samples for a record of `samples`, whose noise is independent after `apart` samples.
    pub fn new(n_gauges: usize, n_loads: usize, (samples, apart): (usize, usize)) -> Self {
        let spread = TESTED_SAMPLES
            .saturating_sub(2 * n_loads)
            .max(TESTED_SAMPLES / 2);
        let none = Extreme {
            at: 0,
            value: f64::NEG_INFINITY,
            strain: Vec::new(),
        };
        Self {
            n_gauges,
            n_loads,
            stride: samples.div_ceil(spread).max(apart).max(1),
            spread: BTreeMap::new(),
            extremes: vec![none; 2 * n_loads],
        }
    }

    /// Looks at samples from number `first` of the record on: strain minus zero (`n_gauges` for each row), and the loads recovered from it.
    pub fn add(&mut self, first: usize, strain: &[f64], loads: &[f64]) {
        let n = self.n_gauges.max(1);
        let rows = strain.len() / n;
        let row = |i: usize| strain.get(i * n..(i + 1) * n).unwrap_or_default().to_vec();
        let begin = first.next_multiple_of(self.stride) - first;
        for i in (begin..rows).step_by(self.stride) {
            self.spread.insert(first + i, row(i));
        }
        for (l, pair) in self.extremes.chunks_exact_mut(2).enumerate() {
            let mut best: Vec<(f64, Option<usize>)> =
                pair.iter().map(|e| (e.value, None)).collect();
            if let [high, low] = best.as_mut_slice() {
                for (i, v) in loads
                    .iter()
                    .skip(l)
                    .step_by(self.n_loads.max(1))
                    .enumerate()
                {
                    if *v > high.0 {
                        *high = (*v, Some(i));
                    }
                    if -*v > low.0 {
                        *low = (-*v, Some(i));
                    }
                }
            }
            for (extreme, (value, at)) in pair.iter_mut().zip(best) {
                if let Some(i) = at {
                    *extreme = Extreme {
                        at: first + i,
                        value,
                        strain: row(i),
                    };
                }
            }
        }
    }

    /// Adds the samples of the next part of the record.
    pub fn merge(&mut self, next: Self) {
        self.spread.extend(next.spread);
        for (a, b) in self.extremes.iter_mut().zip(next.extremes) {
            if b.value > a.value {
                *a = b;
            }
        }
    }

    /// The smallest and the largest value of each load, as they were given; not a number where a load has none.
    pub fn ends(&self) -> Vec<[f64; 2]> {
        let value = |e: &Extreme| {
            if e.strain.is_empty() {
                f64::NAN
            } else {
                e.value
            }
        };
        let pairs = self.extremes.chunks_exact(2);
        let ends = pairs.map(|pair| match pair {
            [high, low] => [-value(low), value(high)],
            _ => [f64::NAN; 2],
        });
        ends.collect()
    }

    /// Returns the samples spread over the record, each with its number.
    pub fn numbered_samples(&self) -> impl Iterator<Item = (usize, &[f64])> {
        self.spread.iter().map(|(at, strain)| (*at, &**strain))
    }

    /// Recovers all of these samples. If the loads explain them, recovers the extremes alone too: among 200 samples a single wrong one may not be
    /// significant. Empty if no gauge reads. `beyond` are errors beyond the noise. `installed` are the rows of S of gauges that are installed
    /// otherwise than stated.
    pub fn recover_loads(
        self,
        (s, installed): (&Sensitivity, &[AlternativeRows]),
        (errors, noise_factor, beyond): (ErrorModel, f64, Option<&ReadingCovariance>),
        time_s: impl Fn(usize) -> f64,
    ) -> Vec<Recovery> {
        let extremes = self.extremes.into_iter().map(|e| (e.at, e.strain));
        let extremes: BTreeMap<usize, Vec<f64>> =
            extremes.filter(|(_, strain)| !strain.is_empty()).collect();
        let mut all = self.spread;
        all.extend(extremes.clone());
        let mut out = Vec::new();
        for samples in [all, extremes] {
            let errors_of = |(i, strain): (&usize, &Vec<f64>)| {
                let reads = |g: &usize| strain[*g].is_finite();
                let used: Vec<usize> = (0..strain.len()).filter(reads).collect();
                beyond.map(|b| b.covariances_at(*i, &used))
            };
            let of_samples = samples.iter().filter_map(errors_of).collect();
            let readings: Vec<Readings> = samples
                .into_iter()
                .map(|(i, strain)| Readings::of_sample(time_s(i), strain, noise_factor))
                .collect();
            if readings.is_empty() {
                continue;
            }
            // Vibration changes the readings of gauges that are installed otherwise too, and is not removed for them.
            let mut rows = || match beyond {
                Some(_) => Vec::new(),
                None => installed.to_vec(),
            };
            let with = (of_samples, &mut rows as &mut Alternatives);
            let recovery = recover_samples_with_alternatives(s, readings, errors, with);
            let unexplained = recovery.findings.iter().any(|f| f.code == UNEXPLAINED);
            out.push(recovery);
            if unexplained {
                break;
            }
        }
        out
    }
}

/// Returns the findings on the record: findings on all samples, and additional findings on the extremes.
pub fn findings_of(recoveries: Vec<Recovery>) -> Vec<Finding> {
    let mut out: Vec<Finding> = Vec::new();
    for recovery in recoveries {
        for f in findings_of_one(recovery) {
            let said =
                |o: &Finding| o.code == f.code && (o.subject == f.subject || is_of_samples(&f));
            if !out.iter().any(said) {
                out.push(f);
            }
        }
    }
    out
}

/// Codes of findings whose subjects are samples.
pub const OF_SAMPLES: [&str; 3] = [UNEXPLAINED, NOT_SOLVABLE, uncalibrated_strain::CODE];

fn is_of_samples(f: &Finding) -> bool {
    OF_SAMPLES.contains(&f.code)
}

/// Converts the findings on samples into findings of the record. Info findings are left out: one correct record in twenty has one by chance.
fn findings_of_one(recovery: Recovery) -> Vec<Finding> {
    let mut out: Vec<Finding> = Vec::new();
    let mut subjects: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for f in recovery.findings {
        if f.severity == Severity::Info {
            continue;
        }
        // Findings on single samples with the same code become one finding.
        let of_sample = f.code == uncalibrated_strain::CODE || f.code == NOT_SOLVABLE;
        if of_sample {
            let list = subjects.entry(f.code).or_default();
            list.push(f.subject.clone());
            if list.len() > 1 {
                continue;
            }
        }
        out.push(f);
    }
    let enough = (UNLIKE * recovery.runs.len() as f64).max(2.0);
    let n_unlike = subjects.get(uncalibrated_strain::CODE).map_or(0, Vec::len);
    out.retain(|f| f.code != uncalibrated_strain::CODE || n_unlike as f64 >= enough);
    for f in &mut out {
        if let Some(list) = subjects.get(f.code) {
            f.subject = list_few(list);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_the_same_however_the_record_is_cut_and_hold_every_extreme() {
        let samples = 5000;
        let strain: Vec<f64> = (0..3 * samples).map(|i| i as f64).collect();
        let mut loads: Vec<f64> = (0..2 * samples).map(|i| (i % 97) as f64).collect();
        (loads[2 * 777], loads[2 * 4001 + 1]) = (1e3, -1e3);
        let select = |piece: usize| {
            let mut all = TestedSamples::new(3, 2, (samples, 1));
            for first in (0..samples).step_by(piece) {
                let end = (first + piece).min(samples);
                let mut part = TestedSamples::new(3, 2, (samples, 1));
                part.add(
                    first,
                    &strain[3 * first..3 * end],
                    &loads[2 * first..2 * end],
                );
                all.merge(part);
            }
            all
        };
        let (whole, cut) = (select(samples), select(33));
        assert_eq!(format!("{whole:?}"), format!("{cut:?}"));
        assert!((150..=TESTED_SAMPLES).contains(&(whole.spread.len() + whole.extremes.len())));
        assert_eq!((whole.extremes[0].at, whole.extremes[3].at), (777, 4001));
        assert_eq!(whole.extremes[0].strain, strain[3 * 777..3 * 778]);
    }
}
