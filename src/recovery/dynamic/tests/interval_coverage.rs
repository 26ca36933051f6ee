//! Tests intervals against errors of frequency, of modes outside the model, and of the gauges that read.

use super::{
    Matrix, N_GAUGES, STRUCTURE, Structure, TAU, Waves, draw_normal, load, load_weights, loads_at,
    strain, variance, waves,
};
use crate::recovery::dynamic::readings_at_rest;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Returns the share of weighted loads within their intervals, the mean square error over the predicted variance, that variance, and its part from
/// noise. Frequencies of the real structures differ randomly from the model. `blank` removes readings; `is_tested` selects the samples.
fn simulate_coverage(
    weights: [f64; 2],
    of_loads: impl Fn(&mut ChaCha8Rng) -> Waves,
    blank: impl Fn(&mut [Vec<f64>]),
    is_tested: impl Fn(usize) -> bool,
) -> [f64; 4] {
    let mut random = ChaCha8Rng::seed_from_u64(15);
    let mut normal = || draw_normal(&mut random);
    let (stated, sd, noise, rate, samples) = (STRUCTURE, [0.01, 0.0], 1e-4, 250.0, 1500);
    let (s, dynamics) = stated.build_model(20.0, sd);
    let (mut inside, mut all, mut errors, mut variances) = (0, 0, 0.0, 0.0);
    let mut by_noise = 0.0;
    for trial in 0..100 {
        let mut real = STRUCTURE;
        for j in 0..3 {
            real.hz[j] *= 1.0 + sd[0] * normal();
            let share = (real.hz[j] / stated.hz[j]).powi(2);
            real.work[j] = real.work[j].map(|w| w * share);
        }
        let waves = of_loads(&mut ChaCha8Rng::seed_from_u64(200 + trial));
        let mut record: Vec<Vec<f64>> = (0..N_GAUGES)
            .map(|g| {
                let reading = |i| strain(&real, &waves, g, f64::from(i) / rate) + noise * normal();
                (0..samples).map(reading).collect()
            })
            .collect();
        blank(&mut record);
        let rested = readings_at_rest(&s, &dynamics, noise, &record, rate).unwrap();
        for i in (0..samples as usize).step_by(37).filter(|i| is_tested(*i)) {
            let reads = |g: &usize| rested.readings[*g][i].is_finite();
            let used: Vec<usize> = (0..N_GAUGES).filter(reads).collect();
            if used.is_empty() {
                continue;
            }
            let rows = Matrix::from_fn(used.len(), 2, |g, l| s.values[(used[g], l)]);
            let w = rows.pseudo_inverse(1e-12).unwrap().transpose()
                * crate::linalg::Vector::from_column_slice(&weights);
            let got: f64 = used
                .iter()
                .zip(w.iter())
                .map(|(g, w)| w * rested.readings[*g][i])
                .sum();
            let of_noise = (w.transpose() * rested.doubt.of_noise(&used) * &w)[0];
            let of_noise = rested.noise_share * noise * noise * w.norm_squared() + of_noise;
            let variance = of_noise + rested.doubt.of_motion(Some(i), &used, w.as_slice());
            let expected: f64 = (0..2)
                .map(|l| weights[l] * load(&waves[l], i as f64 / rate))
                .sum();
            inside += usize::from((got - expected).powi(2) <= 1.96_f64.powi(2) * variance);
            errors += (got - expected).powi(2);
            variances += variance;
            by_noise += of_noise;
            all += 1;
        }
    }
    assert!(all > 300, "{all}");
    let all = all as f64;
    [
        inside as f64 / all,
        errors / variances,
        variances / all,
        by_noise / all,
    ]
}

fn random_waves(random: &mut ChaCha8Rng) -> Waves {
    waves(
        [&[1.0, 3.1, 6.2, 10.7, 17.0], &[0.7, 4.9, 9.8, 15.1, 18.9]],
        random,
    )
}

/// Tests sums and differences of loads. The frequency error of one mode affects all loads at once, so their errors are correlated.
#[test]
fn intervals_of_sums_of_loads_hold_what_one_mode_puts_into_all() {
    for weights in [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, -1.0]] {
        let [share, squares, ..] = simulate_coverage(weights, random_waves, |_| (), |_| true);
        // The share has the same limits as above. The mean square of 100 structures scatters by 14 %, and more because their loads differ. The limits
        // are three times this scatter.
        assert!((0.90..=0.99).contains(&share), "{weights:?} {share}");
        assert!((0.55..=1.6).contains(&squares), "{weights:?} {squares}");
    }
}

