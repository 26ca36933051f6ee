//! Gap of an equation over time and over the amplitude of the measured quantity. It shows effects that act only in a part of the record, or that grow
//! with amplitude.

use super::design::Bins;
use crate::estimate::rms;
use crate::series::plans::inverse;
use rustfft::num_complex::Complex64;

/// Stretches of equal length in time.
const STRETCHES: usize = 8;
/// Classes of amplitude, with as many samples each.
const CLASSES: usize = 5;
/// Share of the record at each end that the taper spoils.
const END: f64 = 0.075;

/// Local gap: RMS of the residual in a part of the record, divided by the RMS of the measured quantity in the whole record.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GapProfile {
    /// End of the stretch, seconds; gap.
    pub by_time: Vec<[f64; 2]>,
    /// Upper edge of the size of the measured quantity, over its RMS; gap.
    pub by_amplitude: Vec<[f64; 2]>,
}

/// Returns the profile of a residual relative to the measured quantity; empty for fewer than two bins. Both are bins at `f_hz` of one windowed
/// transform at `rate_hz` that begins at `start_s` ([`crate::series::window::WindowedTransform`]).
pub fn gap_profile(
    residual: &Bins,
    measured: &Bins,
    f_hz: &[f64],
    rate_hz: f64,
    start_s: f64,
) -> GapProfile {
    let (Some(first), Some(last)) = (f_hz.first(), f_hz.last()) else {
        return GapProfile::default();
    };
    let step = (last - first) / (f_hz.len().max(2) - 1) as f64;
    if f_hz.len() < 2 || step <= 0.0 {
        return GapProfile::default();
    }
    let length = (rate_hz / step).round() as usize;
    let at = (first / step).round() as usize;
    let plan = inverse(length);
    let in_time = |bins: &Bins| -> Vec<f64> {
        let mut input = plan.make_input_vec();
        for (cell, b) in input.iter_mut().skip(at).zip(bins) {
            *cell = *b;
        }
        // A real signal has a real mean and, if its length is even, a real last bin.
        if let Some(v) = input.first_mut() {
            *v = Complex64::default();
        }
        if length.is_multiple_of(2)
            && let Some(v) = input.last_mut()
        {
            v.im = 0.0;
        }
        let mut out = plan.make_output_vec();
        let done = plan.process(&mut input, &mut out);
        debug_assert!(done.is_ok());
        let ends = (END * length as f64).ceil() as usize;
        out.get(ends..length.saturating_sub(ends))
            .unwrap_or_default()
            .to_vec()
    };
    let (left, whole) = (in_time(residual), in_time(measured));
    let size = rms(whole.iter().copied()).max(f64::MIN_POSITIVE);
    let n = left.len();
    let begin = start_s + END * length as f64 / rate_hz;
    let by_time = (0..STRETCHES.min(n))
        .map(|i| {
            let (from, to) = (i * n / STRETCHES, (i + 1) * n / STRETCHES);
            let local = rms(left[from..to].iter().copied());
            [begin + to as f64 / rate_hz, local / size]
        })
        .collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_unstable_by(|a, b| whole[*a].abs().total_cmp(&whole[*b].abs()));
    let by_amplitude = (0..CLASSES.min(n))
        .map(|i| {
            let class = &order[i * n / CLASSES..(i + 1) * n / CLASSES];
            let top = class.last().map_or(0.0, |k| whole[*k].abs());
            [top / size, rms(class.iter().map(|k| left[*k])) / size]
        })
        .collect();
    GapProfile {
        by_time,
        by_amplitude,
    }
}

#[cfg(test)]
mod tests {
    use super::gap_profile;
    use crate::series::spectrum::Band;
    use crate::series::window::WindowedTransform;
    use std::f64::consts::TAU;

    const RATE: f64 = 100.0;

    fn signals(residual: impl Fn(f64, f64) -> f64) -> super::GapProfile {
        let band = Band {
            low_hz: 0.5,
            high_hz: 20.0,
        };
        let n = 8000;
        let mut window = WindowedTransform::new(n, RATE, band);
        // A wave whose amplitude varies with a period of 16 s.
        let wave = |i: usize| {
            let t = i as f64 / RATE;
            (1.0 - 0.8 * (TAU * t / 16.0).cos()) * (TAU * 3.0 * t).sin()
        };
        let whole: Vec<f64> = (0..n).map(wave).collect();
        let left: Vec<f64> = (0..n)
            .map(|i| residual(i as f64 / RATE, whole[i]))
            .collect();
        let (left, whole) = (window.bins(&left), window.bins(&whole));
        gap_profile(&left, &whole, &window.f_hz, RATE, 0.0)
    }

    #[test]
    fn a_fault_of_the_second_half_shows_in_time() {
        let c = signals(|t, _| if t < 40.0 { 0.01 } else { 0.05 } * (TAU * 5.0 * t).sin());
        let (early, late) = (c.by_time[1][1], c.by_time[6][1]);
        assert!((late / early - 5.0).abs() < 0.25, "{early} {late}");
        // RMS of the measured wave: root of half of (1 + 0.8^2 / 2). RMS of the residual: 0.05 / root 2.
        let expected = 0.05 / (1.0f64 + 0.32).sqrt();
        assert!((late / expected - 1.0).abs() < 0.05, "{late} {expected}");
    }

    #[test]
    fn a_gap_that_grows_with_the_cube_shows_by_amplitude() {
        let c = signals(|_, x| 0.02 * x * x * x);
        let classes: Vec<f64> = c.by_amplitude.iter().map(|a| a[1]).collect();
        assert!(classes.windows(2).all(|w| w[1] > w[0]), "{classes:?}");
        // The amplitudes of the class around 1.5 are twice the amplitudes of the class around 0.75, so the residual is eight times as large.
        assert!(classes[4] > 8.0 * classes[1], "{classes:?}");
    }
}
