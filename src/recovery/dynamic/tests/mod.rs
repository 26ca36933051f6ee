mod estimated_modes;
mod interval_coverage;

use super::{AtRest, Dynamics, ElasticMode, Unfit, readings_at_rest};
use crate::linalg::{Complex, Matrix};
use crate::sensitivity::{Load, Sensitivity};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::f64::consts::TAU;

/// Returns a random number of mean 0 and variance 1 (Box and Muller).
fn draw_normal(random: &mut ChaCha8Rng) -> f64 {
    let (a, b): (f64, f64) = (
        random.random_range(1e-12..1.0),
        random.random_range(0.0..TAU),
    );
    (-2.0 * a.ln()).sqrt() * b.cos()
}

fn sensitivity(values: Matrix) -> Sensitivity {
    let loads = (0..values.ncols()).map(|l| Load::from_name(format!("F{l}")));
    Sensitivity {
        gauges: (0..values.nrows()).map(|g| format!("G{g}")).collect(),
        loads: loads.collect(),
        values,
        uncertainty: None,
        noise: None,
    }
}

/// Returns a mass on a spring with a gauge, 10 Hz. The static strain of a force equals the force.
fn oscillator(damping: f64, up_to_hz: f64) -> (Sensitivity, Dynamics) {
    let modes = vec![ElasticMode {
        hz: 10.0,
        strain: vec![1.0],
        work: vec![(TAU * 10.0_f64).powi(2)],
        damping,
        frequency_sd: 0.0,
        damping_sd: 0.0,
    }];
    let dynamics = Dynamics {
        modes,
        further_hz: None,
        further_damping: damping,
        up_to_hz,
    };
    (sensitivity(Matrix::from_element(1, 1, 1.0)), dynamics)
}

/// Tests a force `(1 - cos W t) / 2` for one period `T`, which is near the natural period, from rest. Without damping the strain is `((1 - cos w t) -
/// (cos W t - cos w t) / (1 - (W / w)^2)) / 2` during the pulse, and free vibration after it. Source: Biggs, Introduction to Structural Dynamics,
/// 1964, chapter 2 (Duhamel's integral).
#[test]
fn the_force_of_a_pulse_is_found_and_what_rings_after_it_is_none() {
    let (rate, own, period) = (1000.0, TAU * 10.0, 0.15);
    let drive = TAU / period;
    let share = 1.0 / (1.0 - (drive / own).powi(2));
    let during =
        |t: f64| 0.5 * ((1.0 - (own * t).cos()) - share * ((drive * t).cos() - (own * t).cos()));
    let speed = |t: f64| {
        0.5 * (own * (own * t).sin() + share * (drive * (drive * t).sin() - own * (own * t).sin()))
    };
    let strain = |t: f64| match t {
        t if t < 0.0 => 0.0,
        t if t < period => during(t),
        t => {
            let after = own * (t - period);
            during(period) * after.cos() + speed(period) / own * after.sin()
        }
    };
    let force = |t: f64| match (0.0..period).contains(&t) {
        true => 0.5 * (1.0 - (drive * t).cos()),
        false => 0.0,
    };
    let time = |i: usize| i as f64 / rate - 1.0;
    let record: Vec<f64> = (0..3000).map(|i| strain(time(i))).collect();
    let ringing = record[1500..].iter().fold(0.0_f64, |a, v| a.max(v.abs()));
    assert!(ringing > 0.5, "{ringing}");
    let (s, dynamics) = oscillator(1e-5, 60.0);
    let rested = readings_at_rest(&s, &dynamics, 0.0, &[record], rate).unwrap();
    let mut known = 0;
    for (i, got) in rested.readings[0].iter().enumerate() {
        if got.is_nan() {
            continue;
        }
        known += 1;
        // The spectrum of the pulse falls with the cube of the frequency. A few thousandths are above 60 Hz, nine times 1 / T.
        let expected = force(time(i));
        assert!(
            (got - expected).abs() < 5e-3,
            "{} {got} {expected}",
            time(i)
        );
    }
    assert_eq!(known, 3000 - 2 * rested.reach);
    assert!(rested.reach < 300, "{}", rested.reach);
}

const N_GAUGES: usize = 5;

/// Five gauges, two loads and four modes. The fourth mode is beyond the band and not part of the model.
struct Structure {
    hz: [f64; 4],
    strain: [[f64; N_GAUGES]; 4],
    work: [[f64; 2]; 4],
    damping: f64,
}