/// Some gauges read in one half, others in the other half, and never all of them. Each set has separate errors.
#[test]
fn intervals_hold_for_the_gauges_that_read() {
    let halves = |record: &mut [Vec<f64>]| {
        record[0][..750].fill(f64::NAN);
        record[3][..750].fill(f64::NAN);
        record[1][750..].fill(f64::NAN);
    };
    for part in [0..750, 750..1500] {
        for weights in [[1.0, 0.0], [0.0, 1.0]] {
            let [share, squares, ..] =
                simulate_coverage(weights, random_waves, halves, |i| part.contains(&i));
            assert!(
                (0.90..=0.99).contains(&share),
                "{part:?} {weights:?} {share}"
            );
            assert!(
                (0.5..=1.7).contains(&squares),
                "{part:?} {weights:?} {squares}"
            );
        }
    }
}

/// Tests a quiet record with a burst of one second. Intervals are wide in the burst and narrow in the quiet part.
#[test]
fn intervals_follow_a_record_that_rests_and_then_shakes() {
    // Waves .1 Hz apart with equal phase at 3 s form a Gaussian burst of .3 s, which repeats at 13 s.
    let burst = |_: &mut ChaCha8Rng| -> Waves {
        [7.0, 9.0].map(|f0| {
            let wave = |m: i32| {
                let off = 0.1 * f64::from(m);
                let size = 0.2 * (-0.5 * (TAU * 0.3 * off).powi(2)).exp();
                [size, f0 + off, -TAU * (f0 + off) * 3.0]
            };
            (-20..=20).map(wave).collect()
        })
    };
    let shakes = |i: usize| (i as f64 / 250.0 - 3.0).abs() < 0.3;
    let rests = |i: usize| i < 375;
    for weights in [[1.0, 0.0], [0.0, 1.0]] {
        let [share, squares, wide, noise] = simulate_coverage(weights, burst, |_| (), shakes);
        assert!((0.88..=1.0).contains(&share), "{weights:?} {share}");
        assert!((0.4..=2.0).contains(&squares), "{weights:?} {squares}");
        let [share, _, narrow, same] = simulate_coverage(weights, burst, |_| (), rests);
        assert!((0.88..=1.0).contains(&share), "{weights:?} {share}");
        // The burst is a Gaussian of .3 s. Five of its widths earlier there is only noise, whose variance is constant.
        assert!(
            (same / noise - 1.0).abs() < 1e-9,
            "{weights:?} {same} {noise}"
        );
        let [narrow, wide] = [narrow - noise, wide - noise];
        assert!(narrow < 0.01 * wide, "{weights:?} {narrow} {wide} {noise}");
    }
}

/// Tests a mode outside the model at three times the band. Its dynamic response is an eighth of its share at the end of the band.
#[test]
fn intervals_include_the_response_of_modes_outside_the_model() {
    let real = Structure {
        hz: [8.0, 13.0, 31.0, 60.0],
        ..STRUCTURE
    };
    let (s, mut dynamics) = real.build_model(20.0, [0.0, 0.0]);
    let waves = random_waves(&mut ChaCha8Rng::seed_from_u64(8));
    let of_gauge = |g| {
        let reading = |i| strain(&real, &waves, g, f64::from(i) / 250.0);
        (0..1500).map(reading).collect()
    };
    let record: Vec<Vec<f64>> = (0..N_GAUGES).map(of_gauge).collect();
    let mut holds = |further_hz| {
        dynamics.further_hz = further_hz;
        let rested = readings_at_rest(&s, &dynamics, 0.0, &record, 250.0).unwrap();
        let (mut inside, mut all) = (0, 0);
        for i in rested.reach..1500 - rested.reach {
            let got = loads_at(&s, &rested, i);
            for l in 0..2 {
                let error = got[l] - load(&waves[l], i as f64 / 250.0);
                let sigma = variance(&s, &rested, 0.0, i, &load_weights(&s, l)).sqrt();
                // The filter itself causes an error of a thousandth of the loads in the band.
                inside += usize::from(error.abs() <= 1.96 * sigma + 1e-3);
                all += 1;
            }
        }
        inside as f64 / all as f64
    };
    // The only omitted mode has the lowest frequency that further modes may have, so its error equals the predicted error. The peaks are root 2 of
    // the rms value.
    assert!(holds(Some(60.0)) > 0.99);
    assert!(holds(None) < 0.5);
}
