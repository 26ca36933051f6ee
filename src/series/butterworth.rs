//! Butterworth filters of order 4 without phase shift.
//!
//! The bilinear transform with prewarped corner gives two sections of second order. They run forward and backward over the samples, so that the
//! amplitude at a frequency `f` is `1 / (1 + w^8)` with `w = tan(pi f / rate) / tan(pi corner / rate)`; for the high-pass, with `1 / w`. It is one
//! half at the corner.
//!
//! # Reference
//! F. Gustafsson, Determining the initial states in forward-backward filtering, IEEE Transactions on Signal Processing 44 (1996) 988.

use std::f64::consts::PI;

/// Samples by which both ends are continued, point-symmetric about the last sample.
const EDGE: usize = 15;
/// Quality of the two sections of a filter of order 4.
const QUALITIES: [f64; 2] = [0.541_196_100_146_197, 1.306_562_964_876_376_5];

/// Frequencies that a filter passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passes {
    /// Below the corner.
    Low,
    /// Above the corner.
    High,
}

/// Coefficients of a section, `y = (b0 + b1 z + b2 z^2) / (1 + a1 z + a2 z^2) x`, `z` the delay by a sample.
#[derive(Clone, Copy)]
struct Section {
    b: [f64; 3],
    a: [f64; 2],
}

impl Section {
    /// Returns a section; `corner` is relative to the sample rate, below one half.
    fn new(passes: Passes, corner: f64, quality: f64) -> Self {
        let k = (PI * corner).tan();
        let norm = 1.0 / (1.0 + k / quality + k * k);
        let b = match passes {
            Passes::Low => [1.0, 2.0, 1.0].map(|v| v * k * k * norm),
            Passes::High => [1.0, -2.0, 1.0].map(|v| v * norm),
        };
        let a = [
            2.0 * (k * k - 1.0) * norm,
            (1.0 - k / quality + k * k) * norm,
        ];
        Self { b, a }
    }

    /// Filters samples in place, from the state of a constant input that equals the first sample.
    fn run(&self, x: &mut [f64]) {
        let (b, a) = (self.b, self.a);
        let first = x.first().copied().unwrap_or(0.0);
        let steady = first * b.iter().sum::<f64>() / (1.0 + a[0] + a[1]);
        let mut z2 = b[2] * first - a[1] * steady;
        let mut z1 = b[1] * first - a[0] * steady + z2;
        for v in x {
            let y = b[0] * *v + z1;
            z1 = b[1] * *v - a[0] * y + z2;
            z2 = b[2] * *v - a[1] * y;
            *v = y;
        }
    }
}

/// Filters samples in place. `corner` is relative to the sample rate, above 0 and below one half.
///
/// Gaps shorter than `1 / corner` samples are bridged by straight lines for the filter and stay gaps. Longer gaps separate stretches. A stretch that
/// is shorter than `1 / corner` samples becomes a gap.
pub fn filter_without_phase(x: &mut [f64], passes: Passes, corner: f64) {
    let sections = QUALITIES.map(|q| Section::new(passes, corner, q));
    let period = (1.0 / corner).ceil() as usize;
    let read: Vec<usize> = (0..x.len()).filter(|i| x[*i].is_finite()).collect();
    for stretch in read.chunk_by(|a, b| b - a <= period) {
        let (Some(first), Some(last)) = (stretch.first(), stretch.last()) else {
            continue;
        };
        if last - first < period {
            stretch.iter().for_each(|i| x[*i] = f64::NAN);
            continue;
        }
        let mut bridged = x[*first..=*last].to_vec();
        for pair in stretch.windows(2) {
            let (a, b) = (pair[0], pair[1]);
            for i in a + 1..b {
                let share = (i - a) as f64 / (b - a) as f64;
                bridged[i - first] = x[a] + share * (x[b] - x[a]);
            }
        }
        filter_stretch(&mut bridged, &sections);
        stretch.iter().for_each(|i| x[*i] = bridged[i - first]);
    }
}