const STRUCTURE: Structure = Structure {
    hz: [8.0, 13.0, 31.0, 400.0],
    strain: [
        [1.0, 0.4, -0.3, 0.8, 0.1],
        [0.5, -0.8, 0.6, 0.1, 0.9],
        [-0.9, 0.7, 1.1, 0.2, -0.5],
        [30.0, -25.0, 40.0, 15.0, -20.0],
    ],
    work: [[0.9, 0.3], [0.2, 0.8], [0.7, -0.6], [10.0, 12.0]],
    damping: 0.02,
};

impl Structure {
    fn modal_response(&self, j: usize, l: usize, hz: f64) -> Complex<f64> {
        let (own, w) = (TAU * self.hz[j], TAU * hz);
        let x = Complex::new(own * own - w * w, 2.0 * self.damping * own * w);
        x.inv() * self.work[j][l]
    }

    /// Returns the strain of gauge `g` under load `l` at the frequency, by modal superposition.
    fn response(&self, g: usize, l: usize, hz: f64) -> Complex<f64> {
        (0..4)
            .map(|j| self.modal_response(j, l, hz) * self.strain[j][g])
            .sum()
    }

    fn build_model(&self, up_to_hz: f64, sd: [f64; 2]) -> (Sensitivity, Dynamics) {
        let s = Matrix::from_fn(N_GAUGES, 2, |g, l| self.response(g, l, 0.0).re);
        let modes = (0..3).map(|j| ElasticMode {
            hz: self.hz[j],
            strain: self.strain[j].to_vec(),
            work: self.work[j].to_vec(),
            damping: self.damping,
            frequency_sd: sd[0],
            damping_sd: sd[1],
        });
        let dynamics = Dynamics {
            modes: modes.collect(),
            further_hz: None,
            further_damping: self.damping,
            up_to_hz,
        };
        (sensitivity(s), dynamics)
    }
}

/// Sizes, frequencies and phases of the waves of two loads.
type Waves = [Vec<[f64; 3]>; 2];

fn waves(hz: [&[f64]; 2], random: &mut ChaCha8Rng) -> Waves {
    hz.map(|list| {
        let wave = |f: &f64| [1.0 / list.len() as f64, *f, random.random_range(0.0..TAU)];
        list.iter().map(wave).collect()
    })
}

fn load(waves: &[[f64; 3]], t: f64) -> f64 {
    waves
        .iter()
        .map(|[a, f, p]| a * (TAU * f * t + p).cos())
        .sum()
}

fn strain(of: &Structure, waves: &Waves, g: usize, t: f64) -> f64 {
    let of_load = |(l, list): (usize, &Vec<[f64; 3]>)| -> f64 {
        let wave = |[a, f, p]: &[f64; 3]| {
            (of.response(g, l, *f) * Complex::from_polar(*a, TAU * f * t + p)).re
        };
        list.iter().map(wave).sum()
    };
    waves.iter().enumerate().map(of_load).sum()
}

fn loads_at(s: &Sensitivity, rested: &AtRest, i: usize) -> [f64; 2] {
    let y = crate::linalg::Vector::from_fn(N_GAUGES, |g, _| rested.readings[g][i]);
    let inverse = s.values.clone().pseudo_inverse(1e-12).unwrap();
    let f = inverse * y;
    [f[0], f[1]]
}

fn load_weights(s: &Sensitivity, l: usize) -> Vec<f64> {
    let gain = s.values.clone().pseudo_inverse(1e-12).unwrap();
    gain.row(l).iter().copied().collect()
}

/// Returns the stated variance of the sum of all readings at a sample, weighted by `weights`.
fn variance(s: &Sensitivity, rested: &AtRest, noise: f64, i: usize, weights: &[f64]) -> f64 {
    let all: Vec<usize> = (0..s.gauges.len()).collect();
    let w = crate::linalg::Vector::from_column_slice(weights);
    let of_noise = rested.doubt.of_noise(&all);
    rested.noise_share * noise * noise * w.norm_squared()
        + (w.transpose() * of_noise * &w)[0]
        + rested.doubt.of_motion(Some(i), &all, weights)
}

