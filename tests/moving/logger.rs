//! Adds faults of a logger to finished records. It uses no code of the program.

use super::generator::{Background, Case, Layout, RATE_HZ, hide};
use std::f64::consts::{PI, TAU};

/// Fault of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Relative clock error: reading(t) = truth(t - share t).
    Clock(f64),
    /// Number of lost samples, and their position as a share of the record.
    Lost(usize, f64),
    /// First-order low-pass with a cut-off in Hz (bilinear transform).
    LowPass(f64),
    /// Second-order Butterworth low-pass with a cut-off in Hz (bilinear transform).
    Butterworth(f64),
    /// Sine with a frequency in Hz and an amplitude.
    Hum(f64, f64),
}

impl Fault {
    pub fn name(self) -> &'static str {
        match self {
            Self::Clock(_) => "clock_drift",
            Self::Lost(..) => "dropped_samples",
            Self::LowPass(_) | Self::Butterworth(_) => "low_pass",
            Self::Hum(..) => "hum",
        }
    }

    /// Returns the true size of the fault.
    pub fn size(self) -> f64 {
        match self {
            Self::Clock(share) => 1e6 * share,
            Self::Lost(n, _) => -(n as f64) / RATE_HZ,
            Self::LowPass(hz) | Self::Butterworth(hz) => 1.0 / (TAU * hz),
            Self::Hum(_, amplitude) => amplitude,
        }
    }

    fn spoil(self, x: &mut Vec<f64>, fitted: bool) {
        match self {
            Self::Clock(share) => *x = stretch_time(x, share),
            Self::Lost(n, at) if fitted => {
                let from = (at * x.len() as f64) as usize;
                let last = x[x.len() - 1];
                x.drain(from..from + n);
                x.extend(vec![last; n]);
            }
            Self::Lost(..) => {}
            Self::LowPass(hz) => {
                let k = (PI * hz / RATE_HZ).tan();
                apply_filter(
                    x,
                    [k / (1.0 + k), k / (1.0 + k), 0.0],
                    [(k - 1.0) / (k + 1.0), 0.0],
                );
            }
            Self::Butterworth(hz) => {
                let k = (PI * hz / RATE_HZ).tan();
                let n = 1.0 / (1.0 + 2f64.sqrt() * k + k * k);
                let b = k * k * n;
                let a = [2.0 * (k * k - 1.0) * n, (1.0 - 2f64.sqrt() * k + k * k) * n];
                apply_filter(x, [b, 2.0 * b, b], a);
            }
            Self::Hum(hz, amplitude) => {
                for (i, v) in x.iter_mut().enumerate() {
                    *v += amplitude * (TAU * hz * i as f64 / RATE_HZ + 0.7).sin();
                }
            }
        }
    }
}

/// Applies a difference equation that starts in equilibrium at the first sample.
fn apply_filter(x: &mut [f64], b: [f64; 3], a: [f64; 2]) {
    let level = x[0];
    let (mut xs, mut ys) = ([0.0; 2], [0.0; 2]);
    for v in x.iter_mut() {
        let u = *v - level;
        let y = b[0] * u + b[1] * xs[0] + b[2] * xs[1] - a[0] * ys[0] - a[1] * ys[1];
        (xs, ys) = ([u, xs[0]], [y, ys[0]]);
        *v = y + level;
    }
}

/// Returns x(t - share t), interpolated by a cubic.
fn stretch_time(x: &[f64], share: f64) -> Vec<f64> {
    let last = x.len() as isize - 1;
    let at = |i: isize| x[i.clamp(0, last) as usize];
    (0..x.len())
        .map(|i| {
            let u = i as f64 * (1.0 - share);
            let (k, f) = (u.floor() as isize, u - u.floor());
            let (p, q, r, s) = (at(k - 1), at(k), at(k + 1), at(k + 2));
            // Lagrange interpolation through four samples.
            p * (-f * (f - 1.0) * (f - 2.0) / 6.0)
                + q * ((f + 1.0) * (f - 1.0) * (f - 2.0) / 2.0)
                + r * (-(f + 1.0) * f * (f - 2.0) / 2.0)
                + s * ((f + 1.0) * f * (f - 1.0) / 6.0)
        })
        .collect()
}

/// Returns a faultless truck with one faulty channel in both records.
pub fn generate_faulty_case(
    layout: Layout,
    fault: Fault,
    channel: &str,
    background: Background,
    seed: u64,
) -> Case {
    let mut case = hide(layout, "none", 0, background, seed);
    for (record, fitted) in [(&mut case.data, true), (&mut case.hold_out, false)] {
        for (_, x) in record.iter_mut().filter(|c| c.0 == channel) {
            fault.spoil(x, fitted);
        }
    }
    case.truth = fault.name().to_owned();
    case.channel = Some(channel.to_owned());
    case
}
