//! Estimation of a large clock rate, on a beginning of the record that is extended step by step.

use super::candidate::Candidate;
use super::change::Change;
use super::fit::{Effort, fit};
use super::frame::MotionFrame;
use super::motion_fit::MotionFit;
use super::noise::Background;
use super::part::Part;
use crate::series::channels::{Channel, Channels};

/// Length of the first stretch, s. Each further stretch is twice as long, up to the whole record. The error of a rate from one stretch is small
/// enough as a start on the next one.
const BEGIN_S: f64 = 15.0;
/// Start rates for the first stretch.
const RATES: [f64; 9] = [-8e-3, -6e-3, -4e-3, -2e-3, 0.0, 2e-3, 4e-3, 6e-3, 8e-3];

/// Fits the clock of one channel as the only effect.
///
/// A step of least squares converges from up to a quarter of a wave. At the 10 Hz of an axle, a clock off by 3,000 millionths is nearly two waves
/// late after a minute. One of the nine start rates is at most 1,000 millionths off. This is 15 ms on the first stretch, a seventh of such a wave.
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
        // Without a fit, the stretch is too short for the band, or the rate is not plausible for a clock. The next stretch then uses the same start
        // rates.
        if let Some(f) = best {
            rates = f.parts.iter().map(|p| p.fault).collect();
        }
        length *= 2;
    }
}

/// Returns the first `n` samples.
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