#[test]
fn loads_about_three_modes_are_those_that_modal_superposition_was_given() {
    let mut random = ChaCha8Rng::seed_from_u64(3);
    let waves = waves(
        [&[0.0, 2.0, 7.7, 12.0], &[1.0, 9.5, 13.2, 24.0]],
        &mut random,
    );
    let rate = 500.0;
    let record: Vec<Vec<f64>> = (0..N_GAUGES)
        .map(|g| {
            (0..6000)
                .map(|i| strain(&STRUCTURE, &waves, g, f64::from(i) / rate))
                .collect()
        })
        .collect();
    let (s, dynamics) = STRUCTURE.build_model(25.0, [0.0, 0.0]);
    let rested = readings_at_rest(&s, &dynamics, 0.0, &record, rate).unwrap();
    let at_rest = AtRest {
        readings: record,
        ..rested.clone()
    };
    let (mut worst, mut as_if) = (0.0_f64, 0.0_f64);
    for i in rested.reach..6000 - rested.reach {
        let (got, raw) = (loads_at(&s, &rested, i), loads_at(&s, &at_rest, i));
        for l in 0..2 {
            let expected = load(&waves[l], i as f64 / rate);
            worst = worst.max((got[l] - expected).abs());
            as_if = as_if.max((raw[l] - expected).abs());
        }
    }
    // A thousandth of the filter weights is beyond the reach. The dynamic response of the fourth mode is 1 / (1 - (24 / 400)^2) - 1, .4 % of its
    // static share.
    assert!(worst < 5e-3, "{worst}");
    assert!(as_if > 1.0, "{as_if}");
}

#[test]
fn a_gap_takes_what_hangs_on_it_and_the_rest_stays() {
    let mut random = ChaCha8Rng::seed_from_u64(4);
    let waves = waves([&[2.0, 7.7], &[9.5]], &mut random);
    let mut record: Vec<Vec<f64>> = (0..N_GAUGES)
        .map(|g| {
            (0..4000)
                .map(|i| strain(&STRUCTURE, &waves, g, f64::from(i) / 500.0))
                .collect()
        })
        .collect();
    let (s, dynamics) = STRUCTURE.build_model(25.0, [0.0, 0.0]);
    let whole = readings_at_rest(&s, &dynamics, 0.0, &record, 500.0).unwrap();
    assert_eq!(whole.blank, 2 * whole.reach);
    record.iter_mut().for_each(|c| c[1500..1600].fill(f64::NAN));
    // Without one gauge, the other gauges still determine the loads.
    record[2][2800..].fill(f64::NAN);
    let gap = readings_at_rest(&s, &dynamics, 0.0, &record, 500.0).unwrap();
    let r = gap.reach;
    for (i, (a, b)) in whole.readings[0].iter().zip(&gap.readings[0]).enumerate() {
        let near = |at: usize| (at.saturating_sub(r)..at + r).contains(&i);
        if near(1500) || (1500..1600 + r).contains(&i) {
            assert!(b.is_nan(), "{i}");
        } else if i < 2800 - r && i >= r {
            assert!((a - b).abs() < 1e-3 * 0.02, "{i} {a} {b}");
        }
    }
    assert!(gap.readings[2][2800..].iter().all(|v| v.is_nan()));
    let known = gap.readings[0][2800..]
        .iter()
        .filter(|v| v.is_finite())
        .count();
    assert!(known > 600, "{known}");
}

/// Tests structures whose frequencies and damping deviate from the model by the stated standard deviations, with noise. Counts how often the true
/// loads are within 1.96 standard deviations.
#[test]
fn intervals_hold_what_frequencies_damping_and_noise_make() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut normal = || draw_normal(&mut random);
    let (stated, sd, noise, rate) = (STRUCTURE, [0.02, 0.3], 2e-5, 250.0);
    let (s, dynamics) = stated.build_model(20.0, sd);
    let (mut held, mut all) = (0, 0);
    for trial in 0..100 {
        let mut real = STRUCTURE;
        for j in 0..3 {
            real.hz[j] *= 1.0 + sd[0] * normal();
            // A mode with a higher frequency due to less mass has the same static strain under the same loads.
            let share = (real.hz[j] / stated.hz[j]).powi(2);
            real.work[j] = real.work[j].map(|w| w * share);
        }
        real.damping *= 1.0 + sd[1] * normal().clamp(-2.5, 2.5);
        let mut other = ChaCha8Rng::seed_from_u64(100 + trial);
        let waves = waves(
            [&[1.0, 3.1, 6.2, 10.7, 17.0], &[0.7, 4.9, 9.8, 15.1, 18.9]],
            &mut other,
        );
        let record: Vec<Vec<f64>> = (0..N_GAUGES)
            .map(|g| {
                let reading = |i| strain(&real, &waves, g, f64::from(i) / rate) + noise * normal();
                (0..1500).map(reading).collect()
            })
            .collect();
        let rested = readings_at_rest(&s, &dynamics, noise, &record, rate).unwrap();
        for i in (rested.reach..1500 - rested.reach).step_by(97) {
            let got = loads_at(&s, &rested, i);
            for l in 0..2 {
                let sigma = variance(&s, &rested, noise, i, &load_weights(&s, l)).sqrt();
                let error = got[l] - load(&waves[l], i as f64 / rate);
                held += usize::from(error.abs() <= 1.96 * sigma);
                all += 1;
            }
        }
    }
    let share = held as f64 / all as f64;
    // The errors of one structure are correlated, so with 100 structures three standard errors of the share are about 5 %. The prediction uses one sd
    // of the deviation. The error of a real structure can be smaller or larger, so the tails are wider than in a normal distribution.
    assert!((0.90..=0.99).contains(&share), "{share}");
}

