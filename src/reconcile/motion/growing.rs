//! The rate of a clock that is far off, found on a beginning of the record that grows.

use super::candidate::Candidate;
use super::change::Change;
use super::fit::{Effort, fit};
use super::fitted::MotionFit;
use super::frame::MotionFrame;
use super::noise::Background;
use super::part::Part;
use crate::series::channels::{Channel, Channels};

/// Shares of the record, one after the other: what is left of a rate's error on one is small on the next.
const SHARES: [f64; 3] = [0.25, 0.5, 1.0];
/// Rates that the shortest begins with.
const RATES: [f64; 9] = [-8e-3, -6e-3, -4e-3, -2e-3, 0.0, 2e-3, 4e-3, 6e-3, 8e-3];

/// The fit of a channel's clock alone.
///
/// A step of least squares finds its way over a quarter of a wave. A clock off by 3,000 millionths is three waves of an axle late after a
/// minute, but half a wave after ten seconds, and of nine starts one is within a tenth there.
pub fn fit_of_clock(
    frame: &MotionFrame,
    candidates: &[Candidate],
    candidate: usize,
    shape: &Change,
) -> Option<MotionFit> {
    let none = Background::default();
    let n = frame.data.n_samples();
    let mut rates = RATES.to_vec();
    let mut found = None;
    for share in SHARES {
        let begin = beginning(&frame.data, (share * n as f64) as usize);
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
        // Too short for the band, or no rate that a clock has: the next one tries for itself.
        if let Some(f) = best {
            rates = f.parts.iter().map(|p| p.fault).collect();
            found = Some((share, f));
        }
    }
    found.filter(|(share, _)| *share >= 1.0).map(|(_, f)| f)
}

/// The first `n` samples.
fn beginning(record: &Channels, n: usize) -> Channels {
    let cut = |c: &Channel| Channel {
        samples: c.samples.iter().take(n).copied().collect(),
        ..c.clone()
    };
    Channels {
        list: record.list.iter().map(cut).collect(),
        ..record.clone()
    }
}
