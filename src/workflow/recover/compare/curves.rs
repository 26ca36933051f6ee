//! Spectra, coherence and level crossings of recovered and recorded loads.

use crate::series::butterworth::{Passes, filter_without_phase};
use crate::series::level_crossing::count_crossings;
use crate::series::welch::cross_spectra;
use rayon::prelude::*;
use serde::Serialize;

/// Choices for spectra and levels, each with its reason.
pub(super) struct CurveRules {
    /// Number of averaged segments, if the record is long enough. The standard deviation of a density is then about 20 %.
    averages: usize,
    /// Longest segment, samples. Longer ones resolve more lines than a page can show.
    longest: usize,
    /// Shortest segment, samples. Shorter ones do not resolve a spectrum, so that none is given.
    shortest: usize,
    /// Levels of each load, at the middles of equal classes over both loads.
    levels: usize,
    /// Corner of the filter for a faster recording, a share of the sample rate of the strain. Content that folds back to half of the corner is
    /// beyond twice the corner, where the filter passes 0.4 % of the amplitude.
    pub low_pass: f64,
}

pub(super) const RULES: CurveRules = CurveRules {
    averages: 32,
    longest: 8192,
    shortest: 64,
    levels: 40,
    low_pass: 0.4,
};

/// How the spectra of a comparison were computed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ComparisonSpectra {
    /// Window of each segment.
    pub window: &'static str,
    /// Overlap of two neighbours, a share of the segment.
    pub overlap: f64,
    /// Length of a segment, s.
    pub segment_s: f64,
    /// Segments averaged, by load the smallest number.
    pub averages: usize,
    /// Frequencies, Hz, up to half of the sample rate if both records have samples at the same times. Otherwise up to an eighth of the rate of the
    /// recording: the curve between its samples loses 1 % of the density there.
    #[serde(skip)]
    pub f_hz: Vec<f64>,
    /// By load.
    #[serde(skip)]
    pub loads: Vec<LoadSpectra>,
}

/// Spectra of a load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadSpectra {
    /// Load or combination.
    pub load: String,
    /// Report unit.
    pub unit: String,
    /// One-sided density of the recovered load, unit^2/Hz.
    pub recovered: Vec<f64>,
    /// One-sided density of the recorded load, unit^2/Hz.
    pub recorded: Vec<f64>,
    /// Coherence of both.
    pub coherence: Vec<f64>,
    /// Phase of the recovered relative to the recorded load, degrees.
    pub phase_deg: Vec<f64>,
}

/// Level crossings of a load.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadLevels {
    /// Load or combination.
    pub load: String,
    /// Report unit.
    pub unit: String,
    /// Mean of the recorded load. Levels at or above count rises, levels below count falls.
    pub reference: f64,
    /// Levels, ascending.
    pub levels: Vec<f64>,
    /// Crossings by the recovered load.
    pub recovered: Vec<u64>,
    /// Crossings by the recorded load.
    pub recorded: Vec<u64>,
}

/// A load at the same times, recovered and recorded; NaN where either is unknown.
pub(super) struct SampledLoad {
    pub load: String,
    pub unit: String,
    pub recovered: Vec<f64>,
    pub recorded: Vec<f64>,
}

/// Returns the longest power of two that leaves the wanted number of half-overlapping segments; `None` for records that are too short.
fn segment_of(n: usize) -> Option<usize> {
    let fitting = 2 * n / (RULES.averages + 1);
    let shortened = (fitting.max(1).ilog2() as usize).min(RULES.longest.ilog2() as usize);
    Some(1 << shortened).filter(|s| *s >= RULES.shortest)
}

/// Returns recorded loads without their content above the sample rate of the strain; `None` if the recording is not faster. `rates` is the
/// sample rate of the strain over the rate of the recording.
pub(super) fn without_alias(recorded: &[Vec<f32>], rates: f64) -> Option<Vec<Vec<f32>>> {
    let is_faster = rates < 0.9;
    is_faster.then(|| {
        let of_load = |samples: &Vec<f32>| {
            let mut x: Vec<f64> = samples.iter().map(|v| f64::from(*v)).collect();
            filter_without_phase(&mut x, Passes::Low, RULES.low_pass * rates);
            x.into_iter().map(|v| v as f32).collect()
        };
        recorded.par_iter().map(of_load).collect()
    })
}

/// Returns spectra and coherence of loads at `rate_hz`, up to `highest_hz`; `None` for a record that is too short.
pub(super) fn spectra_of(
    loads: &[SampledLoad],
    rate_hz: f64,
    highest_hz: f64,
) -> Option<ComparisonSpectra> {
    let segment = segment_of(loads.first()?.recovered.len())?;
    let mut out = ComparisonSpectra {
        window: "hann",
        overlap: 0.5,
        segment_s: segment as f64 / rate_hz,
        averages: usize::MAX,
        f_hz: Vec::new(),
        loads: Vec::new(),
    };
    for load in loads {
        let found = cross_spectra(&load.recorded, &load.recovered, rate_hz, segment);
        if found.n_segments == 0 {
            continue;
        }
        let kept = found.f_hz.iter().filter(|f| **f <= highest_hz).count();
        let cut = |x: &[f64]| x[..kept].to_vec();
        out.averages = out.averages.min(found.n_segments);
        out.f_hz = cut(&found.f_hz);
        let phase = found.xy.iter().map(|c| c.arg().to_degrees());
        out.loads.push(LoadSpectra {
            load: load.load.clone(),
            unit: load.unit.clone(),
            recovered: cut(&found.yy),
            recorded: cut(&found.xx),
            coherence: cut(&found.coherence()),
            phase_deg: cut(&phase.collect::<Vec<f64>>()),
        });
    }
    (!out.loads.is_empty()).then_some(out)
}

/// Returns the crossings of levels over the range of both loads; `None` for loads that are constant or unknown.
pub(super) fn levels_of(
    (load, unit): (&str, &str),
    recovered: impl Iterator<Item = f64> + Clone,
    recorded: impl Iterator<Item = f64> + Clone,
) -> Option<LoadLevels> {
    let known = recorded.clone().filter(|v| v.is_finite());
    let reference = known.clone().sum::<f64>() / known.count() as f64;
    let all = || {
        recovered
            .clone()
            .chain(recorded.clone())
            .filter(|v| v.is_finite())
    };
    let [low, high] = [
        all().fold(f64::INFINITY, f64::min),
        all().fold(f64::NEG_INFINITY, f64::max),
    ];
    let width = (high - low) / RULES.levels as f64;
    if !(width > 0.0 && reference.is_finite()) {
        return None;
    }
    let middles = (0..RULES.levels).map(|i| low + (i as f64 + 0.5) * width);
    let levels: Vec<f64> = middles.collect();
    Some(LoadLevels {
        load: load.to_owned(),
        unit: unit.to_owned(),
        reference,
        recovered: count_crossings(recovered, &levels, reference),
        recorded: count_crossings(recorded, &levels, reference),
        levels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 32 half-overlapping segments of 256 samples need 4224 samples.
    #[test]
    fn a_segment_is_the_longest_power_of_two_with_32_averages() {
        assert_eq!(segment_of(4224), Some(256));
        assert_eq!(segment_of(4223), Some(128));
        assert_eq!(segment_of(10_000_000), Some(8192));
        assert_eq!(segment_of(1000), None);
    }
}