#[test]
fn noise_alone_has_the_stated_variance() {
    let mut random = ChaCha8Rng::seed_from_u64(6);
    let mut normal = || draw_normal(&mut random);
    let (s, dynamics) = STRUCTURE.build_model(20.0, [0.0, 0.0]);
    let record: Vec<Vec<f64>> = (0..N_GAUGES)
        .map(|_| (0..40_000).map(|_| normal()).collect())
        .collect();
    let rested = readings_at_rest(&s, &dynamics, 1.0, &record, 250.0).unwrap();
    let gain = s.values.clone().pseudo_inverse(1e-12).unwrap();
    let range = rested.reach..40_000 - rested.reach;
    for l in 0..2 {
        let square: f64 = range
            .clone()
            .map(|i| loads_at(&s, &rested, i)[l].powi(2))
            .sum();
        let got = square / range.len() as f64;
        let expected = variance(&s, &rested, 1.0, 20_000, &load_weights(&s, l));
        // There are about 40,000 x 50 / 250 independent numbers, which scatter by 1.6 %. The limit is three times this scatter.
        assert!((got / expected - 1.0).abs() < 0.05, "{l} {got} {expected}");
        // Without motion error, the variance of filtered white noise can't be below the share of the band.
        assert!(
            expected > 0.5 * 2.0 * 20.0 / 250.0 * gain.row(l).norm_squared(),
            "{expected}"
        );
    }
}

#[test]
fn impossible_bands_are_faults() {
    let record = vec![vec![0.0; 1000]];
    let (s, dynamics) = oscillator(0.02, 60.0);
    let slow = readings_at_rest(&s, &dynamics, 0.0, &record, 150.0).unwrap_err();
    assert!(matches!(slow, Unfit::Rate { .. }), "{slow}");
    // One gauge can't separate two loads.
    let (_, mut dynamics) = oscillator(0.02, 20.0);
    dynamics.modes[0].work = vec![1.0, 1.0];
    let s = sensitivity(Matrix::from_element(1, 2, 1.0));
    let unfit = readings_at_rest(&s, &dynamics, 0.0, &record, 500.0).unwrap_err();
    assert!(matches!(unfit, Unfit::NotSeparable { .. }), "{unfit}");
    // Bands of less than a billionth of the rate for any structure, and a band whose reach is too long. A lower band would have a longer reach.
    let (s, mut dynamics) = oscillator(0.02, 20.0);
    for (up_to_hz, rate) in [(1e-18, 500.0), (1e-300, 500.0), (0.001, 50.0)] {
        dynamics.up_to_hz = up_to_hz;
        let narrow = readings_at_rest(&s, &dynamics, 0.0, &record, rate).unwrap_err();
        assert!(
            matches!(narrow, Unfit::Narrow { .. }),
            "{up_to_hz} {narrow}"
        );
    }
    // More modes than the memory limit of a filter permits: 2 x 3 numbers for each mode and frequency.
    dynamics.up_to_hz = 20.0;
    dynamics.modes = vec![dynamics.modes[0].clone(); 400_000];
    let large = readings_at_rest(&s, &dynamics, 0.0, &record, 500.0).unwrap_err();
    assert!(matches!(large, Unfit::Large { .. }), "{large}");
    // The gauge has no strain from the load at one frequency in the band, and almost no damping. Its reading there depends on hours of the record.
    let (_, mut dynamics) = oscillator(1e-7, 40.0);
    dynamics.modes[0].strain = vec![0.5];
    let s = sensitivity(Matrix::from_element(1, 1, 1.0));
    let rings = readings_at_rest(&s, &dynamics, 0.0, &record, 500.0).unwrap_err();
    assert!(matches!(rings, Unfit::Rings { .. }), "{rings}");
}
