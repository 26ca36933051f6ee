use super::*;
use std::f64::consts::TAU;

/// Returns two signals of three sines each, whose periods have no common multiple.
fn signals(start_s: f64, rate_hz: f64, n: usize) -> Vec<Vec<f32>> {
    let of = |frequencies: [f64; 3]| {
        let value = |i: usize| {
            let t = start_s + i as f64 / rate_hz;
            let sines = frequencies.iter().zip([1.0, 0.7, 0.4]);
            100.0 + 50.0 * sines.map(|(f, a)| a * (TAU * f * t).sin()).sum::<f64>()
        };
        (0..n).map(|i| value(i) as f32).collect()
    };
    vec![of([0.31, 1.13, 2.71]), of([0.47, 1.61, 2.23])]
}

#[test]
fn a_shift_of_a_fraction_of_a_sample_is_found_at_two_rates() {
    for (rate, shift) in [(100.0, 3.7_f64), (128.0, -2.3456), (100.0, 0.0)] {
        let fixed = signals(5.0, 100.0, 6000);
        // Sample i of the moving signals was taken at 5 + i / rate. Their clock shows this time minus the shift.
        let moving = signals(5.0, rate, 6000);
        let found = estimate_shift(
            SampledSignals {
                start_s: 5.0,
                rate_hz: 100.0,
                signals: &fixed,
            },
            SampledSignals {
                start_s: 5.0 - shift,
                rate_hz: rate,
                signals: &moving,
            },
            &ShiftRules::default(),
        )
        .unwrap();
        // The error of cubic interpolation is 3/128 (2 pi f / rate)^4 of a sine. For the fastest sine here it is 2e-5, or 1e-5 s at its slope.
        assert!((found.seconds - shift).abs() < 2e-5, "{found:?} {shift}");
        assert!(
            found.half_width_s < 1e-4 && found.correlation > 0.99,
            "{found:?}"
        );
    }
}

#[test]
fn constant_unlike_and_periodic_signals_have_no_shift() {
    let fixed = signals(0.0, 100.0, 3000);
    let of = |signals: &[Vec<f32>]| {
        let sampled = |signals| SampledSignals {
            start_s: 0.0,
            rate_hz: 100.0,
            signals,
        };
        estimate_shift(sampled(&fixed), sampled(signals), &ShiftRules::default())
    };
    assert_eq!(of(&vec![vec![1.0; 3000]; 2]), Err(NoShift::Constant));
    let other: Vec<f32> = (0..3000)
        .map(|i| ((i * i % 1013 * 7919) % 1013) as f32)
        .collect();
    assert!(matches!(
        of(&[other.clone(), other]),
        Err(NoShift::Unlike(_))
    ));
    let sine: Vec<Vec<f32>> = vec![
        (0..3000)
            .map(|i| (TAU * 0.02 * f64::from(i)).sin() as f32)
            .collect(),
    ];
    let sampled = SampledSignals {
        start_s: 0.0,
        rate_hz: 100.0,
        signals: &sine,
    };
    let found = estimate_shift(sampled, sampled, &ShiftRules::default());
    assert!(matches!(found, Err(NoShift::Ambiguous(_))), "{found:?}");
}

/// Four samples determine every value of a cubic. For a parabola, linear interpolation has the error `u (1 - u)` times half of the second difference.
#[test]
fn values_between_samples_are_those_of_the_cubic() {
    let samples: Vec<Vec<f32>> = vec![(0..8).map(|i| (i * i * i - 5 * i * i) as f32).collect()];
    let sampled = SampledSignals {
        start_s: 2.0,
        rate_hz: 4.0,
        signals: &samples,
    };
    let x: f64 = 3.25;
    let found = sampled.value_at(0, 2.0 + x / 4.0).unwrap();
    assert!((found.value - (x * x * x - 5.0 * x * x)).abs() < 1e-12);
    assert!(
        (found.line - (-18.0 + 0.25 * 2.0)).abs() < 1e-12,
        "{found:?}"
    );
    // In the middle the weights are -1/16, 9/16, 9/16, -1/16: squares sum to 164/256.
    let middle = sampled.value_at(0, 2.0 + 3.5 / 4.0).unwrap();
    assert!((middle.noise * middle.noise - 164.0 / 256.0).abs() < 1e-12);
    let last = sampled
        .value_at(0, 2.0 + 7.0 / 4.0)
        .map(|v| (v.value, v.noise));
    assert_eq!(last, Some((98.0, 1.0)));
    assert_eq!(sampled.value_at(0, 2.0 + 7.5 / 4.0), None);
}
