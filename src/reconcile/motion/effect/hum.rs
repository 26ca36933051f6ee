//! A mains line on a channel. Its frequency is 50 Hz, 60 Hz or 16.7 Hz (railways), a multiple, or an alias of these within the band.

use crate::reconcile::motion::candidate::Candidate;
use crate::reconcile::motion::change::Change;
use crate::reconcile::motion::frame::MotionFrame;
use crate::series::window::WindowedTransform;
use crate::vehicle::motion::Motion;

/// Mains, Hz.
const MAINS_HZ: [f64; 3] = [50.0 / 3.0, 50.0, 60.0];
/// Highest multiple of a mains frequency.
const MULTIPLES: usize = 6;
/// Largest deviation of a mains frequency from its nominal value, a share.
const WANDER: f64 = 0.005;
/// Power of a line over the mean of its neighbourhood: noise of a dozen bins exceeds this in one job of a million.
const LINE_POWER_RATIO: f64 = 16.0;

pub(super) fn candidates(frame: &MotionFrame, motion: &Motion) -> Vec<Candidate> {
    let mut out: Vec<Candidate> = Vec::new();
    for channel in frame.channels() {
        let Some(x) = motion.signal(&frame.vehicle, &channel) else {
            continue;
        };
        for hz in lines(frame, motion, x) {
            let id = format!("{channel}@{hz:.1} Hz");
            let line = Change::Line {
                channel: channel.clone(),
                hz,
            };
            let mut one = Candidate::new("hum", Some(&channel), vec![line]);
            // The first line of a channel has the plain name. The names of further lines contain the frequency.
            if out.iter().any(|c| c.id == one.id) {
                one.id = format!("hum:{id}");
            }
            out.push(one);
        }
    }
    out
}

/// Returns the possible mains frequencies at which a signal exceeds its neighbourhood.
fn lines(frame: &MotionFrame, motion: &Motion, x: &[f64]) -> Vec<f64> {
    let window = WindowedTransform::new(motion.n_samples(), motion.rate_hz, frame.band);
    let step = window.step_hz();
    let rate = frame.data.rate_hz;
    let mut out: Vec<f64> = Vec::new();
    for mains in MAINS_HZ {
        for k in 1..=MULTIPLES {
            let nominal = k as f64 * mains;
            // A frequency above half the sample rate appears as its alias.
            let folded = (nominal - rate * (nominal / rate).round()).abs();
            let inside = folded > frame.band.low_hz && folded < frame.band.high_hz;
            let known = out
                .iter()
                .any(|f| (f - folded).abs() < WANDER * nominal + 2.0 * step);
            if !inside || known {
                continue;
            }
            out.extend(line(&window, motion, x, folded, WANDER * nominal));
        }
    }
    out
}

/// Returns the frequency of a line within `reach` of `about`, if the line exceeds its neighbourhood.
fn line(
    window: &WindowedTransform,
    motion: &Motion,
    x: &[f64],
    about: f64,
    reach: f64,
) -> Option<f64> {
    /// Number of bins from a line to the first bin of its neighbourhood, either side.
    const NEAR: f64 = 3.0;
    /// Bins of the neighbourhood, either side.
    const FAR: usize = 16;
    let step = window.step_hz();
    let power = |f: f64| window.transform_at(x, motion.rate_hz, f).norm_sqr();
    let best = |from: f64, to: f64, step: f64| -> (f64, f64) {
        let n = ((to - from) / step).ceil().max(1.0) as usize;
        (0..=n)
            .map(|i| from + i as f64 * step)
            .map(|f| (f, power(f)))
            .fold((from, 0.0), |a, b| if b.1 > a.1 { b } else { a })
    };
    let (mut f, _) = best(about - reach - step, about + reach + step, 0.5 * step);
    let mut fine = 0.25 * step;
    while fine > 1e-3 * step {
        f = best(f - 2.0 * fine, f + 2.0 * fine, fine).0;
        fine *= 0.5;
    }
    let sides: Vec<f64> = (0..FAR)
        .flat_map(|k| {
            let off = (NEAR + k as f64) * step;
            [power(f - off), power(f + off)]
        })
        .collect();
    let mean = sides.iter().sum::<f64>() / sides.len() as f64;
    (power(f) > LINE_POWER_RATIO * mean).then_some(f)
}