fn filter_stretch(x: &mut [f64], sections: &[Section; 2]) {
    let edge = EDGE.min(x.len() - 1);
    let (first, last) = (x[0], x[x.len() - 1]);
    let before = (1..=edge).rev().map(|i| 2.0 * first - x[i]);
    let after = (1..=edge).map(|i| 2.0 * last - x[x.len() - 1 - i]);
    let mut all: Vec<f64> = before.chain(x.iter().copied()).chain(after).collect();
    for _ in 0..2 {
        sections.iter().for_each(|s| s.run(&mut all));
        all.reverse();
    }
    x.copy_from_slice(&all[edge..edge + x.len()]);
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares amplitudes of sines with the closed form.
    #[test]
    fn sines_have_the_amplitude_of_the_closed_form_and_no_phase_shift() {
        for (passes, hz) in [(Passes::Low, 7.0), (Passes::Low, 30.0), (Passes::High, 7.0)] {
            let (rate, corner) = (250.0, 20.0);
            let wave = |i: usize| (2.0 * PI * hz * i as f64 / rate).sin();
            let mut x: Vec<f64> = (0..5000).map(wave).collect();
            filter_without_phase(&mut x, passes, corner / rate);
            let w: f64 = (PI * hz / rate).tan() / (PI * corner / rate).tan();
            let w = if passes == Passes::Low { w } else { 1.0 / w };
            let gain = 1.0 / (1.0 + w.powi(8));
            for i in 1000..4000 {
                assert!((x[i] - gain * wave(i)).abs() < 1e-9, "{hz} {i}");
            }
        }
    }

    /// SciPy 1.17.1: `sosfiltfilt(butter(4, 20, fs=250, output="sos"), x)` on `x[i] = i % 7 + 0.1 i`, 40 samples.
    #[test]
    fn the_ends_are_those_of_scipy() {
        let mut x: Vec<f64> = (0..40)
            .map(|i| f64::from(i % 7) + 0.1 * f64::from(i))
            .collect();
        filter_without_phase(&mut x, Passes::Low, 20.0 / 250.0);
        let expected = [
            (0, 0.017_315_731_609_063_523),
            (1, 1.128_373_240_491_033),
            (20, 5.025_352_814_553_94),
            (38, 7.375_341_691_597_592),
            (39, 7.889_780_222_712_94),
        ];
        for (i, want) in expected {
            assert!((x[i] - want).abs() < 1e-9, "{i} {} {want}", x[i]);
        }
    }

    /// A missing sample is bridged: a high-pass hardly changes its neighbours. A long gap separates stretches, and a short stretch is blank.
    #[test]
    fn short_gaps_are_bridged_and_long_ones_separate_stretches() {
        let wave = |i: usize| (2.0 * PI * i as f64 / 50.0).sin();
        let whole: Vec<f64> = (0..1000).map(wave).collect();
        let mut gap = whole.clone();
        (20..1000).step_by(40).for_each(|i| gap[i] = f64::NAN);
        let mut plain = whole.clone();
        filter_without_phase(&mut gap, Passes::High, 0.002);
        filter_without_phase(&mut plain, Passes::High, 0.002);
        let both = gap.iter().zip(&plain).filter(|(g, _)| g.is_finite());
        let most = both.fold(0.0_f64, |m, (g, p)| m.max((g - p).abs()));
        assert!(most < 0.02, "{most}");
        assert_eq!(gap.iter().filter(|v| v.is_nan()).count(), 25);
        let mut long = whole;
        long[100..600].fill(f64::NAN);
        long[605..].fill(f64::NAN);
        filter_without_phase(&mut long, Passes::Low, 0.05);
        assert!(long[..100].iter().all(|v| v.is_finite()));
        assert!(long[100..].iter().all(|v| v.is_nan()));
    }
}
