//! The rate of a clock that is far off, found on a beginning of the record that grows.

use super::candidate::Candidate;
use super::change::Change;
use super::fit::{Effort, fit};
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use super::noise::Background;
use super::part::Part;
use crate::series::channels::{Channel, Channels};

/// The first stretch, s; each of the next is twice as long, up to the whole: the remaining error of a rate on one is small on the next.
const BEGIN_S: f64 = 15.0;
/// Rates that the first begins with.
const RATES: [f64; 9] = [-8e-3, -6e-3, -4e-3, -2e-3, 0.0, 2e-3, 4e-3, 6e-3, 8e-3];

/// The fit of a channel's clock alone.
///
/// A step of least squares finds its way over a quarter of a wave. At 10 Hz, an axle's, a clock off by 3,000 millionths is nearly two waves late
/// after a minute. Of the nine starts one is at most 1,000 off, 15 ms on the first stretch, a seventh of that wave.
pub fn fit_of_clock(
    frame: &MotionFrame,
    candidates: &[Candidate],
    candidate: usize,
    shape: &Change,
) -> Option<MotionFit> {
    let none = Background::default();
    let n = frame.data.n_samples();
    let mut length = ((BEGIN_S * frame.data.rate_hz) as usize).max(1);
    let mut rates = RATES.to_vec();
    loop {
        let begin = truncate_record(&frame.data, length);
        let fitted = |rate: &f64| {
            let part = Part {
                candidate,
                shape: shape.clone(),
                fault: *rate,
            };
            let parts = vec![part];
            fit(
                frame,
                candidates,
                &begin,
                parts,
                None,
                &none,
                Effort::Settled,
            )
        };
        let best = (rates.iter().filter_map(fitted))
            .min_by(|a, b| a.reduced_chi2().total_cmp(&b.reduced_chi2()));
        if length >= n {
            return best;
        }
        // Too short for the band, or no rate that a clock has: the next one tries for itself.
        if let Some(f) = best {
            rates = f.parts.iter().map(|p| p.fault).collect();
        }
        length *= 2;
    }
}

/// The first `n` samples.
fn truncate_record(record: &Channels, n: usize) -> Channels {
    let cut = |c: &Channel| Channel {
        name: c.name.clone(),
        unit: c.unit.clone(),
        samples: c.samples.iter().take(n).copied().collect(),
    };
    Channels {
        rate_hz: record.rate_hz,
        start_s: record.start_s,
        list: record.list.iter().map(cut).collect(),
    }
}
