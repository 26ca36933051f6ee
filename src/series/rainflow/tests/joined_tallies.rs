//! Compares tallies of parts with the tally of the whole record, and tests the interval of damage over days.

use crate::series::rainflow::*;

/// Uniform numbers between -1 and 1, equal on every machine (splitmix64).
struct Numbers(u64);

impl Numbers {
    fn even(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Returns a random number of mean 0 and standard deviation 1.
    fn normal_number(&mut self) -> f64 {
        (0..12).map(|_| 0.5 * self.even()).sum()
    }
}

fn tally(rows: &[f64], k: usize, load: usize, noise: f64) -> Tally {
    let mut counter = Counter::new(load, k, noise, 0.25, Law::from_slope(5.0));
    // In blocks of different size, as in real records.
    for block in rows.chunks(k * 37) {
        push(&mut counter, block, &vec![noise; k]);
    }
    counter.finish()
}

fn push(counter: &mut Counter, rows: &[f64], noise: &[f64]) {
    let mut marks = Vec::new();
    Marks::new(noise).append_marks(rows, &mut marks);
    counter.push(rows, &marks);
}

/// Returns two loads with gaps. The first one is rounded, so that many reversals are equal.
fn history(n: usize) -> Vec<f64> {
    let mut numbers = Numbers(3);
    let (mut a, mut b) = (0.0, 0.0);
    (0..n)
        .flat_map(|i| {
            a = 0.9 * a + numbers.normal_number();
            b = 0.5 * b + 0.3 * a + numbers.normal_number();
            let gap = i % 977 < 3;
            [
                if gap {
                    f64::NAN
                } else {
                    (a * 4.0).round() / 4.0
                },
                b,
            ]
        })
        .collect()
}

#[test]
fn parts_join_to_the_whole_to_the_last_cycle_wherever_they_are_cut() {
    let (n, k) = (20_000, 2);
    let rows = history(n);
    for load in 0..k {
        let whole = tally(&rows, k, load, 0.0);
        assert!(whole.cycles.iter().map(|c| c.2).sum::<u64>() > 1000);
        for cuts in [1, 2, 7, 50, 3000] {
            let mut numbers = Numbers(cuts as u64);
            let mut at: Vec<usize> = (0..cuts)
                .map(|_| ((numbers.even() + 1.0) * 0.5 * n as f64) as usize)
                .collect();
            at.extend([0, n]);
            at.sort_unstable();
            let parts: Vec<Tally> = at
                .windows(2)
                .map(|w| tally(&rows[w[0] * k..w[1] * k], k, load, 0.0))
                .collect();
            let joined = Tally::join_parts(&parts.iter().collect::<Vec<_>>()).unwrap();
            assert_eq!(joined.cycles, whole.cycles, "{cuts}");
            assert_eq!(joined.levels, whole.levels, "{cuts}");
            assert_eq!(joined.range_pairs(), whole.range_pairs(), "{cuts}");
            assert_eq!((joined.max, joined.min), (whole.max, whole.min), "{cuts}");
            assert_eq!((joined.samples, joined.missing), (n, whole.missing));
            let values = |t: &Tally| t.residues[0].iter().map(|r| r.value).collect::<Vec<_>>();
            assert_eq!(values(&joined), values(&whole), "{cuts}");
            let (a, b) = (
                damage_interval(&joined, &[1e-4, 0.0, 0.0, 1e-4], 0.0),
                damage_interval(&whole, &[1e-4, 0.0, 0.0, 1e-4], 0.0),
            );
            // Sums of equal numbers in another order.
            for (a, b) in [(a.value, b.value), (a.low, b.low), (a.high, b.high)] {
                assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
            }
        }
    }
}

#[test]
fn what_is_kept_as_json_comes_back_whole_gaps_and_an_endless_slope_too() {
    let law = Law {
        slope: 5.0,
        knee: Some(Knee {
            range: 1.0,
            slope: f64::INFINITY,
        }),
    };
    let mut counter = Counter::new(0, 2, 0.1, 0.25, law);
    // The second load is missing at reversals of the first.
    push(
        &mut counter,
        &[0.0, f64::NAN, 3.0, f64::NAN, -1.0, 2.0, 2.0, 1.0],
        &[0.1; 2],
    );
    let tally = counter.finish();
    let text = serde_json::to_string(&tally).unwrap();
    let back: Tally = serde_json::from_str(&text).unwrap();
    assert_eq!(back.law, law);
    assert_eq!((&back.cycles, &back.levels), (&tally.cycles, &tally.levels));
    let first = |t: &Tally| t.residues[0][0].loads.clone();
    assert!(first(&back)[1].is_nan() && first(&back)[0] == first(&tally)[0]);
}

#[test]
fn joining_in_two_steps_is_joining_at_once() {
    let rows = history(9000);
    let parts: Vec<Tally> = rows.chunks(2 * 1000).map(|c| tally(c, 2, 0, 0.1)).collect();
    let all = Tally::join_parts(&parts.iter().collect::<Vec<_>>()).unwrap();
    let halves: Vec<Tally> = parts
        .chunks(4)
        .map(|c| Tally::join_parts(&c.iter().collect::<Vec<_>>()).unwrap())
        .collect();
    let twice = Tally::join_parts(&halves.iter().collect::<Vec<_>>()).unwrap();
    assert_eq!(
        (all.cycles, all.levels, all.max),
        (twice.cycles, twice.levels, twice.max)
    );
}

#[test]
fn damage_of_a_sine_in_noise_is_that_of_the_sine_and_never_above_what_was_counted() {
    // 400 periods of range 4: 400 * 4^5. Noise of 2 to 15 % of the range makes 1.2 to 7.6 times as much.
    let truth = 400.0 * 4f64.powi(5);
    for (seed, share) in (1..).zip([0.02, 0.05, 0.08, 0.1, 0.15]) {
        let sigma = 4.0 * share;
        let mut numbers = Numbers(seed);
        let sine = |i: i32| -2.0 * (std::f64::consts::TAU * f64::from(i) / 64.0).cos();
        let rows: Vec<f64> = (0..=400 * 64)
            .map(|i| sine(i) + sigma * numbers.normal_number())
            .collect();
        let d = damage_interval(&tally(&rows, 1, 0, sigma), &[0.0], sigma);
        let ratio = d.value / truth;
        assert!(d.value <= d.counted && d.counted > truth, "{share}: {d:?}");
        // An independent count with a hundred times as many periods gave .97 to 1.12 times the truth. If noise makes seven times the damage, only the
        // interval is tested.
        assert!(
            share > 0.1 || (0.7..1.3).contains(&ratio),
            "{share}: {ratio} {d:?}"
        );
        assert!(d.low < truth && truth < d.high, "{share}: {d:?}");
    }
}

#[test]
fn damage_without_the_bias_of_noise_is_the_same_however_the_record_is_cut() {
    let (n, k, noise) = (20_000, 2, 0.05);
    let rows = history(n);
    let whole = damage_interval(&tally(&rows, k, 0, noise), &[0.0; 4], noise);
    assert!(whole.noise_bias > 0.0);
    for cuts in [1, 2, 7, 50] {
        let mut numbers = Numbers(cuts as u64);
        let mut at: Vec<usize> = (0..cuts)
            .map(|_| ((numbers.even() + 1.0) * 0.5 * n as f64) as usize)
            .collect();
        at.extend([0, n]);
        at.sort_unstable();
        // The loads of each part have different rounding errors, as from a separate filter for each part.
        let part = |w: &[usize]| {
            let off = 1.0 + 1e-13 * w[0] as f64 / n as f64;
            let loads: Vec<f64> = rows[w[0] * k..w[1] * k].iter().map(|v| v * off).collect();
            tally(&loads, k, 0, noise)
        };
        let parts: Vec<Tally> = at.windows(2).map(part).collect();
        let joined = Tally::join_parts(&parts.iter().collect::<Vec<_>>()).unwrap();
        let d = damage_interval(&joined, &[0.0; 4], noise);
        for (a, b) in [
            (d.value, whole.value),
            (d.low, whole.low),
            (d.high, whole.high),
        ] {
            assert!((a / b - 1.0).abs() < 1e-9, "{cuts}: {a} {b}");
        }
    }
}

/// Returns the ratio of the subtracted bias to the true bias for `periods` of a sine of `length` samples.
fn removed_bias_ratio(length: f64, periods: f64, share: f64, slope: f64) -> f64 {
    let mut numbers = Numbers(length as u64);
    let law = Law::from_slope(slope);
    let sigma = 4.0 * share;
    let sine = |i: usize| 2.0 * (std::f64::consts::TAU * i as f64 / length).sin();
    let clean: Vec<f64> = (0..(length * periods) as usize).map(sine).collect();
    let noisy: Vec<f64> = clean
        .iter()
        .map(|v| v + sigma * numbers.normal_number())
        .collect();
    let damage = |rows: &[f64], noise: f64| {
        let mut counter = Counter::new(0, 1, noise, 0.25, law);
        push(&mut counter, rows, &[noise]);
        damage_interval(&counter.finish(), &[0.0], noise)
    };
    let truth = damage(&clean, 0.0).value;
    let d = damage(&noisy, sigma);
    (d.counted - d.value) / (d.counted - truth)
}

#[test]
fn of_smooth_loads_as_much_is_taken_off_as_noise_adds() {
    // A parabola through the logarithms subtracted 1.2 to 1.7 times as much. Over this number of periods, the subtracted bias scatters by 2 to 4 %.
    for (length, share, slope) in [
        (16.3, 0.02, 5.0),
        (16.3, 0.02, 9.0),
        (64.3, 0.01, 5.0),
        (64.3, 0.02, 9.0),
        (200.7, 0.01, 5.0),
        (200.7, 0.02, 9.0),
    ] {
        let ratio = removed_bias_ratio(length, 5000.0, share, slope);
        assert!(
            (0.85..1.15).contains(&ratio),
            "{length} {share} {slope}: {ratio}"
        );
    }
}

#[test]
fn levels_are_rises_through_borders_sample_by_sample_on_borders_too() {
    // Multiples of 0.25 are on borders of classes of width .25. The second load is seldom on a border, and stays in one class for a long time.
    let rows = history(20_000);
    for load in 0..2 {
        let mut expected = std::collections::BTreeMap::new();
        let mut before: Option<f64> = None;
        for v in rows
            .chunks_exact(2)
            .map(|r| if load == 0 { r[0] } else { 0.02 * r[1] })
        {
            let here = (v / 0.25).floor();
            if v.is_nan() {
                continue;
            }
            let mut border = before.unwrap_or(here) + 1.0;
            while border <= here {
                *expected.entry(border as i32).or_insert(0) += 1;
                border += 1.0;
            }
            before = Some(here);
        }
        let scaled: Vec<f64> = rows
            .chunks_exact(2)
            .flat_map(|r| [r[0], 0.02 * r[1]])
            .collect();
        let found: Vec<(i32, usize)> = tally(&scaled, 2, load, 0.0)
            .levels
            .into_iter()
            .map(|(border, n)| (border, n as usize))
            .collect();
        assert!(!expected.is_empty(), "{load}");
        assert_eq!(found, expected.into_iter().collect::<Vec<_>>(), "{load}");
    }
}

#[test]
fn a_known_sine_is_known_cycles_levels_and_damage() {
    // 100 periods of amplitude 2 from valley to valley: full cycles of range 4, levels of width .25 from -2 to 2.
    let rows: Vec<f64> = (0..=100 * 64)
        .map(|i| -2.0 * (std::f64::consts::TAU * f64::from(i) / 64.0).cos())
        .collect();
    let t = tally(&rows, 1, 0, 0.0);
    // A hundred peaks between 101 valleys give a hundred cycles, the last as two half cycles.
    assert_eq!(t.n_cycles(), 100.0);
    let d = damage_interval(&t, &[0.0], 0.0);
    assert!(
        (d.value / (100.0 * 4f64.powi(5)) - 1.0).abs() < 1e-9,
        "{}",
        d.value
    );
    // The load rises through every inner border once a period.
    for (i, n) in &t.levels {
        if (-7..8).contains(i) {
            assert_eq!(*n, 100, "{i}");
        }
    }
    assert_eq!(t.max.unwrap().value, 2.0);
    assert_eq!(t.max.unwrap().at, 32);
}

#[test]
fn below_a_knee_a_cycle_does_what_the_flatter_line_states() {
    let law = Law {
        slope: 5.0,
        knee: Some(Knee {
            range: 10.0,
            slope: 9.0,
        }),
    };
    assert_eq!(law.damage(20.0), 20f64.powi(5));
    assert!((law.damage(5.0) - 1e5 * 0.5f64.powi(9)).abs() < 1e-6);
    let none = Law {
        slope: 5.0,
        knee: Some(Knee {
            range: 10.0,
            slope: f64::INFINITY,
        }),
    };
    assert_eq!((none.damage(9.99), none.derivative(9.99)), (0.0, 0.0));
    // `derivative` equals the difference quotient of the damage.
    for r in [2.0, 8.0, 15.0] {
        let h = 1e-5 * r;
        let slope = (law.damage(r + h) - law.damage(r - h)) / (2.0 * h);
        assert!((slope / law.derivative(r) - 1.0).abs() < 1e-6);
    }
}

/// Returns a day of two correlated loads in slow waves of random size, similar to wheel loads.
fn day(numbers: &mut Numbers, n: usize) -> Vec<f64> {
    let mut waves = [[0.0_f64; 2]; 2];
    let mut rows = Vec::with_capacity(2 * n);
    for _ in 0..n {
        // Each load is a lightly damped oscillator, some 25 samples a period, driven by noise.
        for w in &mut waves {
            let next = 1.9 * w[0] - 0.96 * w[1] + 0.1 * numbers.normal_number();
            *w = [next, w[0]];
        }
        rows.extend([waves[0][0], 0.5 * waves[0][0] + waves[1][0]]);
    }
    rows
}

#[test]
fn the_interval_of_damage_holds_over_thirty_days_with_one_error_of_scale() {
    const VEHICLES: usize = 1000;
    const DAYS: usize = 30;
    const SAMPLES: usize = 500;
    // Each entry of the gain has an error of 2 %, equal on every day. Noise is 2 % of the typical load and independent in each sample.
    const SCALE: f64 = 0.02;
    let mut numbers = Numbers(11);
    let sample = day(&mut numbers, 20_000);
    let rms = (sample.iter().step_by(2).map(|v| v * v).sum::<f64>() / 20_000.0).sqrt();
    let noise = 0.02 * rms;
    let covariance = [SCALE * SCALE, 0.0, 0.0, SCALE * SCALE];
    let (mut held, mut held_apart) = (0, 0);
    for _ in 0..VEHICLES {
        let c = [
            SCALE * numbers.normal_number(),
            SCALE * numbers.normal_number(),
        ];
        let mut truth = Vec::new();
        let mut seen = Vec::new();
        for _ in 0..DAYS {
            let rows = day(&mut numbers, SAMPLES);
            truth.push(tally(&rows, 2, 0, 0.0));
            let read: Vec<f64> = rows
                .chunks_exact(2)
                .flat_map(|r| {
                    let first = r[0] * (1.0 + c[0]) + c[1] * r[1];
                    [
                        first + noise * numbers.normal_number(),
                        r[1] + noise * numbers.normal_number(),
                    ]
                })
                .collect();
            seen.push(tally(&read, 2, 0, noise));
        }
        let of = |days: &[Tally]| Tally::join_parts(&days.iter().collect::<Vec<_>>()).unwrap();
        let real = damage_interval(&of(&truth), &covariance, 0.0).value;
        let d = damage_interval(&of(&seen), &covariance, noise);
        held += usize::from((d.low..=d.high).contains(&real));
        // Errors of equal size, but treated as independent from day to day.
        let apart: f64 = seen
            .iter()
            .map(|t| damage_interval(t, &covariance, noise).sigma_s.powi(2))
            .sum();
        held_apart += usize::from((d.value - real).abs() < 1.96 * apart.sqrt());
    }
    let share = |n: usize| n as f64 / VEHICLES as f64;
    // The standard deviation of a share of 0.95 in 1,000 trials is 0.7 %.
    assert!((0.92..=0.98).contains(&share(held)), "{}", share(held));
    assert!(share(held_apart) < 0.6, "{}", share(held_apart));
}
